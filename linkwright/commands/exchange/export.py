"""`linkwright export`: an arm for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import linkwright as lw
from linkwright.commands.options import CatalogueFile, JsonFile, MarkdownFile, as_options, asked_of, tell
from linkwright.output.files import check_target, write_result
from units.quantities import InputError

HELP = """The arm for other programs: URDF, MJCF (with all that gives), SDF, DXF (to scale), STEP (solid bodies), parts.

What the format cannot hold is told.

Example: linkwright export arm.yaml --to mjcf --out arm.xml
Example: linkwright export arm.yaml --to dxf
Example: linkwright export arm.yaml --to step --out arm.step
"""


def export(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file; a corrected one, say.")],
    to: Annotated[
        str, typer.Option("--to", metavar="FORMAT", help="urdf, mjcf, sdf, dxf, step, or bom: a list of parts.")
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="The file to write; a new one called as the arm file by default."),
    ] = None,
    json: JsonFile = None,
    markdown: MarkdownFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from linkwright.face.exchange.exported import SUFFIXES
    from linkwright.results.exported import describe

    target = Path(arm.stem + SUFFIXES.get(to, "")) if out is None else out
    if out is None and target.exists() and to in SUFFIXES:
        raise InputError(target, "", "is there already; name the file to write with --out")
    given = lw.read_arm(arm, catalogue=catalogue)
    with asked_of(arm), as_options(angles=f"{arm}: angles"):
        found = lw.export_arm(given, to=to)
    for each in (target, json, markdown):
        check_target(each, arm, catalogue)
    found.save(target)
    write_result(json, found.to_json())
    tell(describe(found.found), markdown, target, json)
