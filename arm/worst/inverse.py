"""Inverse kinematics: the poses that put the tip where it is wanted.

By damped least squares from many seeds (Levenberg-Marquardt; Wampler 1986, IEEE Trans. SMC 16, 93-101), clipped to the
joint limits.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.branches import Way, way_to
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.vectors import Rotation
from linkwright.core.sections.numeric import Array

from .workspace import Unreachable, Workspace, climbing_bounds, joint_box, spread, wrapped

_REACHED = 1e-9
"""A pose whose tip lies within this distance of the target (m, and rad times the arm's size) meets it."""
_APART = 1e-3
"""Solutions that differ by less than this in every joint (rad, m) are one."""
_RANK = 1e-7
"""A direction in which the tip follows the joints by less than this, over the arm's size, is none."""
_SINGULAR = 1e-3
"""A pose whose tip follows the joints in one direction this much less than in the best is called singular: the search
comes to a singular pose no closer than the root of its tolerance, 3e-5."""


class UnreachableInclined(Unreachable):
    """The tip cannot stand at a point under the orientation asked for; at another orientation it may."""

    def __init__(self, point: tuple[float, ...], missing: float, orientation: str) -> None:
        """`point` and `missing` in m; `orientation` in words."""
        super().__init__(point, missing)
        place_ = ", ".join(f"{1e3 * x:.4g}" for x in point)
        self.orientation = orientation
        self.args = (
            f"the point ({place_}) mm cannot be reached {orientation}: the tip stays {1e3 * missing:.4g} mm away",
        )


@dataclass(frozen=True)
class InversePose:
    """A pose that meets a target: joint coordinates (rad, m), and how far its tip still is from it (m).

    `isolated`: no motion of the joints leaves the tip where it is; otherwise the pose is one of a family.
    `singular`: the tip can be moved in fewer directions than elsewhere, as at full stretch.
    """

    q: tuple[float, ...]
    residual: float
    isolated: bool
    singular: bool


def inverse(
    arm: Arm,
    point: Sequence[float],
    orientation: Rotation | None = None,
    *,
    seeds: int = 64,
    most: int = 16,
) -> tuple[InversePose, ...]:
    """The distinct poses found, within the joint limits, whose tip stands at a point, and under an orientation if any.

    `point` (m) has two components (z is then 0) or three, in the base frame; `orientation` is the rotation matrix of
    the last link's frame. `seeds` low-discrepancy starting poses are followed; at most `most` poses are returned, those
    nearest mid-range first. An arm with more joints than the target asks for has a continuum of them: samples of it
    are returned. Of several arms on one torso the tip's joints are sought, those of the others stand in the middle
    of their ranges. Raises `Unreachable` (with an orientation `UnreachableInclined`) with the least distance found, m.
    """
    if arm.branches:
        way = way_to(arm, arm.tip)
        poses = inverse(way.arm, point, orientation, seeds=seeds, most=most)
        return tuple(replace(pose, q=_among_others(arm, way, pose.q)) for pose in poses)
    target = np.array([*(float(value) for value in point), 0.0][:3])
    lower, upper = joint_box(arm, Workspace())
    bounds = climbing_bounds(arm, lower, upper)
    size = _size_of(arm)
    q, miss = damped(arm, spread(lower, upper, seeds), target, orientation, bounds)
    distance = np.sqrt((miss * miss).sum(axis=1))
    met = distance <= max(_REACHED, 1e-9 * size)
    if not met.any():
        shown = tuple(target[: len(point)].tolist())
        if orientation is None:
            raise Unreachable(shown, float(distance.min()))
        beside = np.sqrt((miss[:, :3] ** 2).sum(axis=1))
        raise UnreachableInclined(shown, float(beside[np.argmin(distance)]), "under the orientation asked for")
    solutions = wrapped(arm, q[met], lower, upper)
    residual = np.sqrt((miss[met][:, :3] ** 2).sum(axis=1))
    middle = 0.5 * (lower + upper)
    distinct: list[int] = []
    for index in np.argsort(np.abs(solutions - middle).sum(axis=1)):
        if all(_apart(arm, solutions[index], solutions[other]) for other in distinct):
            distinct.append(int(index))
        if len(distinct) == most:
            break
    moves = upper > lower  # what is held at one coordinate, or only follows, moves nothing by itself
    here = np.linalg.svd(_jacobian(arm, solutions[distinct], orientation is not None, size) * moves, compute_uv=False)
    anywhere = np.linalg.svd(_jacobian(arm, q, orientation is not None, size) * moves, compute_uv=False)
    usual = int((anywhere > _RANK * size).sum(axis=1).max())
    return tuple(
        InversePose(
            tuple(solutions[index].tolist()),
            float(residual[index]),
            isolated=int((values > _RANK * size).sum()) == int(moves.sum()),
            singular=usual > 0 and bool(values[usual - 1] < _SINGULAR * values[0]),
        )
        for index, values in zip(distinct, here, strict=True)
    )


def _among_others(arm: Arm, way: Way, q: Sequence[float]) -> tuple[float, ...]:
    """A pose of the arm to one tip as one of the whole, the other arms in the middle of their ranges."""
    whole = [0.5 * (low + high) for low, high in (joint.range for joint in arm.joints)]
    for joint, value in zip(way.joints, q, strict=True):
        whole[joint] = value
    return tuple(whole)


def damped(
    arm: Arm,
    starts: Array,
    target: Array,
    orientation: Rotation | None,
    bounds: tuple[Array, Array],
    steps: int = 120,
) -> tuple[Array, Array]:
    """Damped least squares from every row of `starts` (N, n) at once, clipped to `bounds` (rad, m).

    `target` is (3,) or (N, 3) in m. Returns the poses (N, n) and what they miss (N, 3 or 6): metres, then radians
    times the arm's size, so that both weigh alike.
    """
    lower, upper = bounds
    inclined, size = orientation is not None, _size_of(arm)
    aim = None if orientation is None else np.array(orientation, dtype=float)
    q = np.clip(starts, lower, upper)
    damping = np.full(len(q), 1e-3)
    miss = _missing(arm, q, target, aim, size)
    square = (miss * miss).sum(axis=1)
    for _ in range(steps):
        slope = _jacobian(arm, q, inclined, size)
        uphill = np.einsum("nij,ni->nj", slope, miss)
        held = ((q <= lower) & (uphill < 0.0)) | ((q >= upper) & (uphill > 0.0))
        slope = slope * ~held[:, None, :]
        normal = np.einsum("nij,nkj->nik", slope, slope)
        weight = damping * (np.einsum("nii->n", normal) + 1e-30)
        solved = np.linalg.solve(normal + weight[:, None, None] * np.eye(miss.shape[1]), miss[:, :, None])
        step = np.clip(np.einsum("nij,nik->nj", slope, solved), -0.5, 0.5)
        trial = np.clip(q + step, lower, upper)
        new_miss = _missing(arm, trial, target, aim, size)
        new_square = (new_miss * new_miss).sum(axis=1)
        better = new_square < square
        damping = np.where(better, np.maximum(0.1 * damping, 1e-15), np.minimum(10.0 * damping, 1e3))
        q = np.where(better[:, None], trial, q)
        miss, square = np.where(better[:, None], new_miss, miss), np.where(better, new_square, square)
        if np.all((square < (1e-12 * size) ** 2) | (damping >= 1e3)):
            break
    return q, miss


def _size_of(arm: Arm) -> float:
    return max(sum(arm.lengths), 1e-3)


def _missing(arm: Arm, q: Array, target: Array, aim: Array | None, size: float) -> Array:
    tip, turned = nominal(arm, q)
    if aim is None:
        return target - tip
    return np.concatenate([target - tip, size * _rotation_vector(aim @ np.swapaxes(turned, 1, 2))], axis=1)


def _rotation_vector(turn: Array) -> Array:
    """The rotation vectors (N, 3) of rotation matrices (N, 3, 3), rad."""
    skew = 0.5 * np.stack(
        [turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]], axis=1
    )
    sine = np.sqrt((skew * skew).sum(axis=1))
    angle = np.arctan2(sine, 0.5 * (np.einsum("nii->n", turn) - 1.0))
    vector = skew * np.where(sine > 1e-9, angle / np.where(sine > 1e-9, sine, 1.0), 1.0)[:, None]
    # Near half a turn the skew part vanishes: the axis is then the column of (R + I)/2 with the largest diagonal.
    flipped = (sine <= 1e-9) & (angle > 1.0)
    if flipped.any():
        outer = 0.5 * (turn[flipped] + np.eye(3))
        column = np.argmax(np.einsum("nii->ni", outer), axis=1)
        axis = outer[np.arange(len(outer)), :, column]
        vector[flipped] = math.pi * axis / np.sqrt((axis * axis).sum(axis=1))[:, None]
    return vector


def _jacobian(arm: Arm, q: Array, inclined: bool, size: float) -> Array:
    """How tip (and orientation, weighted) follow the joints, (N, 3 or 6, n), by central differences."""
    step, count = 1e-6, len(q)
    shifts = step * np.eye(arm.size)
    moved = np.concatenate([q[:, None, :] + shifts, q[:, None, :] - shifts], axis=1)
    tip, turned = nominal(arm, moved.reshape(-1, arm.size))
    tip = tip.reshape(count, 2, arm.size, 3)
    slope = np.swapaxes(tip[:, 0] - tip[:, 1], 1, 2) / (2.0 * step)
    if not inclined:
        return slope
    ahead, behind = np.moveaxis(turned.reshape(count, 2, arm.size, 3, 3), 1, 0)
    relative = (ahead @ np.swapaxes(behind, 2, 3)).reshape(-1, 3, 3)
    turning = _rotation_vector(relative).reshape(count, arm.size, 3) / (2.0 * step)
    return np.concatenate([slope, size * np.swapaxes(turning, 1, 2)], axis=1)


def _apart(arm: Arm, one: Array, other: Array) -> bool:
    turns = np.array([joint.revolute for joint in arm.joints])
    gap = np.abs(one - other)
    return bool(np.any(np.where(turns, np.minimum(gap, np.abs(2.0 * math.pi - gap)), gap) > _APART))
