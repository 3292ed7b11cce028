"""Output folders of `tables` and `figures`: only a new or empty one, or one that the same command has written."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from linkwright.core.units.files import left_over_of, read_bytes
from linkwright.core.units.quantities import InputError
from linkwright.output.files import made_folder, refuse_strangers


def claim(folder: Path, names: Collection[str], signed: str, signature: str) -> None:
    """Make the folder, or take one that holds nothing but `names`, where the file `signed` opens with `signature`.

    A folder that holds anything else is refused, so that nobody's files are written over. Raises `InputError`.
    """
    there = made_folder(folder)
    refuse_strangers(folder, there, names)
    if any(left_over_of(name) is None for name in there) and not _opens_with(folder / signed, signature):
        message = f"holds files that are not of this command ({min(there)}); name a new or empty folder"
        raise InputError(folder, "", message)


def _opens_with(path: Path, signature: str) -> bool:
    try:
        return signature.encode() in read_bytes(path)[:200]
    except InputError:
        return False
