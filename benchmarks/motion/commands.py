"""The command line: python -m benchmarks.motion make | run | score."""

from __future__ import annotations

import argparse

from benchmarks.blind.answers import load
from benchmarks.blind.front import answer, options
from benchmarks.blind.run import run
from benchmarks.blind.tables import as_json
from benchmarks.motion.generator.cases import HALVES, NoCaseError
from benchmarks.motion.make import make
from benchmarks.motion.predicted import predict_all, predictions
from benchmarks.motion.score import score, shown


def _parser() -> argparse.ArgumentParser:
    return options("python -m benchmarks.motion", __doc__, HALVES, 300, 300.0)[0]


def main(arguments: list[str] | None = None) -> int:
    """Runs one command; exit status 0, or 2 with one line where the input is wrong."""
    asked = _parser().parse_args(arguments)
    return answer("benchmarks.motion", lambda: _done(asked), NoCaseError)


def _done(arguments: argparse.Namespace) -> str:
    """What a command comes to, in words."""
    if arguments.command == "make":
        return make(arguments.cases, arguments.seed, arguments.half, arguments.out, arguments.jobs)
    if arguments.command == "run":
        answered = run(arguments.cases, arguments.answers, arguments.jobs, arguments.limit, arguments.timeout)
        predicted = predict_all(arguments.cases, arguments.answers, arguments.jobs)
        return f"{answered} cases answered, {predicted} test logs predicted"
    truths, given, half, seal = load(arguments.cases, arguments.answers, partial=arguments.partial)
    result = score(truths, given, predictions(arguments.answers), half, seal)
    if arguments.json:
        arguments.json.write_text(as_json(result), encoding="utf-8")
    return shown(result)
