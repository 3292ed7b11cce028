"""`linkwright seam`: can the arm follow a straight seam, and how far off is it along and across it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import linkwright as lw
from linkwright.output.files import check_target, write_result

from .options import CatalogueFile, JsonFile, Tip, as_options, asked_of

HELP = """Whether a planar arm can follow a straight seam, and its worst error along the seam, tangential and normal.

Example: linkwright seam arm.yaml --from "600 mm, 500 mm" --to "-600 mm, 500 mm"
"""


def seam(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    start: Annotated[str, typer.Option("--from", metavar="POINT", help="Where it starts: 'X, Y' with units.")],
    end: Annotated[str, typer.Option("--to", metavar="POINT", help="Where it ends: 'X, Y' with units.")],
    points: Annotated[int, typer.Option("--points", min=2, max=1000, help="Points looked at along it.")] = 9,
    tip: Tip = None,
    json: JsonFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from linkwright.screen.console import console
    from linkwright.screen.described import show
    from linkwright.screen.progress import waiting

    check_target(json, arm)
    ends = [[part.strip() for part in text.split(",")] for text in (start, end)]
    with asked_of(arm), as_options(arm=str(arm), start="--from", end="--to"), waiting("following the seam"):
        found = lw.seam(lw.read_arm(arm, catalogue=catalogue, tip=tip), *ends, points=points)
    write_result(json, found.to_json())
    screen = console()
    show(screen, found.described)
    if json is not None:
        screen.print(f"written: {json}", soft_wrap=True)
