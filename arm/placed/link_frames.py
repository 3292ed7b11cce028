"""Where the links' bodies stand in space: the one source of what is exported as solids and what is drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.branches import ways
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.sections.numeric import Array


@dataclass(frozen=True)
class Stand:
    """Where a link stands: its joint (m), and the unit vectors along it and along its section's width and height, in
    the base frame; its length (m), of one that runs out of a sleeve what has run out."""

    joint: Array
    along: Array
    width: Array
    height: Array
    length: float

    def at(self, share: float, points: Array) -> Array:
        """Points (N, 2) of the section, across and along its height (m, from its centroid), at a share of the length:
        (N, 3), m in the base frame."""
        across, high = np.asarray(points, dtype=float).T
        return (
            self.joint + share * self.length * self.along + np.outer(across, self.width) + np.outer(high, self.height)
        )


def stands(arm: Arm, q: Sequence[float] | None = None) -> tuple[Stand, ...]:
    """Where each link stands at joint coordinates (rad, m; None: all at zero); of several arms on one torso each link
    on the way to its tip."""
    coordinates = [0.0] * arm.size if q is None else list(q)
    stands_by_link: dict[int, Stand] = {}
    for way in ways(arm):
        frames, here = place(way.arm, [coordinates[joint] for joint in way.joints]), np.zeros(3)
        for number, joint, link in zip(way.joints, frames.joints, frames.links, strict=True):
            here = here + np.array(joint.lead, dtype=float)
            vector, along, width, height = (
                np.array(item, dtype=float) for item in (link.vector, link.along, link.width, link.height)
            )
            stands_by_link[number] = Stand(here, along, width, height, float(vector @ along))
            here = here + vector
    return tuple(stands_by_link[number] for number in range(arm.size))
