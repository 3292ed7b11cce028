"""What the command lines of both proofs share: the options of `make`, `run` and `score`, and the exit status."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from benchmarks.blind.run import SealedTwiceError
from benchmarks.blind.seal import BrokenSealError

Parsers = tuple[argparse.ArgumentParser, Any, dict[str, argparse.ArgumentParser]]


def options(prog: str, about: str | None, halves: Sequence[str], cases: int, seconds: float) -> Parsers:
    """The parser of `make`, `run` and `score`, whose defaults are so many cases and seconds a case; and what adds to
    it: commands, and those three by name."""
    parser = argparse.ArgumentParser(prog=prog, description=about)
    commands = parser.add_subparsers(dest="command", required=True)
    making = commands.add_parser("make", help="write recordings of concealed physics and seal their truths")
    making.add_argument("--cases", type=int, default=cases)
    making.add_argument("--seed", type=int, required=True)
    making.add_argument("--half", choices=halves, required=True)
    making.add_argument("--out", type=Path, required=True)
    running = commands.add_parser("run", help="ask the tool about each case by its command line; goes on where it was")
    running.add_argument("--limit", type=int, default=None)
    running.add_argument("--timeout", type=float, default=seconds, help="seconds for one case")
    for item in (making, running):
        item.add_argument("--jobs", type=int, default=2)
    scoring = commands.add_parser("score", help="open the truths and score the answers")
    scoring.add_argument("--json", type=Path, default=None)
    scoring.add_argument("--partial", action="store_true", help=f"score a {halves[0]} half that is not all answered")
    for item in (running, scoring):
        item.add_argument("cases", type=Path)
        item.add_argument("--answers", type=Path, required=True)
    return parser, commands, {"make": making, "score": scoring}


def answer(prog: str, does: Callable[[], str], refuses: type[Exception]) -> int:
    """Prints what a command comes to; exit status 0, or 2 with one line where the input is wrong."""
    try:
        print(does())
    except (FileExistsError, FileNotFoundError, BrokenSealError, SealedTwiceError, refuses) as error:
        print(f"{prog}: {error}", file=sys.stderr)
        return 2
    return 0
