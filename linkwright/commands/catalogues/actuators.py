"""`linkwright actuators`: the gears that joints can name."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

import linkwright as lw
from linkwright.commands.groups import Commands, write_content
from linkwright.commands.options import JsonFile
from linkwright.json.fields import fields
from linkwright.output.files import check_target
from linkwright.results.figures_in_words import figure, with_unit

from .actuator_edit import OWN, ActuatorFile, export_actuators

if TYPE_CHECKING:
    from linkwright.core.arm.actuators import Actuator


def list_actuators(
    least_torque: Annotated[
        str | None, typer.Option("--least-torque", metavar="TORQUE", help="Only those rated for it, e.g. '100 N*m'.")
    ] = None,
    json: JsonFile = None,
    catalogue: ActuatorFile = None,
) -> None:
    """Every actuator: what it holds, how stiff it is, what it loses, weighs and costs.

    Example: linkwright actuators list --least-torque '100 N*m'
    """
    from linkwright.core.units.quantities import read_quantity
    from linkwright.screen.console import console, table

    check_target(json, catalogue)
    least = 0.0 if least_torque is None else read_quantity(least_torque, "torque", file="", key="--least-torque")
    found = [each for each in lw.actuators.with_file(catalogue).values() if each.rated_torque >= least]
    write_content(json, "actuators", {"actuators": [_as_json(each) for each in found]})
    if not found:
        console().print("no actuator is rated for that")
        return
    units = ("rated N·m", "peak N·m", "stiffness kN·m/rad", "backlash arcmin", "mass kg", "cost EUR")
    shown = table("actuator", "gear", *units, numbers=(2, 3, 4, 5, 6, 7))
    shown.columns[0].no_wrap = True
    for each in found:
        figures = {
            "rated_torque": each.rated_torque,
            "peak_torque": each.peak_torque,
            "stiffness": each.stiffness / 1e3,
            "backlash": _arcmin(each.backlash),
            "mass": each.mass,
            "cost": each.cost,
        }
        marked = (figure(value, 5) + _mark(each, name) for name, value in figures.items())
        shown.add_row(each.name, each.gear, *marked)
    console().print(shown)
    makers = ", ".join(dict.fromkeys(each.maker for each in found))
    told = "stiffness: of the softest zone; a dash: not known"
    console().print(f"{makers}: figures of the makers' catalogues; {told}", soft_wrap=True)
    if any(each.unconfirmed for each in found):
        console().print("?: could not be found in its source; `actuators show NAME` says more", soft_wrap=True)


def show_actuator(
    name: Annotated[str, typer.Argument(metavar="NAME", help="The actuator's name.")],
    json: JsonFile = None,
    catalogue: ActuatorFile = None,
) -> None:
    """One actuator: every figure, and where it is from.

    Example: linkwright actuators show RV-20E
    """
    from linkwright.screen.console import console, table

    check_target(json, catalogue)
    found = lw.actuators.with_file(catalogue)[name]
    write_content(json, "actuators", _as_json(found))
    screen = console()
    screen.print(f"{found.name}: {found.maker}, {found.gear}", style="bold")
    shown = table("what", "value", numbers=(1,))
    if found.ratio is not None:
        shown.add_row("ratio", figure(found.ratio, 5))
    shown.add_row("rated torque", with_unit(found.rated_torque, "N·m", 5) + _mark(found, "rated_torque"))
    shown.add_row("peak torque", with_unit(found.peak_torque, "N·m", 5) + _mark(found, "peak_torque"))
    for label, stiffness in zip(_zones(found), found.stiffnesses, strict=True):
        shown.add_row(f"stiffness{label}", with_unit(stiffness / 1e3, "kN·m/rad", 5) + _mark(found, "stiffness"))
    wound = 1e3 * found.wind_up(found.rated_torque)
    shown.add_row("gives under its rated torque", with_unit(wound, "mrad", 3))
    shown.add_row(
        "backlash (total lost motion)", with_unit(_arcmin(found.backlash), "arcmin", 3) + _mark(found, "backlash")
    )
    shown.add_row("mass, without motor", with_unit(found.mass, "kg", 5) + _mark(found, "mass"))
    tilting = "not known"
    if found.tilting_stiffness is not None:
        tilting = with_unit(found.tilting_stiffness / 1e3, "kN·m/rad", 5) + _mark(found, "tilting_stiffness")
    shown.add_row("tilting stiffness of its bearing", tilting)
    shown.add_row("cost", _cost_words(found))
    screen.print(shown)
    note = f"{found.note}; " if found.note else ""
    screen.print(f"{note}{found.source}; from {found.file}", soft_wrap=True)
    if found.found_in:
        screen.print(f"found in: {found.found_in}", soft_wrap=True)
    for key, text in found.unconfirmed:
        screen.print(f"? {key.replace('_', ' ')}, not confirmed: {text}", soft_wrap=True)


def _mark(each: Actuator, name: str) -> str:
    return " ?" if each.is_unconfirmed(name) else ""


def _arcmin(radians: float) -> float:
    return math.degrees(radians) * 60.0


def _zones(found: Actuator) -> list[str]:
    """Which torques each stiffness is for, in words."""
    if not found.zone_torques:
        return [""]
    ends = [figure(end, 5) for end in found.zone_torques]
    between = [f", {low} to {high} N·m" for low, high in itertools.pairwise(ends)]
    return [f", up to {ends[0]} N·m", *between, f", beyond {ends[-1]} N·m"]


def _cost_words(found: Actuator) -> str:
    if found.cost is None or found.cost_spread is None:
        return "not known"
    low, high = (figure(value) for value in found.cost_spread)
    spread = "" if low == high else f"{low} to {high}, "
    return f"{figure(found.cost)} EUR ({spread}{found.cost_date})"


def _as_json(each: Actuator) -> dict[str, Any]:
    figures = ("rated_torque_Nm", "peak_torque_Nm", "stiffness_Nm_per_rad", "stiffness_zones_Nm_per_rad=stiffnesses")
    figures += ("zone_torques_Nm", "backlash_arcmin", "tilting_stiffness_Nm_per_rad", "mass_kg")
    cost = ("cost_EUR", "cost_spread_EUR", "cost_date", "source", "note")
    found = {"found_in": each.found_in or None, "unconfirmed": dict(each.unconfirmed) or None}
    return {**fields(each, "name", "maker", "gear", "ratio", *figures, *cost), **found, **fields(each, "file")}


def group() -> Commands:
    """The commands of the group."""
    return {"list": list_actuators, "show": show_actuator, **OWN.commands(export_actuators)}
