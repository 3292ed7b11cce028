"""Output folders of `tables` and `figures`: only a new or empty one, or one that the same command has written."""

from __future__ import annotations

import os
from collections.abc import Collection
from pathlib import Path

from materials.quantities import InputError


def claim(folder: Path, names: Collection[str], signed: str, signature: str) -> None:
    """Make the folder, or take one that holds nothing but `names`, where the file `signed` opens with `signature`.

    A folder that holds anything else is refused, so that nobody's files are written over. Raises `InputError`.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        there = {entry.name for entry in folder.iterdir()}
    except FileExistsError:
        raise InputError(folder, "", "is a file; name a folder to write to") from None
    except OSError as error:
        raise InputError(folder, "", f"cannot be made: {error.strerror or error}") from None
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(folder, "", "cannot be written: permission denied")
    strangers = sorted(there - set(names))
    if strangers:
        raise InputError(folder, "", f"holds other files ({strangers[0]}); name a new or empty folder")
    if there and not _opens_with(folder / signed, signature):
        message = f"holds files that are not of this command ({min(there)}); name a new or empty folder"
        raise InputError(folder, "", message)


def _opens_with(path: Path, signature: str) -> bool:
    try:
        with path.open(encoding="utf-8") as file:
            return signature in file.read(200)
    except (OSError, UnicodeDecodeError):
        return False
