"""Results on disk: one SQLite file in the folder, each result a row with its files."""

from __future__ import annotations

import hashlib
import re
import sqlite3
import zlib
from collections.abc import Generator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from types import MappingProxyType

from linkwright.core.units.quantities import InputError

NAME = "linkwright-results.sqlite"
_TABLES = """
CREATE TABLE IF NOT EXISTS results (
    id INTEGER PRIMARY KEY AUTOINCREMENT, made TEXT NOT NULL, kind TEXT NOT NULL, title TEXT NOT NULL,
    line TEXT NOT NULL, complete INTEGER NOT NULL, seconds REAL NOT NULL);
CREATE TABLE IF NOT EXISTS files (
    result INTEGER NOT NULL REFERENCES results(id) ON DELETE CASCADE, name TEXT NOT NULL, content BLOB NOT NULL,
    PRIMARY KEY (result, name));
CREATE TABLE IF NOT EXISTS scripts (digest TEXT PRIMARY KEY, content BLOB NOT NULL);
CREATE TABLE IF NOT EXISTS inserted (
    result INTEGER NOT NULL, name TEXT NOT NULL, place INTEGER NOT NULL,
    digest TEXT NOT NULL REFERENCES scripts(digest),
    PRIMARY KEY (result, name, place), FOREIGN KEY (result, name) REFERENCES files(result, name) ON DELETE CASCADE);
CREATE TABLE IF NOT EXISTS runs (
    id INTEGER PRIMARY KEY AUTOINCREMENT, began TEXT NOT NULL, kind TEXT NOT NULL, title TEXT NOT NULL,
    server TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS labels (
    result INTEGER PRIMARY KEY REFERENCES results(id) ON DELETE CASCADE, name TEXT NOT NULL, note TEXT NOT NULL);
"""
_TABLE_NAMES = frozenset(re.findall(r"EXISTS (\w+)", _TABLES))
_RESULT = (
    "SELECT id, made, kind, title, line, complete, seconds, coalesce(name, ''), coalesce(note, '') "
    "FROM results LEFT JOIN labels ON result = id"
)
_UNUSED = "DELETE FROM scripts WHERE digest NOT IN (SELECT digest FROM inserted)"
_SCRIPT = re.compile(rb"(?<=>)[^<]{100000,}(?=</script>)")
"""A script that is worth keeping once for all reports: plotly, packed."""
_NUMBERS = 2**63
"""What a row's number is below in SQLite."""
_PATIENCE, _PATIENCE_TO_KEEP = 2.0, 10.0
"""Seconds that another program's lock is waited for, by who looks and by who has an answer to keep."""
_WHAT_TO_DO: Mapping[int, str] = MappingProxyType(
    {
        sqlite3.SQLITE_BUSY: "is locked by another program; end that one or wait for it, then try again",
        sqlite3.SQLITE_LOCKED: "is locked by another program; end that one or wait for it, then try again",
        sqlite3.SQLITE_FULL: "has no room left on its disk; make some, then try again",
        sqlite3.SQLITE_READONLY: "may not be written to; see to its permissions, then try again",
        sqlite3.SQLITE_PERM: "may not be used; see to its permissions, then try again",
        sqlite3.SQLITE_CANTOPEN: "cannot be opened; see that its folder is there and may be written to, then try again",
        sqlite3.SQLITE_IOERR: "cannot be read or written by its disk; see to that (is it full?), then try again",
        sqlite3.SQLITE_TOOBIG: "takes no file of that size",
    }
)
"""By SQLite's result code; with any other the file itself is wrong (https://www.sqlite.org/rescode.html)."""


_SENTENCE_END = re.compile(r"(?<=\.) (?=[A-Z])")
_HEADING = 160
"""Characters of a heading."""


@dataclass(frozen=True)
class Kept:
    """A result that is kept: when it was `made` (UTC), of which kind, from what (`title`), the result (`line`),
    whether it is `complete` or the best until it was stopped, how long it took, and what people call it and noted."""

    id: int
    made: str
    kind: str
    title: str
    line: str
    complete: bool
    seconds: float
    name: str = ""
    note: str = ""

    @property
    def head(self) -> str:
        """The first sentences of the result, as many as a heading has room for."""
        head, *rest = _SENTENCE_END.split(self.line)
        for sentence in rest:
            if len(head) + len(sentence) > _HEADING:
                break
            head = f"{head} {sentence}"
        return head

    @property
    def rest(self) -> str:
        """The sentences of the result that follow its head."""
        return self.line[len(self.head) :].strip()


@dataclass(frozen=True)
class Run:
    """A piece of work that was begun and has not ended: when (UTC), of which kind, from what, by which server."""

    id: int
    began: str
    kind: str
    title: str
    server: str


class Shelf:
    """The results of a folder; each call opens the file anew, from whatever thread. Raises `InputError`."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / NAME
        with self._open():
            pass

    @contextmanager
    def _open(self, patience: float = _PATIENCE) -> Generator[sqlite3.Connection]:
        """The base, with its tables: it may have been taken away while it was not looked at."""
        try:
            if self.path.is_symlink():
                raise InputError(self.path, "", "is a link; results are kept in the folder itself")
            with closing(sqlite3.connect(self.path, timeout=patience)) as base, base:
                base.text_factory = _text
                base.execute("PRAGMA foreign_keys = ON")
                there = {name for (name,) in base.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
                if not there >= _TABLE_NAMES:
                    base.executescript(("" if there else "PRAGMA auto_vacuum = FULL;") + _TABLES)
                yield base
        except sqlite3.Error as error:
            wrong = f"cannot be used: {error}; move it away, and a new one is made"
            code: int = getattr(error, "sqlite_errorcode", -1) & 0xFF  # the low byte of an extended code
            raise InputError(self.path, "", _WHAT_TO_DO.get(code, wrong)) from None

    def keep(
        self,
        kind: str,
        title: str,
        line: str,
        files: Mapping[str, bytes],
        *,
        complete: bool,
        seconds: float,
        run: int | None = None,
    ) -> int:
        """Keep a result with its files, in place of the `run` that it came of; gives its number."""
        with self._open(_PATIENCE_TO_KEEP) as base:
            row = (_now(), kind, title, line, int(complete), seconds)
            number = base.execute(
                "INSERT INTO results (made, kind, title, line, complete, seconds) VALUES (?, ?, ?, ?, ?, ?)", row
            ).lastrowid
            for name, content in files.items():
                scripts = list(_SCRIPT.finditer(content)) if name.endswith(".html") else []
                rest = _SCRIPT.sub(b"", content) if scripts else content
                base.execute("INSERT INTO files VALUES (?, ?, ?)", (number, name, zlib.compress(rest, 6)))
                for script in scripts:
                    digest = hashlib.sha256(script[0]).hexdigest()
                    if not base.execute("SELECT 1 FROM scripts WHERE digest = ?", (digest,)).fetchone():
                        base.execute("INSERT INTO scripts VALUES (?, ?)", (digest, zlib.compress(script[0], 6)))
                    base.execute("INSERT INTO inserted VALUES (?, ?, ?, ?)", (number, name, script.start(), digest))
            base.execute("DELETE FROM runs WHERE id = ?", (run,))
        return int(number or 0)

    def all(self) -> list[Kept]:
        """The results, the newest first."""
        with self._open() as base:
            rows = base.execute(f"{_RESULT} ORDER BY id DESC").fetchall()
        return [_kept(row) for row in rows]

    def find(self, number: int) -> Kept | None:
        """A result by its number, None where there is none."""
        if not 0 <= number < _NUMBERS:
            return None
        with self._open() as base:
            row = base.execute(f"{_RESULT} WHERE id = ?", (number,)).fetchone()
        return None if row is None else _kept(row)

    def names(self, number: int) -> list[str]:
        """The names of a result's files."""
        if not 0 <= number < _NUMBERS:
            return []
        with self._open() as base:
            return [
                str(name)
                for (name,) in base.execute("SELECT name FROM files WHERE result = ? ORDER BY name", (number,))
            ]

    def file(self, number: int, name: str) -> bytes | None:
        """A file of a result, None where it has none of that name."""
        if not 0 <= number < _NUMBERS:
            return None
        with self._open() as base:
            row = base.execute("SELECT content FROM files WHERE result = ? AND name = ?", (number, name)).fetchone()
            scripts = base.execute(
                "SELECT place, content FROM inserted JOIN scripts USING (digest) WHERE result = ? AND name = ? "
                "ORDER BY place",
                (number, name),
            ).fetchall()
        if row is None:
            return None
        try:
            content = zlib.decompress(row[0])
            for place, script in scripts:  # each place counts what stands before it
                content = content[:place] + zlib.decompress(script) + content[place:]
        except (zlib.error, TypeError):
            raise InputError(self.path, f"{name} of result {number}", "is damaged; remove the result") from None
        return content

    def size(self) -> int:
        """Bytes that all of it takes on the disk."""
        try:
            return self.path.stat().st_size
        except OSError:
            return 0

    def label(self, number: int, name: str, note: str) -> None:
        """Say how a result is called, and what is to be remembered of it."""
        if self.find(number) is None:
            raise InputError("", f"result {number}", "is not there; it may have been removed")
        with self._open(_PATIENCE_TO_KEEP) as base:
            base.execute("INSERT OR REPLACE INTO labels VALUES (?, ?, ?)", (number, name, note))

    def remove(self, number: int) -> None:
        """Take a result away, with its files."""
        with self._open(_PATIENCE_TO_KEEP) as base:
            base.execute("DELETE FROM results WHERE id = ?", (number,))
            base.execute(_UNUSED)

    def remove_all(self) -> None:
        """Take every result away, and give the disk its room back."""
        with self._open(_PATIENCE_TO_KEEP) as base:
            base.execute("DELETE FROM results")
            base.execute(_UNUSED)
            base.commit()
            base.execute("VACUUM")  # an older base does not shrink by itself

    def begin(self, kind: str, title: str, server: str) -> int:
        """Note that a piece of work was begun; gives its number."""
        with self._open() as base:
            row = (_now(), kind, title, server)
            number = base.execute("INSERT INTO runs (began, kind, title, server) VALUES (?, ?, ?, ?)", row).lastrowid
        return int(number or 0)

    def runs(self) -> list[Run]:
        """What was begun and did not end, the newest first."""
        with self._open() as base:
            rows = base.execute("SELECT id, began, kind, title, server FROM runs ORDER BY id DESC").fetchall()
        return [Run(number, *map(str, shown)) for number, *shown in rows]

    def end(self, run: int) -> None:
        """Forget a piece of work that ended, or that nobody need be told of any more."""
        with self._open() as base:
            base.execute("DELETE FROM runs WHERE id = ?", (run,))


def _now() -> str:
    return datetime.now(UTC).isoformat(sep=" ", timespec="seconds").removesuffix("+00:00")


def _text(content: bytes) -> str:
    return content.decode(errors="replace")


def _kept(row: tuple[object, ...]) -> Kept:
    """A row as it is shown, whatever stands in it: SQLite holds no column to its type."""
    number, made, kind, title, line, complete, seconds, name, note = row
    took = float(seconds) if isinstance(seconds, int | float) else float("nan")
    return Kept(
        int(str(number)), str(made), str(kind), str(title), str(line), bool(complete), took, str(name), str(note)
    )
