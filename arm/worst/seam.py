"""Whether a tip can follow a straight seam, every point of it and not just samples.

A planar arm without joint limits: its ring is cut exactly. Any other arm: a walk in steps that are each proved, since
a pose proves the whole ball around its tip (`arm.worst.reach`). The walk stops at the first point that no search
reaches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.sections.numeric import Array

from .reach import Reach, free_ring

Verdict = Literal["reachable", "unreachable", "undecided"]

_REACHED = 1e-9
_LEAST_STEP = 1e-5
"""A step below this (m) is taken for a standstill."""
_LOOK = 1e-3
"""How far ahead of a standstill (m) the search looks for a point that cannot be reached."""


@dataclass(frozen=True)
class SeamCheck:
    """Whether a straight seam can be followed.

    `reachable`: every point has a pose, proved; `unreachable`: `first_unreachable` (m) is where the seam first leaves
    the reachable set (with a walk: the first point that no search reaches) and `missing` (m) how far the tip stays from
    the seam's farthest point; `undecided`: poses were found everywhere, but between the shares `gaps` nothing proves
    them. `proved_to` is the share up to which it is proved. `exact`: by the ring's equation, not a walk.
    """

    verdict: Verdict
    start: tuple[float, ...]
    end: tuple[float, ...]
    proved_to: float
    first_unreachable: tuple[float, ...] | None = None
    missing: float = 0.0
    exact: bool = False
    gaps: tuple[tuple[float, float], ...] = ()


def check_seam(arm: Arm, start: Sequence[float], end: Sequence[float]) -> SeamCheck:
    """Check the straight seam between two points (m, two components in the plane, three in space)."""
    ring = free_ring(arm)
    if ring is None or len(start) != 2:
        return _Walk(Reach(arm), np.array(start, dtype=float), np.array(end, dtype=float)).check()
    one, other = tuple(float(x) for x in start), tuple(float(x) for x in end)
    share = ring.first_outside(one, other)
    if share is None:
        return SeamCheck("reachable", one, other, 1.0, exact=True)
    first = tuple(a + share * (b - a) for a, b in zip(one, other, strict=True))
    # Where a segment leaves a ring, it misses it most at its end or where it comes nearest to the center.
    ahead = np.subtract(other, one)
    square = float(ahead @ ahead) or 1.0
    nearest = float(np.clip(-(np.subtract(one, ring.center) @ ahead) / square, 0.0, 1.0))
    missing = max(ring.missing(tuple(np.add(one, at * ahead))) for at in (0.0, nearest, 1.0))
    return SeamCheck("unreachable", one, other, share, first, missing, exact=True)


@dataclass(frozen=True)
class _Walk:
    reach: Reach
    start: Array
    end: Array

    def check(self) -> SeamCheck:
        length = float(np.linalg.norm(self.end - self.start))
        one, other = tuple(self.start.tolist()), tuple(self.end.tolist())
        along, gaps = 0.0, list[tuple[float, float]]()
        pose, looked_at = self._best(0.0, length), 4e-3
        if pose is None:
            return self._ended(0.0, length, one, other)
        while True:
            radius = self.reach.ball(pose).radius
            looked_at = max(looked_at, min(radius, 4e-3))
            if radius < _LEAST_STEP or (radius < 0.25 * looked_at and along + radius < length):
                looked_at = radius  # a search at every step of a narrow place would take too long
                better = self._best(along, length)
                if better is not None and self.reach.ball(better).radius > 1.5 * radius:
                    pose = better
                    radius = self.reach.ball(pose).radius
            if along + radius >= length:
                break
            if radius < _LEAST_STEP:
                ahead = min(length, along + _LOOK)
                beyond = self._first_beyond(along, ahead, length)
                if beyond is not None:
                    return self._ended(beyond, length, one, other)
                joined = gaps.pop()[0] if gaps and gaps[-1][1] == along / length else along / length
                gaps.append((joined, ahead / length))
                along = ahead
                pose = self._best(along, length)
                if pose is None:
                    return self._ended(along, length, one, other)
                if along >= length:
                    break
                continue
            along += 0.98 * radius  # the ball's edge is left to the next ball
            followed = self._follow(pose, along, length)
            if followed is None:
                return self._ended(along, length, one, other)
            pose = followed
        verdict: Verdict = "undecided" if gaps else "reachable"
        return SeamCheck(verdict, one, other, gaps[0][0] if gaps else 1.0, gaps=tuple(gaps))

    def _point(self, along: float, length: float) -> Array:
        return self.start + (along / max(length, 1e-300)) * (self.end - self.start)

    def _best(self, along: float, length: float) -> Array | None:
        """Of the poses found at a point of the seam, the one that proves most; None where none was found."""
        q, distance = self.reach.nearest(self._point(along, length)[None])
        poses = q[0][distance[0] <= _REACHED]
        if not len(poses):
            return None
        return poses[int(np.argmax([self.reach.ball(pose).radius for pose in poses]))]

    def _follow(self, pose: Array, along: float, length: float) -> Array | None:
        """The pose carried on to the next point, moved to prove more where it is one of a family."""
        point = self._point(along, length)[None]
        spreads = np.random.default_rng(3).normal(0.0, 0.05, (6, len(pose)))
        starts = np.vstack([pose, pose + spreads])
        q, distance = self.reach.nearest(point, starts=starts)
        poses = q[0][distance[0] <= _REACHED]
        if not len(poses):
            return self._best(along, length)
        near = poses[np.abs(poses - pose).max(axis=1) < 0.5] if len(poses) > 1 else poses
        rows = near if len(near) else poses
        return rows[int(np.argmax([self.reach.ball(row).radius for row in rows]))]

    def _first_beyond(self, low: float, high: float, length: float) -> float | None:
        """The first place between two that no search reaches, by a scan and bisection; None where all are reached."""
        places = np.linspace(low, high, 9)[1:]
        missed = self._missing(places, length) > _REACHED
        if not missed.any():
            return None
        index = int(np.argmax(missed))
        low, high = float(places[index - 1]) if index else low, float(places[index])
        for _ in range(8):  # each round looks at seven places between
            places = np.linspace(low, high, 9)
            missed = self._missing(places[1:-1], length) > _REACHED
            index = int(np.argmax(missed)) if missed.any() else 7
            low, high = float(places[index]), float(places[index + 1])
        return high

    def _missing(self, places: Array, length: float) -> Array:
        """The least distance found at each place (m along the seam)."""
        points = np.array([self._point(float(along), length) for along in places])
        return self.reach.nearest(points)[1].min(axis=1)

    def _ended(self, along: float, length: float, one: tuple[float, ...], other: tuple[float, ...]) -> SeamCheck:
        low, high, missing = along, length, 0.0
        for _ in range(3):
            places = np.linspace(low, high, 17)
            missed = self._missing(places, length)
            farthest = int(np.argmax(missed))
            missing = max(missing, float(missed[farthest]))
            low, high = float(places[max(farthest - 1, 0)]), float(places[min(farthest + 1, 16)])
        first = tuple(self._point(along, length).tolist())
        share = along / max(length, 1e-300)
        return SeamCheck("unreachable", one, other, share, first, missing)
