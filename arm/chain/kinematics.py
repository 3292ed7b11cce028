"""Forward kinematics of a serial chain, in floats, arrays or symbols.

Neighbouring joints with parallel axes share one summed angle, so that an arm whose axes are all parallel costs what
code written for the plane would cost.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwright.core.sections.numeric import Array, column_of_symbols, cos, sin

from .chain import Arm, FloatVector, Joint, Link
from .following import turns, turns_by_coordinates
from .vectors import (
    IDENTITY,
    ZERO,
    Rotation,
    Scalar,
    Vector,
    about,
    add,
    compose,
    cross,
    norm,
    plus,
    rotate,
    scale,
    times,
    unit,
)


@dataclass(frozen=True)
class JointFrame:
    """A joint at a pose: the step from the end of the previous link to its axis (`lead`, m), and its axis (unit)."""

    lead: Vector
    axis: Vector
    before: Orientation

    @property
    def frame(self) -> Rotation:
        """The frame in which the joint moves; it stays with the link before."""
        return self.before.matrix()


@dataclass(frozen=True)
class LinkFrame:
    """A link at a pose: its vector (m) and the unit vectors along it, along its section's height and width."""

    vector: Vector
    along: Vector
    height: Vector
    width: Vector


@dataclass(frozen=True)
class Frames:
    """All joints and links of an arm at a pose, in the base frame; `tool` is the step from the last link to the tip."""

    joints: tuple[JointFrame, ...]
    links: tuple[LinkFrame, ...]
    tool: Vector
    orientation: Rotation

    def tip(self) -> Vector:
        """The tip's position, m."""
        position: Vector = ZERO
        for joint, link in zip(self.joints, self.links, strict=True):
            position = add(add(position, joint.lead), link.vector)
        return add(position, self.tool)


@dataclass(frozen=True)
class Orientation:
    """prefix * Rot(axis, angle): the last turn is kept apart so that a parallel next joint only adds its angle."""

    prefix: Rotation
    axis: FloatVector
    angle: Scalar

    def matrix(self) -> Rotation:
        """The whole rotation."""
        if isinstance(self.angle, float) and self.angle == 0.0:
            return self.prefix
        return compose(self.prefix, about(self.axis, cos(self.angle), sin(self.angle)))

    def turned(self, rotation: Rotation) -> Orientation:
        """Turned further by a fixed rotation."""
        if rotation == IDENTITY:
            return self
        return Orientation(compose(self.matrix(), rotation), (0.0, 0.0, 1.0), 0.0)

    def jointed(self, axis: FloatVector, angle: Scalar, absolute: bool) -> Orientation:
        """Turned further about a joint's axis; with `absolute`, to the angle itself."""
        if self.axis == axis:
            return Orientation(self.prefix, axis, angle if absolute else plus(self.angle, angle))
        if self.axis == tuple(-component for component in axis) and not absolute:
            return Orientation(self.prefix, self.axis, plus(self.angle, times(-1.0, angle)))
        return Orientation(self.matrix(), axis, angle)


def section_directions(link: Link, joint: Joint) -> tuple[FloatVector, FloatVector]:
    """The directions of a section's height and width in the link's frame.

    Unless the link says otherwise, the height lies in the plane in which its joint turns it; for a joint that turns
    it about its axis, or slides, along the frame's y (or z, where the link itself runs along y).
    """
    along = link.direction
    if link.height_direction is not None:
        hint = link.height_direction
    else:
        hint = cross(joint.axis, along) if joint.revolute else ZERO
        if norm(hint) < 1e-9:
            hint = (0.0, 1.0, 0.0) if abs(along[1]) < 0.9 else (0.0, 0.0, 1.0)
    width = unit(cross(along, hint))
    return unit(cross(width, along)), width


def carried_unturned(joints: Sequence[Joint], index: int) -> int:
    """Where angles are absolute, the joint (from 0) from whose axis on a drive carries the rest along without turning
    it: the next that turns, past the pieces of its link and slides that ride on it; their number if there is none,
    for then even the tool turns."""
    after = range(index + joints[index].spans, len(joints))
    return next((item for item in after if joints[item].revolute), len(joints))


def turns_by_drives(arm: Arm) -> Array:
    """The matrix (n, n) from the rates of an arm's coordinates to those at which each joint turns or slides against the
    link before it; its transpose leads from torques about the joints to those of the drives."""
    matrix = turns_by_coordinates(arm)
    if arm.angles == "absolute":
        against = np.eye(arm.size)
        for index, joint in enumerate(arm.joints):
            after = carried_unturned(arm.joints, index)
            if joint.revolute and after < arm.size:
                against[after, index] = -1.0
        matrix = against @ matrix
    return matrix


def place(arm: Arm, q: Sequence[Scalar], lengths: Sequence[Scalar] | None = None) -> Frames:
    """The arm's joints and links at joint coordinates q (rad, m), with other lengths (m) where given.

    The components of q may be floats, arrays of equal length or symbols; the frames hold the same.
    """
    spans = arm.lengths if lengths is None else lengths
    state = Orientation(IDENTITY, (0.0, 0.0, 1.0), 0.0)
    joints: list[JointFrame] = []
    links: list[LinkFrame] = []
    each = zip(arm.joints, arm.links, turns(arm, q), spans, strict=True)
    for index, (joint, link, coordinate, span) in enumerate(each):
        if arm.branches and arm.away_wholly(index):
            joints.append(JointFrame(ZERO, ZERO, state))
            links.append(LinkFrame(ZERO, ZERO, ZERO, ZERO))
            continue
        lead = rotate(state.matrix(), joint.origin_translation) if any(joint.origin_translation) else ZERO
        state = state.turned(joint.origin_rotation)
        moved = plus(coordinate, joint.zero)
        before = state
        if joint.revolute:
            state = state.jointed(joint.axis, moved, arm.angles == "absolute")
            matrix = state.matrix()
            axis = rotate(state.prefix, joint.axis) if state.axis == joint.axis else rotate(matrix, joint.axis)
        else:
            matrix = state.matrix()
            axis = rotate(matrix, joint.axis)
            if link.runs_out:
                span = moved
            else:
                lead = add(lead, scale(moved, axis))
        height, width = section_directions(link, joint)
        along = rotate(matrix, link.direction)
        joints.append(JointFrame(lead, axis, before))
        links.append(LinkFrame(scale(span, along), along, rotate(matrix, height), rotate(matrix, width)))
        state = state.turned(link.end_rotation)
    last = state.matrix()
    return Frames(tuple(joints), tuple(links), rotate(last, arm.tool) if any(arm.tool) else ZERO, last)


def tip_position(arm: Arm, q: Any) -> Any:
    """The nominal tip (N x 3, m) at joint coordinates q (N x n, rad or m) as NumPy arrays."""
    array = np.atleast_2d(np.asarray(q, dtype=float))
    tip = place(arm, [array[:, i] for i in range(arm.size)]).tip()
    return np.stack([np.broadcast_to(component, array.shape[:1]) for component in tip], axis=1)


def symbols(arm: Arm) -> Any:
    """The joint coordinates as a column of CasADi symbols."""
    return column_of_symbols("q", arm.size)


def parts(column: Any) -> list[Any]:
    """The entries of a CasADi column as a list."""
    return [column[i] for i in range(column.numel())]
