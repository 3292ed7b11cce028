"""Pieces of work in parallel, each kept as a file: a run that was broken off goes on where it stood."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import Any

VERSION = "1"
"""Part of every key: raised where a part's meaning changes."""
FAILED = "failed"
"""The key under which a piece that failed says why."""
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


@dataclass(frozen=True)
class Piece:
    """One case's share of a part: what to call, and the key under which its result stays valid."""

    case: str
    key: str
    arguments: tuple[Any, ...]


def done(
    part: str, call: Callable[..., dict[str, Any]], pieces: list[Piece], folder: Path, jobs: int
) -> Mapping[str, dict[str, Any]]:
    """The results by case, computed where `folder` does not hold them under their key. A piece that fails gives
    {FAILED: why}; it is tried again in the next run."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in _THREADS:
        os.environ.setdefault(name, "1")
    found: dict[str, dict[str, Any]] = {}
    waiting: list[Piece] = []
    for piece in pieces:
        kept = _kept(folder / f"{piece.case}.json", piece)
        if kept is None:
            waiting.append(piece)
        else:
            found[piece.case] = kept
    start = time.monotonic()
    while waiting:
        waiting, before = _round(part, call, waiting, folder, jobs, found, start), len(waiting)
        if len(waiting) == before:  # a worker dies of the first one
            found[waiting.pop(0).case] = {FAILED: "the worker died"}
    return {piece.case: found[piece.case] for piece in pieces}


def _round(
    part: str,
    call: Callable[..., dict[str, Any]],
    pieces: list[Piece],
    folder: Path,
    jobs: int,
    found: dict[str, dict[str, Any]],
    start: float,
) -> list[Piece]:
    """Works on all pieces; gives those that a dead worker left undone."""
    lost: list[Piece] = []
    with ProcessPoolExecutor(jobs) as pool:
        futures = {pool.submit(call, *piece.arguments): piece for piece in pieces}
        for number, future in enumerate(as_completed(futures), 1):
            piece, error = futures[future], future.exception()
            if isinstance(error, BrokenProcessPool):
                lost.append(piece)
            elif error is not None:
                found[piece.case] = {FAILED: f"{type(error).__name__}: {error}"[:300]}
            else:
                found[piece.case] = future.result()
                content = {"key": _key(piece), "result": found[piece.case]}
                (folder / f"{piece.case}.json").write_text(json.dumps(content) + "\n", encoding="utf-8")
            if number % 20 == 0 or number == len(pieces):
                print(f"{part}: {number} of {len(pieces)}, {time.monotonic() - start:.0f} s", file=sys.stderr)
    return sorted(lost, key=lambda piece: piece.case)


def _key(piece: Piece) -> str:
    return f"{VERSION} {piece.key}"


def _kept(path: Path, piece: Piece) -> dict[str, Any] | None:
    if not path.exists():
        return None
    content = json.loads(path.read_text(encoding="utf-8"))
    return content["result"] if content["key"] == _key(piece) else None
