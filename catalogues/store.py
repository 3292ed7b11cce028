"""A text file that several people and programs change at once: locked, whole at every instant, with undo.

Beside `NAME` stand `.NAME.lock` (`units.files.locked`), `.NAME.new` (the next content, only while an edit
runs) and the folder `.NAME.undo` (the journal, one file an edit with the text before it). The order of an edit is:
lock, read, change, check, journal, write the neighbour, flush it to the disk, rename it over the file. A process killed
at any instant leaves the old or the new file, and at worst a journal entry for an edit that never landed, which
`undo` recognises by its checksums.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, cast

from linkwright.core.units.files import locked, write_whole
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import read_text

MOST_UNDO = 100
"""How many edits the journal keeps; older ones are dropped."""


@dataclass(frozen=True)
class JournalEntry:
    """One edit: its number since the journal began, what it did, the text before (None: there was no file), and the
    SHA-256 of the text after it (empty: the file was taken away)."""

    number: int
    what: str
    before: str | None
    after: str


def edit_text(path: Path | str, change: Callable[[str | None], tuple[str, str]]) -> str:
    """Replace the file's text by what `change` makes of it, under the lock, and return what it says it did.

    `change` gets the text (None where there is no file) and gives the new text and a description; whatever it raises
    leaves the file as it was. A text that stays the same is not written. Raises `InputError` where the file or its
    folder cannot be read or written.
    """
    target = _resolved(path)
    with locked(target):
        before = _text(target)
        after, what = change(before)
        if after != before:
            with _os_errors(path):
                _remember(target, what, before, after)
                write_whole(target, after, flush=True, ending="new")
        return what


def undo(path: Path | str) -> str:
    """Take the last edit back and return what it had done.

    Raises `InputError` where there is none, or where the file was since changed by other means, which an undo would
    lose.
    """
    target = _resolved(path)
    with locked(target):
        current = _text(target)
        while (entries := journal(target)) and entries[-1].after != _checksum(current):
            if entries[-1].before != current:
                raise InputError(path, "", "has been changed by other means since its last edit; not undone")
            _entry_path(target, entries[-1].number).unlink()  # that edit never landed, or is undone already
        if not entries:
            raise InputError(path, "", "has no edit to undo")
        last = entries[-1]
        with _os_errors(path):
            if last.before is None:
                target.unlink()
            else:
                write_whole(target, last.before, flush=True, ending="new")
            _entry_path(target, last.number).unlink()
        return last.what


def journal(path: Path | str) -> tuple[JournalEntry, ...]:
    """Return the edits that can be undone, the oldest first; one that a kill left unfinished is not among them."""
    folder = _beside(_resolved(path), "undo")
    entries: list[JournalEntry] = []
    for number in _numbers(folder):
        try:
            content = cast(dict[str, Any], json.loads((folder / f"{number:08d}.json").read_text(encoding="utf-8")))
            entries.append(JournalEntry(number, content["what"], content["before"], content["after"]))
        except (ValueError, KeyError, TypeError, OSError, RecursionError):
            continue
    return tuple(entries)


@contextmanager
def _os_errors(path: Path | str) -> Generator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(path, "", f"cannot be written: {error.strerror or error}") from None


def _resolved(path: Path | str) -> Path:
    """The file itself, so that a link to it stays a link and has the same lock."""
    place = Path(path)
    try:
        return place.resolve()
    except (OSError, ValueError, RuntimeError) as error:
        raise InputError(path, "", f"cannot be read: {error}") from None


def _beside(target: Path, ending: str) -> Path:
    return target.with_name(f".{target.name}.{ending}")


def _text(target: Path) -> str | None:
    return read_text(target) if os.path.exists(target) else None


def _checksum(text: str | None) -> str:
    return "" if text is None else hashlib.sha256(text.encode("utf-8")).hexdigest()


def _numbers(folder: Path) -> list[int]:
    if not os.path.isdir(folder):
        return []
    return sorted(int(item.stem) for item in folder.iterdir() if item.suffix == ".json" and item.stem.isdecimal())


def _entry_path(target: Path, number: int) -> Path:
    return _beside(target, "undo") / f"{number:08d}.json"


def _remember(target: Path, what: str, before: str | None, after: str) -> None:
    folder = _beside(target, "undo")
    folder.mkdir(exist_ok=True)
    numbers = _numbers(folder)
    entry = JournalEntry(numbers[-1] + 1 if numbers else 1, what, before, _checksum(after))
    write_whole(_entry_path(target, entry.number), json.dumps(asdict(entry), ensure_ascii=False), ending="new")
    for number in numbers[: max(0, len(numbers) + 1 - MOST_UNDO)]:
        _entry_path(target, number).unlink(missing_ok=True)
