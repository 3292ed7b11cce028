"""Optional dependencies (extras): what to type where one is not installed."""

from __future__ import annotations

import re
from importlib import metadata

PROGRAM = "linkwright"
"""The distribution's name."""


def install_line(extra: str) -> str:
    """The command that installs what an extra of the distribution needs, by the packages' names: it does so
    wherever the distribution came from, a folder, a wheel or an index."""
    try:
        needs = metadata.requires(PROGRAM) or []
    except metadata.PackageNotFoundError:
        return f"pip install '.[{extra}]' in its folder"
    asked = re.compile(rf"extra == [\"']{re.escape(extra)}[\"']")
    return " ".join(["pip install", *(f"'{need.partition(';')[0].strip()}'" for need in needs if asked.search(need))])


def not_installed(what: str, package: str, extra: str) -> str:
    """The message for something that needs a package of an extra: one line, with the command that installs it."""
    return f"{what} needs {package}, not installed here: {install_line(extra)}"
