"""Where a joint's motor may stand, as a problem file lists it.

A motor nearer the base may turn its link by rods, a parallelogram. The joint's coordinate is then its link's turn
against what the first rod stands on. What follows the joint goes on turning with its link as before, so a wrist that
rods keep level stays level.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from linkwright.core.arm.chain.balance import PointMass
from linkwright.core.arm.chain.chain import Arm, Joint
from linkwright.core.arm.chain.following import Following, Tie
from linkwright.core.arm.files.following import along_links
from linkwright.core.units.quantities import shown
from linkwright.core.units.reading import Mapping

_HALF = 0.5


@dataclass(frozen=True)
class Parallelogram:
    """Rods along the links from `first` (from 0) to the one before the joint: the `range` (rad) of the joint's new
    coordinate, and what the rods along each link weigh (kg)."""

    first: int
    range: tuple[float, float]
    rod: float = 0.0


def read_parallelogram(body: Mapping, arm: Arm, joint: int) -> Parallelogram | None:
    """The parallelogram of a place for the motor of a joint (from 1), None where it has none; raises `InputError`."""
    if not body.has("parallelogram"):
        for name in ("range", "rod"):
            if body.has(name):
                raise body.error(name, "goes with rods; say along which links, e.g. parallelogram: 2")
        return None
    raw = body.raw("parallelogram", "the number of the first link along which rods run")
    if isinstance(raw, bool) or not isinstance(raw, int) or not 1 <= raw < joint:
        would_do = f"the number of the first link along which rods run, 1 to {joint - 1}"
        raise body.error("parallelogram", f"is {would_do}, not {shown(raw)}" if joint > 1 else "needs a link before")
    if arm.angles == "absolute":
        raise body.error("parallelogram", "is what angles: absolute says of every joint; write relative")
    between = range(raw - 1, joint)
    for index in between:
        if not arm.joints[index].revolute or arm.joints[index].follows is not None:
            what = "slides" if not arm.joints[index].revolute else "follows others"
            raise body.error("parallelogram", f"needs joints that turn by themselves; joint {index + 1} {what}")
    range_ = body.range("range", "angle")
    rod = body.quantity("rod", "mass") if body.has("rod") else 0.0
    if rod < 0.0:
        raise body.error("rod", "cannot be negative")
    parallelogram = Parallelogram(raw - 1, range_, rod)
    follows = with_parallelogram(arm, joint - 1, parallelogram).joints[joint - 1].follows
    if follows is None or not all(tie.along for tie in follows.ties):
        raise body.error("parallelogram", f"needs parallel axes from joint {raw} to joint {joint}")
    return parallelogram


def with_parallelogram(arm: Arm, joint: int, rods: Parallelogram) -> Arm:
    """The arm with a joint (from 0) turned by rods; the rods' mass hangs half on either end of the links along which
    they run."""
    between = range(rods.first, joint)
    ties = tuple(Tie(index, -1.0) for index in between)
    joints = [_as_before(item, joint, between) for item in arm.joints]
    joints[joint] = replace(joints[joint], follows=Following(ties, driven=True), range=rods.range)
    links = list(arm.links)
    if rods.rod > 0.0:
        half = _HALF * rods.rod
        for index in between:
            hung = (PointMass(half), PointMass(half, on="end"))
            links[index] = replace(links[index], masses=(*links[index].masses, *hung))
    return along_links(replace(arm, joints=tuple(joints), links=tuple(links)))


def _as_before(follower: Joint, joint: int, between: range) -> Joint:
    """A joint that turns as before where the joint that it may follow has the turns of those between in its coordinate:
    the old coordinate is the new one less theirs."""
    follows = follower.follows
    weight = 0.0 if follows is None else sum(tie.weight for tie in follows.ties if tie.joint == joint)
    if follows is None or weight == 0.0:
        return follower
    weights = {tie.joint: tie.weight for tie in follows.ties}
    for index in between:
        weights[index] = weights.get(index, 0.0) - weight
    ties = tuple(Tie(index, item) for index, item in sorted(weights.items()) if item != 0.0)
    return replace(follower, follows=replace(follows, ties=ties))


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
