"""How much of a box or a path an arm reaches within its joint ranges: places all over it, a pose searched for each.

What is certified of a workspace is certified of the poses that it has. A hole in a box, or in a path between the points
at which it is sampled, has none and would pass without a word.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from sections.numeric import Array

from .workspace import TipFunction, Workspace, pull, spread

_ALONG = 241
"""Places along a path, over all its segments, beside its vertices."""
_ACROSS = 25
"""Places along each side of a box in the plane."""
_IN_SPACE = 9
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
        place = ", ".join(f"{1e3 * x:.4g}" for x in self.point)
        away = f"at ({place}) mm the tip stays {1e3 * self.missing:.3g} mm away"
        return f"{100.0 * self.share:.2g} % of the {kind} cannot be reached ({away}); all figures are of the rest"


def unreached(workspace: Workspace, tip: TipFunction, lower: Array, upper: Array) -> Unreached | None:
    """What of a box or path no pose within the joint box reaches, as far as a search tells; None where all is reached,
    and for joint ranges. `tip` maps poses (N, n) to nominal tips (N, 3), m."""
    if workspace.kind == "joints":
        return None
    places, weights = _places(workspace)
    used = np.array([1.0, 1.0, 0.0 if workspace.in_plane else 1.0])
    q = spread(lower, upper, _POSES)
    tips = tip(q) * used
    distances = [((tips - place) ** 2).sum(axis=1) for place in places * used]
    starts = np.vstack([q[np.argpartition(each, _NEAREST)[:_NEAREST]] for each in distances])
    _, miss = pull(tip, starts, np.repeat(places, _NEAREST, axis=0), lower, upper, used)
    missing = miss.reshape(len(places), -1).min(axis=1)
    stubborn = np.flatnonzero(missing > _REACHED)
    if len(stubborn):
        again = np.tile(q[:_FURTHER], (len(stubborn), 1))
        _, miss = pull(tip, again, np.repeat(places[stubborn], _FURTHER, axis=0), lower, upper, used)
        missing[stubborn] = np.minimum(missing[stubborn], miss.reshape(len(stubborn), -1).min(axis=1))
    worst = int(missing.argmax())
    if missing[worst] <= _REACHED:
        return None
    point = places[worst][: 2 if workspace.in_plane else 3]
    share = float(weights[missing > _REACHED].sum() / weights.sum())
    return Unreached(share, tuple(point.tolist()), float(missing[worst]))


def _places(workspace: Workspace) -> tuple[Array, Array]:
    """Places (N, 3) all over a box or along a path, its corners or vertices among them, and how much each counts."""
    points = np.array(workspace.points)
    if workspace.kind == "box":
        low, high = points.min(axis=0), points.max(axis=0)
        count = _ACROSS if workspace.in_plane else _IN_SPACE
        sides = [np.linspace(a, b, count) if b > a else np.array([a]) for a, b in zip(low, high, strict=True)]
        # Places on the edge stand for half as much as those inside.
        shares = [np.where((side == side[0]) | (side == side[-1]), 0.5, 1.0) for side in sides]
        weights = np.prod(np.meshgrid(*shares, indexing="ij"), axis=0).ravel()
        return np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 3), weights
    lengths = [math.dist(a, b) for a, b in itertools.pairwise(points)]
    found = [points]
    for (a, b), length in zip(itertools.pairwise(points), lengths, strict=True):
        share = np.linspace(0.0, 1.0, 2 + round(_ALONG * length / (sum(lengths) or 1.0)))[1:-1, None]
        found.append(a + share * (b - a))
    places = np.vstack(found)
    return places, np.ones(len(places))
