"""Postures in which an arm touches the same point, plane or bar again, for simulated recordings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.chain.arrays import nominal
from arm.chain.chain import Arm
from arm.chain.following import completed
from arm.chain.jacobian import jacobian
from sections.numeric import Array
from units.quantities import InputError

from .view import touched_planes

_NEAR, _EXACT = 60, 8
"""Newton's steps by the nominal arm, and then by the whole model."""
_LONGEST, _MISSED = 0.3, 1e-7
"""rad or m, the longest step of a joint; m, how far off a touch may end."""
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
) -> Touches:
    """Postures near `start` (N, n), alike for the readings of a `visit` (N,), in which the tips that `true_tips` gives
    for joints (N, n) touch points, planes, or bars at places `bar` along them, m, `off` (N, 3) m by what nobody can
    repeat. There are `count` of them (by default so many that each is touched some times), or those that `planned` (N,)
    numbers, which lie where the arm undeformed touches them. Raises `InputError`."""
    visits = int(visit.max()) + 1
    flat = arm.planar()
    count = count or max(1, visits // (2 * _POSTURES if planes else _POSTURES))
    label = (visit % count).astype(np.int64)
    if planned is not None:
        label, count = planned.copy(), int(planned.max()) + 1
    low, high = (np.array([joint.range[end] for joint in arm.joints]) for end in (0, 1))
    middle = completed(arm, low + (high - low) * random.uniform(0.3, 0.7, (count, arm.size)))
    points, _ = nominal(arm, middle, 3)
    normals = _normals(count, random, flat=flat)
    if planned is not None:
        there = nominal(arm, start, 3)[0]
        fitted, offsets, _ = touched_planes(there, planned, count, flat=flat)
        middles = np.stack([there[planned == one].mean(axis=0) for one in range(count)])
        normals, points = (fitted, offsets[:, None] * fitted) if planes else (normals, middles)
    places = np.array(bar) if len(bar) else np.zeros(1)
    along = places[(visit // count) % len(places)]
    # Bars lie along what stands across planes, each about where one posture has the tip.
    goal = points[label] + (along - places.mean())[:, None] * normals[label]

    def missed(tips: Array) -> Array:
        away = tips + off - goal
        return np.sum(away * normals[label], axis=1)[:, None] if planes else away[:, : 2 if flat else 3]

    q = start.copy()
    for step in range(_NEAR + _EXACT):
        tips = nominal(arm, q, 3)[0] if step < _NEAR else true_tips(q)
        slopes = np.swapaxes(jacobian(arm, q), 1, 2)
        slopes = np.einsum("na,nak->nk", normals[label], slopes)[:, None] if planes else slopes[:, : 2 if flat else 3]
        moved = -np.einsum("nkm,nm->nk", np.linalg.pinv(slopes, rcond=1e-3), missed(tips))
        longest = np.maximum(np.abs(moved).max(axis=1, keepdims=True), 1e-300)
        q = completed(arm, np.clip(q + moved * np.minimum(1.0, _LONGEST / longest), low, high))
    good = np.abs(missed(true_tips(q))).max(axis=1) < _MISSED
    good &= np.bincount(visit, weights=~good)[visit] == 0
    least = least_touches(planes=planes, flat=flat)
    if planned is not None and not good.all():
        where = int(visit[~good][0]) + 1
        raise InputError("", "at", f"names a posture (visit {where}) from which what it touches cannot be reached")
    for one in range(count if planned is None else 0):
        own = good & (label == one)
        if len(np.unique(visit[own])) < least or len(np.unique(along[own])) < min(2, len(places)):
            good &= label != one
    if not good.any():
        what = "plane" if planes else "bar" if len(bar) else "point"
        raise InputError(
            "", "observe", f"no {what} could be touched from {least} postures within the joint ranges; try more poses"
        )
    kept, renumbered = np.unique(label[good], return_inverse=True)
    label[good] = renumbered.reshape(-1)
    return Touches(good, q, label, len(kept), along)


def least_touches(*, planes: bool, flat: bool) -> int:
    """From how many postures a point or a plane has to be touched to tell anything."""
    return (3 if flat else 4) if planes else 2


def _normals(count: int, random: np.random.Generator, *, flat: bool) -> Array:
    """Planes that stand level and upright in turn, a little askew."""
    axes: Sequence[int] = (1, 0) if flat else (2, 0, 1)
    found = np.eye(3)[[axes[k % len(axes)] for k in range(count)]] + 0.1 * random.standard_normal((count, 3))
    if flat:
        found[:, 2] = 0.0
    return found / np.linalg.norm(found, axis=1, keepdims=True)
