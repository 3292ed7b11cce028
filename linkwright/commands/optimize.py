"""`linkwright optimize`: the design with the least worst-case error (or mass, or cost) within a problem's limits."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import linkwright as lw
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.output.files import (
    DESIGN,
    REPORT,
    RESULT,
    check_target,
    claim_folder,
    write_json,
    write_markdown,
    write_result,
)

from .options import (
    Author,
    CatalogueFile,
    Comment,
    Dask,
    JsonFile,
    MarkdownFile,
    OutFolder,
    PdfFile,
    Workers,
    asked_of,
    check_pdf,
    crew_of,
    files_of,
    not_lost,
    stop,
    tell,
)

if TYPE_CHECKING:
    from linkwright.core.executors import Executor
    from linkwright.core.optimize.result import Iteration
    from linkwright.face.design import Optimization
    from linkwright.face.problem import Problem

HELP = """The best design within a problem's limits: what changes, how sure it is, what binds and what that costs.

Example: linkwright optimize problem.yaml --out result
Example: linkwright optimize problem.yaml --round stock --out result
Example: linkwright optimize problem.yaml --resume search.jsonl --out result
"""


def optimize(
    problem: Annotated[Path, typer.Argument(metavar="PROBLEM", help="The problem file.")],
    out: OutFolder = None,
    json: JsonFile = None,
    markdown: MarkdownFile = None,
    pdf: PdfFile = None,
    catalogue: CatalogueFile = None,
    author: Author = "",
    comment: Comment = "",
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
    resume: Annotated[
        Path | None,
        typer.Option(
            "--resume",
            metavar="FILE",
            help="Note all that is solved in FILE, and go on with what it holds after a stop.",
        ),
    ] = None,
    workers: Workers = None,
    dask: Dask = None,
) -> None:
    """Run the command."""
    from linkwright.json.infeasible import infeasible_json
    from linkwright.results.optimization import describe, describe_infeasible
    from linkwright.screen.console import console
    from linkwright.screen.described import show
    from linkwright.screen.progress import waiting

    for target in (json, markdown, pdf, resume):
        check_target(target, problem, catalogue)
    check_pdf(pdf)
    if round_to is None and round_length is not None:
        raise InputError("", "--round-length", "goes with --round; write --round stock, or --round '0.5 mm'")
    if round_to is not None:
        from linkwright.core.optimize.rounding.options import read_rounding

        read_rounding(round_to, round_length)  # a mistake is told before anything is read
    with waiting("reading"):
        asked = lw.read_problem(problem, catalogue=catalogue)
    with asked_of(problem), crew_of(workers, dask) as crew:
        claim_folder(out, "optimize")
        try:
            result = _solved(asked, round_to, round_length, resume, crew)
        except NoAnswer as error:
            if error.infeasible is not None:
                described = describe_infeasible(error.infeasible)
                with not_lost(described):
                    write_json(json, infeasible_json(error.infeasible, "optimize", problem))
                    write_markdown(markdown, described)
                show(console(), described)
            raise
    described = describe(result.found)
    read = files_of(problem, asked.arm_file, catalogue)
    with not_lost(described):
        write_result(json, result.to_json())
        if pdf is not None:
            result.save_pdf(pdf, made_from=read, author=author, comment=comment)
        if out is not None:
            result.save(out, made_from=read, author=author, comment=comment)
    written = [out / name for name in (REPORT, DESIGN, RESULT)] if out is not None else []
    tell(described, markdown, *written, pdf, json)
    if result.interrupted:
        stop(crew, _kept("this is the best design so far", resume, crew))


def _solved(
    problem: Problem, round_to: str | None, round_length: str | None, resume: Path | None, crew: Executor
) -> Optimization:
    """Optimise (and round), with a line for each iteration and a bar while combinations are tried."""
    from linkwright.results.design import rigid_links_words
    from linkwright.results.figures_in_words import mm
    from linkwright.results.optimization import iteration_line
    from linkwright.screen.console import console
    from linkwright.screen.loudness import loudness
    from linkwright.screen.progress import Steps

    screen = console()
    steps = Steps("looking at what there is to choose from")

    def log(iteration: Iteration) -> None:
        if loudness() != "answer":
            with steps.aside():
                screen.print(iteration_line(iteration, problem.model.minimize), soft_wrap=True)

    def beyond(text: str) -> None:
        with steps.aside():
            screen.print(f"{text}; now looking for what the limits would have to be", soft_wrap=True)

    def begun(before: lw.Evaluation) -> None:
        if loudness() != "answer" and problem.model.minimize == "max_error":
            for each in rigid_links_words(before.found):
                with steps.aside():
                    screen.print(f"arm as given: {mm(before.found.max_error)}; {each.text}", soft_wrap=True)

    given: Any = {"round_to": round_to, "round_length": round_length, "resume": resume}
    given |= {"progress": steps, "log": log, "out_of_reach": beyond, "begun": begun}
    try:
        found = lw.optimize(problem, **given, executor=crew)
    except KeyboardInterrupt:
        steps.close()
        stop(crew, _kept("no design was finished yet, so there is none to keep", resume, crew))
    finally:
        steps.close()
    if loudness() != "answer":
        screen.print()
    return found


def _kept(words: str, resume: Path | None, crew: Executor) -> str:
    """What an interrupt leaves, and how it goes on."""
    if resume is not None:
        return f"{words}; the same command goes on with what is in {resume}"
    return words if crew.lost is None else f"{words}; one that is to go on where it stops needs --resume FILE"
