"""`linkwright figures`: the paper's Figures 5 to 9 beside the truth, as a page of pictures and as data."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import linkwright as lw
from linkwright.commands.options import JsonFile
from linkwright.output.files import check_target, claim_own, write_result

HELP = """The paper's Figures 5 to 9: what it plots by its own conventions, and the truth beside it.

Example: linkwright figures --out figures
"""


def figures(
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Write report.html, result.json and a CSV file per figure there."),
    ] = None,
    json: JsonFile = None,
) -> None:
    """Run the command."""
    from linkwright.screen.console import console
    from linkwright.screen.progress import waiting

    check_target(json)
    with waiting("computing the paper's figures"):
        from linkwright.paper.face import FIGURE_FILES

        if out is not None:
            claim_own(out, "figures", FIGURE_FILES)
        made = lw.figures()
    write_result(json, made.to_json())
    written = [] if json is None else [json]
    if out is not None:
        made.save(out)
        written += [out / name for name in FIGURE_FILES]
    screen = console()
    for each in made.figures:
        screen.print(f"Figure {each.number}: {each.title}", style="bold")
        for remark in each.remarks:
            screen.print(f"  {remark}")
    if not written:
        screen.print("Nothing is written without --out DIR or --json FILE.")
    for path in written:
        screen.print(f"written: {path}", soft_wrap=True)
