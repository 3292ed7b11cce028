"""`linkwright compare`: two recordings of one arm, before and after a service say, and what changed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import linkwright as lw
from linkwright.output.files import check_target, write_result

from .diagnose import RecordingYaml, Thorough, Without, known_effects, steps
from .options import CatalogueFile, JsonFile, MarkdownFile, asked_of, not_lost, tell

HELP = """What changed between two recordings of one arm: parameters with intervals, noise, figures of the standards.

Example: linkwright compare arm.yaml before.csv after.csv --json changes.json
"""


def compare(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    first: Annotated[Path, typer.Argument(metavar="A", help="The earlier recording.")],
    second: Annotated[Path, typer.Argument(metavar="B", help="The later recording.")],
    json: JsonFile = None,
    markdown: MarkdownFile = None,
    thorough: Thorough = False,
    without_effect: Without = None,
    recording_yaml: RecordingYaml = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from linkwright.results.diagnoses.comparison import describe
    from linkwright.screen.progress import waiting

    for target in (json, markdown):
        check_target(target, arm, first, second, recording_yaml, catalogue)
    without = known_effects(without_effect or ())
    with waiting("reading"):
        given = lw.read_arm(arm, catalogue=catalogue)
        before, after = lw.read_recordings((first, second), given, settings=recording_yaml)
    with asked_of(arm), steps() as told:
        found = lw.compare(given, before, after, thorough=thorough, without=without, progress=told)
    described = describe(found.found)
    with not_lost(described):
        write_result(json, found.to_json())
    tell(described, markdown, json)
