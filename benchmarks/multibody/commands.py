"""The command line: python -m benchmarks.multibody make | run | score."""

from __future__ import annotations

import argparse
from pathlib import Path

from benchmarks.blind.answers import load
from benchmarks.blind.front import answer, options
from benchmarks.blind.run import run
from benchmarks.blind.tables import as_json
from benchmarks.multibody.cases import HALVES, REMOUNTS, NoCaseError
from benchmarks.multibody.make import make
from benchmarks.multibody.page import section, write_section
from benchmarks.multibody.score import score


def _parser() -> argparse.ArgumentParser:
    parser, _, known = options("python -m benchmarks.multibody", __doc__, HALVES, 600, 300.0)
    known["make"].add_argument(
        "--remounts", type=float, default=REMOUNTS, help="share of cases with a free frame that have two mountings"
    )
    known["score"].add_argument("--page", type=Path, default=None, help="the page whose section is written anew")
    return parser


def main(arguments: list[str] | None = None) -> int:
    """Runs one command; exit status 0, or 2 with one line where the input is wrong."""
    asked = _parser().parse_args(arguments)
    return answer("benchmarks.multibody", lambda: _done(asked), NoCaseError)


def _done(asked: argparse.Namespace) -> str:
    """What a command comes to, in words."""
    if asked.command == "make":
        return make(asked.cases, asked.seed, asked.half, asked.out, asked.jobs, asked.remounts)
    if asked.command == "run":
        return f"{run(asked.cases, asked.answers, asked.jobs, asked.limit, asked.timeout)} cases answered"
    result = score(*load(asked.cases, asked.answers, partial=asked.partial))
    if asked.json:
        asked.json.write_text(as_json(result), encoding="utf-8")
    if asked.page:
        write_section(asked.page, result)
    return section(result)
