"""`linkwright effects`: the physics that the models know."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any

import typer

import linkwright as lw
from linkwright.commands.options import Commands, JsonFile, answer
from linkwright.core.units.quantities import format_quantity
from linkwright.json.fields import fields
from linkwright.output.files import check_target
from linkwright.screen.console import table

if TYPE_CHECKING:
    from linkwright.core.arm.effects import Effect, Parameter

_ROLES: Mapping[str, str] = MappingProxyType(
    {
        "size": "a size: without it nothing moves",
        "shape": "a shape: it changes the pattern, and a diagnosis searches it",
        "given": "given, not fitted",
        "torque": "a size of the torque: no tip shows it, a motion does",
        "torque_shape": "a shape of the torque: it changes the pattern in motion, and a diagnosis searches it",
    }
)


def list_effects(json: JsonFile = None) -> None:
    """Every effect, and whether a model has it without being asked.

    Example: linkwright effects list
    """
    check_target(json)
    shown = table("effect", "what", "acts at", "sizes (shapes)", "in the model")
    shown.columns[0].no_wrap = True
    for effect in lw.effects.values():
        shown.add_row(effect.id, effect.title, effect.place, _fitted(effect), _when(effect))
    answer(json, "effects", {"effects": [_as_json(effect) for effect in lw.effects.values()]}, shown)


def show_effect(
    name: Annotated[str, typer.Argument(metavar="NAME", help="The effect's id.")], json: JsonFile = None
) -> None:
    """One effect: its formula, its parameters, what shows it and what it cannot be told from.

    Example: linkwright effects show backlash
    """
    check_target(json)
    effect = lw.effects[name]
    shown = table("", "")
    shown.show_header = False
    shown.add_row("moves the tip by" if effect.moves_tip else "adds to the torque", effect.formula)
    shown.add_row("acts at", effect.place)
    in_model = "where the arm has its data" if effect.automatic else "where `effects` names it"
    shown.add_row("in the model", in_model)
    shown.add_row("shows itself in", effect.needs)
    shown.add_row("cannot be told from", ", ".join(effect.aliases) or "–")
    if effect.requires:
        shown.add_row("moves nothing without", ", ".join(name.replace("_", " ") for name in effect.requires))
    if effect.together:
        shown.add_row("usually shared", f"by all {effect.place}s: one value may hold for every one")
    if effect.drive.before_encoder:
        shown.add_row("seen by the encoder", "moves the tip as long as the coordinates are commands")
    shown.add_row("source", effect.source)
    for parameter in effect.parameters:
        shown.add_row(f"parameter {parameter.name}", _described(parameter))
    answer(json, "effects", _as_json(effect), shown, title=f"{effect.id}: {effect.title}")


def _described(parameter: Parameter) -> str:
    """A parameter's meaning, role, bounds, typical sizes and grid as one sentence."""
    parts = [
        f"{parameter.meaning}; {_ROLES[parameter.role]}",
        f"typically {_span(*parameter.typical, parameter.kind)}",
        f"bounds {_span(parameter.lower, parameter.upper, parameter.kind)}",
    ]
    if parameter.grid:
        kind = "dimensionless" if parameter.relative_to_load else parameter.kind
        of = " of the drive's greatest load" if parameter.relative_to_load else ""
        parts.append(f"searched at {_grid(parameter.grid, kind)}{of}")
    return "; ".join(parts)


def _span(low: float, high: float, kind: str) -> str:
    """Both ends of a range, each in the unit that suits it; where the lower is 0 or the upper's negative, in one
    unit."""
    upper = format_quantity(high, kind, digits=3)
    common_unit = upper.partition(" ")[2] if low in (0.0, -high) else ""
    return f"{format_quantity(low, kind, common_unit or None, digits=3)} to {upper}"


def _grid(values: tuple[float, ...], kind: str) -> str:
    """The values of a grid, runs of neighbouring whole numbers drawn together."""
    runs: list[list[float]] = []
    for value in values:
        if runs and value == runs[-1][-1] + 1.0:
            runs[-1].append(value)
        else:
            runs.append([value])
    texts = [[format_quantity(value, kind, digits=4) for value in run] for run in runs]
    return ", ".join(f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(run) for run in texts)


def _fitted(effect: Effect) -> str:
    sizes = ", ".join(parameter.name for parameter in effect.parameters if parameter.role in ("size", "torque"))
    shapes = ", ".join(parameter.name for parameter in effect.shapes)
    return f"{sizes} ({shapes})" if shapes else sizes or "–"


def _when(effect: Effect) -> str:
    return "with its data" if effect.automatic else "where named"


def _as_json(effect: Effect) -> dict[str, Any]:
    names = (
        "id",
        "title",
        "formula",
        "place",
        "automatic",
        "together",
        "before_encoder=drive.before_encoder",
        "requires",
        "only",
        "needs",
    )
    return {
        **fields(effect, *names, "aliases", "source"),
        "parameters": [_parameter(parameter) for parameter in effect.parameters],
    }


def _parameter(parameter: Parameter) -> dict[str, Any]:
    lower, upper, *typical = (
        format_quantity(value, parameter.kind) for value in (parameter.lower, parameter.upper, *parameter.typical)
    )
    bounds = {"lower": lower, "upper": upper, "typical": typical}
    return {
        **fields(parameter, "name", "kind", "meaning"),
        **bounds,
        **fields(parameter, "source", "role", "grid", "relative_to_load"),
    }


def group() -> Commands:
    """The commands of the group."""
    return {"list": list_effects, "show": show_effect}
