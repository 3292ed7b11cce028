"""A seeded sample of the proof, small enough for every build: python -m benchmarks.blind_sample [--cases N]

Cases are made by the independent generator, asked through the command line like all others, and scored. Bounds are
wide, since the sample is small: they fail where the diagnosis has broken, not where it is one case worse.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from benchmarks.blind.answers import load
from benchmarks.blind.make import make
from benchmarks.blind.run import run
from benchmarks.blind.score import Score, score

SEED = 4
CASES = 100
LARGE = 1.0
"""Dose (projected signal to noise) from which an effect should be found."""


def misses(found: Score) -> list[str]:
    """What falls below the bounds of a sample, as lines for people."""
    large = [rate for dose, rate in found.class_by_dose if float(dose) >= LARGE]
    named, asked = sum(rate.count for rate in large), sum(rate.total for rate in large)
    judged = (
        ("cases that failed", found.failed.count, 0),
        ("nulls called anything", found.false_alarms.count, max(1, found.false_alarms.total // 20)),
        ("effects of dose 1 and more not named", asked - named, asked // 5),
        (
            "unknown physics of dose 1 and more taken for known",
            found.wrong_closure.count,
            max(1, found.wrong_closure.total // 5),
        ),
    )
    lines: list[str] = []
    for what, count, allowed in judged:
        print(f"{what}: {count}, at most {allowed}")
        if count > allowed:
            lines.append(what)
    return lines


def main() -> int:
    """Make, ask, score, print; 1 where a bound is missed."""
    parser = argparse.ArgumentParser(description="A seeded sample of the proof of the diagnosis.")
    parser.add_argument("--cases", type=int, default=CASES)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        root, answers = Path(folder) / "cases", Path(folder) / "answers"
        make(arguments.cases, SEED, "disclosed", root)
        run(root, answers, jobs=2)
        truths, given, half, seal = load(root, answers)
        missed = misses(score(truths, given, half, seal))
    for line in missed:
        print(f"MISSED  {line}")
    return 1 if missed else 0


if __name__ == "__main__":
    raise SystemExit(main())
