"""Postures in which an arm touches the same point, plane or bar again, for simulated recordings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.arrays import jacobian, nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.following import completed
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .touched import touched_bars, touched_planes

_NEAR, _EXACT = 60, 8
"""Newton's steps by the nominal arm, and then by the whole model."""
_LONGEST, _MISSED = 0.3, 1e-7
"""rad or m, the longest step of a joint; m, how far off a touch may end."""
_ABOUT, _AROUND = 0.1, 0.15
"""Shares: of a bar's length, by which two tips may be farther or nearer than it; of the reach, what is around a tip."""
_INNER = (0.5, 0.75, 1.0)
"""Shares of the joint ranges about their middles from which bars may be reached, the first that will do: at the ends
of the ranges few postures reach a place."""
_POSTURES = 6
"""Postures to each point and bar; twice as many to each plane."""


@dataclass(frozen=True)
class Touches:
    """Which readings touch something, `keep` (N,), in postures `q` (N, n), which label (N,) they touch, and how far
    `along` its bar (N,), m."""

    keep: NDArray[np.bool_]
    q: Array
    label: NDArray[np.int64]
    count: int
    along: Array


def touched(
    arm: Arm,
    start: Array,
    visit: NDArray[np.int64],
    off: Array,
    true_tips: Callable[[Array], Array],
    random: np.random.Generator,
    *,
    planes: bool,
    bar: Sequence[float] = (),
    count: int | None = None,
    planned: NDArray[np.int64] | None = None,
    planned_along: Array | None = None,
    reached: bool = False,
) -> Touches:
    """Postures near `start` (N, n), alike for the readings of a `visit` (N,), in which the tips that `true_tips` gives
    for joints (N, n) touch points, planes, or bars at places `bar` along them, m, `off` (N, 3) m by what nobody can
    repeat. There are `count` of them (by default so many that each is touched some times), or those that `planned` (N,)
    numbers, which lie where the arm undeformed touches them, bars at `planned_along` (N,), m. Bars lie anyhow, or, so
    that both ends are `reached`, from where the arm stands at one `start` to another. Raises `InputError`."""
    targets = _targets(
        arm,
        start,
        visit,
        random,
        count or max(1, (int(visit.max()) + 1) // (2 * _POSTURES if planes else _POSTURES)),
        planes=planes,
        bar=bar,
        planned=planned,
        planned_along=planned_along,
        reached=reached,
    )
    q, good = _approached(arm, start, targets, off, true_tips, planes=planes)
    good &= np.bincount(visit, weights=~good)[visit] == 0
    if planned is not None and not good.all():
        where = int(visit[~good][0]) + 1
        raise InputError("", "at", f"names a posture (visit {where}) from which what it touches cannot be reached")
    label, least = targets.label, least_touches(planes=planes, flat=arm.planar())
    for one in range(targets.count if planned is None else 0):
        rows = good & (label == one)
        if len(np.unique(visit[rows])) < least or len(np.unique(targets.along[rows])) < min(2, max(len(bar), 1)):
            good &= label != one
    if not good.any():
        what = "plane" if planes else "bar" if len(bar) else "point"
        raise InputError(
            "", "observe", f"no {what} could be touched from {least} postures within the joint ranges; try more poses"
        )
    kept, renumbered = np.unique(label[good], return_inverse=True)
    label[good] = renumbered.reshape(-1)
    return Touches(good, q, label, len(kept), targets.along)


@dataclass(frozen=True)
class _Targets:
    """What is touched: a point and a direction (count, 3) of each thing, which one a reading touches, `label` (N,), and
    how far `along` its bar and `from_middle` of that (N,), m."""

    points: Array
    directions: Array
    label: NDArray[np.int64]
    along: Array
    from_middle: Array

    @property
    def count(self) -> int:
        """How many things there are."""
        return len(self.points)


def _targets(
    arm: Arm,
    start: Array,
    visit: NDArray[np.int64],
    random: np.random.Generator,
    count: int,
    *,
    planes: bool,
    bar: Sequence[float],
    planned: NDArray[np.int64] | None,
    planned_along: Array | None,
    reached: bool,
) -> _Targets:
    """`count` things about where postures of random joint coordinates have the tip, or those that are `planned`."""
    flat = arm.planar()
    label = (visit % count).astype(np.int64)
    if planned is not None:
        label, count = planned.copy(), int(planned.max()) + 1
    low, high = _ranges(arm)
    middle = completed(arm, low + (high - low) * random.uniform(0.3, 0.7, (count, arm.size)))
    points, _ = nominal(arm, middle, 3)
    directions = _normals(count, random, flat=flat)
    if planned is not None:
        there = nominal(arm, start, 3)[0]
        fitted, offsets, _ = touched_planes(there, planned, count, flat=flat)
        middles = np.stack([there[planned == one].mean(axis=0) for one in range(count)])
        directions, points = (fitted, offsets[:, None] * fitted) if planes else (directions, middles)
    places = np.array(bar) if len(bar) else np.zeros(1)
    if reached and len(bar):
        middle = 0.5 * (low + high)
        clouds = [nominal(arm, completed(arm, middle + share * (start - middle)), 3)[0] for share in _INNER]
        points, directions = _within_reach(clouds, float(np.ptp(places)), count, random)
        points = points + (places.mean() - 0.5 * (places.min() + places.max())) * directions
    along = places[(visit // count) % len(places)]
    from_middle = along - places.mean()
    if planned is not None and planned_along is not None:
        along = planned_along
        points, directions, from_middle = touched_bars(nominal(arm, start, 3)[0], planned, along, count)
    return _Targets(points, directions, label, along, from_middle)


def _approached(
    arm: Arm, start: Array, targets: _Targets, off: Array, true_tips: Callable[[Array], Array], *, planes: bool
) -> tuple[Array, NDArray[np.bool_]]:
    """The postures (N, n) in which tips touch what they are to, by Newton's steps, and which (N,) do."""
    low, high = _ranges(arm)
    width = 2 if arm.planar() else 3
    across = targets.directions[targets.label]
    # Bars lie along what stands across planes, each about where one posture has the tip.
    goal = targets.points[targets.label] + targets.from_middle[:, None] * across

    def missed(tips: Array) -> Array:
        away = tips + off - goal
        return np.sum(away * across, axis=1)[:, None] if planes else away[:, :width]

    q = start.copy()
    for step in range(_NEAR + _EXACT):
        tips = nominal(arm, q, 3)[0] if step < _NEAR else true_tips(q)
        slopes = np.swapaxes(jacobian(arm, q), 1, 2)
        slopes = np.einsum("na,nak->nk", across, slopes)[:, None] if planes else slopes[:, :width]
        moved = -np.einsum("nkm,nm->nk", np.linalg.pinv(slopes, rcond=1e-3), missed(tips))
        longest = np.maximum(np.abs(moved).max(axis=1, keepdims=True), 1e-300)
        q = completed(arm, np.clip(q + moved * np.minimum(1.0, _LONGEST / longest), low, high))
    return q, np.abs(missed(true_tips(q))).max(axis=1) < _MISSED


def _ranges(arm: Arm) -> tuple[Array, Array]:
    """The least and the greatest coordinate of each joint."""
    low, high = (np.array([joint.range[end] for joint in arm.joints]) for end in (0, 1))
    return low, high


def _within_reach(
    clouds: Sequence[Array], length: float, count: int, random: np.random.Generator
) -> tuple[Array, Array]:
    """Where bars of a length, m, may lie for the arm to touch both ends: their middles and which way they point (unit),
    (count, 3), from one tip (N, 3) to another that is about as far, drawn among those with most tips around both;
    of the first of some clouds of tips that has such. Raises `InputError`."""
    for tips in clouds:
        away = np.linalg.norm(tips[:, None] - tips[None], axis=2)
        first, last = np.nonzero(np.triu(np.abs(away - length) <= _ABOUT * length, k=1))
        if len(first):
            break
    else:
        raise InputError("", "bar", "is longer than the arm reaches from one posture to another; take a shorter one")
    around = np.sum(away < _AROUND * float(np.linalg.norm(np.ptp(tips, axis=0))), axis=1)
    best = np.argsort(-np.minimum(around[first], around[last]), kind="stable")[: max(count, len(first) // 2)]
    drawn = best[random.permutation(len(best))][np.arange(count) % len(best)]
    one, other = tips[first[drawn]], tips[last[drawn]]
    return 0.5 * (one + other), (other - one) / np.linalg.norm(other - one, axis=1)[:, None]


def least_touches(*, planes: bool, flat: bool) -> int:
    """From how many postures a point or a plane has to be touched to tell anything."""
    return (3 if flat else 4) if planes else 2


def _normals(count: int, random: np.random.Generator, *, flat: bool) -> Array:
    """Planes that stand level and upright in turn, a little askew."""
    axes: Sequence[int] = (1, 0) if flat else (2, 0, 1)
    normals = np.eye(3)[[axes[k % len(axes)] for k in range(count)]] + 0.1 * random.standard_normal((count, 3))
    if flat:
        normals[:, 2] = 0.0
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)
