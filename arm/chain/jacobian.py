"""Where each joint moves the tip: the columns of the Jacobian, for many poses at once."""

from __future__ import annotations

import numpy as np

from linkwright.core.sections.numeric import Array

from .chain import Arm
from .kinematics import place
from .vectors import Vector


def jacobian(arm: Arm, q: Array) -> Array:
    """How the nominal tip follows the joints at poses q (N, n): (N, n, 3), m/rad (pure numbers for slides)."""
    count = len(q)
    frames = place(arm, [q[:, index] for index in range(arm.size)])

    def columns(vector: Vector) -> Array:
        parts = [np.broadcast_to(np.asarray(part, dtype=float), (count,)) for part in vector]
        return np.stack(parts, axis=1)

    tip = columns(frames.tip())
    here = np.zeros((count, 3))
    found = np.empty((count, arm.size, 3))
    axes = np.empty((count, arm.size, 3))
    arms = np.empty((count, arm.size, 3))
    for index, (joint, link) in enumerate(zip(frames.joints, frames.links, strict=True)):
        here = here + columns(joint.lead)
        axes[:, index] = columns(joint.axis)
        arms[:, index] = tip - here
        here = here + columns(link.vector)
        found[:, index] = np.cross(axes[:, index], arms[:, index]) if arm.joints[index].revolute else axes[:, index]
    for follower, joint in enumerate(arm.joints):
        if joint.follows is not None:
            for tie in joint.follows.ties:
                found[:, tie.joint] += tie.weight * found[:, follower]
            if not joint.driven:
                found[:, follower] = 0.0
    if arm.angles == "absolute":
        # Such a drive turns its own link alone and carries the rest along unturned.
        for index in range(arm.size):
            if arm.joints[index].revolute:
                after = index + arm.joints[index].spans
                beyond = arms[:, after] if after < arm.size else 0.0
                found[:, index] = np.cross(axes[:, index], arms[:, index] - beyond)
    return found


def motion_directions(arm: Arm, q: Array) -> Array:
    """The directions (unit vectors, (N, n, 3)) in which each joint moves the tip towards increasing coordinates; zero
    where it does not move it."""
    moved = jacobian(arm, q)
    size = np.linalg.norm(moved, axis=2, keepdims=True)
    small = size <= 1e-9
    return np.where(small, 0.0, moved / np.where(small, 1.0, size))
