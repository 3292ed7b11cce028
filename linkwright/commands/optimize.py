"""`linkwright optimize`: the design with the least worst-case error (or mass, or cost) within a problem's limits."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from linkwright.writing import (
    DESIGN,
    REPORT,
    RESULT,
    check_target,
    claim_folder,
    json_text,
    write_folder,
    write_json,
)
from materials.quantities import InputError

from .options import CatalogueFile, JsonFile, OutFolder, asked_of, catalogue_with

if TYPE_CHECKING:
    from optimize.problem import Problem
    from optimize.result import Iteration, OptimizationResult
    from optimize.round_options import Rounding

HELP = """The best design within a problem's limits: what changes, how sure it is, what binds and what that costs.

Example: linkwright optimize problem.yaml --out result
Example: linkwright optimize problem.yaml --round stock --out result
"""


def optimize(
    problem: Annotated[Path, typer.Argument(metavar="PROBLEM", help="The problem file.")],
    out: OutFolder = None,
    json: JsonFile = None,
    catalogue: CatalogueFile = None,
    round_to: Annotated[
        str | None,
        typer.Option(
            "--round", metavar="SIZES", help="Also the best design of stock sizes ('stock') or of a grid ('0.5 mm')."
        ),
    ] = None,
    round_length: Annotated[
        str | None,
        typer.Option("--round-length", metavar="STEP", help="With --round: the grid of link lengths, 1 mm by default."),
    ] = None,
) -> None:
    """Run the command."""
    from linkwright.as_json import optimization_json
    from linkwright.screen.console import console, waiting
    from linkwright.screen.optimization import show_optimization

    check_target(json, problem, catalogue)
    rounding = _rounding(round_to, round_length)
    with waiting("reading"):
        from optimize.problem import read_problem

        asked = read_problem(problem, catalogue_with(catalogue))
    claim_folder(out, "optimize")
    with asked_of(problem):
        result = _solved(asked, rounding)
    content = optimization_json(result)
    write_json(json, content)
    if out is not None:
        from arm.writing import arm_to_yaml
        from linkwright.report.optimization import optimization_page

        page = optimization_page(result)
        write_folder(out, {RESULT: json_text(content), REPORT: page, DESIGN: arm_to_yaml(result.built)})
    screen = console()
    show_optimization(screen, result)
    written = [out / name for name in (REPORT, DESIGN, RESULT)] if out is not None else []
    for path in written + ([json] if json is not None else []):
        screen.print(f"written: {path}", soft_wrap=True)


def _rounding(text: str | None, length: str | None) -> Rounding | None:
    from optimize.round_options import read_rounding

    if text is None:
        if length is not None:
            raise InputError("", "--round-length", "goes with --round; write --round stock, or --round '0.5 mm'")
        return None
    return read_rounding(text, length)


def _solved(problem: Problem, rounding: Rounding | None) -> OptimizationResult:
    """Optimise (and round), with a line for each iteration and a bar (or lines) while combinations are tried."""
    from linkwright.screen.console import Tries, console
    from linkwright.screen.optimization import iteration_line
    from optimize.rounding import optimise_rounded
    from optimize.run import optimise

    screen = console()
    tries = Tries(screen)

    def log(iteration: Iteration) -> None:
        screen.print(iteration_line(iteration, problem.minimize), soft_wrap=True)

    try:
        if rounding is not None:
            return optimise_rounded(problem, rounding, log=log, progress=tries)
        return optimise(problem, log=log, progress=tries)
    finally:
        tries.close()
