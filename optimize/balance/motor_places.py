"""Where a joint's motor may stand, as a problem file lists it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.units.quantities import shown
from linkwright.core.units.reading import Mapping

from .parallelogram import Parallelogram, read_parallelogram

MOST_PLACES = 64
"""So many combinations of places are looked at, every one."""


@dataclass(frozen=True)
class MotorPlace:
    """Where a motor stands: on link `on` at that link's joint (from 1), on the base (0) or at its joint (None);
    its mass (kg), what the transmission there makes of the drive (None: what the arm has), in SI, and the rods by which
    it turns its link, if so."""

    on: int | None
    mass: float
    words: str
    stiffness: float | None = None
    backlash: float | None = None
    cost: float | None = None
    rods: Parallelogram | None = None


@dataclass(frozen=True)
class MotorChoice:
    """The places where the motor of a joint (from 0) may stand."""

    joint: int
    places: tuple[MotorPlace, ...]


def read_motor_places(choose: Mapping, arm: Arm) -> tuple[MotorChoice, ...]:
    """The places of motors in `choose`; raises `InputError`."""
    choices: list[MotorChoice] = []
    if not choose.has("motor"):
        return ()
    for entry in choose.mappings("motor"):
        with entry.reading() as body:
            raw = body.raw("joint", f"the number of a joint, 1 to {arm.size}")
            if isinstance(raw, bool) or not isinstance(raw, int) or not 1 <= raw <= arm.size:
                raise body.error("joint", f"is the number of a joint, 1 to {arm.size}, not {shown(raw)}")
            if any(choice.joint == raw - 1 for choice in choices):
                raise body.error("joint", f"joint {raw} has places already; list all of them in one entry")
            if body.has("on") == body.has("places"):
                raise body.error("", "needs mass and on, e.g. on: [joint, base], or places: [{on: joint, mass: 4 kg}]")
            choices.append(MotorChoice(raw - 1, _places(body, arm, raw)))
    if math.prod(len(choice.places) for choice in choices) > MOST_PLACES:
        raise choose.error("motor", f"lists more than {MOST_PLACES} combinations of places; leave some out")
    return tuple(choices)


def _places(body: Mapping, arm: Arm, joint: int) -> tuple[MotorPlace, ...]:
    if body.has("on"):
        mass = _mass(body)
        places = [_place(body, item, mass, arm, joint) for item in body.items("on")]
    else:
        places = []
        for entry in body.mappings("places"):
            with entry.reading() as place:
                stiffness, backlash, cost = (
                    place.optional_quantity(name, kind) for name, kind in zip(_DRIVE, _kinds(arm, joint), strict=True)
                )
                if stiffness is not None and stiffness <= 0.0:
                    raise place.error("stiffness", "must be positive")
                if min(backlash or 0.0, cost or 0.0) < 0.0:
                    raise place.error("backlash" if (backlash or 0.0) < 0.0 else "cost", "cannot be negative")
                plain = _place(place, place.raw("on", "joint, base, or the number of a link"), _mass(place), arm, joint)
                rods = read_parallelogram(place, arm, joint)
                words = plain.words if rods is None else f"{plain.words}, by rods {_along(rods.first, joint)}"
                places.append(MotorPlace(plain.on, plain.mass, words, stiffness, backlash, cost, rods))
    if not places:
        raise body.error("on" if body.has("on") else "places", "is empty; list where the motor may stand")
    return tuple(places)


def _along(first: int, joint: int) -> str:
    """Along which links rods run to a joint (from 1), from the link `first` (from 0) on."""
    return f"along link {first + 1}" if first + 2 == joint else f"along links {first + 1} to {joint - 1}"


_DRIVE = ("stiffness", "backlash", "cost")


def _kinds(arm: Arm, joint: int) -> tuple[str, str, str]:
    turns = arm.joints[joint - 1].revolute
    return ("torsional_stiffness" if turns else "linear_stiffness", "angle" if turns else "length", "cost")


def _mass(body: Mapping) -> float:
    mass = body.quantity("mass", "mass")
    if mass <= 0.0:
        raise body.error("mass", "must be positive")
    return mass


def _place(body: Mapping, raw: object, mass: float, arm: Arm, joint: int) -> MotorPlace:
    if raw == "joint":
        return MotorPlace(None, mass, f"of joint {joint} at its joint")
    if raw == "base":
        return MotorPlace(0, mass, f"of joint {joint} on the base")
    if isinstance(raw, bool) or not isinstance(raw, int) or not 1 <= raw <= arm.size:
        raise body.error("on", f"is joint, base, or the number of a link, 1 to {arm.size}, not {shown(raw)}")
    return MotorPlace(raw, mass, f"of joint {joint} on link {raw}")
