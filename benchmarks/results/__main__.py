"""All measured figures in one run: python -m benchmarks.results [--quick] [--only SECTION ...] [--page FILE]

Every figure is of this machine at this time, and CPU time where nothing else is said, so that other work on the machine
says little; ratios are of sides run one after the other. `--page` writes the page
that docs/how-to/workshop.md links; sections that were not asked for stay in it as they were.
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
    "questions": ("What can be asked, against every choice singly or independent physics", questions),
    "executors": ("Executors", executors),
    "scans": ("Scans against bounds", random_scans),
}
OPENING = """# Measured figures

Written by `make results` (`python -m benchmarks.results --page benchmarks/RESULTS.md`). Seconds are of CPU where
nothing else is said; ratios are of sides run one after the other in one run, their answers held against each other.
"""


def sections_of(page: str) -> dict[str, str]:
    """The sections of a page in Markdown, by their titles."""
    return {part.partition("\n")[0]: part.partition("\n")[2].strip() for part in page.split("\n## ")[1:]}


def _section(rows: list[Row]) -> str:
    words = {True: "met", False: "**missed**", None: ""}
    lines = [f"| {row.what} | {row.figure} | {row.target} | {words[row.met]} | {row.note} |" for row in rows]
    return "\n".join(["| what | measured | target | | |", "|---|---|---|---|---|", *lines])


def page(results: dict[str, list[Row]], before: str = "", *, quick: bool) -> str:
    """The page in Markdown; sections that were not measured stay as they were `before`."""
    cores, versions = os.cpu_count(), f"NumPy {np.__version__}, SciPy {scipy.__version__}, CasADi {casadi.__version__}"
    left_out = ", fewest rounds, slow rivals left out" if quick else ""
    lines = [OPENING, f"{cores} cores, Python {platform.python_version()}, {versions}{left_out}.", ""]
    kept = sections_of(before)
    measured = {title: _section(results[key]) for key, (title, _) in SECTIONS.items() if key in results}
    every = {title: measured.get(title) or kept.get(title) for title, _ in SECTIONS.values()}
    shown = {title: text for title, text in every.items() if text}
    missed = [line.split(" | ") for text in shown.values() for line in text.splitlines() if "| **missed** |" in line]
    lines += [f"Targets missed: {'; '.join(f'{cells[0][2:]} ({cells[1]})' for cells in missed) or 'none'}.", ""]
    for title, text in shown.items():
        lines += [f"## {title}", "", text, ""]
    return "\n".join(lines)


def main() -> int:
    """Measure, print, write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.results")
    parser.add_argument("--quick", action="store_true", help="fewest rounds, and without what takes minutes")
    parser.add_argument("--only", nargs="+", choices=[*SECTIONS], default=[*SECTIONS])
    parser.add_argument("--page", type=Path, help="the page to write")
    arguments = parser.parse_args()
    results: dict[str, list[Row]] = {}
    before = ""
    if arguments.page is not None and arguments.page.is_file():
        before = arguments.page.read_text(encoding="utf-8")
    for key in arguments.only:
        title, section = SECTIONS[key]
        print(title, flush=True)
        results[key] = section(quick=arguments.quick)
        if arguments.page is not None:
            arguments.page.write_text(page(results, before, quick=arguments.quick), encoding="utf-8")
        for row in results[key]:
            verdict = {True: "met", False: "MISSED", None: ""}[row.met]
            print(f"  {row.what}: {row.figure} ({row.target or 'no target'}) {verdict} {row.note}", flush=True)
    return 1 if not arguments.quick and any(row.met is False for rows in results.values() for row in rows) else 0


if __name__ == "__main__":
    raise SystemExit(main())
