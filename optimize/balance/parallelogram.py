"""A motor nearer the base that turns its link by rods: a parallelogram, as one of the places to choose from.

The joint's coordinate is then its link's turn against what the first rod stands on. What follows the joint goes on
turning with its link as before, so a wrist that rods keep level stays level.
"""

from __future__ import annotations

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
