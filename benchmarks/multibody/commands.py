"""The command line: python -m benchmarks.multibody make | run | score."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks.blind.answers import load
from benchmarks.blind.run import SealedTwiceError, run
from benchmarks.blind.seal import BrokenSealError
from benchmarks.blind.tables import as_json
from benchmarks.multibody.cases import HALVES, REMOUNTS, NoCaseError
from benchmarks.multibody.make import make
from benchmarks.multibody.page import section, write_section
from benchmarks.multibody.score import score


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.multibody", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    making = commands.add_parser("make", help="write recordings of arms on the multibody engine and seal their truths")
    making.add_argument("--cases", type=int, default=600)
    making.add_argument("--seed", type=int, required=True)
    making.add_argument("--half", choices=HALVES, required=True)
    making.add_argument("--out", type=Path, required=True)
    making.add_argument("--jobs", type=int, default=2)
    making.add_argument(
        "--remounts", type=float, default=REMOUNTS, help="share of cases with a free frame that have two mountings"
    )
    running = commands.add_parser("run", help="ask the tool about each case by its command line; goes on where it was")
    running.add_argument("cases", type=Path)
    running.add_argument("--answers", type=Path, required=True)
    running.add_argument("--jobs", type=int, default=2)
    running.add_argument("--limit", type=int, default=None)
    running.add_argument("--timeout", type=float, default=300.0, help="seconds for one case")
    scoring = commands.add_parser("score", help="open the truths and score the answers")
    scoring.add_argument("cases", type=Path)
    scoring.add_argument("--answers", type=Path, required=True)
    scoring.add_argument("--json", type=Path, default=None)
    scoring.add_argument("--page", type=Path, default=None, help="the page whose section is written anew")
    scoring.add_argument("--partial", action="store_true", help="score a development half that is not all answered")
    return parser


def main(arguments: list[str] | None = None) -> int:
    """Runs one command; exit status 0, or 2 with one line where the input is wrong."""
    asked = _parser().parse_args(arguments)
    try:
        if asked.command == "make":
            print(make(asked.cases, asked.seed, asked.half, asked.out, asked.jobs, asked.remounts))
        elif asked.command == "run":
            print(f"{run(asked.cases, asked.answers, asked.jobs, asked.limit, asked.timeout)} cases answered")
        else:
            result = score(*load(asked.cases, asked.answers, partial=asked.partial))
            if asked.json:
                asked.json.write_text(as_json(result), encoding="utf-8")
            if asked.page:
                write_section(asked.page, result)
            print(section(result))
    except (FileExistsError, FileNotFoundError, BrokenSealError, SealedTwiceError, NoCaseError) as error:
        print(f"benchmarks.multibody: {error}", file=sys.stderr)
        return 2
    return 0
