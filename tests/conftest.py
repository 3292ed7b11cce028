"""How hypothesis searches: anew in every run at a desk, the same examples in CI, so that a red run can be run again;
and how wide things are printed."""

import os

from hypothesis import settings

settings.register_profile("desk", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
os.environ.pop("COLUMNS", None)  # what is printed is compared: as wide as without a terminal
settings.load_profile("ci" if os.environ.get("CI") else "desk")

pytest_plugins = ["tests.costs"]
