"""`linkwright seam`: can the arm follow a straight seam, and how far off is it along and across it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from linkwright.writing import check_target, write_json
from materials.quantities import InputError, read_quantity

from .options import CatalogueFile, JsonFile, asked_of, catalogue_with

HELP = """Whether a planar arm can follow a straight seam, and its worst error along the seam, tangential and normal.

Example: linkwright seam arm.yaml --from "600 mm, 500 mm" --to "-600 mm, 500 mm"
"""


def seam(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    start: Annotated[str, typer.Option("--from", metavar="POINT", help="Where it starts: 'X, Y' with units.")],
    end: Annotated[str, typer.Option("--to", metavar="POINT", help="Where it ends: 'X, Y' with units.")],
    points: Annotated[int, typer.Option("--points", min=2, max=1000, help="Points looked at along it.")] = 9,
    json: JsonFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from arm.files import read_arm
    from arm.seam import check_seam
    from arm.workspace import Unreachable
    from linkwright.paper.output import extended_json
    from linkwright.paper.screen import show_extended
    from linkwright.paper.sensitivity import seam_table
    from linkwright.screen.console import console, waiting

    check_target(json, arm)
    first, last = _point(start, "--from"), _point(end, "--to")
    if first == last:
        raise InputError("", "--to", "is the same point as --from; a seam has a length")
    read = read_arm(arm, catalogue_with(catalogue))
    if not read.planar():
        raise InputError(arm, "", "leaves the x-y plane; a seam's normal is one direction in the plane only")
    with asked_of(arm), waiting("following the seam"):
        check = check_seam(read, first, last)
        if check.verdict == "unreachable" and check.first_unreachable is not None:
            raise Unreachable(check.first_unreachable, check.missing)
        table = seam_table(read, first, last, points=points)
    content: dict[str, Any] = {"reachable": check.verdict, "proved_to": check.proved_to, **extended_json(table)}
    write_json(json, content)
    screen = console()
    proved = "every point can be reached, proved" if check.verdict == "reachable" else "poses were found everywhere"
    screen.print(f"{read.name}: {proved}", style="bold")
    show_extended(screen, [table])
    if json is not None:
        screen.print(f"written: {json}", soft_wrap=True)


def _point(text: str, option: str) -> tuple[float, float]:
    """Two lengths with units, m."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2:
        raise InputError("", option, f"needs two lengths, e.g. '600 mm, 500 mm', not {text!r}")
    x, y = (read_quantity(part, "length", file="", key=option) for part in parts)
    return x, y
