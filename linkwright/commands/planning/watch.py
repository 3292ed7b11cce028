"""`linkwright watch`: parameters over dated recordings, what moved and when."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import linkwright as lw
from linkwright.commands.diagnose import RecordingYamls, Without, steps
from linkwright.commands.options import (
    Author,
    CatalogueFile,
    Comment,
    Dask,
    JsonFile,
    MarkdownFile,
    OutFolder,
    PdfFile,
    Workers,
    as_options,
    asked_of,
    check_pdf,
    crew_of,
    files_of,
    not_lost,
    tell,
)
from linkwright.output.files import REPORT, RESULT, check_target, claim_own, write_result

HELP = """What moved in an arm and when, by dated recordings of it: steps, drifts, and what is only noise.

Example: linkwright watch arm.yaml week-*.csv --out watched

Each recording.yaml has a date: 2026-05-16; all are of one arm.
"""


def watch(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    recordings: Annotated[
        list[Path],
        typer.Argument(metavar="RECORDING...", help="Three recordings or more (.csv, .xlsx, .parquet), in any order."),
    ],
    for_: Annotated[
        str | None,
        typer.Option(
            "--for",
            metavar="EFFECTS",
            help="Watch these effects beside what is found: a,b,c; by default zeros, drives' compliance and backlash.",
        ),
    ] = None,
    no_search: Annotated[
        bool, typer.Option("--no-search", help="Watch what --for names alone; no diagnosis says what else there is.")
    ] = False,
    out: OutFolder = None,
    json: JsonFile = None,
    markdown: MarkdownFile = None,
    pdf: PdfFile = None,
    without_effect: Without = None,
    recording_yaml: RecordingYamls = None,
    catalogue: CatalogueFile = None,
    author: Author = "",
    comment: Comment = "",
    workers: Workers = None,
    dask: Dask = None,
) -> None:
    """Run the command."""
    from linkwright.face.planning.watch import known_effects, read_dated
    from linkwright.results.diagnoses.watch import describe
    from linkwright.screen.progress import waiting

    for target in (json, markdown, pdf):
        check_target(target, arm, *recordings, *(recording_yaml or ()), catalogue)
    check_pdf(pdf)
    asked = None if for_ is None else tuple(name.strip() for name in for_.split(",") if name.strip())
    with as_options(for_="--for", without="--without-effect"):
        known_effects(asked or (), "for_")
        known_effects(without_effect or (), "without")
    with waiting("reading"), as_options(settings="--recording-yaml", recordings="RECORDING"):
        given = lw.read_arm(arm, catalogue=catalogue)
        own = recording_yaml[0] if recording_yaml is not None and len(recording_yaml) == 1 else recording_yaml
        read = read_dated(recordings, given, own)
    if out is not None:
        claim_own(out, "watch", (RESULT, REPORT))
    with asked_of(arm), steps() as told, crew_of(workers, dask) as crew:
        found = lw.watch(
            given,
            read,
            for_=asked,
            search=not no_search,
            without=without_effect or (),
            progress=told,
            executor=crew,
        )
    held = [Path(each.found.settings) for each in read if each.found.settings]
    files = files_of(arm, *recordings, *dict.fromkeys(held), catalogue)
    described = describe(found.found)
    with not_lost(described):
        if out is not None:
            found.save(out, made_from=files, author=author, comment=comment)
        if pdf is not None:
            found.save_pdf(pdf, made_from=files, author=author, comment=comment)
        write_result(json, found.to_json())
    report = [] if out is None else [out / REPORT, out / RESULT]
    tell(described, markdown, *report, pdf, json)
