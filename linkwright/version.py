"""Which release this is."""

from __future__ import annotations


def program_version() -> str:
    """The version of the installed distribution; `unknown` where the code runs uninstalled."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("linkwright")
    except PackageNotFoundError:
        return "unknown"
