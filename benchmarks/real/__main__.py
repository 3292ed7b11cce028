"""Real machines: python -m benchmarks.real [MACHINE ...] [--inside] [--out DIR] [--json FILE]

Without a machine it prints the table: of each machine and recording (tips, mm) or joint (torques, N*m) what the given
file, the textbook's least squares and the written file leave of what neither was fitted to (`table` with names after
it: of these alone; some twenty CPU minutes in all). With machines (motoman, ur10, servo, printer, irb120, iiwa7,
together, xl330) it prints what the tool says of each and how well that predicts what was not fitted;
together is of several recordings of one machine. `--inside` adds cross-validation with the diagnosis inside the folds
(minutes); `--out` keeps the servo's telemetry with its pulls and the iiwa 7's runs as one table; `--json` the
table's figures.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

from benchmarks.real import iiwa7, irb120, motoman, printer, servo, together, ur10
from benchmarks.real.data import NoDataError
from benchmarks.real.public import xl330
from benchmarks.real.table import tips, torques
from benchmarks.real.table.row import Row, header, shown, summary

_MACHINES = ("motoman", "ur10", "servo", "printer", "irb120", "iiwa7", "together", "xl330")


def table(names: Sequence[str], out: Path | None, tell: Callable[[str], None] = print) -> list[Row]:
    """Prints rows as they are known, and what they come to; a machine that is not there is named below them."""
    rows: list[Row] = []
    missing: list[str] = []
    header(tell)
    for name, machine in {**tips.MACHINES, **torques.MACHINES}.items():
        if names and name not in names:
            continue
        try:
            for row in machine():
                rows.append(row)
                tell(shown(row))
        except NoDataError as error:
            missing.append(f"{name}: skipped, {error}")
    tell("")
    tell(summary(rows))
    for line in missing:
        tell(line)
    if out is not None:
        said = [asdict(row) | {"ratio": row.ratio, "reason": row.reason} for row in rows]
        out.write_text(json.dumps(said, indent=1) + "\n", encoding="utf-8")
    return rows


def main() -> int:
    """Run what was asked for."""
    reader = argparse.ArgumentParser(prog="python -m benchmarks.real")
    reader.add_argument(
        "machines", nargs="*", metavar="MACHINE", help=f"table [NAME ...] (the default), or {', '.join(_MACHINES)}"
    )
    reader.add_argument("--inside", action="store_true", help="the diagnosis inside the folds, too")
    reader.add_argument("--out", type=Path, help="where the servo's and the iiwa 7's tables go")
    reader.add_argument("--json", type=Path, help="where the table's figures go")
    arguments = reader.parse_args()
    machines = arguments.machines
    in_table = not machines or machines[0] == "table"
    known = [*tips.MACHINES, *torques.MACHINES] if in_table else _MACHINES
    strangers = [name for name in machines[1 if in_table else 0 :] if name not in known]
    if strangers:
        reader.error(f"{strangers[0]} is none of {', '.join(known)}")
    try:
        if in_table:
            table(machines[1:], arguments.json)
            return 0
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
        if "xl330" in machines:
            xl330.evaluate()
    except NoDataError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
