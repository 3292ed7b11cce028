"""All measured figures in one run: python -m benchmarks.results [--quick] [--only SECTION ...] [--page FILE]

Every figure is of this machine at this time, and CPU time where nothing else is said, so that other work on the machine
says little; ratios are of sides run one after the other. `--page` writes the page
that docs/how-to/workshop.md links.
Exit status 1 where a target is missed, but with `--quick`, which measures too little to say so.
"""

from __future__ import annotations

import argparse
import os
import platform
from collections.abc import Callable
from pathlib import Path

import casadi
import numpy as np
import scipy

from .commands import commands
from .long_work import executors, millions, random_scans
from .optimisers import grid, optimisers
from .questions import questions
from .row import Row
from .searches import certificates, links

Section = Callable[..., list[Row]]
SECTIONS: dict[str, tuple[str, Section]] = {
    "grid": ("The exchange against a full grid: how many times as long that takes", grid),
    "optimisers": ("The exchange: how many times as long others take", optimisers),
    "certificates": ("Certificates", certificates),
    "links": ("Cost by the number of links", links),
    "commands": ("Commands", commands),
    "millions": ("Choice among millions", millions),
    "questions": ("Further questions against every choice singly", questions),
    "executors": ("Executors", executors),
    "scans": ("Scans against bounds", random_scans),
}
OPENING = """# Measured figures

Written by `make results` (`python -m benchmarks.results --page benchmarks/RESULTS.md`). Seconds are of CPU where
nothing else is said; ratios are of sides run one after the other in one run, their answers held against each other.
"""


def page(found: dict[str, list[Row]], *, quick: bool) -> str:
    """The page in Markdown."""
    cores, versions = os.cpu_count(), f"NumPy {np.__version__}, SciPy {scipy.__version__}, CasADi {casadi.__version__}"
    left_out = ", fewest rounds, slow rivals left out" if quick else ""
    lines = [OPENING, f"{cores} cores, Python {platform.python_version()}, {versions}{left_out}.", ""]
    missed = [row for rows in found.values() for row in rows if row.met is False]
    lines += [f"Targets missed: {'; '.join(f'{row.what} ({row.figure})' for row in missed) or 'none'}.", ""]
    for key, rows in found.items():
        lines += [f"## {SECTIONS[key][0]}", "", "| what | measured | target | | |", "|---|---|---|---|---|"]
        words = {True: "met", False: "**missed**", None: ""}
        lines += [f"| {row.what} | {row.figure} | {row.target} | {words[row.met]} | {row.note} |" for row in rows]
        lines.append("")
    return "\n".join(lines)


def main() -> int:
    """Measure, print, write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.results")
    parser.add_argument("--quick", action="store_true", help="fewest rounds, and without what takes minutes")
    parser.add_argument("--only", nargs="+", choices=[*SECTIONS], default=[*SECTIONS])
    parser.add_argument("--page", type=Path, help="the page to write")
    arguments = parser.parse_args()
    results: dict[str, list[Row]] = {}
    for key in arguments.only:
        title, section = SECTIONS[key]
        print(title, flush=True)
        results[key] = section(quick=arguments.quick)
        if arguments.page is not None:
            arguments.page.write_text(page(results, quick=arguments.quick), encoding="utf-8")
        for row in results[key]:
            verdict = {True: "met", False: "MISSED", None: ""}[row.met]
            print(f"  {row.what}: {row.figure} ({row.target or 'no target'}) {verdict} {row.note}", flush=True)
    return 1 if not arguments.quick and any(row.met is False for rows in results.values() for row in rows) else 0


if __name__ == "__main__":
    raise SystemExit(main())
