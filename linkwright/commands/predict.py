"""`linkwright predict`: what an arm file is worth on a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import linkwright as lw
from linkwright.output.files import check_target, write_result

from .diagnose import RecordingYaml
from .options import CatalogueFile, JsonFile, MarkdownFile, asked_of, not_lost, tell

HELP = """How far an arm's model is from a recording: nothing is fitted but frame and tool, and those only where free.

Example: linkwright predict result/arm.yaml other.csv --json prediction.json
"""


def predict(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file; a corrected one, say.")],
    recording: Annotated[Path, typer.Argument(metavar="RECORDING", help="The recording, CSV, .xlsx or parquet.")],
    json: JsonFile = None,
    markdown: MarkdownFile = None,
    recording_yaml: RecordingYaml = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from linkwright.results.prediction import describe
    from linkwright.screen.progress import waiting

    for target in (json, markdown):
        check_target(target, arm, recording, recording_yaml, catalogue)
    with waiting("predicting") as told, asked_of(arm):
        given = lw.read_arm(arm, catalogue=catalogue, tip="")
        found = lw.predict(given, lw.read_recording(recording, given, settings=recording_yaml), progress=told)
    described = describe(found.found)
    with not_lost(described):
        write_result(json, found.to_json())
    tell(described, markdown, json)
