"""Fixed transforms that the arm file leaves free: what a change of each number moves, and the arm after it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.chain import Arm, FloatVector, Joint, OriginPart
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Rotation as Rows
from linkwright.core.arm.chain.vectors import Vector, compose, cross, dot, plus, rotate, scale, snap_vector, transpose
from linkwright.core.arm.effects import Twist
from linkwright.core.arm.errors.recorded import seen_of_links
from linkwright.core.sections.numeric import Array

from .observed import Observed

SHIFTS: tuple[OriginPart, ...] = ("x", "y", "z")
TURNS: tuple[OriginPart, ...] = ("roll", "pitch", "yaw")
_OF_THE_PLANE: tuple[OriginPart, ...] = ("x", "y", "yaw")
_AXES: tuple[FloatVector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Freedom:
    """One way in which a fixed transform may be otherwise: in front of which joint (from 0), along or about which axis
    of the frame before it, and whether it turns. Of a turn that is free as a whole the three axes are those of that
    frame; else that of the angle alone."""

    joint: int
    part: OriginPart
    axis: FloatVector

    @property
    def turns(self) -> bool:
        """Whether it turns what lies beyond, in place of shifting it."""
        return self.part in TURNS


def freedoms(arm: Arm, *, flat: bool) -> tuple[Freedom, ...]:
    """The ways in which an arm's fixed transforms may be otherwise; `flat` keeps to those within the plane."""
    return tuple(
        Freedom(index, part, _axis(arm.joints[index], part))
        for index in arm.unknown_origins
        for part in arm.joints[index].origin_free
        if not flat or part in _OF_THE_PLANE
    )


def of_observed(observed: Observed) -> tuple[Freedom, ...]:
    """The ways that a recording can show: within the plane alone where the arm and what is measured stay in it."""
    return freedoms(observed.arm, flat=observed.space == 2 and observed.arm.planar())


def turned_whole(joint: Joint) -> bool:
    """Whether all of a joint's turn is free."""
    return all(part in joint.origin_free for part in TURNS)


def _axis(joint: Joint, part: OriginPart) -> FloatVector:
    if part in SHIFTS:
        return _AXES[SHIFTS.index(part)]
    axis = _AXES[TURNS.index(part)]
    if turned_whole(joint):
        return axis
    # Fixed-axis angles: the yaw turns last, about z itself; what turns before it is carried along.
    _, pitch, yaw = Rotation.from_matrix(np.array(joint.origin_rotation)).as_euler("xyz").tolist()
    later = {"roll": (0.0, pitch, yaw), "pitch": (0.0, 0.0, yaw), "yaw": (0.0, 0.0, 0.0)}[part]
    x, y, z = Rotation.from_euler("xyz", later).apply(axis).tolist()
    return (x, y, z)


def origin_columns(observed: Observed, ways: Sequence[Freedom]) -> Array:
    """What a unit (m, rad) of each way moves in every column, (N, C, b)."""
    shape = (*observed.residual.shape, 0)
    parts = [observed.stacked(seen_of_links(observed.state, _twists(observed.state, w), observed.asked)) for w in ways]
    return np.stack(parts, axis=2) if parts else np.zeros(shape)


def _twists(state: PoseState, way: Freedom) -> list[Twist]:
    joint, joint_before = state.joints[way.joint], state.arm.joints[way.joint]
    before: Rows = compose(state.frames.joints[way.joint].frame, transpose(joint_before.origin_rotation))
    axis = rotate(before, way.axis)
    if not way.turns:
        return [Twist("joint", way.joint, axis, (0.0, 0.0, 0.0))]
    # A slide's guide turns about where it begins, and the carriage stands some way along it.
    travel: Vector = (0.0, 0.0, 0.0)
    if not joint_before.revolute and not state.arm.links[way.joint].runs_out:
        travel = cross(axis, scale(plus(joint.coordinate, joint_before.zero), joint.axis))
    twists = [Twist("joint", way.joint, travel, axis)]
    # What a joint moves, its followers do after it; how it stands moves none of them.
    along = dot(joint.axis, axis if joint_before.revolute else travel)
    for index, other in enumerate(state.arm.joints):
        for tie in () if other.follows is None else other.follows.ties:
            if tie.joint == way.joint:
                back = scale(-tie.weight, scale(along, state.joints[index].axis))
                none = (0.0, 0.0, 0.0)
                twists.append(Twist("joint", index, *((none, back) if other.revolute else (back, none))))
    return twists


def moved(arm: Arm, ways: Sequence[Freedom], by: Array) -> Arm:
    """The arm with its fixed transforms changed by `by` (b,), m and rad, in these ways, by finite turns."""
    joints = list(arm.joints)
    for index in sorted({way.joint for way in ways}):
        joint = arm.joints[index]
        shift = np.array(joint.origin_translation, dtype=float)
        turn, angles = np.zeros(3), np.zeros(3)
        for way, value in zip(ways, by.tolist(), strict=True):
            if way.joint != index:
                continue
            if not way.turns:
                shift[SHIFTS.index(way.part)] += value
            elif turned_whole(joint):
                turn += value * np.array(way.axis)
            else:
                angles[TURNS.index(way.part)] += value
        matrix = Rotation.from_matrix(np.array(joint.origin_rotation))
        if angles.any():
            matrix = Rotation.from_euler("xyz", matrix.as_euler("xyz") + angles)
        joints[index] = with_origin(joint, (Rotation.from_rotvec(turn) * matrix).as_matrix(), shift)
    return replace(arm, joints=tuple(joints))


def with_origin(joint: Joint, rotation: Array, shift: Array) -> Joint:
    """A joint that stands elsewhere on the link before it."""
    # What stays in the plane must do so to the last digit.
    rows = [snap_vector((a, b, c)) for a, b, c in rotation.tolist()]
    x, y, z = shift.tolist()
    return replace(joint, origin_rotation=(rows[0], rows[1], rows[2]), origin_translation=(x, y, z))


def known(arm: Arm) -> Arm:
    """The arm with its fixed transforms taken for known as they stand."""
    return replace(arm, joints=tuple(replace(joint, origin_free=()) for joint in arm.joints))


def with_origins_of(arm: Arm, other: Arm) -> Arm:
    """The arm with its fixed transforms where they stand in another, free as they were."""
    placed = (
        replace(joint, origin_rotation=there.origin_rotation, origin_translation=there.origin_translation)
        for joint, there in zip(arm.joints, other.joints, strict=True)
    )
    return replace(arm, joints=tuple(placed))


def turned_by(arm: Arm, other: Arm) -> float:
    """How far the fixed transforms of two arms are turned from each other, rad: the furthest of all."""
    turns = [
        (Rotation.from_matrix(np.array(b.origin_rotation)) * Rotation.from_matrix(np.array(a.origin_rotation)).inv())
        for a, b in zip(arm.joints, other.joints, strict=True)
    ]
    return max(float(turn.magnitude()) for turn in turns)
