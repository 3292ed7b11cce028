"""Vectors, rotations, nominal tips and their Jacobians as arrays of numbers, one row a pose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.sections.numeric import Array

from .chain import Arm
from .kinematics import carried_unturned, place
from .vectors import Rotation, Scalar


def columns(vector: Sequence[Scalar], rows: int) -> Array:
    """The components of a vector, each a number or `rows` of them, as columns (rows, len(vector))."""
    return np.stack([np.broadcast_to(np.asarray(part, dtype=float), (rows,)) for part in vector], axis=1)


def matrices(rotation: Rotation, rows: int, width: int = 3) -> Array:
    """The entries of a rotation, each a number or `rows` of them, as matrices (rows, width, width): 2 for those in the
    plane."""
    return np.stack([columns(row[:width], rows) for row in rotation[:width]], axis=1)


def nominal(arm: Arm, q: Array, width: int = 3) -> tuple[Array, Array]:
    """The nominal tips (N, width), m, at poses q (N, n) and the last link's axes (N, width, width)."""
    frames = place(arm, [q[:, index] for index in range(arm.size)])
    return columns(frames.tip()[:width], len(q)), matrices(frames.orientation, len(q), width)


def jacobian(arm: Arm, q: Array) -> Array:
    """How the nominal tip follows the joints at poses q (N, n): (N, n, 3), m/rad (pure numbers for slides)."""
    count = len(q)
    frames = place(arm, [q[:, index] for index in range(arm.size)])
    tip = columns(frames.tip(), count)
    here = np.zeros((count, 3))
    result = np.empty((count, arm.size, 3))
    axes = np.empty((count, arm.size, 3))
    arms = np.empty((count, arm.size, 3))
    for index, (joint, link) in enumerate(zip(frames.joints, frames.links, strict=True)):
        here = here + columns(joint.lead, count)
        axes[:, index] = columns(joint.axis, count)
        arms[:, index] = tip - here
        here = here + columns(link.vector, count)
        result[:, index] = np.cross(axes[:, index], arms[:, index]) if arm.joints[index].revolute else axes[:, index]
    for follower, joint in enumerate(arm.joints):
        if joint.follows is not None:
            for tie in joint.follows.ties:
                result[:, tie.joint] += tie.weight * result[:, follower]
            if not joint.driven:
                result[:, follower] = 0.0
    if arm.angles == "absolute":
        # Such a drive turns its link alone and carries the rest along unturned.
        for index in range(arm.size):
            if arm.joints[index].revolute:
                after = carried_unturned(arm.joints, index)
                beyond = arms[:, after] if after < arm.size else 0.0
                result[:, index] = np.cross(axes[:, index], arms[:, index] - beyond)
    return result


def motion_directions(arm: Arm, q: Array) -> Array:
    """The directions (unit vectors, (N, n, 3)) in which each joint moves the tip towards increasing coordinates; zero
    where it does not move it."""
    moved = jacobian(arm, q)
    size = np.linalg.norm(moved, axis=2, keepdims=True)
    small = size <= 1e-9
    return np.where(small, 0.0, moved / np.where(small, 1.0, size))
