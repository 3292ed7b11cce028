"""`linkwright import`: an arm from another program's description."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import linkwright as lw
from linkwright.commands.options import JsonFile, MarkdownFile, as_options, not_lost, tell
from linkwright.core.units.quantities import InputError
from linkwright.output.files import DESIGN, check_target, write_result

HELP = """An arm file from a URDF: frames, limits and weights; with lists of what is doubtful and what it does not say.

Example: linkwright import robot.urdf --tip tool0 --out arm.yaml
"""


def import_(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="The URDF file; STL meshes beside it are opened for volumes.")
    ],
    tip: Annotated[
        list[str] | None,
        typer.Option("--tip", metavar="LINK", help="The link at whose origin the tip is; repeated: arms on one torso."),
    ] = None,
    base: Annotated[
        str | None, typer.Option("--base", metavar="LINK", help="The link on which the arm stands; the root.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The arm file to write; a new arm.yaml by default.")
    ] = None,
    json: JsonFile = None,
    markdown: MarkdownFile = None,
) -> None:
    """Run the command."""
    from linkwright.results.imported import describe

    target = Path(DESIGN) if out is None else out
    if out is None and target.exists():
        raise InputError(target, "", "is there already; name the file to write with --out")
    for each in (target, json, markdown):
        check_target(each, file)
    with as_options():
        found = lw.import_arm(file, tip=tip, base=base)
    with not_lost(describe(found.found)):
        write_result(json, found.to_json())
        found.save(target)
    tell(describe(found.found), markdown, target, json)
