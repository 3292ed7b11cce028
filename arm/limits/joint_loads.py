"""What each joint carries at a pose: force and moment for its bearings, and what of them its drive holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.chain.vectors import Vector, cross, dot, norm
from linkwright.core.arm.errors.model import beams_of


@dataclass(frozen=True)
class JointLoad:
    """What the arm beyond a joint puts on it: `force` (N) and `moment` (N*m) about its point, both in the base frame;
    `axis` is its unit axis there. `drive` is what its drive holds: N*m about the axis, or N along it (a slide)."""

    revolute: bool
    axis: tuple[float, float, float]
    force: tuple[float, float, float]
    moment: tuple[float, float, float]
    drive: float

    @property
    def along(self) -> float:
        """The force along the axis, N."""
        return float(cast(float, dot(self.axis, self.force)))

    @property
    def radial(self) -> float:
        """The size of the force across the axis, N."""
        return norm(_triple(cross(self.axis, self.force)))

    @property
    def tilting(self) -> float:
        """The size of the moment across the axis, which bearings hold, N*m."""
        return norm(_triple(cross(self.axis, self.moment)))


def joint_loads(arm: Arm, case: LoadCase, q: Sequence[float]) -> tuple[JointLoad, ...]:
    """The loads at every joint from the base out, at joint coordinates q (rad, m), by the statics of the undeformed
    arm. Raises `arm.bodies.beams.PropertyNeeded` where a mass is not known."""
    state = solve(arm, list(q), beams_of(arm, (case,)), case)
    return tuple(
        JointLoad(
            joint.revolute,
            _triple(joint.axis),
            _triple(joint.force),
            _triple(joint.moment),
            float(cast(float, joint.drive_load)),
        )
        for joint in state.joints
    )


def _triple(vector: Vector) -> tuple[float, float, float]:
    x, y, z = (float(cast(float, part)) for part in vector)
    return x, y, z
