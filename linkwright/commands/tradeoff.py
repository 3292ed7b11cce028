"""`linkwright tradeoff`: the Pareto front between two figures of a design, as a table, a picture and arm files."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import linkwright as lw
from linkwright.core.units.quantities import InputError
from linkwright.output.files import (
    RESULT,
    check_target,
    made_folder,
    refuse_strangers,
    write_file,
    write_result,
)

from .options import (
    Author,
    CatalogueFile,
    Comment,
    Dask,
    JsonFile,
    MarkdownFile,
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
    from linkwright.core.optimize.tradeoff.journal import Journal
    from linkwright.core.optimize.tradeoff.question import Question
    from linkwright.face.problem import Problem
    from linkwright.face.tradeoff import Tradeoff
    from linkwright.report.origin import Origin

HELP = """The trade-off between two figures: no design of the front can be beaten in both.

Any two figures: max_error, mass, total_mass, cost, reach, safety_factor, first_frequency, wall_slenderness, aspect,
tip_stiffness, sideways_stiffness. A front that was stopped goes on with --resume.

Example: linkwright tradeoff problem.yaml --x mass --y max_error --by material --out front
"""


class GroupBy(StrEnum):
    """What there can be a front for each of."""

    MATERIAL = "material"
    SHAPE = "shape"


class ReachWanted(StrEnum):
    """Which way the reach is better."""

    LONG = "long"
    SHORT = "short"


def tradeoff(
    problem: Annotated[Path, typer.Argument(metavar="PROBLEM", help="The problem file.")],
    x: Annotated[str, typer.Option("--x", metavar="FIGURE", help="The figure to the right.")] = "mass",
    y: Annotated[str, typer.Option("--y", metavar="FIGURE", help="The figure upwards.")] = "max_error",
    by: Annotated[
        GroupBy | None, typer.Option("--by", help="A front for each material, or shape, that all links then share.")
    ] = None,
    reach: Annotated[ReachWanted, typer.Option("--reach", help="Which reach is the better one.")] = ReachWanted.LONG,
    accuracy: Annotated[
        float,
        typer.Option(
            "--accuracy", min=1e-4, max=0.5, help="Relative error that straight lines between points may have."
        ),
    ] = 0.01,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="Write report.html, picture, CSV, JSON, an arm file a point, and the journal."
        ),
    ] = None,
    json: JsonFile = None,
    markdown: MarkdownFile = None,
    pdf: PdfFile = None,
    csv: Annotated[
        Path | None, typer.Option("--csv", metavar="FILE", help="Write the points: .csv, .parquet, .md or .tex.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with what the journal in --out DIR holds.")] = False,
    catalogue: CatalogueFile = None,
    author: Author = "",
    comment: Comment = "",
    workers: Workers = None,
    dask: Dask = None,
) -> None:
    """Run the command."""
    from linkwright.output.table_file import check_table
    from linkwright.report.origin import origin_of
    from linkwright.results.tradeoff import describe
    from linkwright.screen.console import console
    from linkwright.screen.loudness import loudness
    from linkwright.screen.progress import waiting

    for target in (json, csv, markdown, pdf):
        check_target(target, problem, catalogue)
    check_table(csv)
    check_pdf(pdf)
    if resume and out is None:
        raise InputError("", "--resume", "needs --out DIR, where the journal of the earlier run is")
    with waiting("reading"):
        from linkwright.core.optimize.tradeoff.question import question

        given = lw.read_problem(problem, catalogue=catalogue)
        asked = question(given.model, x, y, by=None if by is None else by.value, reach=reach.value)
    with (
        asked_of(problem),
        crew_of(workers, dask) as crew,
        _journal(asked, accuracy, out, resume=resume) as journal,
    ):
        result = _traced(given, asked, accuracy, journal, out, crew)
        read = files_of(problem, given.arm_file, catalogue)
        origin = origin_of(read, author=author, comment=comment)
        described = describe(result.found)
        with not_lost(described):
            if pdf is not None:
                result.save_pdf(pdf, made_from=read, author=author, comment=comment)
            written = _write(result, out, json, csv, origin)
    if loudness() != "answer":
        console().print()
    tell(described, markdown, *written, pdf)


def _journal(asked: Question, accuracy: float, out: Path | None, *, resume: bool) -> Journal:
    """The journal in the output folder, which is made or taken again; without a folder, one that is not written."""
    from linkwright.core.optimize.tradeoff.journal import JOURNAL, LOCK, Journal, journal_digest
    from linkwright.core.optimize.tradeoff.question import digest
    from linkwright.json.tradeoff import made_by
    from linkwright.output.tradeoff_folder import FILES

    own = digest(asked, accuracy)
    if out is None:
        return Journal(None, own)
    names = made_folder(out) - {LOCK}
    refuse_strangers(out, names, FILES)
    there = journal_digest(out / JOURNAL)
    if names and there is None:
        # A kill in the first instant leaves an empty journal, which is as good as none.
        if names != {JOURNAL} or (out / JOURNAL).stat().st_size > 0:
            would_do = "name a new or empty folder"
            raise InputError(out, "", f"holds files that are not of `linkwright tradeoff`; {would_do}")
    elif there == own and RESULT not in names and not resume:
        would_do = "--resume goes on with it, or name another folder"
        raise InputError(out, "", f"holds this trade-off, unfinished; {would_do}")
    journal = Journal(out / JOURNAL, own, resume=resume, made_by=made_by())
    # Until the new result is there, none is: a folder with a journal alone is known for unfinished.
    (out / RESULT).unlink(missing_ok=True)
    return journal


def _traced(
    given: Problem, asked: Question, accuracy: float, journal: Journal, out: Path | None, crew: Executor
) -> Tradeoff:
    """Trace the fronts, with a sign of how far they are; an interrupt ends the work between two of its parts."""
    from linkwright.face.tradeoff import traced_front
    from linkwright.screen.tracing import TracingProgress

    shown = TracingProgress(groups=asked.by is not None)
    try:
        result = traced_front(given, asked, accuracy, journal, shown, crew)
        if result.interrupted:
            raise KeyboardInterrupt
    except KeyboardInterrupt:
        kept = "nothing is kept without --out DIR"
        if out is not None:
            kept = f"{journal.size} solved points are kept in {out}; --resume goes on with them"
        shown.close()
        stop(crew, kept)
    finally:
        shown.close()
    return result


def _write(result: Tradeoff, out: Path | None, json: Path | None, csv: Path | None, origin: Origin) -> list[Path]:
    """Write what is asked for; the files of the folder, and which there are."""
    from linkwright.face.arm import catalogue_of
    from linkwright.json.tradeoff import tradeoff_csv
    from linkwright.output.table_file import WAYS, write_table
    from linkwright.output.tradeoff_folder import write_tradeoff

    write_result(json, result.to_json())
    if csv is not None:
        if csv.suffix.lower() in WAYS:
            write_table(result.table, csv)
        else:
            write_file(csv, tradeoff_csv(result.found))
    materials = catalogue_of(result.problem.arm.catalogue)
    written = [] if out is None else write_tradeoff(result.found, out, origin, materials)
    return written + [path for path in (json, csv) if path is not None]
