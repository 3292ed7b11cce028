"""Statics of a serial chain at a pose: what each link and joint carries.

The loads run from the tip to the base: payload and process force, the links' distributed weight, the joints' masses.
All forces are fixed in the base frame (dead loads), moments are those about the point named.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from linkwright.core.arm.bodies.inertia import Inertia
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE

from .acting import Acting, Branches, Counterbalances, Couplings, Load, PointLoads, masses_on
from .beam import Beam
from .branches import alone
from .chain import Arm, FloatVector, Joint, Link, LoadCase, Zones
from .conditions import Conditions
from .following import coordinates, turns
from .kinematics import Frames, LinkFrame, carried_unturned, place, section_directions
from .vectors import (
    Scalar,
    Vector,
    add,
    cross,
    dot,
    minus,
    plus,
    rotate,
    scale,
    snap,
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


@dataclass(frozen=True)
class JointState:
    """A joint at a pose: its axis, what it carries (force N, moment N*m) and the load on its drive.

    `drive_load` is the torque about the axis (N*m), or the force along it (N) for a slide. `whole_load` is 1 where
    these loads hold what the arm's effects add to its file too, else 0.
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


def in_base_frame(state: PoseState, index: int, vector: FloatVector) -> Vector:
    """A vector (3,) of the frame of link `index` (from 0) at a pose, in the base frame and in its unit."""
    link, at_pose = state.arm.links[index], state.links[index]
    height, width = section_directions(link, state.arm.joints[index])
    axes = ((link.direction, at_pose.along), (height, at_pose.height), (width, at_pose.width))
    along, up, aside = (scale(snap(dot(vector, item)), there) for item, there in axes)
    return add(along, add(up, aside))


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
    held = Conditions() if conditions is None else conditions
    rise = arm.temperature - REFERENCE_TEMPERATURE if warming is None else warming
    if case.moving is not None:
        q = case.moving.at(q)
    placed = place(arm, q, [beam.length for beam in beams]) if frames is None else frames
    # On a shape that is given, beams are as long as they have run out to there.
    beams = beams if frames is not None else run_out(arm, beams, q)
    pull: Vector = arm.gravity_felt(case) if gravity is None else gravity
    pushed: Vector = case.force if tip_force is None else tip_force
    carried = case.mass if payload_mass is None else payload_mass
    acting: list[Acting] = [Couplings(arm, placed), Counterbalances(arm, beams, turns(arm, q))]
    if point_forces is not None or point_moments is not None:
        acting.append(PointLoads(point_forces, point_moments or {}))
    if arm.branches:
        acting.insert(0, Branches(arm, _hanging(arm, placed, q, beams, pull)))
    warm = [rise] * arm.size if held.warming is None else held.warming
    felt, at_tip = [(pull, pull)] * arm.size, pull
    if case.moving is not None:
        inertia = Inertia(arm, placed, beams, case.moving, carried)
        acting.append(inertia)
        felt, at_tip = _felt(pull, inertia)
    at = Load(moment=case.moment).pushed(add(pushed, scale(carried, at_tip)), placed.tool)
    links, joints = _inward(arm, placed, beams, acting, felt, at, warm, coordinates(arm, q))
    _leave_out(arm, links, joints)
    return PoseState(
        tuple(joints),
        tuple(links),
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


def _felt(pull: Vector, inertia: Inertia) -> tuple[list[tuple[Vector, Vector]], Vector]:
    """Gravity less the acceleration of each link and joint, and that at the tip."""
    pairs = zip(inertia.links, inertia.joints, strict=True)
    felt = [(subtract(pull, of_link), subtract(pull, of_joint)) for of_link, of_joint in pairs]
    return felt, subtract(pull, inertia.tip)


def _inward(
    arm: Arm,
    placed: Frames,
    beams: Sequence[Beam],
    acting: Sequence[Acting],
    felt: Sequence[tuple[Vector, Vector]],
    at: Load,
    warming: Sequence[Scalar],
    coordinate: Sequence[Scalar],
) -> tuple[list[LinkState], list[JointState]]:
    """The links and joints from the base out, by a walk inward from the load `at` the end of the last link; `felt` is
    the gravity (m/s^2) that each link and joint feels."""
    joints: list[JointState] = []
    links: list[LinkState] = []
    ends: dict[int, Load] = {}
    for index in range(arm.size - 1, -1, -1):
        joint, beam, beyond = arm.joints[index], beams[index], at
        of_link, of_joint = felt[index]
        for item in acting:
            at = item.at_end(index, at)
        ends[index] = at
        link, at = _along(arm.links[index], beam, placed.links[index], of_link, at, warming[index])
        for item in acting:
            at = item.at_joint(index, at)
        axis, past = placed.joints[index].axis, at
        for item in acting:
            past = item.past(index, past)
        # A slide's mass rides on it, so what moves the slide moves that too.
        riding = at.pushed(scale(joint.mass, of_joint)).force
        on_axis = dot(axis, past.moment if joint.revolute else riding)
        drive_load = dot(axis, at.moment if joint.revolute else riding)
        if joint.revolute and arm.angles == "absolute":
            following = carried_unturned(arm.joints, index)
            if following < arm.size:
                end = ends[following - 1]
                at_axis = subtract(end.moment, cross(placed.joints[following].lead, end.force))
                drive_load = dot(axis, subtract(at.moment, at_axis))
        for item in acting:
            drive_load = plus(drive_load, item.on_drive(index, on_axis))
        links.append(link)
        joints.append(_joint_state(joint, axis, at, drive_load, coordinate[index]))
        force = add(at.force, scale(joint.mass, of_joint))
        at = Load(force, add(past.moment, cross(placed.joints[index].lead, force)))
        for item in acting:
            at = item.passed_by(index, beyond, at)
    return links[::-1], joints[::-1]


def _along(
    link: Link, beam: Beam, frame: LinkFrame, pull: Vector, far: Load, warming: Scalar
) -> tuple[LinkState, Load]:
    """A link's state under the load at its far end, and the load at its joint: with its weight and all that hangs
    there."""
    masses = masses_on(link.masses, beam)
    far = far.with_hung(masses, "end", frame, pull)
    weight = scale(times(beam.mass_per_length, beam.length), pull)
    half = add(far.force, scale(beam.taper.balance, weight))
    along, height, width = beam.first_moment
    eccentric = add(scale(along, frame.along), add(scale(height, frame.height), scale(width, frame.width)))
    near = Load(add(add(far.force, weight), scale(beam.housed, pull)), add(far.moment, cross(frame.vector, half)))
    near = near.pushed(scale(beam.lumped_mass, pull), scale(beam.lumped_at, frame.along))
    near = near.turned(cross(eccentric, pull))
    directions = frame.vector, frame.along, frame.height, frame.width
    state = LinkState(*directions, beam, far.force, far.moment, weight, warming, near.moment)
    return state, near.with_hung(masses, "joint", frame, pull)


def _joint_state(joint: Joint, axis: Vector, load: Load, drive_load: Scalar, coordinate: Scalar) -> JointState:
    return JointState(
        joint.revolute,
        axis,
        load.force,
        load.moment,
        drive_load,
        joint.stiffness,
        joint.clearance,
        joint.backlash,
        joint.mass,
        coordinate,
        joint.spans,
        joint.zones,
        tilting_stiffness=joint.tilting_stiffness,
    )


def _hanging(
    arm: Arm, placed: Frames, q: Sequence[Scalar], beams: Sequence[Beam], pull: Vector
) -> list[tuple[Scalar, Load]]:
    """How far the tip is away from each branch that it is not of, and the load at the torso's end of that branch's
    weights, as its joints have it."""
    torso = arm.branches[0].first - 1
    link, frame = arm.links[torso], placed.links[torso]
    axes = (link.direction, *section_directions(link, arm.joints[torso]))
    there = (frame.along, frame.height, frame.width)

    def to_base(vector: Vector) -> Vector:
        turned = rotate(link.end_rotation, vector)
        parts = [scale(dot(axis, turned), axis_there) for axis, axis_there in zip(axes, there, strict=True)]
        return add(add(parts[0], parts[1]), parts[2])

    def from_base(vector: Vector) -> Vector:
        parts = [scale(dot(axis_there, vector), axis) for axis, axis_there in zip(axes, there, strict=True)]
        return rotate(transpose(link.end_rotation), add(add(parts[0], parts[1]), parts[2]))

    down = from_base(pull)
    loads: list[tuple[Scalar, Load]] = []
    for branch in arm.branches:
        if _never(branch.away):
            continue
        rows = slice(branch.first, branch.end)
        weighs = LoadCase(branch.payload.mass)
        state = solve(alone(arm, branch), list(q)[rows], beams[rows], weighs, gravity=down)
        first = state.joints[0]
        weight = add(first.force, scale(first.mass, down))
        turning = add(first.moment, cross(state.leads[0], weight))
        loads.append((branch.away, Load(to_base(weight), to_base(turning))))
    return loads


def _never(away: Scalar) -> bool:
    return isinstance(away, float) and away == 0.0


def _leave_out(arm: Arm, links: list[LinkState], joints: list[JointState]) -> None:
    """Take away, in place, what parts carry at readings of which they are not on the way to the tip."""
    for index in [index for index in range(arm.size) if not _never(arm.away(index))]:
        here = minus(1.0, arm.away(index))
        links[index], joints[index] = _only(here, links[index]), _only_drive(here, joints[index])


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
    return replace(arm, branches=tuple(replace(branch, payload=LoadCase()) for branch in arm.branches))


def run_out(arm: Arm, beams: Sequence[Beam], q: Sequence[Scalar]) -> Sequence[Beam]:
    """The beams at coordinates q (rad, m): those that run out of a sleeve as long as they have."""
    if not any(link.runs_out for link in arm.links):
        return beams
    joint_turns = turns(arm, q)
    return [
        beam.run_out(plus(joint_turns[k], arm.joints[k].zero)) if arm.links[k].runs_out else beam
        for k, beam in enumerate(beams)
    ]
