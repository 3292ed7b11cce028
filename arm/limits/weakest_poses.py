"""The poses at which links are stressed and pressed most: climbed to from the best of a scan, as a scan stops short.

A scan of 2,000 poses understates a greatest stress by some tenths of a per cent: enough to break a limit by.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.worst.refine import wander_in_region
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import climbing_bounds, wrapped
from linkwright.core.sections.numeric import Array

Ids = NDArray[np.int_]

_THE_SAME = 1e-9
"""Figures that differ by less than this share differ by rounding."""
_FIRST_STEP, _LAST_STEP = 0.1, 1e-5
_MOST_STEPS = 120


def climbed(
    search: WorstSearch, loads: Callable[[Array], Array], poses: Array, p: Array, climbs: int, *, least: float = 0.0
) -> Array:
    """Poses (M, n) of the workspace where each of some loads (N, K) of poses (N, n) is locally greatest, climbed to
    from the best of `poses`. Loads that exceed `least` at none of them are left out."""
    known = loads(poses)
    order = np.argsort(-known, axis=0, kind="stable")[:climbs]
    columns = np.flatnonzero(known.max(axis=0) > least)
    rows, starts = np.repeat(columns, len(order)), poses[order.T[columns].ravel()]
    if not len(rows):
        return poses[:0]

    def load(q: Array, climb: Ids | None = None) -> Array:
        """The load of poses q (N, n), each of a climb (N,); without those all climbs have equally many, in order."""
        of_poses = np.repeat(rows, len(q) // len(rows)) if climb is None else rows[climb]
        return loads(q)[np.arange(len(q)), of_poses]

    box = (search.lower, search.upper)
    if search.workspace.kind == "poses":
        return starts
    if search.workspace.in_space:
        return wander_in_region(load, starts, search.workspace, lambda q: search.motion(q, p), box)
    return wrapped(search.arm, compass(load, starts, climbing_bounds(search.arm, *box)), *box)


def plainest(load: Callable[[Array], Array], pose: Array, box: tuple[Array, Array]) -> Array:
    """The plainest pose (n,) within a box of joint coordinates that is as bad as one of its poses but for rounding:
    joints that do not count stand at zero, or as near to it as they come, and of two poses that mirror each other
    the one whose first joint is off to the positive side is reported. `load` (N,) of poses (N, n) is greatest where
    they are worst."""
    least = float(load(pose[None])[0]) * (1.0 - _THE_SAME)
    plain = pose.copy()
    for joint, nearest in enumerate(np.clip(0.0, *box).tolist()):
        trial = plain.copy()
        trial[joint] = nearest
        if float(load(trial[None])[0]) >= least:
            plain = trial
    moved = np.flatnonzero(plain)
    mirrored = -plain
    within = bool((box[0] <= mirrored).all() and (mirrored <= box[1]).all())
    if len(moved) and plain[moved[0]] < 0.0 and within and float(load(mirrored[None])[0]) >= least:
        plain = mirrored + 0.0
    return plain


def compass(
    value: Callable[[Array, Ids], Array], starts: Array, bounds: tuple[Array, Array], *, seed: int = 11
) -> Array:
    """Local maxima by compass search on all starts (N, n) at once, along axes turned at random (seeded) at each step.

    `value` takes trial poses (M, n), each of a start (M,). Bounds may be infinite.
    """
    generator = np.random.default_rng(seed)
    count, size = starts.shape
    best, known, step = starts.copy(), value(starts, np.arange(count)), np.full(count, _FIRST_STEP)
    for _ in range(_MOST_STEPS):
        frame = np.linalg.qr(generator.standard_normal((size, size)))[0]
        ways = np.vstack([frame, -frame, np.eye(size), -np.eye(size)])
        # Most climbs end long before the last.
        left = np.flatnonzero(step >= _LAST_STEP)
        if not len(left):
            break
        trial = np.clip(best[left, None, :] + step[left, None, None] * ways, *bounds)
        values = value(trial.reshape(-1, size), np.repeat(left, len(ways))).reshape(len(left), -1)
        top = values.argmax(axis=1)
        better = values.max(axis=1) > known[left]
        won = left[better]
        best[won], known[won] = trial[better, top[better]], values.max(axis=1)[better]
        step[left[~better]] *= 0.5
    return best
