"""Real machines: python -m benchmarks.real [MACHINE ...] [--inside] [--out DIR]

Prints, for each of motoman, ur10, servo, printer, irb120, iiwa7 and together (all by default), what the tool says of
its recordings and how well that predicts what was not fitted; together is of several recordings of one machine.
`--inside` adds cross-validation with the diagnosis inside the folds (minutes); `--out` keeps the servo's telemetry with
its pulls and the iiwa 7's runs as one table.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks.real import iiwa7, irb120, motoman, printer, servo, together, ur10
from benchmarks.real.data import NoDataError

_MACHINES = ("motoman", "ur10", "servo", "printer", "irb120", "iiwa7", "together")


def main() -> int:
    """Run what was asked for."""
    reader = argparse.ArgumentParser(prog="python -m benchmarks.real")
    reader.add_argument("machines", nargs="*", choices=[*_MACHINES, []], metavar="MACHINE", help=", ".join(_MACHINES))
    reader.add_argument("--inside", action="store_true", help="the diagnosis inside the folds, too")
    reader.add_argument("--out", type=Path, help="where the servo's and the iiwa 7's tables go")
    arguments = reader.parse_args()
    machines = arguments.machines or _MACHINES
    try:
        if "motoman" in machines:
            for day in motoman.TARGETS:
                motoman.evaluate(day, inside=arguments.inside)
                print()
                motoman.evaluate(day, sides=False)
                print()
        if "ur10" in machines:
            ur10.evaluate(inside=arguments.inside)
            print()
        if "servo" in machines:
            servo.evaluate(out=arguments.out)
        if "printer" in machines:
            printer.evaluate()
            print()
        if "irb120" in machines:
            irb120.evaluate()
            print()
        if "iiwa7" in machines:
            iiwa7.evaluate(out=arguments.out)
            print()
        if "together" in machines:
            together.evaluate()
    except NoDataError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
