"""`linkwright evaluate`: the worst position error of an arm as given, and why."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from linkwright.writing import REPORT, RESULT, check_target, claim_folder, json_text, write_folder, write_json
from materials.quantities import InputError

from .options import CatalogueFile, JsonFile, OutFolder, asked_of, catalogue_with

if TYPE_CHECKING:
    from arm.chain import Arm
    from arm.evaluation import ErrorMap, Evaluation

HELP = """The worst position error over the workspace, where it is, what each effect adds, and the arm's figures.

Example: linkwright evaluate arm.yaml --pose "10 20 30" --json result.json
"""


def evaluate(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    problem: Annotated[
        Path | None,
        typer.Option("--problem", metavar="PROBLEM", help="Take workspace and load cases from this problem file."),
    ] = None,
    pose: Annotated[
        str | None,
        typer.Option("--pose", metavar="Q", help="Where mm/N is asked for: degrees (mm for slides), in quotes."),
    ] = None,
    out: OutFolder = None,
    json: JsonFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from linkwright.screen.console import console, waiting
    from linkwright.screen.evaluation import show_evaluation

    check_target(json, arm, problem, catalogue)
    with waiting("evaluating"):
        from arm.files import read_arm

        materials = catalogue_with(catalogue)
        given = read_arm(arm, materials)
        at = None if pose is None else read_pose(pose, given)
        claim_folder(out, "evaluate")
        with asked_of(arm):
            evaluation = _evaluation(given, arm, problem, catalogue, at)
            field = _error_map(evaluation) if out is not None else None
    content = _written(evaluation, json)
    if field is not None:
        from linkwright.report.evaluation import evaluation_page

        write_folder(out, {RESULT: json_text(content), REPORT: evaluation_page(evaluation, field)})
    screen = console()
    show_evaluation(screen, evaluation)
    for path in ([out / REPORT, out / RESULT] if out is not None else []) + ([json] if json is not None else []):
        screen.print(f"written: {path}", soft_wrap=True)


def read_pose(text: str, arm: Arm) -> tuple[float, ...]:
    """Joint coordinates in SI from `--pose`: numbers in degrees (mm for slides), apart by blanks or commas."""
    words = text.replace(",", " ").split()
    if len(words) != arm.size:
        raise InputError("", "--pose", f"needs {arm.size} numbers, one for each joint, not {len(words)}")
    values: list[float] = []
    for word, joint in zip(words, arm.joints, strict=True):
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError("", "--pose", f"'{word}' is not a number of degrees (or mm)")
        values.append(math.radians(value) if joint.revolute else 1e-3 * value)
    return tuple(values)


def _evaluation(
    given: Arm, file: Path, problem: Path | None, catalogue: Path | None, pose: tuple[float, ...] | None
) -> Evaluation:
    from arm.evaluation import evaluate as evaluated

    if problem is None:
        return evaluated(given, pose=pose)
    from optimize.problem import read_problem

    asked = read_problem(problem, catalogue_with(catalogue))
    workspace = asked.workspace
    if workspace.ranges is not None and len(workspace.ranges) != given.size:
        raise InputError(problem, "workspace", f"is for {len(workspace.ranges)} joints; {file} has {given.size}")
    return evaluated(given, workspace, asked.load_cases, pose=pose)


def _error_map(evaluation: Evaluation) -> ErrorMap:
    from arm.evaluation import error_map
    from arm.model import beam_values, beams_of, error_model
    from arm.worst import WorstSearch

    model = error_model(evaluation.arm, evaluation.load_cases)
    beams = beams_of(evaluation.arm, evaluation.load_cases)
    return error_map(WorstSearch(model, evaluation.workspace), beam_values(beams))


def _written(evaluation: Evaluation, json: Path | None) -> dict[str, object]:
    from linkwright.as_json import evaluation_json

    content = evaluation_json(evaluation)
    write_json(json, content)
    return content
