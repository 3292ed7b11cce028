"""Where converted public recordings are."""

from __future__ import annotations

import os
from pathlib import Path

from benchmarks.real.data import ROOT, NoDataError

VARIABLE = "LINKWRIGHT_PUBLIC"


def public_folder(name: str) -> Path:
    """The folder of a public machine, in LINKWRIGHT_PUBLIC, else in ../public from the project's root.

    Raises `NoDataError` where it is not there.
    """
    root = os.environ.get(VARIABLE)
    folder = (Path(root) if root else ROOT.parent / "public") / name
    if not (folder / "recording.yaml").is_file():
        raise NoDataError(f"{name} is not there: python -m benchmarks.real.public, then {VARIABLE}")
    return folder
