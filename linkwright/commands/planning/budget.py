"""`linkwright budget`: what an arm is to be expected to err by, before anything is bought."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import linkwright as lw
from linkwright.commands.options import (
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
from linkwright.output.files import REPORT, RESULT, check_target, claim_own, write_result

HELP = """The error to expect, by cause, from data sheets and tolerances; and which part to buy better first.

Example: linkwright budget arm.yaml --sheet sheet.yaml --out budget
"""


def budget(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    sheet: Annotated[
        Path | None,
        typer.Option("--sheet", metavar="FILE", help="Tolerances, repeatability, temperature, better parts, prices."),
    ] = None,
    problem: Annotated[
        Path | None,
        typer.Option("--problem", metavar="PROBLEM", help="Take workspace and loads from this problem file."),
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
    from linkwright.results.budget import describe
    from linkwright.screen.progress import waiting

    for target in (json, markdown, pdf):
        check_target(target, arm, sheet, problem, catalogue)
    check_pdf(pdf)
    if out is not None:
        claim_own(out, "budget", (RESULT, REPORT))
    with waiting("reading") as told, asked_of(arm):
        given = lw.read_arm(arm, catalogue=catalogue, tip=tip)
        asked = None if problem is None else lw.read_problem(problem, catalogue=catalogue)
        found = lw.budget(given, sheet=sheet, problem=asked, progress=told)
    read = files_of(arm, sheet, problem, catalogue)
    described = describe(found.found)
    with not_lost(described):
        if out is not None:
            found.save(out, made_from=read, author=author, comment=comment)
        if pdf is not None:
            found.save_pdf(pdf, made_from=read, author=author, comment=comment)
        write_result(json, found.to_json())
    report = [] if out is None else [out / REPORT, out / RESULT]
    tell(described, markdown, *report, pdf, json)
