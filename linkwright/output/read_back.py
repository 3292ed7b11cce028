"""Verification of written files: those that the program can read are read back and compared with the result."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from linkwright.core.units.quantities import InputError, NoAnswer

_MOST = 3
"""How many differences a line tells."""


class NotAsWritten(NoAnswer):
    """A file was written, and reading it back does not give the result. Its `path`, and what differs, in words."""

    def __init__(self, path: Path, differs: str) -> None:
        self.path = path
        self.differs = differs
        super().__init__(f"{path}: is written, but does not read back as what was found: {differs}")

    def __reduce__(self) -> tuple[object, ...]:
        """Keep the fields when the error crosses between processes."""
        return NotAsWritten, (self.path, self.differs)


@dataclass(frozen=True)
class ReadBack:
    """The text of a file that the program can read. `differs` reads the file back and describes each difference from
    the result; it is empty where there is none."""

    text: str
    differs: Callable[[Path], Iterable[str]]

    def hold(self, path: Path) -> None:
        """Read the file back. Raises `NotAsWritten` where it cannot be read, or says otherwise."""
        try:
            differences = list(self.differs(path))
        except InputError as error:
            raise NotAsWritten(path, f"{error.key}: {error.message}" if error.key else error.message) from None
        if differences:
            more = f", and {len(differences) - _MOST} more" if len(differences) > _MOST else ""
            raise NotAsWritten(path, "; ".join(differences[:_MOST]) + more)
