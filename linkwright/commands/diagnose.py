"""`linkwright diagnose`: what a recording says that the model leaves out."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from arm.effects import EFFECTS
from linkwright.writing import check_target, json_text, write_json
from materials.quantities import InputError
from materials.reading import nearest

from .options import CatalogueFile, JsonFile, OutFolder, asked_of, catalogue_with

if TYPE_CHECKING:
    from arm.chain import Arm
    from diagnose.options import Options
    from diagnose.recording import Recording
    from diagnose.result import Diagnosis
    from linkwright.redesign import Redesign
    from optimize.problem import Problem

HELP = """What the model of an arm leaves out, by a recording of the real one: where, what, how sure, and what to do.

Example: linkwright diagnose arm.yaml recording.csv --out result
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


def diagnose(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    recording: Annotated[Path, typer.Argument(metavar="RECORDING", help="The recording, CSV or parquet.")],
    out: OutFolder = None,
    json: JsonFile = None,
    thorough: Thorough = False,
    without_effect: Without = None,
    recording_yaml: RecordingYaml = None,
    problem: Annotated[
        Path | None,
        typer.Option("--problem", metavar="PROBLEM", help="Solve this design problem with what was found, too."),
    ] = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from arm.files import read_arm
    from diagnose.options import Options
    from diagnose.reading import read_recording
    from linkwright.diagnosis_files import FILES, claim_diagnosis, write_diagnosis
    from linkwright.diagnosis_json import diagnosis_json
    from linkwright.redesign_words import redesign_json, redesign_sentences
    from linkwright.screen.console import console, waiting
    from linkwright.screen.diagnosis import show_diagnosis

    check_target(json, arm, recording, recording_yaml, problem, catalogue)
    without = known_effects(without_effect or ())
    with waiting("reading"):
        materials = catalogue_with(catalogue)
        given = read_arm(arm, materials)
        read = read_recording(recording, given, recording_yaml)
        asked = None if problem is None else _read_problem(problem, catalogue)
        claim_diagnosis(out)
    with asked_of(arm):
        found = diagnosed(given, read, Options(thorough=thorough, without=without))
        redesigned = None if asked is None else _redesigned(asked, found)
    content: dict[str, Any] = diagnosis_json(found)
    content["redesign"] = None if redesigned is None else redesign_json(redesigned)
    write_json(json, content)
    written = [] if json is None else [json]
    if out is not None:
        from linkwright.report.diagnosis import diagnosis_page

        names = write_diagnosis(out, found, json_text(content), diagnosis_page(found, redesigned))
        written = [*(out / name for name in FILES if name in names), *written]
    screen = console()
    show_diagnosis(screen, found)
    if redesigned is not None:
        screen.print()
        screen.print("The design with the corrected physics", style="bold")
        for sentence in redesign_sentences(redesigned):
            screen.print(sentence, soft_wrap=True)
    for path in written:
        screen.print(f"written: {path}", soft_wrap=True)


def known_effects(names: Sequence[str]) -> frozenset[str]:
    """The effects named by `--without-effect`; raises `InputError` with the nearest name for one that is not known."""
    for name in names:
        if name not in EFFECTS:
            raise InputError("", "--without-effect", f"there is no effect '{name}'{nearest(name, list(EFFECTS))}")
    return frozenset(names)


def diagnosed(arm: Arm, recording: Recording, options: Options) -> Diagnosis:
    """Diagnose, with a bar on a terminal."""
    from diagnose.diagnosis import diagnose as run
    from linkwright.screen.progress import Steps

    steps = Steps()
    try:
        return run(arm, recording, options, steps)
    finally:
        steps.close()


def _read_problem(path: Path, catalogue: Path | None) -> Problem:
    from optimize.problem import read_problem

    return read_problem(path, catalogue_with(catalogue))


def _redesigned(problem: Problem, found: Diagnosis) -> Redesign:
    from linkwright.redesign import redesign
    from linkwright.screen.progress import Steps

    steps = Steps()
    try:
        return redesign(problem, found.arm, found.corrected, steps)
    finally:
        steps.close()
