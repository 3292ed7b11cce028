"""`linkwright tradeoff`: the Pareto front between two figures of a design, as a table, a picture and arm files."""

from __future__ import annotations

import signal
from collections.abc import Callable, Generator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated

import typer

from linkwright.writing import (
    REPORT,
    RESULT,
    check_target,
    json_text,
    made_folder,
    refuse_strangers,
    write_file,
    write_folder,
    write_json,
)
from materials.quantities import InputError

from .options import CatalogueFile, JsonFile, asked_of, catalogue_with

if TYPE_CHECKING:
    from optimize.tradeoff_journal import Journal
    from optimize.tradeoff_question import Question
    from optimize.tradeoff_result import Tradeoff
    from optimize.tradeoff_trace import Progress

HELP = """The trade-off between two figures: no design of the front can be beaten in both.

Any two of max_error, mass, total_mass, cost, reach, first_frequency. A front that was stopped goes on with --resume.

Example: linkwright tradeoff problem.yaml --x mass --y max_error --by material --out front
"""
CSV, PICTURE, POINTS = "tradeoff.csv", "tradeoff.svg", "points"


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
    csv: Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Write the points as CSV.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with what the journal in --out DIR holds.")] = False,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from linkwright.screen.console import console, waiting
    from linkwright.screen.tradeoff import show_tradeoff

    for target in (json, csv):
        check_target(target, problem, catalogue)
    if resume and out is None:
        raise InputError("", "--resume", "needs --out DIR, where the journal of the earlier run is")
    with waiting("reading"):
        from optimize.problem import read_problem
        from optimize.tradeoff_question import question

        given = read_problem(problem, catalogue_with(catalogue))
        asked = question(given, x, y, by=None if by is None else by.value, reach=reach.value)
    with asked_of(problem), _journal(asked, accuracy, out, resume=resume) as journal:
        result = _traced(asked, accuracy, journal, out)
        written = _write(result, out, json, csv)
    screen = console()
    show_tradeoff(screen, result)
    for path in written:
        screen.print(f"written: {path}", soft_wrap=True)


def _journal(asked: Question, accuracy: float, out: Path | None, *, resume: bool) -> Journal:
    """The journal in the output folder, which is made or taken again; without a folder, one that is not written."""
    from linkwright.tradeoff_data import made_by
    from optimize.tradeoff_journal import JOURNAL, Journal, journal_digest
    from optimize.tradeoff_question import digest

    own = digest(asked, accuracy)
    if out is None:
        return Journal(None, own)
    names = made_folder(out)
    refuse_strangers(out, names, (RESULT, REPORT, CSV, PICTURE, POINTS, JOURNAL))
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


def _traced(asked: Question, accuracy: float, journal: Journal, out: Path | None) -> Tradeoff:
    """Trace the fronts, with a sign of how far they are; an interrupt ends the work between two of its parts."""
    from linkwright.screen.console import console
    from linkwright.screen.tradeoff import TracingProgress
    from optimize.tradeoff import trade_off

    screen = console(errors=True)
    shown = TracingProgress(console(), groups=asked.by is not None)
    with _interrupts() as interrupted:

        def told(progress: Progress) -> None:
            if interrupted():
                raise KeyboardInterrupt
            shown(progress)

        try:
            return trade_off(asked, accuracy=accuracy, journal=journal, told=told)
        except KeyboardInterrupt:
            kept = "nothing is kept without --out DIR"
            if out is not None:
                kept = f"{journal.size} solved points are kept in {out}; --resume goes on with them"
            shown.close()
            screen.print(f"stopped: {kept}", soft_wrap=True)
            raise
        finally:
            shown.close()


@contextmanager
def _interrupts() -> Generator[Callable[[], bool]]:
    """Note the first Ctrl-C instead of raising it, for the solver would take it for a failure of its own; a second one
    is raised."""
    noted: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        if noted:
            signal.default_int_handler(number, frame)
        noted.append(number)

    try:
        before = signal.signal(signal.SIGINT, note)
    except ValueError:  # not the main thread, which alone hears of signals
        yield lambda: False
        return
    try:
        yield lambda: bool(noted)
    finally:
        signal.signal(signal.SIGINT, before)


def _write(result: Tradeoff, out: Path | None, json: Path | None, csv: Path | None) -> list[Path]:
    """Write what is asked for; the files of the folder, and which there are."""
    from linkwright.tradeoff_data import tradeoff_csv, tradeoff_json

    content = tradeoff_json(result)
    write_json(json, content)
    rows = tradeoff_csv(result)
    if csv is not None:
        write_file(csv, rows)
    written: list[Path] = []
    if out is not None:
        from linkwright.report.tradeoff import tradeoff_page
        from linkwright.report.tradeoff_picture import tradeoff_picture

        _write_points(result, out)
        files = {REPORT: tradeoff_page(result), PICTURE: tradeoff_picture(result), CSV: rows}
        for name, text in files.items():
            write_file(out / name, text)
        write_folder(out, {RESULT: json_text(content)})
        written = [out / name for name in (REPORT, PICTURE, CSV, RESULT)] + [out / POINTS]
    return written + [path for path in (json, csv) if path is not None]


def _write_points(result: Tradeoff, out: Path) -> None:
    from arm.writing import arm_to_yaml
    from linkwright.tradeoff_data import point_file

    files = {point_file(result, point): arm_to_yaml(point.arm) for point in result.points}
    folder = out / POINTS
    there = made_folder(folder)
    refuse_strangers(folder, {name for name in there if not _numbered(name)}, ())
    for name in there - {Path(name).name for name in files}:
        (folder / name).unlink()
    for name, text in files.items():
        write_file(out / name, text)


def _numbered(name: str) -> bool:
    return name.endswith(".yaml") and name.removesuffix(".yaml").isdigit()
