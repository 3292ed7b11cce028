"""An answer with its files, wherever they are: kept on the shelf, or left where they were made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from urllib.parse import quote

from linkwright.core.units.quantities import InputError

from .jobs import Job
from .shelf import Kept, Shelf


@dataclass(frozen=True)
class Answer:
    """What came of a piece of work; `names` gives its files, `file` the content of one (None where there is none).
    Both look at the disk, and raise `InputError`."""

    place: str
    number: int
    names: Callable[[], list[str]]
    file: Callable[[str], bytes | None]

    def address(self, name: str) -> str:
        """Where a file is to be had."""
        return f"/{self.place}/{self.number}/{quote(name)}"


def on_shelf(shelf: Shelf, number: int) -> Answer:
    """A result that is kept."""
    return Answer("kept", number, lambda: shelf.names(number), lambda name: shelf.file(number, name))


def left_behind(job: Job) -> Answer:
    """The answer of a job that could not be kept."""

    def names() -> list[str]:
        root = None if job.left is None else job.left / "out"
        return [] if root is None else sorted(p.relative_to(root).as_posix() for p in root.rglob("*") if p.is_file())

    def file(name: str) -> bytes | None:
        if job.left is None or name not in names():
            return None
        try:
            return (job.left / "out" / name).read_bytes()
        except OSError as error:
            raise InputError(name, "", f"cannot be read: {error.strerror or error}") from None

    return Answer("left", job.number, names, file)


def as_kept(job: Job) -> Kept:
    """What the shelf would say of a job."""
    made = datetime.now(UTC).isoformat(sep=" ", timespec="seconds").removesuffix("+00:00")
    return Kept(job.number, made, job.kind, job.title, job.answer, job.complete, job.took)
