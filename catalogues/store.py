"""A text file that several people and programs change at once: locked, and whole at every instant.

Beside `NAME` stand `.NAME.lock` (`units.files.locked`) and `.NAME.new` (the next content, only while an edit runs). The
order of an edit is: lock, read, change, check, write the neighbour, flush it to the disk, rename it over the file. A
process killed at any instant leaves the old or the new file.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from linkwright.core.units.files import locked, write_whole
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import read_text


def edit_text(path: Path | str, change: Callable[[str | None], tuple[str, str]]) -> str:
    """Replace the file's text by what `change` makes of it, under the lock, and return what it says it did.

    `change` gets the text (None where there is no file) and gives the new text and a description; whatever it raises
    leaves the file as it was. A text that stays the same is not written. Raises `InputError` where the file or its
    folder cannot be read or written.
    """
    try:
        target = Path(path).resolve()  # a link to the file stays a link and has the same lock
    except (OSError, ValueError, RuntimeError) as error:
        raise InputError(path, "", f"cannot be read: {error}") from None
    with locked(target):
        before = read_text(target) if os.path.exists(target) else None
        after, what = change(before)
        if after != before:
            try:
                write_whole(target, after, flush=True, ending="new")
            except OSError as error:
                raise InputError(path, "", f"cannot be written: {error.strerror or error}") from None
        return what
