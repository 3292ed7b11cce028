"""What a joint's drive has to hold: the greatest torque over a workspace, against the rated one of its actuator.

The loads are static, as everything here: payload, process force and weights. Accelerations come on top, and a motion
that takes long at the greatest torque is for the maker's own selection procedure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from .chain import Arm, LoadCase
from .compile import VectorFunction, vectorise
from .kinematics import parts
from .model import beam_symbols, symbolic_beams
from .refine import wander_in_region
from .statics import solve
from .weakest import compass
from .workspace import climbing_bounds, wrapped

if TYPE_CHECKING:
    from .worst import WorstSearch

Array = NDArray[np.float64]

_CLIMBS = 4


@dataclass(frozen=True)
class DriveCase:
    """The loads on the drives under one load case: `outputs` (N*m; N for a slide), one a joint, for symbols (q, p)."""

    inputs: tuple[Any, Any]
    outputs: Any

    @cached_property
    def function(self) -> Any:
        """The CasADi function (q, p) -> loads."""
        return ca.Function("drives", list(self.inputs), [self.outputs])

    @cached_property
    def vectorised(self) -> VectorFunction:
        """The same for many poses or designs."""
        return vectorise(list(self.inputs), [self.outputs])


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


def drive_case(arm: Arm, load: LoadCase) -> DriveCase:
    """The loads on an arm's drives under a load case."""
    q = ca.SX.sym("q", arm.size)  # pyright: ignore[reportCallIssue]
    p = beam_symbols(arm)
    state = solve(arm, parts(q), symbolic_beams(arm, p), load)
    return DriveCase((q, p), ca.vertcat(*[ca.SX(joint.drive_load) for joint in state.joints]))


def greatest_drive_loads(
    arm: Arm, cases: Sequence[DriveCase], poses: Array, p: Array, search: WorstSearch | None = None
) -> DriveLoads:
    """The greatest drive loads over poses q (N, n) and load cases for a design p; with `search` over its workspace,
    the poses being where climbs start."""
    if search is not None:
        poses = np.vstack([poses, *(_climbed(arm, case, poses, p, search) for case in cases)])
    loads = np.stack([np.abs(case.vectorised(poses, p)[0]) for case in cases])
    where = [np.unravel_index(int(np.argmax(loads[:, :, joint])), loads.shape[:2]) for joint in range(arm.size)]
    greatest = tuple(float(loads[case, pose, joint]) for joint, (case, pose) in enumerate(where))
    return DriveLoads(
        greatest,
        tuple((tuple(poses[int(pose)].tolist()), int(case)) for case, pose in where),
        tuple(None if r is None else load / r for load, r in zip(greatest, rated_torques(arm), strict=True)),
    )


def _climbed(arm: Arm, case: DriveCase, poses: Array, p: Array, search: WorstSearch) -> Array:
    known = np.abs(case.vectorised(poses, p)[0])
    rows = np.repeat(np.arange(arm.size), _CLIMBS)
    order = np.argsort(-known, axis=0, kind="stable")[:_CLIMBS]
    starts = poses[order.T.ravel()]

    def load(q: Array) -> Array:
        """The load of each climb, whose trial poses (equally many for each) follow each other in q."""
        values = np.abs(case.vectorised(q, p)[0])
        return values[np.arange(len(q)), np.repeat(rows, len(q) // len(rows))]

    if search.workspace.kind != "joints":
        bounds = (search.lower, search.upper)
        return wander_in_region(load, starts, search.workspace, lambda q: search.tip(q, p), bounds)
    reached = compass(load, starts, climbing_bounds(arm, search.lower, search.upper))
    return wrapped(arm, reached, search.lower, search.upper)
