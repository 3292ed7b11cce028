"""Statics of a serial chain at a pose: what each link and joint carries.

The loads run from the tip to the base: payload and process force, the links' distributed weight, the joints' masses.
All forces are fixed in the base frame (dead loads), moments are those about the point named.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from linkwright.core.units.temperature import REFERENCE_TEMPERATURE

from .balance import End, PointMass
from .beam import Beam
from .branches import alone
from .chain import Arm, LoadCase, Zones
from .conditions import Conditions
from .following import coordinates, ties_to, turns
from .kinematics import Frames, LinkFrame, place, section_directions
from .vectors import (
    Scalar,
    Vector,
    add,
    cross,
    dot,
    is_zero,
    minus,
    plus,
    rotate,
    scale,
    subtract,
    times,
    transpose,
)


@dataclass(frozen=True)
class LinkState:
    """A link at a pose: its directions, its beam, and the load at its far end.

    `force` (N) and `moment` (N*m) act on the link's far end, `weight` (N) is its own, spread evenly.
    `vector` runs from its joint to its far end (m). `warming` is its temperature less 20 degC (K).
    """

    vector: Vector
    along: Vector
    height: Vector
    width: Vector
    beam: Beam
    force: Vector
    moment: Vector
    weight: Vector
    warming: Scalar
    base_moment: Vector

    @property
    def base_force(self) -> Vector:
        """The force that the rest of the arm carries at this link's joint, N."""
        return add(self.force, self.weight)


@dataclass(frozen=True)
class JointState:
    """A joint at a pose: its axis, what it carries (force N, moment N*m) and the load on its drive.

    `drive_load` is the torque about the axis (N*m), or the force along it (N) for a slide. `whole_load` is 1 where
    these loads hold what the arm's effects add to its file too (measured ones do), else 0.
    """

    revolute: bool
    axis: Vector
    force: Vector
    moment: Vector
    drive_load: Scalar
    stiffness: float | Scalar | None
    clearance: float
    backlash: float
    mass: float
    coordinate: Scalar
    spans: int
    zones: Zones = ()
    whole_load: Scalar = 0.0
    tilting_stiffness: float | None = None


@dataclass(frozen=True)
class PoseState:
    """The arm at a pose under a load: all that an effect may ask.

    `gravity` (m/s^2), `payload_mass` (kg) and `tip_force` (N) are those that the loads were taken with, `conditions`
    what held beyond pose and load.

    >>> import linkwright as lw
    >>> def turning(state: lw.PoseState) -> list[bool]:
    ...     return [joint.revolute for joint in state.joints]
    """

    joints: tuple[JointState, ...]
    links: tuple[LinkState, ...]
    leads: tuple[Vector, ...]
    tool: Vector
    absolute: bool
    planar: bool
    load: LoadCase
    arm: Arm
    frames: Frames
    gravity: Vector
    conditions: Conditions
    payload_mass: Scalar
    tip_force: Vector

    def tip(self) -> Vector:
        """The tip's nominal position, m."""
        return self.frames.tip()


def solve(
    arm: Arm,
    q: Sequence[Scalar],
    beams: Sequence[Beam],
    load: LoadCase | None = None,
    *,
    warming: Scalar | None = None,
    gravity: Vector | None = None,
    conditions: Conditions | None = None,
    payload_mass: Scalar | None = None,
    tip_force: Vector | None = None,
    point_forces: Sequence[Vector] | None = None,
    point_moments: Mapping[int, Vector] | None = None,
    frames: Frames | None = None,
) -> PoseState:
    """The state of the arm at joint coordinates q (rad, m) under a load case.

    `beams` gives each link's rigidities and length (floats or symbols). `payload_mass` (kg) and `tip_force` (N)
    replace those of the load case, as symbols say. `point_forces` (N, one per link) act at the links' far ends in
    addition, `point_moments` (N*m) at those of some. Of several arms on one torso the load case says whose tip it is.
    `warming` is the temperature above 20 degC of all links (K), the arm's own by default; that of
    `conditions` goes before it. `gravity` (m/s^2) replaces the arm's own.
    """
    case = arm.payload if load is None else load
    arm = arm.on(case.tip)
    rise = arm.temperature - REFERENCE_TEMPERATURE if warming is None else warming
    placed = place(arm, q, [beam.length for beam in beams]) if frames is None else frames
    # On a shape that is given, beams are as long as they have run out to there.
    beams = beams if frames is not None else run_out(arm, beams, q)
    held = Conditions() if conditions is None else conditions
    pull: Vector = arm.gravity if gravity is None else gravity
    pushed: Vector = case.force if tip_force is None else tip_force
    carried = case.mass if payload_mass is None else payload_mass
    force = add(pushed, scale(carried, pull))
    moment: Vector = add(case.moment, cross(placed.tool, force))
    joints: list[JointState] = []
    links: list[LinkState] = []
    ends: dict[int, Vector] = {}
    couplings, own_turns, own_coordinates = _Couplings(arm, placed), turns(arm, q), coordinates(arm, q)
    for index in range(arm.size - 1, -1, -1):
        beam, frame, joint = beams[index], placed.links[index], arm.joints[index]
        away: Scalar = 0.0
        if arm.branches:
            away = arm.away(index)
            if index == arm.branches[0].first - 1:
                force, moment = _with_branches(arm, frame, q, beams, pull, force, moment)
        beyond = force, moment
        moment = couplings.taken_on(index, moment)
        if point_forces is not None:
            force = add(force, point_forces[index])
        if point_moments is not None and index in point_moments:
            moment = add(moment, point_moments[index])
        ends[index] = moment
        own = [_chosen(each, beam) if each.chosen else each for each in arm.links[index].masses]
        force, moment = _hung(own, "end", frame, pull, force, moment)
        weight = scale(times(beam.mass_per_length, beam.length), pull)
        half = add(force, scale(beam.taper.balance, weight))
        base_moment = add(moment, cross(frame.vector, half))
        base_force = add(add(force, weight), scale(beam.housed, pull))
        if not (isinstance(beam.lumped_mass, float) and beam.lumped_mass == 0.0):
            lumped = scale(beam.lumped_mass, pull)
            base_moment = add(base_moment, cross(scale(beam.lumped_at, frame.along), lumped))
            base_force = add(base_force, lumped)
        if not is_zero(beam.first_moment):
            along, height, width = beam.first_moment
            eccentric = add(scale(along, frame.along), add(scale(height, frame.height), scale(width, frame.width)))
            base_moment = add(base_moment, cross(eccentric, pull))
        links.append(
            LinkState(
                frame.vector,
                frame.along,
                frame.height,
                frame.width,
                beam,
                force,
                moment,
                weight,
                rise if held.warming is None else held.warming[index],
                base_moment,
            )
        )
        base_force, base_moment = _hung(own, "joint", frame, pull, base_force, base_moment)
        axis = placed.joints[index].axis
        past = couplings.given_back(index, base_moment)
        # A slide's mass rides on it, so what moves the slide moves that too.
        rides = base_force if joint.revolute else add(base_force, scale(joint.mass, pull))
        couplings.carried(index, dot(axis, past if joint.revolute else rides))
        if not joint.revolute:
            drive_load = dot(axis, rides)
        elif arm.angles == "absolute":
            # Such a drive turns its own link and carries the rest along unturned, so only the link's own moment counts.
            drive_load = dot(axis, subtract(base_moment, ends[index + joint.spans - 1]))
        else:
            drive_load = dot(axis, base_moment)
        drive_load = plus(drive_load, couplings.across(index))
        if joint.counterbalance is not None:
            counterbalance = joint.counterbalance
            if joint.balancer_chosen:
                figure: dict[str, Any] = {joint.balancer_chosen: beam.balancer}
                counterbalance = replace(counterbalance, **figure)
            drive_load = plus(drive_load, counterbalance.turning(own_turns[index]))
        joints.append(
            JointState(
                joint.revolute,
                axis,
                base_force,
                base_moment,
                drive_load,
                joint.stiffness,
                joint.clearance,
                joint.backlash,
                joint.mass,
                own_coordinates[index],
                joint.spans,
                joint.zones,
                tilting_stiffness=joint.tilting_stiffness,
            )
        )
        force = add(base_force, scale(joint.mass, pull))
        lead = placed.joints[index].lead
        moment = past if is_zero(lead) else add(past, cross(lead, force))
        if not (isinstance(away, float) and away == 0.0):
            here = minus(1.0, away)
            links[-1], joints[-1] = _only(here, links[-1]), _only_drive(here, joints[-1])
            force = add(scale(away, beyond[0]), scale(here, force))
            moment = add(scale(away, beyond[1]), scale(here, moment))
    return PoseState(
        tuple(reversed(joints)),
        tuple(reversed(links)),
        tuple(joint.lead for joint in placed.joints),
        placed.tool,
        arm.angles == "absolute",
        arm.planar(case) and point_forces is None,  # those may point out of the plane
        case,
        arm,
        placed,
        pull,
        held,
        carried,
        pushed,
    )


def _with_branches(
    arm: Arm, frame: LinkFrame, q: Sequence[Scalar], beams: Sequence[Beam], pull: Vector, force: Vector, moment: Vector
) -> tuple[Vector, Vector]:
    """Force and moment at the far end of a torso's last link with the weights of the branches that the tip is not of,
    each as its own joints have it."""
    link, joint = arm.links[arm.branches[0].first - 1], arm.joints[arm.branches[0].first - 1]
    own = (link.direction, *section_directions(link, joint))
    placed = (frame.along, frame.height, frame.width)

    def to_base(vector: Vector) -> Vector:
        turned = rotate(link.end_rotation, vector)
        parts = [scale(dot(axis, turned), there) for axis, there in zip(own, placed, strict=True)]
        return add(add(parts[0], parts[1]), parts[2])

    def from_base(vector: Vector) -> Vector:
        parts = [scale(dot(there, vector), axis) for axis, there in zip(own, placed, strict=True)]
        return rotate(transpose(link.end_rotation), add(add(parts[0], parts[1]), parts[2]))

    down = from_base(pull)
    for branch in arm.branches:
        if isinstance(branch.away, float) and branch.away == 0.0:
            continue
        rows = slice(branch.first, branch.end)
        weighs = LoadCase(branch.payload.mass)
        state = solve(alone(arm, branch), list(q)[rows], beams[rows], weighs, gravity=down)
        first = state.joints[0]
        weight = add(first.force, scale(first.mass, down))
        turning = add(first.moment, cross(state.leads[0], weight))
        force = add(force, scale(branch.away, to_base(weight)))
        moment = add(moment, scale(branch.away, to_base(turning)))
    return force, moment


def _only(here: Scalar, link: LinkState) -> LinkState:
    """A link that is on the way to the tip at some readings only (`here` 1, else 0): elsewhere it carries nothing."""
    names = ("force", "moment", "weight", "base_moment")
    carried: dict[str, Any] = {name: scale(here, getattr(link, name)) for name in names}
    return replace(link, **carried)


def _only_drive(here: Scalar, joint: JointState) -> JointState:
    force, moment, load = scale(here, joint.force), scale(here, joint.moment), times(here, joint.drive_load)
    return replace(joint, force=force, moment=moment, drive_load=load)


def unladen(arm: Arm) -> Arm:
    """The arm without the payloads of branches that the tip is not of."""
    return replace(arm, branches=tuple(replace(each, payload=LoadCase()) for each in arm.branches))


def run_out(arm: Arm, beams: Sequence[Beam], q: Sequence[Scalar]) -> Sequence[Beam]:
    """The beams at coordinates q (rad, m): those that run out of a sleeve as long as they have."""
    if not any(link.runs_out for link in arm.links):
        return beams
    own = turns(arm, q)
    return [
        beam.run_out(plus(own[k], arm.joints[k].zero)) if arm.links[k].runs_out else beam
        for k, beam in enumerate(beams)
    ]


class _Couplings:
    """What the loads of joints that follow others come to on the way to the base (see `arm.chain.following`)."""

    def __init__(self, arm: Arm, placed: Frames) -> None:
        self.ties, self.placed = ties_to(arm), placed
        self.loads: dict[int, Scalar] = {}
        self.last = {index + arm.joints[index].spans - 1: index for index in self.ties}

    def carried(self, joint: int, load: Scalar) -> None:
        """Note the load on a joint's axis, all that lies beyond it counted as if nothing were coupled."""
        self.loads[joint] = load

    def _coupled(self, joint: int, along: bool) -> Scalar:
        total: Scalar = 0.0
        for follower, tie in self.ties.get(joint, ()):
            if tie.along == along:
                total = plus(total, times(tie.weight, self.loads[follower]))
        return total

    def across(self, joint: int) -> Scalar:
        """What the drive of a joint holds for followers that no rod along its link couples to it."""
        return self._coupled(joint, along=False)

    def taken_on(self, link: int, moment: Vector) -> Vector:
        """The moment at a link's far end, less what rods along it carry; the links of one body share them."""
        return moment if link not in self.last else self._with(self.last[link], 1.0, moment)

    def given_back(self, joint: int, moment: Vector) -> Vector:
        """The moment that a joint hands on to what is before it, rods along its link included."""
        return moment if joint not in self.ties else self._with(joint, -1.0, moment)

    def _with(self, joint: int, sign: float, moment: Vector) -> Vector:
        coupled = self._coupled(joint, along=True)
        return add(moment, scale(times(sign, coupled), self.placed.joints[joint].axis))


def _chosen(mass: PointMass, beam: Beam) -> PointMass:
    """A counterweight as the link's beam has it."""
    own: dict[str, Any] = {"mass": beam.counterweight, "at": (beam.counterweight_at, *mass.at[1:])}
    return replace(mass, **own)


def _hung(
    masses: Sequence[PointMass], end: End, frame: LinkFrame, pull: Vector, force: Vector, moment: Vector
) -> tuple[Vector, Vector]:
    """Force and moment at one end of a link with the weights of what hangs there."""
    for each in masses:
        if each.on != end:
            continue
        weight = scale(each.mass, pull)
        along, height, width = each.at
        arm = add(add(scale(along, frame.along), scale(height, frame.height)), scale(width, frame.width))
        force, moment = add(force, weight), add(moment, cross(arm, weight))
    return force, moment
