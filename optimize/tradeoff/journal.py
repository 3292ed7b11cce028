"""The journal of a trade-off: one line of JSON for each point solved, only ever added to, so that a stop loses nothing.

The first line names the question by its digest. Each further line is written whole by one call and flushed to the disk,
and ends with a checksum of itself; a line that a kill cut short, or that somebody changed, is passed over on reading:
its point is solved anew. While a process writes, it holds a lock that the operating system frees when the process ends,
however it ends.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, cast

from linkwright.core.units.files import lock_path, locked, read_bytes
from linkwright.core.units.quantities import InputError

JOURNAL = "journal.jsonl"
LOCK = lock_path(Path(JOURNAL)).name
"""What stands beside a journal as soon as one is begun."""
VERSION = 3
_LARGEST = 1024**3
"""Bytes of a journal that are read."""
_HEADER = 4096
_OTHER = (
    "is of another question (problem, axes, choice or accuracy differ); "
    "name another folder, or leave --resume out to begin anew"
)
_SUM = b', "sum": "'
Record = Mapping[str, Any]


class Journal:
    """Answers by key, in a file (or, without one, only for as long as this lives)."""

    def __init__(
        self,
        path: Path | None,
        digest: str,
        *,
        resume: bool = False,
        made_by: str = "",
    ) -> None:
        """Open the journal, or with `resume` go on with one.

        Where there is none yet, one begins. Raises `InputError` where it is of another question, where another process
        holds it, or where it cannot be written.
        """
        self._records: dict[tuple[str, ...], Record | None] = {}
        self._stream: int | None = None
        self._held = ExitStack()
        if path is None:
            return
        if os.path.exists(path) and not os.path.isfile(path):
            raise InputError(path, "", "is no file that a journal could be kept in")
        self._held.enter_context(locked(path, wait=False))
        try:
            before = read_bytes(path, _LARGEST) if resume and os.path.exists(path) else b""
            self._stream = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
            if not resume:
                os.ftruncate(self._stream, 0)
        except OSError as error:
            self.close()
            raise InputError(path, "", f"cannot be written: {error.strerror or error}") from None
        except InputError:
            self.close()
            raise
        try:
            self._begin(path, before, digest, made_by)
        except InputError:
            self.close()
            raise

    @property
    def size(self) -> int:
        """How many answers are known."""
        return len(self._records)

    def has(self, key: tuple[str, ...]) -> bool:
        """Whether a key has an answer, with a design or without."""
        return key in self._records

    def get(self, key: tuple[str, ...]) -> Record | None:
        """What was noted of a key; None where it has no design."""
        return self._records[key]

    def put(self, key: tuple[str, ...], record: Record | None) -> None:
        """Note an answer."""
        self._records[key] = record
        line = json.dumps({"key": list(key), "found": record}).encode()
        self._add(line[:-1] + _SUM + _sum_of(line) + b'"}')

    def close(self) -> None:
        """Give the file up."""
        if self._stream is not None:
            os.close(self._stream)
            self._stream = None
        self._held.close()

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _begin(self, path: Path, before: bytes, digest: str, made_by: str) -> None:
        if not before.strip():
            self._add(json.dumps({"made_by": made_by, "version": VERSION, "digest": digest}).encode())
            return
        self._read(path, before, digest)
        if self._stream is not None and not before.endswith(b"\n"):
            os.write(self._stream, b"\n")

    def _add(self, line: bytes) -> None:
        if self._stream is not None:
            os.write(self._stream, line + b"\n")
            os.fsync(self._stream)

    def _read(self, path: Path, content: bytes, digest: str) -> None:
        lines = content.split(b"\n")
        header = _parsed(lines[0][:_HEADER])
        if header is None or "digest" not in header:
            raise InputError(path, "", "is not the journal of a trade-off")
        if header["digest"] != digest or header.get("version") != VERSION:
            raise InputError(path, "", _OTHER)
        for line in lines[1:]:
            own, _, total = line.rpartition(_SUM)
            if own and total == _sum_of(own + b"}") + b'"}':
                entry: dict[str, Any] = json.loads(own + b"}")
                self._records[tuple(entry["key"])] = entry["found"]


def journal_digest(path: Path) -> str | None:
    """The digest in a journal's first line; None where the file is not there or is no journal."""
    if not path.is_file():
        return None
    try:
        with path.open("rb") as stream:
            header = _parsed(stream.readline(_HEADER))
    except OSError:
        return None
    return None if header is None else header.get("digest")


def _sum_of(line: bytes) -> bytes:
    return hashlib.sha256(line).hexdigest()[:16].encode()


def _parsed(line: bytes) -> dict[str, Any] | None:
    try:
        content: object = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return cast(dict[str, Any], content) if isinstance(content, dict) else None
