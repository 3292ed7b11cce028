"""`linkwright figures`: the paper's Figures 5 to 9 beside the truth, as a page of pictures and as data."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from linkwright.writing import REPORT, RESULT, check_target, json_text, write_folder, write_json

from .options import JsonFile

HELP = """The paper's Figures 5 to 9: what it plots by its own conventions, and the truth beside it.

Example: linkwright figures --out figures
"""
CSV = ("figure-5.csv", "figure-6.csv", "figure-7.csv", "figure-8.csv", "figure-9.csv")


def figures(
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Write report.html, result.json and a CSV file per figure there."),
    ] = None,
    json: JsonFile = None,
) -> None:
    """Run the command."""
    from linkwright.screen.console import console, waiting

    check_target(json)
    if out is not None:
        from linkwright.paper.folders import claim

        claim(out, [RESULT, REPORT, *CSV], RESULT, "linkwright figures")
    with waiting("computing the paper's figures"):
        from linkwright.paper.figures import make_figures
        from linkwright.paper.output import figure_csv, figures_json
        from linkwright.paper.pictures import page

        made = make_figures()
    content = figures_json(made)
    write_json(json, content)
    written = [] if json is None else [json]
    if out is not None:
        files = {RESULT: json_text(content), REPORT: page(made)}
        files.update({name: figure_csv(each) for name, each in zip(CSV, made, strict=True)})
        write_folder(out, files)
        written += [out / name for name in files]
    screen = console()
    for each in made:
        screen.print(f"Figure {each.number}: {each.title}", style="bold")
        for remark in each.remarks:
            screen.print(f"  {remark}")
    if not written:
        screen.print("Nothing is written without --out DIR or --json FILE.")
    for path in written:
        screen.print(f"written: {path}", soft_wrap=True)
