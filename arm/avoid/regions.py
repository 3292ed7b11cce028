"""Regions of space in the base frame: boxes along its axes, open on some sides where they are half-spaces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import combinations
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.vectors import Scalar
from linkwright.core.sections.numeric import Array, maximum, sqrt

from .obstacle import TOUCHES, Obstacle, Piece

AXES = ("x", "y", "z")

Corner = tuple[float, float, float]


@dataclass(frozen=True)
class Region(Obstacle):
    """The points between two corners, m, in the base frame; infinite where it has no end. A half-space is a region with
    one finite end. What touches a face is clear of it."""

    low: Corner
    high: Corner

    def asks(self, parts: Sequence[Piece]) -> list[tuple[int, ...]]:
        """Every piece by itself."""
        return [(number,) for number in range(len(parts))]

    def gap(self, parts: Sequence[Piece], shares: Sequence[Scalar]) -> Scalar:
        """By how much a disc across the piece's axis, at a point of it, is clear of the region along x, y or z,
        whichever is most. Exact at a face, less than the distance at an edge or corner."""
        return reduce(maximum, self._faces(parts[0], shares[0]))

    def _faces(self, part: Piece, share: Scalar) -> list[Scalar]:
        """By how much a disc across a piece's axis is clear of each face, m."""
        gaps: list[Scalar] = []
        for low, high, cosine, at in zip(self.low, self.high, part.along, part.at(share), strict=True):
            # The disc reaches so far along x, y or z.
            out = part.radius * sqrt(maximum(1.0 - cosine * cosine, 0.0))
            gaps += [low - at - out] if math.isfinite(low) else []
            gaps += [at - high - out] if math.isfinite(high) else []
        return gaps

    def closest(self, parts: Sequence[Piece], count: int) -> tuple[Array, Array]:
        """The greatest of what is linear along the piece is least at an end, or where two of these are equal."""
        near, far = (
            np.stack([np.broadcast_to(np.asarray(face, dtype=float), count) for face in self._faces(parts[0], share)])
            for share in (0.0, 1.0)
        )
        slope = far - near
        shares = [np.zeros(count), np.ones(count)]
        for one, other in combinations(range(len(near)), 2):
            apart = slope[one] - slope[other]
            there = (near[other] - near[one]) / np.where(apart == 0.0, 1.0, apart)
            shares.append(np.clip(there, 0.0, 1.0))
        gaps = np.stack([(near + share * slope).max(axis=0) for share in shares])
        least = gaps.argmin(axis=0)[None]
        share = np.take_along_axis(np.stack(shares), least, axis=0)[0]
        return np.take_along_axis(gaps, least, axis=0)[0], np.stack([share, np.zeros(count)], axis=1)

    @property
    def words(self) -> str:
        """What people call it."""
        ends = [
            (f"{axis} {'below' if math.isinf(low) else 'above'} {1e3 * (high if math.isinf(low) else low):g} mm")
            for axis, low, high in zip(AXES, self.low, self.high, strict=True)
            if math.isinf(low) != math.isinf(high)
        ]
        if ends:
            return ends[0]
        centre = [0.5 * (low + high) for low, high in zip(self.low, self.high, strict=True) if math.isfinite(low)]
        return f"the box about ({', '.join(f'{1e3 * x:g}' for x in centre)}) mm"

    def holds(self, points: Array) -> NDArray[np.bool_]:
        """Which of some points (..., 3), m, lie in it or on its faces."""
        low, high = np.array(self.low) - TOUCHES, np.array(self.high) + TOUCHES
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
