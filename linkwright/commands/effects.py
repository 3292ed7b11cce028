"""`linkwright effects`: the physics that the models know."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Annotated, Any

import typer

from arm.effects import EFFECTS, Effect, Parameter
from linkwright.as_json import program_version
from linkwright.writing import check_target, write_json
from materials.quantities import InputError, format_quantity

from .groups import command_group
from .options import JsonFile

HELP = """The physics that the models know: list, show."""
LIST_HELP = """Every effect, and whether a model has it without being asked.

Example: linkwright effects list
"""
SHOW_HELP = """One effect: its formula, its parameters, what shows it and what it cannot be told from.

Example: linkwright effects show backlash
"""


def list_effects(json: JsonFile = None) -> None:
    """Run `effects list`."""
    from linkwright.screen.console import console, table

    check_target(json)
    _write(json, {"effects": [_as_json(effect) for effect in EFFECTS.values()]})
    shown = table("effect", "what", "in the model")
    for effect in EFFECTS.values():
        shown.add_row(effect.id, effect.title, _when(effect))
    console().print(shown)


def show_effect(
    name: Annotated[str, typer.Argument(metavar="NAME", help="The effect's id.")], json: JsonFile = None
) -> None:
    """Run `effects show`."""
    from linkwright.screen.console import console, table

    check_target(json)
    effect = EFFECTS.get(name)
    if effect is None:
        near = difflib.get_close_matches(name, EFFECTS, n=1, cutoff=0.5)
        hint = f"; did you mean '{near[0]}'?" if near else "; `linkwright effects list` has them all"
        raise InputError("", "effect", f"there is no effect '{name}'{hint}")
    _write(json, _as_json(effect))
    screen = console()
    screen.print(f"{effect.id}: {effect.title}", style="bold")
    shown = table("", "")
    shown.show_header = False
    shown.add_row("moves the tip by", effect.formula)
    shown.add_row("acts at", effect.place)
    shown.add_row("in the model", _when(effect))
    shown.add_row("shows itself in", effect.needs)
    shown.add_row("cannot be told from", ", ".join(effect.aliases) or "–")
    shown.add_row("source", effect.source)
    for parameter in effect.parameters:
        low, high = _typical(parameter)
        shown.add_row(f"parameter {parameter.name}", f"{parameter.meaning}; typically {low} to {high}")
    screen.print(shown)


def _typical(parameter: Parameter) -> tuple[str, str]:
    """Both ends of the typical size, in the unit that suits the upper one."""
    high = format_quantity(parameter.typical[1], parameter.kind, digits=3)
    unit = high.partition(" ")[2] or None
    return format_quantity(parameter.typical[0], parameter.kind, unit, digits=3), high


def _when(effect: Effect) -> str:
    return "where the arm has its data" if effect.automatic else "where `effects` names it"


def _write(json: Path | None, content: dict[str, Any]) -> None:
    write_json(json, {"made_by": f"linkwright effects {program_version()}", **content})


def _as_json(effect: Effect) -> dict[str, Any]:
    return {
        "id": effect.id,
        "title": effect.title,
        "formula": effect.formula,
        "place": effect.place,
        "automatic": effect.automatic,
        "needs": effect.needs,
        "aliases": list(effect.aliases),
        "source": effect.source,
        "parameters": [
            {
                "name": parameter.name,
                "kind": parameter.kind,
                "meaning": parameter.meaning,
                "lower": format_quantity(parameter.lower, parameter.kind),
                "upper": format_quantity(parameter.upper, parameter.kind),
                "typical": [format_quantity(value, parameter.kind) for value in parameter.typical],
                "source": parameter.source,
            }
            for parameter in effect.parameters
        ],
    }


def group() -> typer.Typer:
    """The command group."""
    return command_group(HELP, {"list": (list_effects, LIST_HELP), "show": (show_effect, SHOW_HELP)})
