"""Pieces of work in parallel, each kept as a file: a run that was broken off goes on where it stood."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from linkwright.core.executors import Processes, plain

VERSION = "1"
"""Part of every key: raised where a part's meaning changes."""
FAILED = "failed"
"""The key under which a piece that failed says why."""


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
    results: dict[str, dict[str, Any]] = {}
    waiting: list[Piece] = []
    for piece in pieces:
        kept = _kept(folder / f"{piece.case}.json", piece)
        if kept is None:
            waiting.append(piece)
        else:
            results[piece.case] = kept
    start = time.monotonic()
    with Processes(jobs, patience=0.0) as processes:
        outcomes = processes.outcomes(plain(partial(_one, call)), [piece.arguments for piece in waiting])
        for ended, (number, result, error) in enumerate(outcomes, 1):
            piece = waiting[number]
            if result is None:
                results[piece.case] = {FAILED: f"{type(error).__name__}: {error}"[:300]}
            else:
                results[piece.case] = result
                content = {"key": _key(piece), "result": result}
                (folder / f"{piece.case}.json").write_text(json.dumps(content) + "\n", encoding="utf-8")
            if ended % 20 == 0 or ended == len(waiting):
                print(f"{part}: {ended} of {len(waiting)}, {time.monotonic() - start:.0f} s", file=sys.stderr)
    return {piece.case: results[piece.case] for piece in pieces}


Call = Callable[..., dict[str, Any]]


def _one(call: Call, arguments: tuple[Any, ...]) -> dict[str, Any]:
    return call(*arguments)


def _key(piece: Piece) -> str:
    return f"{VERSION} {piece.key}"


def _kept(path: Path, piece: Piece) -> dict[str, Any] | None:
    if not path.exists():
        return None
    content = json.loads(path.read_text(encoding="utf-8"))
    return content["result"] if content["key"] == _key(piece) else None
