"""What a joint's drive has to hold: the greatest torque over a workspace, against the rated one of its actuator.

The loads are static, as everything here: payload, process force and weights. Accelerations come on top, and a motion
that takes long at the greatest torque is for the maker's own selection procedure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.kinematics import parts
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.compiled.expressions import Expressions
from linkwright.core.arm.errors.model import beam_symbols, symbolic_beams
from linkwright.core.arm.errors.structure import by_structure
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.symbols import column_of_symbols

from .weakest_poses import climbed

if TYPE_CHECKING:
    from linkwright.core.arm.worst.search import WorstSearch

_CLIMBS = 4
"""Climbs for each drive."""


@dataclass(frozen=True)
class DriveLoads:
    """The greatest load on each joint's drive (N*m; N for a slide) over a workspace and load cases, where it is, and
    what share of its actuator's rated torque that is (None without an actuator)."""

    greatest: tuple[float, ...]
    poses: tuple[tuple[tuple[float, ...], int], ...]
    use: tuple[float | None, ...]

    @property
    def greatest_use(self) -> float | None:
        """The greatest share of a rated torque; None where no joint has an actuator."""
        return max((use for use in self.use if use is not None), default=None)


def rated_torques(arm: Arm) -> tuple[float | None, ...]:
    """The rated torque of each joint's actuator, N*m; None without one."""
    return tuple(None if joint.actuator is None else joint.actuator.rated_torque for joint in arm.joints)


@by_structure
def drive_case(arm: Arm, load: LoadCase) -> Expressions:
    """The loads on an arm's drives under a load case (N*m; N for a slide), one a joint, for symbols (q, p)."""
    q = column_of_symbols("q", arm.size)
    p = beam_symbols(arm)
    state = solve(arm, parts(q), symbolic_beams(arm, p), load)
    return Expressions((q, p), (ca.vertcat(*[ca.SX(joint.drive_load) for joint in state.joints]),))


def greatest_drive_loads(
    arm: Arm, cases: Sequence[Expressions], poses: Array, p: Array, search: WorstSearch | None = None
) -> DriveLoads:
    """The greatest drive loads over poses q (N, n) and load cases for a design p; with `search` over its workspace,
    the poses being where climbs start."""

    def held(case: Expressions, q: Array) -> Array:
        return np.abs(case.vectorised(q, p)[0])

    if search is not None:
        climbs = [climbed(search, partial(held, case), poses, p, _CLIMBS, least=-1.0) for case in cases]
        poses = np.vstack([poses, *climbs])
    loads = np.stack([held(case, poses) for case in cases])
    where = [np.unravel_index(int(np.argmax(loads[:, :, joint])), loads.shape[:2]) for joint in range(arm.size)]
    greatest = tuple(float(loads[case, pose, joint]) for joint, (case, pose) in enumerate(where))
    return DriveLoads(
        greatest,
        tuple((tuple(poses[int(pose)].tolist()), int(case)) for case, pose in where),
        tuple(None if r is None else load / r for load, r in zip(greatest, rated_torques(arm), strict=True)),
    )
