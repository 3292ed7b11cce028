"""Where an arm works: its joint ranges, a box in space or a path, as sets of joint coordinates.

A region samples itself, pulls poses onto itself (by damped Gauss-Newton steps on the nominal tip), and tells which
cells of joint space cannot meet it, so that the certificate needs to look at the rest only.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm, FloatVector
from linkwright.core.arm.errors.parts import Part
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import NoAnswer

from .polynomial import Coefficients, Terms, terms_of

Motion = Callable[[Array], tuple[Array, Array]]
"""Joint coordinates (N, n) to nominal tips (N, 3) in m and their slopes (N, 3, n) in m per rad or m."""

PATH_POINTS = 25
"""Points looked at along each segment of a path, ends included, when poses are sampled."""

_ON_PATH = 1e-9
_BITS = 48
"""Of the points spread over a box, so that they stay below 1."""


@dataclass(frozen=True)
class Workspace:
    """`joints`: every pose within the joint ranges; `poses`: those that are listed; `box`: those whose tip lies in a
    box; `path`: on a polyline.

    `points` (m, in the base frame) are the box's two corners or the path's vertices, each with three components; None
    in a component leaves that direction free. `ranges` replaces the arm's joint ranges where given (rad, m).
    """

    kind: Literal["joints", "poses", "box", "path"] = "joints"
    points: tuple[tuple[float, float, float], ...] = ()
    ranges: tuple[tuple[float, float], ...] | None = None
    in_plane: bool = True
    """Whether the points were given as x and y only."""
    error: Part = "whole"
    """What counts of the error on a path."""
    apart: bool = False
    """Whether the vertices of a path stand alone, with nothing between them."""
    poses: tuple[tuple[float, ...], ...] = ()
    """The joint coordinates (rad, m) of `poses`, which lie within `ranges`."""
    weights: tuple[float, ...] = ()
    """How much each of them, or each of `points` that stand apart, counts in an average; alike where there are none."""

    @property
    def in_space(self) -> bool:
        """Whether it is a place of the tip, which joint coordinates reach or not."""
        return self.kind in ("box", "path")

    @property
    def pieces(self) -> tuple[tuple[FloatVector, FloatVector], ...]:
        """The ends of the straight pieces of a path, one and the same where it has no length."""
        if self.apart or len(self.points) == 1:
            return tuple((point, point) for point in self.points)
        return tuple(itertools.pairwise(self.points))

    @property
    def segments(self) -> tuple[Workspace, ...]:
        """The straight pieces of a path that have a length, each a separate path; pieces that go on straight are
        one."""
        if self.kind != "path":
            return ()
        ends: list[tuple[FloatVector, FloatVector]] = []
        for a, b in self.pieces:
            if a == b:
                continue
            if ends and _goes_on(*ends[-1], b):
                ends[-1] = (ends[-1][0], b)
            else:
                ends.append((a, b))
        return tuple(replace(self, points=pair) for pair in ends)


class Unreachable(NoAnswer):
    """A workspace holds a point that the arm cannot reach within its joint ranges."""

    def __init__(self, point: tuple[float, ...], missing: float) -> None:
        """`point` in m, `missing` the least distance that the tip keeps from it, m."""
        place = ", ".join(f"{1e3 * x:.4g}" for x in point)
        super().__init__(f"the point ({place}) mm cannot be reached: the tip stays {1e3 * missing:.4g} mm away")
        self.point, self.missing = point, missing


def _goes_on(a: FloatVector, b: FloatVector, c: FloatVector) -> bool:
    """Whether a path goes from b straight on to c."""
    one, other = np.subtract(b, a), np.subtract(c, b)
    return float(one @ other) > (1.0 - 1e-12) * float(np.linalg.norm(one) * np.linalg.norm(other))


def joint_box(arm: Arm, workspace: Workspace) -> tuple[Array, Array]:
    """Lower and upper joint coordinates; a revolute range beyond a full circle is cut to one turn, and joints that
    only follow others have no width."""
    ranges = workspace.ranges or tuple(joint.range for joint in arm.joints)
    lower = np.array([low for low, _ in ranges])
    upper = np.array([high for _, high in ranges])
    for index, joint in enumerate(arm.joints):
        if not joint.driven:
            lower[index] = upper[index] = 0.5 * (lower[index] + upper[index])
        elif joint.revolute and upper[index] - lower[index] > 2.0 * math.pi:
            upper[index] = lower[index] + 2.0 * math.pi
    return lower, upper


def climbing_bounds(arm: Arm, lower: Array, upper: Array) -> tuple[Array, Array]:
    """The same bounds, infinite for full-circle joints: a climb must not stop where a circle was cut open."""
    full = np.array([joint.revolute for joint in arm.joints]) & (upper - lower >= 2.0 * math.pi - 1e-12)
    return np.where(full, -np.inf, lower), np.where(full, np.inf, upper)


def wrapped(arm: Arm, q: Array, lower: Array, upper: Array) -> Array:
    """Full-circle joints brought back into their range by whole turns."""
    out = np.array(q, dtype=float, copy=True)
    for index, joint in enumerate(arm.joints):
        if joint.revolute and upper[index] - lower[index] >= 2.0 * math.pi - 1e-12:
            out[..., index] = lower[index] + np.mod(out[..., index] - lower[index], 2.0 * math.pi)
    return out


def spread(lower: Array, upper: Array, count: int, seed: int = 1) -> Array:
    """`count` low-discrepancy points in a box (a scrambled Halton sequence, seeded), and its corners up to 64."""
    inside = lower + (upper - lower) * _spread_in_cube(len(lower), count, seed)
    return np.minimum(inside, upper)  # lower + (upper - lower) may round to more than upper


@lru_cache(maxsize=16)
def _spread_in_cube(size: int, count: int, seed: int) -> Array:
    columns = [_radical_inverses(base, count, (base, seed)) for base in itertools.islice(_primes(), size)]
    points = np.stack(columns, axis=1)
    corners = np.array([[(k >> j) & 1 for j in range(size)] for k in range(2 ** min(size, 6))], dtype=float)
    spread_out = np.vstack([points, corners])
    spread_out.setflags(write=False)
    return spread_out


def _primes() -> Iterator[int]:
    return (n for n in itertools.count(2) if all(n % k for k in range(2, math.isqrt(n) + 1)))


def _radical_inverses(base: int, count: int, seed: tuple[int, int]) -> Array:
    """0 to count - 1 with their digits mirrored at the point, each place's digits permuted at random (A. B. Owen, A
    randomized Halton algorithm in R, arXiv:1706.02808): base^k neighbours meet each base^k-th of 0..1 once."""
    generator = np.random.default_rng(seed)
    rest, inverses = np.arange(count), np.zeros(count)
    for place in range(1, math.ceil(_BITS / math.log2(base)) + 1):
        permuted = generator.permutation(base)
        # No number has that many digits: the place's is zero in all of them.
        inverses += (permuted[rest % base] if base ** (place - 1) < count else permuted[0]) * float(base) ** -place
        rest = rest // base
    return inverses


def path_points(workspace: Workspace) -> Array:
    """Points along a path, every vertex among them, (N, 3)."""
    return np.unique(_along(workspace), axis=0)


def place_shares(workspace: Workspace, tips: Array) -> Array:
    """How much each pose of a path or of points (its tip is a row of (N, 3)) counts in an average, (N): points alike,
    a path by its length, and a place as much however many poses reach it."""
    lengths = np.linalg.norm(np.diff(workspace.pieces, axis=1)[:, 0], axis=1)
    trapezoid = np.ones(PATH_POINTS)
    trapezoid[[0, -1]] = 0.5
    weights = np.outer(lengths if lengths.any() else np.ones(len(lengths)), trapezoid).ravel()
    used = slice(0, 2) if workspace.in_plane else slice(0, 3)
    places, place = np.unique(_along(workspace)[:, used].round(9), axis=0, return_inverse=True)
    of_place = np.bincount(place.ravel(), weights)
    at = np.argmin(np.linalg.norm(tips[:, None, used] - places, axis=2), axis=1)
    return of_place[at] / np.bincount(at)[at]


def weights_of_points(workspace: Workspace, tips: Array) -> Array:
    """The weight (N,) of the point that each tip (N, 3) is at; 1 where points have none of their own."""
    if not workspace.weights:
        return np.ones(len(tips))
    used = slice(0, 2) if workspace.in_plane else slice(0, 3)
    away = np.linalg.norm(tips[:, None, used] - np.array(workspace.points)[:, used], axis=2)
    return np.array(workspace.weights)[np.argmin(away, axis=1)]


def _along(workspace: Workspace) -> Array:
    """Points of each piece of a path, one after the other, (K, 3)."""
    share = np.linspace(0.0, 1.0, PATH_POINTS)[:, None]
    return np.vstack([a + share * (b - a) for a, b in np.array(workspace.pieces)])


def by_differences(tip: Callable[[Array], Array], step: float = 1e-7) -> Motion:
    """The motion of a tip that is known by its places (N, 3) alone, its slopes by forward differences."""

    def motion(q: Array) -> tuple[Array, Array]:
        here = tip(q)
        return here, np.stack([(tip(q + row) - here) / step for row in step * np.eye(q.shape[1])], axis=2)

    return motion


def pull(
    motion: Motion, starts: Array, targets: Array, lower: Array, upper: Array, used: Array, steps: int = 60
) -> tuple[Array, Array]:
    """Joint coordinates near `starts` whose tips meet `targets` (N, 3) in the components `used`, within the box.

    Levenberg-Marquardt on all rows at once, clipped to the box. Returns (q, remaining distance in m).
    """
    q = np.clip(starts, lower, upper)
    damping = np.full(len(q), 1e-3)
    place, jacobian = motion(q)
    miss, jacobian = (targets - place) * used, jacobian * used[:, None]
    distance = np.sqrt((miss * miss).sum(axis=1))
    for _ in range(steps):
        # Who has arrived stays; a few stragglers take most of the steps.
        rows = np.flatnonzero(distance >= _ON_PATH)
        if np.all(damping[rows] >= 1e2):
            break
        here, slopes, wanted = q[rows], jacobian[rows], miss[rows]
        held_low = (here <= lower) & (np.einsum("nij,ni->nj", slopes, wanted) < 0.0)
        held_high = (here >= upper) & (np.einsum("nij,ni->nj", slopes, wanted) > 0.0)
        free = slopes * ~(held_low | held_high)[:, None, :]
        square = np.einsum("nij,nkj->nik", free, free)
        scale = np.einsum("nii->n", square)[:, None, None] + 1e-30
        solved = np.linalg.solve(square + damping[rows, None, None] * scale * np.eye(3), wanted[:, :, None])
        trial = np.clip(here + np.clip(np.einsum("nij,nik->nj", free, solved), -0.5, 0.5), lower, upper)
        # A motion may hold something of each row, such as lengths: it is asked for all of them.
        tried = q.copy()
        tried[rows] = trial
        place, slopes = (item[rows] for item in motion(tried))
        new_miss = (targets[rows] - place) * used
        new_distance = np.sqrt((new_miss * new_miss).sum(axis=1))
        better = new_distance < distance[rows]
        damping[rows] = np.where(better, np.maximum(damping[rows] * 0.1, 1e-14), np.minimum(damping[rows] * 10.0, 1e2))
        nearer = rows[better]
        q[nearer], miss[nearer], distance[nearer] = trial[better], new_miss[better], new_distance[better]
        jacobian[nearer] = slopes[better] * used[:, None]
    return q, distance


def sample(workspace: Workspace, motion: Motion, lower: Array, upper: Array, count: int, seed: int = 1) -> Array:
    """Poses of the workspace, spread over it, or those that it lists; raises `Unreachable` where a path has a point
    without any pose."""
    if workspace.kind == "poses":
        return np.array(workspace.poses)
    q = spread(lower, upper, count, seed)
    if workspace.kind == "joints":
        return q
    used = np.array([1.0, 1.0, 0.0 if workspace.in_plane else 1.0])
    if workspace.kind == "box":
        low, high = np.min(workspace.points, axis=0), np.max(workspace.points, axis=0)
        reached, _ = motion(q)
        targets = np.clip(reached, low, high)
        inside = np.all((np.abs(targets - reached) * used) == 0.0, axis=1)
        near = np.argsort(np.sqrt((((targets - reached) * used) ** 2).sum(axis=1)) + np.where(inside, np.inf, 0.0))
        outside = near[: min(len(near) - int(inside.sum()), max(64, count // 8))]
        pulled, distance = pull(motion, q[outside], targets[outside], lower, upper, used)
        poses = np.vstack([q[inside], pulled[distance < 1e-7]])
        if not len(poses):
            nearest = outside[int(np.argmin(distance))]
            raise Unreachable(tuple(targets[nearest][: 2 if workspace.in_plane else 3]), float(distance.min()))
        return poses
    points = path_points(workspace)
    per_point = max(8, count // len(points))
    starts = np.tile(q[:per_point], (len(points), 1)) if per_point <= len(q) else np.tile(q, (len(points), 1))
    targets = np.repeat(points, len(starts) // len(points), axis=0)
    pulled, distance = pull(motion, starts, targets, lower, upper, used)
    nearest = distance.reshape(len(points), -1).min(axis=1)
    if np.any(nearest > 1e-7):
        first = int(np.argmax(nearest > 1e-7))
        raise Unreachable(tuple(points[first][: 2 if workspace.in_plane else 3]), float(nearest[first]))
    return pulled[distance < 1e-7]


_NARROWINGS = 2
"""How often a cell is narrowed by each axis of the region."""


@dataclass(frozen=True)
class RegionCells:
    """Tells which cells of joint space can hold a pose of a box or path, from bounds on the nominal tip."""

    workspace: Workspace
    tip: Terms

    def keep(self, centers: Array, half: Array) -> NDArray[np.bool_]:
        """False only for cells (N, n) none of whose poses has its tip in the region."""
        places, reach = self._tips(centers, half)
        axes = slice(0, 2) if self.workspace.in_plane else slice(0, 3)
        places, reach = places[:, axes], reach[:, axes] + 1e-9
        points = np.array(self.workspace.points)[:, axes]
        if self.workspace.kind == "box":
            return np.all((places + reach >= points.min(axis=0)) & (places - reach <= points.max(axis=0)), axis=1)
        allowed = np.sqrt((reach * reach).sum(axis=1))
        return distance_to_path(places, self.workspace) <= allowed

    def narrowed(self, centers: Array, half: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Cells (N, n) without what cannot have its tip in the box (that around a path), and which of them may have.

        The tip is its linear part about the centre, and no more than a remainder beside it; what one joint can do is
        what the region leaves it when all others do their utmost (hull consistency; F. Benhamou et al., Revising hull
        and box consistency, ICLP 1999).
        """
        values, slopes, beside = self._linear(centers, half)
        axes = range(len(values))
        points = np.array(self.workspace.points)
        low, high = -half, half.copy()
        possible = np.ones(len(centers), dtype=bool)
        for _ in range(_NARROWINGS):
            for axis in axes:
                slope, room = slopes[axis], beside[axis] + 1e-9
                least, most = np.minimum(slope * low, slope * high), np.maximum(slope * low, slope * high)
                below = points[:, axis].min() - values[axis] - room - most.sum(axis=1)
                above = points[:, axis].max() - values[axis] + room - least.sum(axis=1)
                # What is asked of each joint's part.
                parts = np.stack([below[:, None] + most, above[:, None] + least])
                steep = np.abs(slope) > 1e-12
                ends = np.where(steep, parts / np.where(steep, slope, 1.0), np.stack([low, high]))
                low, high = np.maximum(low, ends.min(axis=0)), np.minimum(high, ends.max(axis=0))
                possible &= (below <= 0.0) & (above >= 0.0) & np.all(low <= high + 1e-12, axis=1)
                high = np.maximum(low, high)
        center, wide = centers + 0.5 * (low + high), 0.5 * (high - low)
        possible[possible] &= self.keep(center[possible], wide[possible])
        return center, wide, possible

    def tips(self, centers: Array) -> Array:
        """The tips (N, 2 or 3) at poses (N, n), m."""
        places, _ = self._tips(centers, np.zeros_like(centers))
        return places[:, : 2 if self.workspace.in_plane else 3]

    @property
    def box(self) -> tuple[Array, Array]:
        """The corners (2 or 3) of the box, or of that around the path, m."""
        points = np.array(self.workspace.points)[:, : 2 if self.workspace.in_plane else 3]
        return points.min(axis=0), points.max(axis=0)

    def holds(self, centers: Array) -> NDArray[np.bool_]:
        """Whether the poses themselves have their tip in the box; a path has no inside."""
        if self.workspace.kind == "path":
            return np.zeros(len(centers), dtype=bool)
        places, _ = self._tips(centers, np.zeros_like(centers))
        axes = slice(0, 2) if self.workspace.in_plane else slice(0, 3)
        points = np.array(self.workspace.points)[:, axes]
        places = places[:, axes]
        return np.all((places >= points.min(axis=0)) & (places <= points.max(axis=0)), axis=1)

    def _linear(self, centers: Array, half: Array) -> tuple[Array, Array, Array]:
        """Per axis that counts: the tips (d, N) at the centres, their slopes (d, N, n), and what is beside those in
        cells (d, N), m."""
        count, axes = len(centers), range(2 if self.workspace.in_plane else 3)
        beside = self.tip.remainder(half, 1)
        results = [self.tip.at(centers, np.full(count, axis, dtype=np.intp), order=1) for axis in axes]
        values, slopes = np.stack([item[0] for item in results]), np.stack([item[1] for item in results])
        return values, slopes, np.stack([np.broadcast_to(beside[axis], (count,)) for axis in axes])

    def _tips(self, centers: Array, half: Array) -> tuple[Array, Array]:
        values, slopes, beside = self._linear(centers, half)
        return values.T, ((np.abs(slopes) * half).sum(axis=2) + beside).T


def region_cells(workspace: Workspace, tip: Coefficients) -> RegionCells:
    """The cell test for a box or path, from the tip's coefficients."""
    return RegionCells(workspace, terms_of(tip))


def distance_to_path(points: Array, path: Workspace) -> Array:
    """The distance of each point (N, d), its coordinates those that count, to a path."""
    best = np.full(len(points), np.inf)
    for a, b in np.array(path.pieces)[:, :, : points.shape[1]]:
        along = b - a
        square = float(along @ along) or 1.0
        share = np.clip(((points - a) @ along) / square, 0.0, 1.0)
        best = np.minimum(best, np.sqrt(((points - a - share[:, None] * along) ** 2).sum(axis=1)))
    return best
