"""`linkwright compare`: two recordings of one arm, before and after a service say, and what changed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from linkwright.writing import check_target, write_json

from .diagnose import RecordingYaml, Thorough, Without, diagnosed, known_effects
from .options import CatalogueFile, JsonFile, asked_of, catalogue_with

HELP = """What changed between two recordings of one arm: parameters with intervals, noise, figures of the standards.

Example: linkwright compare arm.yaml before.csv after.csv --json changes.json
"""


def compare(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    first: Annotated[Path, typer.Argument(metavar="A", help="The earlier recording.")],
    second: Annotated[Path, typer.Argument(metavar="B", help="The later recording.")],
    json: JsonFile = None,
    thorough: Thorough = False,
    without_effect: Without = None,
    recording_yaml: RecordingYaml = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from arm.files import read_arm
    from diagnose.compare import compare as compared
    from diagnose.options import Options
    from diagnose.reading import read_recording
    from linkwright.comparison_words import comparison_json
    from linkwright.screen.comparison import show_comparison
    from linkwright.screen.console import console, waiting

    check_target(json, arm, first, second, recording_yaml, catalogue)
    options = Options(thorough=thorough, without=known_effects(without_effect or ()))
    with waiting("reading"):
        given = read_arm(arm, catalogue_with(catalogue))
        recordings = [read_recording(path, given, recording_yaml) for path in (first, second)]
    with asked_of(arm):
        diagnoses = [diagnosed(given, recording, options) for recording in recordings]
        comparison = compared(given, *diagnoses)
    write_json(json, comparison_json(comparison))
    screen = console()
    show_comparison(screen, comparison)
    if json is not None:
        screen.print(f"written: {json}", soft_wrap=True)
