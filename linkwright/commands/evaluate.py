"""`linkwright evaluate`: the worst position error of an arm as given, and why."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import linkwright as lw
from linkwright.core.units.quantities import InputError
from linkwright.output.files import REPORT, RESULT, check_target, claim_folder, write_result

from .options import (
    Author,
    CatalogueFile,
    Comment,
    JsonFile,
    MarkdownFile,
    OutFolder,
    PdfFile,
    Tip,
    asked_of,
    check_pdf,
    files_of,
    not_lost,
    tell,
)

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm

HELP = """The worst position error over the workspace, where it is, what each effect adds, and the arm's figures.

Example: linkwright evaluate arm.yaml --pose "10 20 30" --json result.json
"""


def evaluate(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    problem: Annotated[
        Path | None,
        typer.Option(
            "--problem",
            metavar="PROBLEM",
            help="Take workspace, loads and what is uncertain from this problem file.",
        ),
    ] = None,
    pose: Annotated[
        str | None,
        typer.Option("--pose", metavar="Q", help="Where mm/N is asked for: degrees (mm for slides), in quotes."),
    ] = None,
    tip: Tip = None,
    out: OutFolder = None,
    json: JsonFile = None,
    markdown: MarkdownFile = None,
    pdf: PdfFile = None,
    catalogue: CatalogueFile = None,
    author: Author = "",
    comment: Comment = "",
) -> None:
    """Run the command."""
    from linkwright.results.evaluation import describe
    from linkwright.screen.progress import waiting

    for target in (json, markdown, pdf):
        check_target(target, arm, problem, catalogue)
    check_pdf(pdf)
    with waiting("evaluating"):
        given = lw.read_arm(arm, catalogue=catalogue, tip=tip)
        at = None if pose is None else read_pose(pose, given.model)
        claim_folder(out, "evaluate")
        with asked_of(arm):
            asked = None if problem is None else lw.read_problem(problem, catalogue=catalogue)
            found = lw.evaluate(given, asked, pose=at)
            read = files_of(arm, problem, catalogue)
    described = describe(found.found, found.robust)
    with not_lost(described), waiting("writing"):
        if out is not None:
            found.save(out, made_from=read, author=author, comment=comment)
        if pdf is not None:
            found.save_pdf(pdf, made_from=read, author=author, comment=comment)
        write_result(json, found.to_json())
    report = [] if out is None else [out / REPORT, out / RESULT]
    tell(described, markdown, *report, pdf, json)


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
