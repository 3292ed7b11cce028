"""`linkwright diagnose`: what a recording says that the model leaves out."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import linkwright as lw
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import nearest
from linkwright.output.files import check_target, write_result

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
    tell,
)

if TYPE_CHECKING:
    from linkwright.screen.progress import Steps

HELP = """What the model of an arm leaves out, by recordings of the real one: where, what, how sure, and what to do.

Example: linkwright diagnose arm.yaml recording.csv --out result

Several at once share the physics: linkwright diagnose arm.yaml may.csv august.csv
"""
Thorough = Annotated[bool, typer.Option("--thorough", help="Calibrate the whole search; takes longer.")]
Without = Annotated[
    list[str] | None,
    typer.Option("--without-effect", metavar="ID", help="Leave this effect out of the candidates; may be repeated."),
]
RecordingYaml = Annotated[
    Path | None,
    typer.Option("--recording-yaml", metavar="FILE", help="What the columns mean; by default the file beside it."),
]
RecordingYamls = Annotated[
    list[Path] | None,
    typer.Option(
        "--recording-yaml",
        metavar="FILE",
        help="What the columns mean; by default the file beside the recording. Of several recordings: once for all, "
        "or once for each, in their order.",
    ),
]


def diagnose(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    recording: Annotated[
        list[Path], typer.Argument(metavar="RECORDING...", help="The recording (.csv, .xlsx, .parquet), or several.")
    ],
    out: OutFolder = None,
    json: JsonFile = None,
    markdown: MarkdownFile = None,
    pdf: PdfFile = None,
    thorough: Thorough = False,
    without_effect: Without = None,
    recording_yaml: RecordingYamls = None,
    units: Annotated[
        bool, typer.Option("--units", help="The recordings are of several arms of one type: anything may differ.")
    ] = False,
    problem: Annotated[
        Path | None,
        typer.Option("--problem", metavar="PROBLEM", help="Solve this design problem with what was found, too."),
    ] = None,
    catalogue: CatalogueFile = None,
    author: Author = "",
    comment: Comment = "",
    workers: Workers = None,
    dask: Dask = None,
) -> None:
    """Run the command."""
    from linkwright.face.diagnosis import recordings_of, settings_of
    from linkwright.output.diagnosis_folder import claim_diagnosis, written_files
    from linkwright.results.diagnoses.described import describe
    from linkwright.screen.progress import waiting

    for target in (json, markdown, pdf):
        check_target(target, arm, *recording, *(recording_yaml or ()), problem, catalogue)
    check_pdf(pdf)
    known_effects(without_effect or ())
    with waiting("reading"):
        given = lw.read_arm(arm, catalogue=catalogue, tip="")
        read = recordings_of(recording, given, recording_yaml, units=units)
        asked = None if problem is None else lw.read_problem(problem, catalogue=catalogue)
    with asked_of(arm), steps() as told, crew_of(workers, dask) as crew:
        claim_diagnosis(out)
        leave = without_effect or ()
        found = lw.diagnose(given, read, thorough=thorough, without=leave, progress=told, executor=crew)
    if asked is not None:
        with asked_of(arm), steps() as told:
            found = replace(found, redesign=lw.redesign(asked, found, progress=told))
    described = describe(found.found, None if found.redesign is None else found.redesign.found)
    written = [] if json is None else [json]
    files = files_of(arm, *recording, *settings_of(read), problem, None if asked is None else asked.arm_file, catalogue)
    with not_lost(described):
        write_result(json, found.to_json())
        if pdf is not None:
            found.save_pdf(pdf, made_from=files, author=author, comment=comment)
            written = [pdf, *written]
        if out is not None:
            found.save(out, made_from=files, author=author, comment=comment)
            written = [*written_files(out, found.found), *written]
    tell(described, markdown, *written)


def known_effects(names: Sequence[str]) -> frozenset[str]:
    """The effects named by `--without-effect`; raises `InputError` with the nearest name for one that is not known."""
    from linkwright.core.arm.effects import EFFECTS

    for name in names:
        if name not in EFFECTS:
            raise InputError("", "--without-effect", f"there is no effect '{name}'{nearest(name, list(EFFECTS))}")
    return frozenset(names)


@contextmanager
def steps() -> Generator[Steps]:
    """A bar on a terminal, nothing elsewhere."""
    from linkwright.screen.progress import waiting

    with waiting("beginning") as made:
        yield made
