"""`linkwright export`: an arm for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import linkwright as lw
from linkwright.commands.options import CatalogueFile, JsonFile, MarkdownFile, as_options, asked_of, not_lost, tell
from linkwright.core.units.quantities import InputError
from linkwright.output.files import check_target, write_result

HELP = """The arm for other programs: URDF, MJCF (with all that gives), DXF (to scale), STEP (solid bodies), parts.

What the format cannot hold is told. --into writes what a diagnosis found into your own URDF or MJCF: a few numbers,
and every other byte as it was.

Example: linkwright export arm.yaml --to mjcf --out arm.xml
Example: linkwright export arm.yaml --to dxf
Example: linkwright export arm.yaml --to step --out arm.step
Example: linkwright export corrected.yaml --into robot.urdf --out robot-corrected.urdf
"""


def export(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file; a corrected one, say.")],
    to: Annotated[
        str | None, typer.Option("--to", metavar="FORMAT", help="urdf, mjcf, dxf, step, or bom: a list of parts.")
    ] = None,
    into: Annotated[
        Path | None, typer.Option("--into", metavar="FILE", help="Your own URDF or MJCF, for what was found.")
    ] = None,
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

    if (to is None) == (into is None):
        raise InputError("", "--to", "is due, or --into FILE, but not both; e.g. --to urdf")
    named = Path(arm.stem + SUFFIXES.get(to or "", "")) if into is None else Path(f"{into.stem}-corrected{into.suffix}")
    target = named if out is None else out
    if out is None and target.exists() and (into is not None or to in SUFFIXES):
        raise InputError(target, "", "is there already; name the file to write with --out")
    given = lw.read_arm(arm, catalogue=catalogue)
    with asked_of(arm), as_options(angles=f"{arm}: angles"):
        found = lw.export_arm(given, to=to, into=into)
    for each in (target, json, markdown):
        check_target(each, arm, catalogue, into)
    with not_lost(describe(found.found)):
        write_result(json, found.to_json())
        found.save(target)
    tell(describe(found.found), markdown, target, json)
