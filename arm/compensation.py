"""The error over the workspace as a table that a controller can subtract: displacements of the tip, and of the joints.

The table holds what is certain: the deterministic part of the model, with play where the load seats it. What depends on
the side of approach, on time or on a temperature other than the arm file's is not in it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RegularGridInterpolator

from linkwright.core.arm.chain.arrays import jacobian
from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Joint, LoadCase
from linkwright.core.arm.chain.following import completed
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.errors.exact import SETTLED, Deformed, Shape, bent_on, settled_shape
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.tip import ActiveEffect, active_effects
from linkwright.core.arm.errors.unknown_mass import unknown_taken_out
from linkwright.core.arm.worst.workspace import spread
from linkwright.core.sections.numeric import Array

_STEPS, _STEPS_TOGETHER = 4, 12
"""The most of each pose: with its shape found anew at each, and found together with the correction."""
_SMALLEST = 1e-2
"""Motions of the tip that the joints make this much worse than the best are left alone: near a singular pose they would
take joints far from where they belong."""
_ARRIVED = 1e-13
"""m; a step is the last where the next one, by how fast they become smaller, would move the tip by no more."""
_MOST_DEFAULT = 20_000
_FINEST_DEFAULT = 15
_CHECKED = 2048
_AT_ONCE = 8192
"""Poses that are computed together: as fast as all at once, with little memory."""

Heard = Callable[[int, int], None]
"""Hears how many rows are done, and of how many."""


@dataclass(frozen=True)
class Check:
    """How the table does between its poses, by linear interpolation, at `poses` spread poses: RMS and largest error (m)
    without it, with displacements subtracted, and with joint corrections added."""

    poses: int
    rms_without: float
    largest_without: float
    rms_subtracted: float
    largest_subtracted: float
    rms_corrected: float
    largest_corrected: float


@dataclass(frozen=True)
class Table:
    """M poses: `q` (M, n) rad and m, `payload` (M,) kg, `error` (M, 3) m by which the tip is off, `correction` (M, n)
    to be added to the joint coordinates, and `left` (M,) m, the length of the error with the correction.

    `axes` are the grid's coordinates for each joint, None for poses of one's own; `check` is None then.
    """

    arm: Arm
    q: Array
    payload: Array
    error: Array
    correction: Array
    left: Array
    axes: tuple[Array, ...] | None
    check: Check | None


def model_error(arm: Arm, q: Array, payload: float) -> Array:
    """By how much the tip is off at poses q (N, n) with a payload (kg): (N, 3), m.

    Raises `arm.bodies.beams.PropertyNeeded` and the materials' errors where the model lacks a figure.
    """
    return _Model.of(arm, payload).settled(q)[0].tip


@dataclass(frozen=True)
class _Model:
    """An arm as it is loaded, without what belongs to the instrument that measured it."""

    arm: Arm
    case: LoadCase
    beams: tuple[Beam, ...]
    effects: tuple[ActiveEffect, ...]

    @classmethod
    def of(cls, arm: Arm, payload: float) -> _Model:
        """The model with a payload (kg). Raises as `model_error` does."""
        case = replace(arm.payload, mass=payload)
        real = unknown_taken_out(without_instrument(arm), (case,))
        return cls(real, case, beams_of(real, (case,)), active_effects(real))

    def settled(self, q: Array) -> tuple[Deformed, Shape]:
        """The arm as it stands at poses q (N, n)."""
        return settled_shape(self._state(q), self.effects, len(q))

    def gone_on(self, last: Shape, q: Array) -> tuple[Shape, NDArray[np.bool_]]:
        """Its shape at poses q (N, n) by one pass from the `last` one, at poses nearby, and where that can be relied
        on (N,)."""
        return bent_on(last, self._state(q), self.effects, len(q))

    def _state(self, q: Array) -> PoseState:
        return solve(self.arm, [q[:, index] for index in range(self.arm.size)], self.beams, self.case)


def without_instrument(arm: Arm) -> Arm:
    """The arm without what belongs to the instrument that measured it."""
    return replace(
        arm, effects=tuple(entry for entry in arm.effects if not EFFECTS[entry.effect].recording.of_instrument)
    )


def corrected(arm: Arm, q: Array, payload: float) -> tuple[Array, Array, Array]:
    """The tip's error (N, 3) m at poses q (N, n), what to add to the joint coordinates (N, n) so that the tip comes to
    where it nominally is, the shortest such, and the length (N,) m of the error that is left with it.

    Least squares through the Jacobian, repeated on the true error where the last step still moved the tip; directions
    in which the drives hardly move the tip stay uncorrected, and passive joints and those that are held at one
    coordinate as they are.

    The shape is found together with the correction: each step goes on from the last one's by one pass, which brings it
    nearer by about as much as the step brings the tip. Where that comes to no rest, or play that the load seats would
    lie elsewhere, the shape is found anew at each step.
    """
    model = _Model.of(arm, payload)
    stands, shape = model.settled(q)
    error = stands.tip
    # Between two shapes, play does not lie where the last of them has it.
    steady = np.linalg.norm(error - shape.tip, axis=1) <= SETTLED

    def gone_on(there: Array, kept: NDArray[np.intp]) -> tuple[Array, NDArray[np.bool_]]:
        nonlocal shape, steady
        steady = steady[kept]
        shape, sure = model.gone_on(shape.at(kept), there)
        return shape.tip, sure & steady

    def anew(there: Array, _: NDArray[np.intp]) -> tuple[Array, NDArray[np.bool_]]:
        return model.settled(there)[0].tip, np.ones(len(there), dtype=bool)

    moved, left, rows = _brought_back(arm, q, error, gone_on, _STEPS_TOGETHER)
    if len(rows):
        again = _brought_back(arm, q[rows], error[rows], anew, _STEPS)
        moved[rows], left[rows], never = again
        left[rows[never]] = remaining(arm, q[rows[never]], moved[rows[never]], payload)
    return error, moved, left


def _brought_back(
    arm: Arm,
    q: Array,
    error: Array,
    error_at: Callable[[Array, NDArray[np.intp]], tuple[Array, NDArray[np.bool_]]],
    steps: int,
) -> tuple[Array, Array, NDArray[np.intp]]:
    """What to add to the coordinates q (N, n) whose tips are off by `error` (N, 3) m, the error (N,) that is left, and
    the rows that have not come to rest. `error_at` is asked at poses that come nearer and nearer, those of them that
    are `kept` since the last time, and says too where its answer can be relied on."""
    drives = np.array([not joint.passive and moves(joint) for joint in arm.joints])
    goal, missing, expected = tip_position(arm, q), -error, np.zeros_like(error)
    moved, left, earlier, factor = np.zeros_like(q), np.zeros(len(q)), np.linalg.norm(error, axis=1), np.ones(len(q))
    rows, kept, sure = np.arange(len(q)), np.arange(len(q)), np.ones(len(q), dtype=bool)
    for number in range(steps):
        there = q[rows] + moved[rows]
        if number:
            result, sure = error_at(there, kept)
            missing = goal[rows] - tip_position(arm, there) - result
        if not np.isfinite(missing).all():  # it is bent beyond all numbers
            break
        step, brought = _least_squares(jacobian(arm, there) * drives[:, None], missing)
        unforeseen, expected = np.linalg.norm(missing - expected, axis=1), missing - brought
        moved[rows] += step
        left[rows] = np.linalg.norm(expected, axis=1)
        # What is unforeseen falls from step to step by a factor; a single one may be small by chance.
        factor, slower = np.minimum(unforeseen / np.maximum(earlier, _ARRIVED), 1.0), factor
        kept = np.flatnonzero((unforeseen * np.maximum(factor, slower) > _ARRIVED) | ~sure)
        rows, expected, earlier, factor = rows[kept], expected[kept], unforeseen[kept], factor[kept]
        if not len(rows):
            break
    return moved, left, rows


def _least_squares(slope: Array, wanted: Array) -> tuple[Array, Array]:
    """The shortest steps (N, n) that bring the tip nearest to what is `wanted` (N, 3) m by the slopes (N, n, 3), and
    what they bring (N, 3), without the directions in which the slopes hardly lead anywhere."""
    square, axes = np.linalg.eigh(np.swapaxes(slope, 1, 2) @ slope)
    worth = square > _SMALLEST**2 * square[:, -1:]
    along = np.where(worth, np.einsum("nji,nj->ni", axes, wanted), 0.0)
    brought = np.einsum("nij,nj->ni", axes, along)
    weights = np.einsum("nij,nj->ni", axes, along / np.where(worth, square, 1.0))
    return np.einsum("nij,nj->ni", slope, weights), brought


def remaining(arm: Arm, q: Array, correction: Array, payload: float) -> Array:
    """The length (N,) m of the error that is left with joint corrections (N, n) added."""
    reached = tip_position(arm, q + correction) + model_error(arm, q + correction, payload)
    return np.linalg.norm(reached - tip_position(arm, q), axis=1)


def default_grid(joints: int, payloads: int = 1) -> int:
    """How many coordinates of each joint make a table of useful size."""
    finest = int((_MOST_DEFAULT / payloads) ** (1.0 / joints) + 1e-9)
    return max(2, min(_FINEST_DEFAULT, finest))


def grid_axes(arm: Arm, points: int) -> tuple[Array, ...]:
    """Evenly spaced coordinates over each joint's range (rad, m); one of a joint that only follows others, or is held
    there."""
    return tuple(
        np.linspace(*joint.range, points) if moves(joint) else np.array([sum(joint.range) / 2.0])
        for joint in arm.joints
    )


def moves(joint: Joint) -> bool:
    """Whether a joint has an independent coordinate, which can change."""
    return joint.driven and joint.range[1] > joint.range[0]


def table_at(arm: Arm, q: Array, payloads: tuple[float, ...], heard: Heard | None = None) -> Table:
    """The table at poses of one's own (N, n), for each payload (kg); `heard` hears how many of all rows are done."""
    parts: list[tuple[Array, Array, Array]] = []
    total = len(payloads) * len(q)
    for number, mass in enumerate(payloads):
        for start in range(0, len(q), _AT_ONCE):
            some = q[start : start + _AT_ONCE]
            parts.append(corrected(arm, some, mass))
            if heard is not None:
                heard(number * len(q) + start + len(some), total)
    error, correction, left = (np.concatenate([part[k] for part in parts]) for k in range(3))
    poses, masses = np.tile(q, (len(payloads), 1)), np.repeat(np.array(payloads), len(q))
    return Table(arm, poses, masses, error, correction, left, None, None)


def table_over(arm: Arm, points: int, payloads: tuple[float, ...], heard: Heard | None = None) -> Table:
    """The table over a grid of so many points for each joint, checked between them; `heard` as in `table_at`."""
    axes = grid_axes(arm, points)
    q = np.stack([item.reshape(-1) for item in np.meshgrid(*axes, indexing="ij")], axis=1)
    table = table_at(arm, completed(arm, q), payloads, heard)
    return replace(table, axes=axes, check=_checked(table, axes, len(q), payloads))


def _checked(table: Table, axes: tuple[Array, ...], size: int, payloads: tuple[float, ...]) -> Check:
    arm = table.arm
    lower, upper = (np.array([axis[end] for axis in axes]) for end in (0, -1))
    q = completed(arm, spread(lower, upper, _CHECKED))
    varied = [index for index, joint in enumerate(arm.joints) if moves(joint)]
    grid, shape = tuple(axes[index] for index in varied), tuple(len(axes[index]) for index in varied)
    checks: list[tuple[Array, Array, Array]] = []
    for number, mass in enumerate(payloads):
        part = slice(number * size, (number + 1) * size)
        error = model_error(arm, q, mass)
        interpolated = RegularGridInterpolator(grid, table.error[part].reshape(*shape, 3))(q[:, varied])
        moved = RegularGridInterpolator(grid, table.correction[part].reshape(*shape, arm.size))(q[:, varied])
        lengths = [np.linalg.norm(item, axis=1) for item in (error, error - interpolated)]
        checks.append((lengths[0], lengths[1], remaining(arm, q, moved, mass)))
    without, subtracted, corrected = (np.concatenate([check[k] for check in checks]) for k in range(3))

    def rms(values: Array) -> float:
        return math.sqrt(float(np.mean(values * values)))

    return Check(
        len(without),
        rms(without),
        float(without.max()),
        rms(subtracted),
        float(subtracted.max()),
        rms(corrected),
        float(corrected.max()),
    )
