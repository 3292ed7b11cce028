"""Completeness and consistency of the declarations of an effect."""

from __future__ import annotations

import re
from collections.abc import Iterator
from types import MappingProxyType
from typing import get_args

from linkwright.core.arm.effects.effect import Cause, Condition, Effect, Only, Parameter, Role, kind_at
from linkwright.core.arm.effects.registry import EFFECTS
from linkwright.core.units.units import kinds

_NAME = re.compile(r"[a-z][a-z0-9_]*")
_PLACES = ("joint", "link", "base", "tip")
_WHY = MappingProxyType(
    {
        "only": "the place must be a joint or a link",
        "together": "the place must be a joint or a link",
        "least_travel": "the place must be a joint or a link",
        "needs_drive": "the place must be a joint",
        "before_encoder": "the place must be a joint",
        "across": "the place must be a joint",
        "of_drives": "the place must be a joint, with one size",
        "curve": "the place must be a joint",
        "free_with": "the place must be the base or the tip",
        "in_modes": "it must be flexible and automatic",
        "flexible": "a load that acts through flexibility is none itself",
        "size_from_slope": "a linear effect has no need of it",
    }
)


def entry_faults(effect: Effect) -> list[str]:
    """What is wrong with an effect's entry, as phrases."""
    faults = [*_words(effect), *_roles(effect), *_conditions(effect)]
    for parameter in effect.parameters:
        faults += [f"parameter {parameter.name}: {fault}" for fault in _parameter(parameter)]
    return faults


def _words(effect: Effect) -> Iterator[str]:
    if not _NAME.fullmatch(effect.id):
        yield f"the id {effect.id!r} needs small letters, digits and underscores"
    for name in ("title", "formula", "needs", "source"):
        if not getattr(effect, name).strip():
            yield f"{name} is empty"
    if effect.place not in _PLACES:
        yield f"place {effect.place!r} is not one of {', '.join(_PLACES)}"
    if effect.cause not in get_args(Cause):
        yield f"cause {effect.cause!r} is not one of {', '.join(get_args(Cause))}"
    for alias in effect.aliases:
        if alias == effect.id or alias not in EFFECTS:
            yield f"alias {alias!r} is {'itself' if alias == effect.id else 'no effect'}"


def _roles(effect: Effect) -> Iterator[str]:
    names = [parameter.name for parameter in effect.parameters]
    if len(set(names)) < len(names):
        yield "two parameters have one name"
    if effect.shapes and not any(parameter.role in ("size", "torque") for parameter in effect.parameters):
        yield "has shapes but no size"
    if effect.torques is None and any(parameter.role == "torque" for parameter in effect.parameters):
        yield "has a size of the torque, but no torques"
    unknown = sorted({name for group in effect.enough for name in group} - set(names))
    if unknown:
        yield f"`enough` names {', '.join(unknown)}, which are no parameters"
    if effect.link.expansion_unless is not None and effect.link.expansion_unless not in names:
        yield f"expansion_unless names {effect.link.expansion_unless!r}, which is no parameter"
    at_joint, at_part = effect.place == "joint", effect.place in ("joint", "link")
    for name, says, holds in (
        ("only", effect.only is not None, at_part),
        ("together", effect.together, at_part),
        ("least_travel", effect.recording.least_travel > 0.0, at_part),
        ("needs_drive", effect.drive.needed, at_joint),
        ("before_encoder", effect.drive.before_encoder, at_joint),
        ("across", effect.drive.across, at_joint),
        ("of_drives", effect.drive.gives, at_joint and len(effect.sizes) == 1),
        ("curve", effect.drive.curve is not None, at_joint),
        ("free_with", effect.recording.free_with is not None, not at_part),
        ("in_modes", effect.link.in_modes, effect.link.flexible and effect.automatic),
        ("flexible", effect.link.flexible, not effect.link.through_flexibility),
        ("size_from_slope", effect.recording.size_from_slope is not None, not effect.linear),
    ):
        if says and not holds:
            yield f"{name} does not go with the rest: {_WHY[name]}"


def _conditions(effect: Effect) -> Iterator[str]:
    known = get_args(Condition)
    conditions = [*effect.requires, *(item for parameter in effect.parameters for item in parameter.requires)]
    for condition in conditions:
        if condition not in known:
            yield f"requires {condition!r}, which is not one of {', '.join(known)}"
    if effect.only is not None and effect.only not in get_args(Only):
        yield f"only {effect.only!r} is not one of {', '.join(get_args(Only))}"


def _parameter(parameter: Parameter) -> Iterator[str]:
    if not _NAME.fullmatch(parameter.name):
        yield "the name needs small letters, digits and underscores"
    for kind in (parameter.kind, kind_at(parameter, slides=True)):
        if kind not in kinds():
            yield f"there is no kind of quantity {kind!r}"
    low, high = parameter.typical
    if not parameter.lower <= low <= high <= parameter.upper:
        yield f"typical {low:g} to {high:g} must lie within the bounds {parameter.lower:g} to {parameter.upper:g}"
    if not parameter.source.strip():
        yield "source is empty"
    if parameter.role not in get_args(Role):
        yield f"role {parameter.role!r} is not one of {', '.join(get_args(Role))}"
    if parameter.role in ("size", "torque") and not parameter.lower <= 0.0 < parameter.upper:
        yield "the bounds of a size must hold 0 and something above it"
    shaped = parameter.role in ("shape", "torque_shape")
    if bool(parameter.grid) != shaped:
        yield "a shape needs a grid" if shaped else "only a shape has a grid"
    if list(parameter.grid) != sorted(set(parameter.grid)):
        yield "the grid must rise"
    inside = all(parameter.lower <= value <= parameter.upper for value in parameter.grid)
    if not inside and not parameter.relative_to_load:
        yield "the grid must lie within the bounds"
    if parameter.whole and not all(value == round(value) for value in parameter.grid):
        yield "the grid of a whole shape must hold whole numbers"
