"""Regions of space in the base frame: boxes along its axes, open on some sides where they are half-spaces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array

AXES = ("x", "y", "z")
_TOUCHES = 1e-9
"""m; a base that stands on a floor is not in it."""

Corner = tuple[float, float, float]


@dataclass(frozen=True)
class Region:
    """The points between two corners, m, in the base frame; infinite where it has no end. A half-space is a region with
    one finite end, whose face does not belong to it."""

    low: Corner
    high: Corner

    def crosses(self, start: Array, along: Array, radius: float = 0.0) -> NDArray[np.bool_]:
        """Whether cylinders (P,) have a point in it: their axes go from `start` (P, 3) by `along` (P, 3), m, and have
        this `radius`. Exact at a face; at an edge or corner of the region it may say so of one that just passes by."""
        length = np.linalg.norm(along, axis=1, keepdims=True)
        still = length <= 0.0
        cosine = np.where(still, 0.0, along / np.where(still, 1.0, length))
        # A disc across the axis reaches so far along x, y and z.
        reach = radius * np.sqrt(np.maximum(1.0 - cosine**2, 0.0))
        low, high = np.array(self.low), np.array(self.high)
        face = np.where(np.isinf(low) | np.isinf(high), _TOUCHES, 0.0)
        low, high = low - reach + face, high + reach - face
        parallel = np.abs(along) < 1e-12
        unit = np.where(parallel, 1.0, along)
        first, last = (low - start) / unit, (high - start) / unit
        inside = (start >= low) & (start <= high)
        enter = np.where(parallel, np.where(inside, -np.inf, np.inf), np.minimum(first, last))
        leave = np.where(parallel, np.where(inside, np.inf, -np.inf), np.maximum(first, last))
        return np.maximum(enter.max(axis=1), 0.0) <= np.minimum(leave.min(axis=1), 1.0)

    def holds(self, points: Array) -> NDArray[np.bool_]:
        """Which of some points (..., 3), m, lie in it or on its faces."""
        low, high = np.array(self.low) - _TOUCHES, np.array(self.high) + _TOUCHES
        return np.asarray(((points >= low) & (points <= high)).all(axis=-1), dtype=np.bool_)


def between(one: Sequence[float], other: Sequence[float]) -> Region:
    """The box between two opposite corners of two or three coordinates each, m; of any height where two are given."""
    ends = [(min(pair), max(pair)) for pair in zip(one, other, strict=True)]
    ends += [(-math.inf, math.inf)] * (3 - len(ends))
    (ax, bx), (ay, by), (az, bz) = ends
    return Region((ax, ay, az), (bx, by, bz))


def beyond(side: Literal["below", "above"], axis: str, value: float) -> Region:
    """The half-space below or above a coordinate, m."""
    ends = [(-math.inf, math.inf)] * 3
    ends[AXES.index(axis)] = (-math.inf, value) if side == "below" else (value, math.inf)
    (ax, bx), (ay, by), (az, bz) = ends
    return Region((ax, ay, az), (bx, by, bz))


def around(points: Array) -> Region:
    """The least box that holds some points (..., 3), m."""
    flat = points.reshape(-1, 3)
    return between(flat.min(axis=0).tolist(), flat.max(axis=0).tolist())
