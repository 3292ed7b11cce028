"""What acts on an arm beside the weights of its links, each kind with its terms in the walk from tip to base.

`arm.chain.statics` walks inward with the load (force and moment) that each link and joint carries. On the way every
kind adds what it does at a link's far end, at a joint, and on its drive.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from .balance import End, PointMass
from .beam import Beam
from .chain import Arm
from .following import ties_to
from .kinematics import Frames, LinkFrame
from .vectors import ZERO, Scalar, Vector, add, cross, minus, plus, scale, times


@dataclass(frozen=True)
class Load:
    """A force (N) and a moment (N*m) at a point."""

    force: Vector = ZERO
    moment: Vector = ZERO

    def pushed(self, force: Vector, at: Vector = ZERO) -> Load:
        """With a further force, that acts at `at` (m) from the point."""
        return Load(add(self.force, force), add(self.moment, cross(at, force)))

    def turned(self, moment: Vector) -> Load:
        """With a further moment."""
        return Load(self.force, add(self.moment, moment))

    def scaled(self, factor: Scalar) -> Load:
        """Factor times as large."""
        return Load(scale(factor, self.force), scale(factor, self.moment))

    def with_hung(self, masses: Sequence[PointMass], end: End, frame: LinkFrame, pull: Vector) -> Load:
        """With the weights of what hangs at one end of a link."""
        load = self
        for mass in masses:
            if mass.on == end:
                along, height, width = mass.at
                at = add(add(scale(along, frame.along), scale(height, frame.height)), scale(width, frame.width))
                load = load.pushed(scale(mass.mass, pull), at)
        return load


def masses_on(masses: Sequence[PointMass], beam: Beam) -> list[PointMass]:
    """What hangs on a link, a counterweight that is chosen as the link's beam has it."""
    return [_as_chosen(mass, beam) if mass.chosen else mass for mass in masses]


def _as_chosen(mass: PointMass, beam: Beam) -> PointMass:
    chosen: dict[str, Any] = {"mass": beam.counterweight, "at": (beam.counterweight_at, *mass.at[1:])}
    return replace(mass, **chosen)


class Acting:
    """One kind of what acts; does nothing where it does not say otherwise. Joints and links count from 0."""

    def at_end(self, link: int, load: Load) -> Load:
        """The load at a link's far end with what acts there."""
        del link
        return load

    def at_joint(self, link: int, load: Load) -> Load:
        """The load at a link's near end with what acts there."""
        del link
        return load

    def past(self, joint: int, load: Load) -> Load:
        """What a joint hands on of the load at it."""
        del joint
        return load

    def on_drive(self, joint: int, on_axis: Scalar) -> Scalar:
        """What a joint's drive holds beside the load on its axis; `on_axis` is what the joint hands on about it."""
        del joint, on_axis
        return 0.0

    def passed_by(self, link: int, beyond: Load, load: Load) -> Load:
        """The load in front of a link's joint, where the load `beyond` the link may pass it by."""
        del link, beyond
        return load


@dataclass(frozen=True)
class PointLoads(Acting):
    """Forces (N, one per link) and moments (N*m, of some) at links' far ends."""

    forces: Sequence[Vector] | None
    moments: Mapping[int, Vector]

    def at_end(self, link: int, load: Load) -> Load:
        """With the link's force and moment."""
        load = load if self.forces is None else load.pushed(self.forces[link])
        return load.turned(self.moments[link]) if link in self.moments else load


@dataclass(frozen=True)
class Counterbalances(Acting):
    """What takes torque off drives, by how far each joint turns; one that is chosen is as the link's beam has it."""

    arm: Arm
    beams: Sequence[Beam]
    turns: Sequence[Scalar]

    def on_drive(self, joint: int, on_axis: Scalar) -> Scalar:
        """The torque of the joint's counterbalance."""
        del on_axis
        counterbalance, chosen = self.arm.joints[joint].counterbalance, self.arm.joints[joint].balancer_chosen
        if counterbalance is None:
            return 0.0
        if chosen:
            figure: dict[str, Any] = {chosen: self.beams[joint].balancer}
            counterbalance = replace(counterbalance, **figure)
        return counterbalance.turning(self.turns[joint])


class Couplings(Acting):
    """Joints that follow others (see `arm.chain.following`): a drive holds their share, and rods along a link between
    take theirs off it."""

    def __init__(self, arm: Arm, placed: Frames) -> None:
        self._ties, self._placed = ties_to(arm), placed
        self._loads: dict[int, Scalar] = {}
        self._last = {index + arm.joints[index].spans - 1: index for index in self._ties}

    def at_end(self, link: int, load: Load) -> Load:
        """Less what rods along the link carry; the links of one body share them."""
        return load if link not in self._last else load.turned(self._rods(self._last[link]))

    def past(self, joint: int, load: Load) -> Load:
        """With what rods along its link carry."""
        return load if joint not in self._ties else load.turned(scale(-1.0, self._rods(joint)))

    def on_drive(self, joint: int, on_axis: Scalar) -> Scalar:
        """What the drive holds for followers that no rod along its link couples to it."""
        self._loads[joint] = on_axis
        return self._coupled(joint, along=False)

    def _coupled(self, joint: int, along: bool) -> Scalar:
        total: Scalar = 0.0
        for follower, tie in self._ties.get(joint, ()):
            if tie.along == along:
                total = plus(total, times(tie.weight, self._loads[follower]))
        return total

    def _rods(self, joint: int) -> Vector:
        return scale(self._coupled(joint, along=True), self._placed.joints[joint].axis)


@dataclass(frozen=True)
class Branches(Acting):
    """The arms on a torso that the tip is not of: they load its last link, and what the tip carries passes them by."""

    arm: Arm
    hanging: Sequence[tuple[Scalar, Load]]
    """How far the tip is away from each branch (0 to 1), and that branch's load on the torso's end."""

    def at_end(self, link: int, load: Load) -> Load:
        """At the torso's end with all that hangs there."""
        if link == self.arm.branches[0].first - 1:
            for away, item in self.hanging:
                item = item.scaled(away)
                load = load.pushed(item.force).turned(item.moment)
        return load

    def passed_by(self, link: int, beyond: Load, load: Load) -> Load:
        """Of a link that is on the way to the tip at some readings only, both in their shares."""
        away = self.arm.away(link)
        if isinstance(away, float) and away == 0.0:
            return load
        here = load.scaled(minus(1.0, away))
        return beyond.scaled(away).pushed(here.force).turned(here.moment)
