"""The links of a moving arm: where they stand, how they turn and speed up, at many instants at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.bodies.bodies import link_axes
from linkwright.core.arm.chain.chain import Arm, FloatVector
from linkwright.core.arm.chain.kinematics import place, turns_by_drives
from linkwright.core.arm.chain.vectors import Vector
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

PIECE = 8192
"""Instants that are taken at once, so that what is needed on the way stays small."""


@dataclass(frozen=True)
class MovingLink:
    """A link at M instants. In the base frame: its joint's `axis` and `origin` (3, M), m, and its `rotation` (3, 3, M).
    In its frame: the `acceleration` of its origin (3, M), m/s^2, gravity taken off, and how it is `turning` (rad/s)
    and `spinning_up` (rad/s^2)."""

    axis: Array
    origin: Array
    rotation: Array
    acceleration: Array
    turning: Array
    spinning_up: Array

    def inward(self, vector: Array) -> Array:
        """A vector (3, M) of the base frame in the link's own."""
        return np.einsum("bam,bm->am", self.rotation, vector)


@dataclass(frozen=True)
class MovingArm:
    """An arm's links at M instants, and the step (3, M) from the last one's origin to the tip, m."""

    links: tuple[MovingLink, ...]
    tip: Array


def refuse_what_no_chain_is(arm: Arm) -> None:
    """Raise `InputError` for an arm whose motion takes more than one rigid chain."""
    if arm.branches:
        raise InputError("", "branches", "end in several tips; torques are those of one arm: write each by itself")
    if any(link.runs_out for link in arm.links):
        number = [link.runs_out for link in arm.links].index(True) + 1
        raise InputError("", f"link {number}", "runs out of a sleeve (bends_over); torques need links as they are")


def pieces(size: int) -> Iterator[slice]:
    """The instants of a motion, a piece at a time."""
    for start in range(0, size, PIECE):
        yield slice(start, min(start + PIECE, size))


def moving(arm: Arm, q: Array, velocity: Array, acceleration: Array, gravity: FloatVector | None = None) -> MovingArm:
    """An arm's links at coordinates, velocities and accelerations (M, n), under its gravity or another (m/s^2)."""
    count = len(q)
    turns = turns_by_drives(arm)
    rates, speeding = (velocity @ turns.T).T, (acceleration @ turns.T).T
    frames = place(arm, list(q.T))
    pull = np.asarray(arm.gravity_felt() if gravity is None else gravity, dtype=float)
    origin, step = np.zeros((3, count)), np.zeros((3, count))
    rising = np.repeat(-pull[:, None], count, axis=1)
    turning, spinning_up = np.zeros((3, count)), np.zeros((3, count))
    links: list[MovingLink] = []
    for index, (joint, link) in enumerate(zip(frames.joints, frames.links, strict=True)):
        step = step + rows(joint.lead, count)
        axis, rate, more = rows(joint.axis, count), rates[index], speeding[index]
        origin = origin + step
        rising = rising + cross(spinning_up, step) + cross(turning, cross(turning, step))
        if arm.joints[index].revolute:
            spinning_up = spinning_up + more * axis + cross(turning, rate * axis)
            turning = turning + rate * axis
        else:
            rising = rising + more * axis + 2.0 * cross(turning, rate * axis)
        axes = link_axes(arm.joints[index], arm.links[index])
        directions = np.empty((3, 3, count))
        for column, direction in enumerate((link.along, link.height, link.width)):
            for row, component in enumerate(direction):
                directions[row, column] = component
        rotation = np.einsum("acm,bc->abm", directions, axes)
        here = MovingLink(axis, origin, rotation, rising, turning, spinning_up)
        parts = (here.inward(item) for item in (rising, turning, spinning_up))
        links.append(MovingLink(axis, origin, rotation, *parts))
        step = rows(link.vector, count)
    return MovingArm(tuple(links), step + rows(frames.tool, count))


def rows(vector: Vector, count: int) -> Array:
    """A vector's components, each a number or `count` of them, as rows (3, count)."""
    made = np.empty((3, count))
    made[0], made[1], made[2] = vector
    return made


def cross(a: Array, b: Array) -> Array:
    """The vector product of rows (3, M)."""
    made = np.empty((3, max(a.shape[1], b.shape[1])))
    made[0] = a[1] * b[2] - a[2] * b[1]
    made[1] = a[2] * b[0] - a[0] * b[2]
    made[2] = a[0] * b[1] - a[1] * b[0]
    return made


def dot(a: Array, b: Array) -> Array:
    """The scalar product of rows (3, M)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
