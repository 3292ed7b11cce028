"""How much of a box or a path an arm reaches within its joint ranges: places all over it, a pose searched for each.

What is certified of a workspace is certified of the poses that it has. A hole in a box, or in a path between the points
at which it is sampled, has none and would pass without a word.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array

from .workspace import Motion, Workspace, pull, spread

_ALONG = 241
"""Places along a path, over all its segments, beside its vertices."""
_ACROSS = 25
"""Places along each side of a box in the plane."""
_IN_SPACE = 9
_FINER = 4
"""Along its edges a box has so many times as many: there a hole begins."""
_POSES = 4096
_NEAREST, _FURTHER = 4, 32
"""Poses with the nearest tips from which a place is tried; poses all over from which a stubborn one is."""
_REACHED = 1e-7


@dataclass(frozen=True)
class Unreached:
    """The share of a box or path without a pose, and the place of it that tips stay farthest from: `point` and
    `missing`, m."""

    share: float
    point: tuple[float, ...]
    missing: float

    def text(self, kind: str) -> str:
        """One line for people; `kind` is the workspace's."""
        return f"{self.where(kind)}; all figures are of the rest"

    def where(self, kind: str) -> str:
        """What of a workspace of that kind, and where most is missing, as a phrase."""
        place = ", ".join(f"{1e3 * x:.4g}" for x in self.point)
        away = f"at ({place}) mm the tip stays {1e3 * self.missing:.3g} mm away"
        part = f"{100.0 * self.share:.{2 if self.share < 0.1 else 3}g} %"
        return f"{part} of the {kind} cannot be reached ({away})"


def unreached(workspace: Workspace, motion: Motion, lower: Array, upper: Array) -> Unreached | None:
    """What of a box or path no pose within the joint box reaches, as far as a search tells; None where all is reached,
    and for joint coordinates. `motion` maps poses (N, n) to nominal tips and their slopes."""
    return reached(workspace, motion, lower, upper)[1] if workspace.in_space else None


def reached(
    workspace: Workspace, motion: Motion, lower: Array, upper: Array, *, near: Array | None = None
) -> tuple[Array, Unreached | None]:
    """Poses (N, n) for places all over a box or path, as near as any where a place has none, and what is `unreached`.

    `near` are those of an arm like this one, from which places are tried first.
    """
    places, weights = _places(workspace)
    used = np.array([1.0, 1.0, 0.0 if workspace.in_plane else 1.0])
    q = spread(lower, upper, _POSES)
    poses, missing = np.tile(q[0], (len(places), 1)), np.full(len(places), np.inf)

    def try_from(left: NDArray[np.intp], starts: Array) -> None:
        """Pull poses (N, starts, n) onto the places left; what comes nearer is kept."""
        count = starts.shape[1]
        pulled, miss = pull(
            motion, starts.reshape(-1, q.shape[1]), np.repeat(places[left], count, axis=0), lower, upper, used
        )
        best = miss.reshape(-1, count).argmin(axis=1)
        pulled, miss = pulled.reshape(starts.shape)[range(len(left)), best], miss.reshape(-1, count).min(axis=1)
        nearer = miss < missing[left]
        poses[left[nearer]], missing[left[nearer]] = pulled[nearer], miss[nearer]

    if near is not None:
        try_from(np.arange(len(places)), near[:, None])
    left = np.flatnonzero(missing > _REACHED)
    if len(left):
        tips = motion(q)[0] * used
        distances = (((tips - place) ** 2).sum(axis=1) for place in places[left] * used)
        try_from(left, np.stack([q[np.argpartition(distance, _NEAREST)[:_NEAREST]] for distance in distances]))
    left = np.flatnonzero(missing > _REACHED)
    if len(left):
        try_from(left, np.tile(q[:_FURTHER], (len(left), 1, 1)))
    worst = int(missing.argmax())
    if missing[worst] <= _REACHED:
        return poses, None
    point = places[worst][: 2 if workspace.in_plane else 3]
    share = float(weights[missing > _REACHED].sum() / weights.sum())
    return poses, Unreached(share, tuple(point.tolist()), float(missing[worst]))


def _places(workspace: Workspace) -> tuple[Array, Array]:
    """Places (N, 3) all over a box or along a path, its corners or vertices among them, and how much each counts."""
    points = np.array(workspace.points)
    if workspace.kind == "box":
        return _places_in_box(points.min(axis=0), points.max(axis=0), in_plane=workspace.in_plane)
    lengths = [math.dist(a, b) for a, b in workspace.pieces]
    results = [points]
    for (a, b), length in zip(np.array(workspace.pieces), lengths, strict=True):
        share = np.linspace(0.0, 1.0, 2 + round(_ALONG * length / (sum(lengths) or 1.0)))[1:-1, None]
        results.append(a + share * (b - a))
    places = np.vstack(results)
    return places, np.ones(len(places))


def _places_in_box(low: Array, high: Array, *, in_plane: bool) -> tuple[Array, Array]:
    """A grid over a box and a finer one along its edges: the places (N, 3), and how much each counts."""
    count = _ACROSS if in_plane else _IN_SPACE
    wide = [int(axis) for axis in np.flatnonzero(high > low)]
    sides = [np.linspace(a, b, count if b > a else 1) for a, b in zip(low, high, strict=True)]
    grid = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 3)
    # Places on a side stand for half as much as those inside, those along an edge for the less as they are closer.
    ends = ((grid == low) | (grid == high))[:, wide].sum(axis=1)
    places, weights = [grid], [np.where(ends >= len(wide) - 1, 1.0 / _FINER, 1.0) * 0.5**ends]
    for axis in wide:
        others = [item for item in wide if item != axis]
        steps = np.linspace(low[axis], high[axis], _FINER * (count - 1) + 1)
        for corner in itertools.product(*[(low[item], high[item]) for item in others]):
            edge = np.tile(low, (len(steps) - count, 1))
            edge[:, others], edge[:, axis] = corner, steps[np.arange(len(steps)) % _FINER > 0]
            places.append(edge)
            weights.append(np.full(len(edge), 0.5 ** len(others) / _FINER))
    return np.vstack(places), np.concatenate(weights)
