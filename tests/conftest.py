"""How hypothesis searches: anew in every run at a desk, the same examples in CI, so that a red run can be run again."""

import os

from hypothesis import settings

settings.register_profile("desk", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "desk")
