"""Results on disk: one SQLite file in the folder, each result a row with its files."""

from __future__ import annotations

import sqlite3
import zlib
from collections.abc import Generator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from units.quantities import InputError

NAME = "linkwright-results.sqlite"
_TABLES = """
CREATE TABLE IF NOT EXISTS results (
    id INTEGER PRIMARY KEY AUTOINCREMENT, made TEXT NOT NULL, kind TEXT NOT NULL, title TEXT NOT NULL,
    line TEXT NOT NULL, complete INTEGER NOT NULL, seconds REAL NOT NULL);
CREATE TABLE IF NOT EXISTS files (
    result INTEGER NOT NULL REFERENCES results(id) ON DELETE CASCADE, name TEXT NOT NULL, content BLOB NOT NULL,
    PRIMARY KEY (result, name));
"""


_NUMBERS = 2**63
"""What a row's number is below in SQLite."""


@dataclass(frozen=True)
class Kept:
    """A result that is kept: when it was `made` (UTC), of which kind, from what (`title`), what was found (`line`),
    whether it is `complete` or the best until it was stopped, and how long it took."""

    id: int
    made: str
    kind: str
    title: str
    line: str
    complete: bool
    seconds: float


class Shelf:
    """The results of a folder; each call opens the file anew, from whatever thread. Raises `InputError`."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / NAME
        with self._open() as base:
            base.executescript(_TABLES)

    @contextmanager
    def _open(self) -> Generator[sqlite3.Connection]:
        try:
            if self.path.is_symlink():
                raise InputError(self.path, "", "is a link; results are kept in the folder itself")
            with closing(sqlite3.connect(self.path, timeout=10.0)) as base, base:
                base.execute("PRAGMA foreign_keys = ON")
                yield base
        except sqlite3.Error as error:
            raise InputError(self.path, "", f"cannot be used: {error}; move it away, and a new one is made") from None

    def keep(
        self, kind: str, title: str, line: str, files: Mapping[str, bytes], *, complete: bool, seconds: float
    ) -> int:
        """Keep a result with its files; gives its number."""
        made = datetime.now(UTC).isoformat(sep=" ", timespec="seconds").removesuffix("+00:00")
        with self._open() as base:
            row = (made, kind, title, line, int(complete), seconds)
            number = base.execute(
                "INSERT INTO results (made, kind, title, line, complete, seconds) VALUES (?, ?, ?, ?, ?, ?)", row
            ).lastrowid
            base.executemany(
                "INSERT INTO files VALUES (?, ?, ?)",
                [(number, name, zlib.compress(content, 6)) for name, content in files.items()],
            )
        return int(number or 0)

    def all(self) -> list[Kept]:
        """The results, the newest first."""
        with self._open() as base:
            rows = base.execute("SELECT * FROM results ORDER BY id DESC").fetchall()
        return [_kept(row) for row in rows]

    def find(self, number: int) -> Kept | None:
        """A result by its number, None where there is none."""
        with self._open() as base:
            row = base.execute("SELECT * FROM results WHERE id = ?", (number,)).fetchone()
        return None if row is None else _kept(row)

    def names(self, number: int) -> list[str]:
        """The names of a result's files."""
        with self._open() as base:
            return [
                name for (name,) in base.execute("SELECT name FROM files WHERE result = ? ORDER BY name", (number,))
            ]

    def file(self, number: int, name: str) -> bytes | None:
        """A file of a result, None where it has none of that name."""
        if not 0 <= number < _NUMBERS:
            return None
        with self._open() as base:
            row = base.execute("SELECT content FROM files WHERE result = ? AND name = ?", (number, name)).fetchone()
        return None if row is None else zlib.decompress(row[0])

    def remove(self, number: int) -> None:
        """Take a result away, with its files."""
        with self._open() as base:
            base.execute("DELETE FROM results WHERE id = ?", (number,))


def _kept(row: tuple[int, str, str, str, str, int, float]) -> Kept:
    number, made, kind, title, line, complete, seconds = row
    return Kept(number, made, kind, title, line, bool(complete), seconds)
