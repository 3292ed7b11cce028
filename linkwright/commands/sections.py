"""`linkwright sections`: the shapes that links can have, and the standard sizes."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Annotated, Any

import typer

from linkwright.as_json import program_version
from linkwright.writing import check_target, write_json
from materials.quantities import InputError
from sections import SHAPES, Section

from .groups import command_group
from .options import JsonFile

HELP = """The shapes that links can have and the standard sizes: list, show."""
LIST_HELP = """Every shape with its dimensions, and every stock size.

Example: linkwright sections list
"""
SHOW_HELP = """One shape, or one stock size with its properties.

Example: linkwright sections show "IPE 80"
"""
_STEEL_POISSON_RATIO = 0.3


def list_sections(json: JsonFile = None) -> None:
    """Run `sections list`."""
    from linkwright.screen.console import console, table

    check_target(json)
    content: dict[str, Any] = {
        "shapes": [_shape_json(kind) for kind in SHAPES.values()],
        "stock": [],
    }
    _write(json, content)
    screen = console()
    shown = table("shape", "dimensions")
    for name, kind in SHAPES.items():
        shown.add_row(name, ", ".join(_dimension_words(kind)))
    screen.print(shown)


def show_section(
    name: Annotated[str, typer.Argument(metavar="NAME", help="A shape, or a stock size.")], json: JsonFile = None
) -> None:
    """Run `sections show`."""
    from linkwright.screen.console import console, table

    check_target(json)
    screen = console()
    if name in SHAPES:
        kind = SHAPES[name]
        _write(json, _shape_json(kind))
        shown = table("dimension", "what", "")
        for dimension in kind.dimensions:
            shown.add_row(dimension.name, dimension.meaning, "may be left out" if dimension.optional else "")
        screen.print(name, style="bold")
        screen.print(shown)
        return
    near = difflib.get_close_matches(name, SHAPES, n=1, cutoff=0.5)
    hint = f"; did you mean '{near[0]}'?" if near else "; `linkwright sections list` has them all"
    raise InputError("", "section", f"there is no shape or stock size '{name}'{hint}")


def _dimension_words(kind: type[Section]) -> list[str]:
    return [f"[{each.name}]" if each.optional else each.name for each in kind.dimensions]


def _shape_json(kind: type[Section]) -> dict[str, Any]:
    return {
        "name": kind.shape,
        "dimensions": [
            {"name": each.name, "meaning": each.meaning, "kind": each.kind, "optional": each.optional}
            for each in kind.dimensions
        ],
        "can_be_optimised": bool(kind.variables),
    }


def _write(json: Path | None, content: dict[str, Any]) -> None:
    write_json(json, {"made_by": f"linkwright sections {program_version()}", **content})


def group() -> typer.Typer:
    """The command group."""
    return command_group(HELP, {"list": (list_sections, LIST_HELP), "show": (show_section, SHOW_HELP)})
