"""A bound on the length of a vector over boxes of coordinates, from the control points that hold it in their hull.

Over an interval shorter than half a turn a trigonometric polynomial is a mean of control points, with weights that are
nowhere negative (J. Sanchez-Reyes, Harmonic rational Bezier curves, p-Bezier curves and trigonometric polynomials,
Computer Aided Geometric Design 15 (1998) 909-923), as a polynomial is with Bernstein's. A mean of vectors is no longer
than the longest, so no pose of a cell has a longer error than the longest control point. That needs neither squares nor
derivatives, and so serves where coordinates are too many for `arm.worst.certificate`; it converges more slowly.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.errors.lost_motion import sign_vertices
from linkwright.core.sections.numeric import Array

_WIDEST = 1.1
"""Half width of the first cells of an angle, rad: below a quarter of a turn."""
_OUTWARD = 1e-11
"""Of the coefficients' sum: rounding."""
_MOST_ENUMERATED = 4
_BLOCK = 400_000
"""Control points worked on at once."""
_MOST_SHIFTED = 1e4
"""How many radii a pin's ball is shifted at most."""
_CLIMBS = 30
_BESIDE = 2000
"""What a cell takes beside its control points, in control points."""

Index = NDArray[np.intp]
Narrowing = Callable[[Array, Array], tuple[Array, Array, NDArray[np.bool_]]]
"""(centres (N, n), half widths (N, n)) -> the same narrowed to what may hold points that count, and which cells may."""


@dataclass(frozen=True)
class Axis:
    """A coordinate: an angle, in which functions are trigonometric polynomials of `degree`, or a length scaled to
    -1..1 (quadratic). It runs from `lower` to `upper`."""

    turns: bool
    degree: int
    lower: float
    upper: float

    def control(self, center: Array, half: Array) -> Array:
        """The matrices (N, points, basis) from coefficients to control points over center +- half (N,).

        The basis is 1, cos q, sin q, cos 2q, sin 2q, or 1, x, x^2.
        """
        if not self.turns:
            low, high, one = center - half, center + half, np.ones_like(center)
            rows = [[one, low, low * low], [one, center, low * high], [one, high, high * high]]
            return np.array(rows).transpose(2, 0, 1)
        even, odd = _about_zero(self.degree, half)
        columns = [np.ones((len(center), 2 * self.degree + 1))]
        for k in range(1, self.degree + 1):
            cosine, sine = np.cos(k * center)[:, None], np.sin(k * center)[:, None]
            columns += [cosine * even[k - 1] - sine * odd[k - 1], sine * even[k - 1] + cosine * odd[k - 1]]
        return np.stack(columns, axis=2)


def _about_zero(degree: int, half: Array) -> tuple[list[Array], list[Array]]:
    """Control points (N, points) of cos kt and of sin kt over -half..half, k from 1 to the degree (1 or 2).

    With u = sin((half - t)/2) and w = sin((half + t)/2) all are homogeneous in u and w: sin(half)^2 is u^2 +
    2 cos(half) u w + w^2, sin(half)^2 cos t is cos(half) u^2 + 2 u w + cos(half) w^2, and sin(half) sin t is w^2 - u^2.
    A control point is the ratio of the coefficients of a function and of 1.
    """
    c, s, o = np.cos(half), np.sin(half), np.zeros_like(half)
    if degree == 1:
        return [np.stack([c, 1.0 / c, c], axis=1)], [np.stack([-s, o, s], axis=1)]
    near, middle = (1.0 + c * c) / (2.0 * c), 1.0 + 2.0 * c * c
    even = [[c, near, 3.0 * c / middle, near, c], [2 * c * c - 1.0, o + 1.0, 3.0 / middle, o + 1.0, 2 * c * c - 1.0]]
    odd = [[-s, -0.5 * s, o, 0.5 * s, s], [-2.0 * s * c, -s / c, o, s / c, 2.0 * s * c]]
    return [np.stack(row, axis=1) for row in even], [np.stack(row, axis=1) for row in odd]


@dataclass(frozen=True)
class Pins:
    """Points anywhere within discs of `radii` (m, m of them) across unit vectors: coefficients (m, 3, basis ...)."""

    radii: Array
    normals: Array


@dataclass(frozen=True)
class Within:
    """Functions that stay within `center` +- `half` (m, a of them) wherever a pose counts: coefficients (a, basis of
    axis 1, ...)."""

    functions: Array
    center: Array
    half: Array


@dataclass(frozen=True)
class PlayedVector:
    """vector + sum_j s_j interval_j with any -1 <= s_j <= 1, and pins: coefficients (3, basis of axis 1, ...) of the
    vector, and (k, 3, basis of axis 1, ...) of the intervals."""

    axes: tuple[Axis, ...]
    vector: Array
    intervals: Array
    pins: Pins
    neglected: float = 0.0
    """What left-out coefficients and rounding may add, m."""
    within: Within | None = None

    @property
    def points(self) -> int:
        """The control points of a cell."""
        return int(np.prod(self.vector.shape[1:]))

    @property
    def effort(self) -> int:
        """The control points of a cell, those of its play too, and what takes as long beside them."""
        within = 0 if self.within is None else 1
        return _BESIDE + self.points * (1 + within + len(self.intervals) + len(self.pins.radii))

    @property
    def curvature(self) -> Array:
        """A measure of how the vector curves along each axis."""
        curvatures: list[float] = []
        for j, axis in enumerate(self.axes):
            order = np.array([0.0, 1.0, 1.0, 4.0, 4.0] if axis.turns else [0.0, 0.5, 2.0])[: self.vector.shape[j + 1]]
            weights = order.reshape(-1, *[1] * (len(self.axes) - 1 - j))
            curvatures.append(float(np.sqrt(((self.vector * weights) ** 2).sum())))
        return np.array(curvatures)

    @property
    def looseness(self) -> float:
        """A measure of how far control points of the whole box lie from it."""
        spans = np.array([min(axis.upper - axis.lower, 2.0 * _WIDEST) for axis in self.axes])
        return float(self.curvature @ spans**2)

    def longest(self, centers: Array, half: Array) -> Array:
        """The length (N,) that the vector does not exceed in each cell (N, n)."""
        lengths = [
            self._longest(centers[start : start + self.block], half[start : start + self.block])
            for start in range(0, len(centers), self.block)
        ]
        return np.concatenate(lengths) if lengths else np.zeros(0)

    @property
    def block(self) -> int:
        """How many cells are worked on at once."""
        return max(8, _BLOCK // self.points)

    def _longest(self, centers: Array, half: Array) -> Array:
        matrices = [axis.control(centers[:, j], half[:, j]) for j, axis in enumerate(self.axes)]
        count = len(centers)
        vector = _controlled(self.vector, matrices).reshape(count, 3, self.points)
        plays, pins = len(self.intervals), len(self.pins.radii)
        intervals = _controlled(self.intervals.reshape(3 * plays, *self.vector.shape[1:]), matrices)
        normals = _controlled(self.pins.normals.reshape(3 * pins, *self.vector.shape[1:]), matrices)
        discs = _Discs(self.pins.radii, normals.reshape(count, pins, 3, self.points))
        intervals = intervals.reshape(count, plays, 3, self.points)
        more = np.zeros(count)
        if self.within is not None:
            places = _controlled(self.within.functions, matrices).reshape(count, -1, self.points)
            vector, more = _tilted(vector, places - self.within.center[:, None], self.within.half)
        lengths = _farthest(vector, intervals, discs) + more
        return lengths + self.neglected


def played_vector(
    axes: Sequence[Axis], vector: Array, intervals: Array, pins: Pins | None = None, within: Within | None = None
) -> PlayedVector:
    """A `PlayedVector` of no higher degree than it takes: what no angle turns twice as fast has fewer points."""
    pins = Pins(np.zeros(0), np.zeros((0, *vector.shape))) if pins is None else pins
    # Normals count by how far they are shifted at most.
    reach = pins.radii * _MOST_SHIFTED
    rows = np.concatenate([vector[None], intervals, reach.reshape(-1, *[1] * vector.ndim) * pins.normals])
    size = float(np.abs(rows).sum())
    neglected = _OUTWARD * size
    kept, normals = list(axes), pins.normals
    functions, room = None if within is None else within.functions, 0.0
    reached = 0.0 if functions is None else float(np.abs(functions).sum())
    for j, axis in enumerate(axes):
        if not axis.turns or axis.degree != 2:
            continue
        rest = float(np.abs(np.take(rows, (3, 4), axis=j + 2)).sum())
        beside = 0.0 if functions is None else float(np.abs(np.take(functions, (3, 4), axis=j + 1)).sum())
        if rest <= _OUTWARD * size and beside <= _OUTWARD * reached:
            neglected, room = neglected + rest, room + beside
            kept[j] = replace(axis, degree=1)
            rows, normals = (np.take(item, (0, 1, 2), axis=j + 2) for item in (rows, normals))
            functions = None if functions is None else np.take(functions, (0, 1, 2), axis=j + 1)
    confined = None
    if within is not None and functions is not None:
        confined = replace(within, functions=functions, half=within.half + room)
    pins = Pins(pins.radii, normals)
    return PlayedVector(tuple(kept), rows[0], rows[1 : 1 + len(intervals)], pins, neglected, confined)


def _controlled(tensor: Array, matrices: Sequence[Array]) -> Array:
    """Control points (N, rows, points of axis 1, ...) of functions (rows, basis of axis 1, ...)."""
    if not len(tensor):
        return np.zeros((len(matrices[0]), 0, math.prod(matrix.shape[1] for matrix in matrices)))
    out = tensor[None]
    before, rest = len(tensor), list(matrices)
    if len(rest) % 2:
        out = np.matmul(rest[0][:, None], out.reshape(len(out), before, rest[0].shape[2], -1))
        before, rest = before * rest[0].shape[1], rest[1:]
    for one, two in zip(rest[::2], rest[1::2], strict=True):
        # Two axes at once: larger products of matrices.
        both = np.einsum("nab,ncd->nacbd", one, two)
        both = both.reshape(len(both), one.shape[1] * two.shape[1], -1)
        out = np.matmul(both[:, None], out.reshape(len(out), before, both.shape[2], -1))
        before *= both.shape[1]
    return out


def _tilted(vector: Array, places: Array, half: Array) -> tuple[Array, Array]:
    """The vector (N, 3, points) less what of it goes with the places (N, a, points), and by how much (N,) it may be
    longer where those are within +-half.

    |v| <= |v - d (k . y)| + |k . y| for every unit vector d and every k: what is far from the places that count no
    longer makes the bound. d is the direction of the longest control point, k the slope of v . d over the places.
    """
    rows = np.arange(len(vector))
    longest = vector[rows, :, (vector * vector).sum(axis=1).argmax(axis=1)]
    toward = longest / np.maximum(_norm(longest), 1e-300)
    along = np.einsum("ni,nip->np", toward, vector)
    aside = places - places.mean(axis=2, keepdims=True)
    squares = np.einsum("nap,nbp->nab", aside, aside)
    size = np.trace(squares, axis1=1, axis2=2)[:, None, None]
    squares += (1e-9 * size + 1e-300) * np.eye(places.shape[1])
    slopes = np.linalg.solve(squares, np.einsum("nap,np->na", aside, along)[:, :, None])[:, :, 0]
    # Where all places of a cell are about within what counts there is nothing to take off.
    slopes[~(np.abs(aside).max(axis=2) > half).any(axis=1)] = 0.0
    taken = np.einsum("na,nap->np", slopes, places)
    return vector - toward[:, :, None] * taken[:, None], np.abs(slopes) @ half


@dataclass(frozen=True)
class _Discs:
    """Pins with the control points (N, m, 3, points) of their normals."""

    radii: Array
    normals: Array

    def shifts(self, vector: Array, at: Index) -> Array:
        """How far (N, m) each disc's ball is best shifted along its normal where the vector is that of a control point.

        A disc of radius r across n lies in the ball of radius r sqrt(1 + k^2) about -r k n, for every k: that is
        cos(a - b) <= 1. With k the cotangent of the angle between n and the direction in which the sum is longest, disc
        and ball reach as far, and to first order they do in all directions near.
        """
        rows = np.arange(len(vector))
        vector_here = vector[rows, :, at]
        normals = self.normals[rows, :, :, at]
        normals = normals / np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-300)
        reached = vector_here
        for _ in range(_CLIMBS):
            across = reached[:, None] - np.einsum("nmi,ni->nm", normals, reached)[:, :, None] * normals
            across /= np.maximum(np.linalg.norm(across, axis=2, keepdims=True), 1e-300)
            reached = vector_here + np.einsum("m,nmi->ni", self.radii, across)
        toward = reached / np.maximum(_norm(reached), 1e-300)
        along = np.einsum("nmi,ni->nm", normals, toward)
        # Angles differ over a cell; a ball that is shifted farther fits nearer to one, and worse to others.
        aside = np.sqrt((np.cross(vector, toward[:, :, None], axis=1) ** 2).sum(axis=1).max(axis=1))
        turned = np.sqrt(((self.normals - normals[:, :, :, None]) ** 2).sum(axis=2).max(axis=2))
        width = turned + (aside / np.maximum(_norm(reached)[:, 0], 1e-300))[:, None]
        sine = np.sqrt(np.maximum(1.0 - along * along, 0.0) + width * width)
        return along / np.maximum(sine, 1.0 / _MOST_SHIFTED)

    def shifted(self, vector: Array, shifts: Array) -> tuple[Array, Array]:
        """The vector (N, 3, points) to the balls' centre, and their radius (N,) together."""
        moved = vector - np.einsum("m,nm,nmip->nip", self.radii, shifts, self.normals)
        return moved, np.sqrt(1.0 + shifts * shifts) @ self.radii


def _norm(vectors: Array) -> Array:
    return np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))


def _farthest(vector: Array, intervals: Array, discs: _Discs) -> Array:
    """Upper bounds (N,) on |vector + sum_j s_j interval_j| with its pins: exact, but for pins, for few intervals."""
    plays = intervals.shape[1]
    if plays > _MOST_ENUMERATED:
        among = _among(intervals)

        def squares(whole: Array) -> Array:
            squares_ = (whole * whole).sum(axis=1) + among
            for j in range(plays):
                squares_ += 2.0 * np.abs((whole * intervals[:, j]).sum(axis=1))
            return squares_

        return _with_discs(vector, squares, discs, lambda: _pulled(vector, intervals))
    best = np.zeros(len(vector))
    for signs in sign_vertices(plays):
        whole = vector + np.einsum("k,nkip->nip", signs, intervals) if plays else vector
        best = np.maximum(best, _with_discs(whole, lambda item: (item * item).sum(axis=1), discs))
    return best


def _with_discs(
    vector: Array, squares: Callable[[Array], Array], discs: _Discs, reaching: Callable[[], Array] | None = None
) -> Array:
    """Upper bounds (N,) on a vector's length with its pins, `squares` (N, points) being those of it without them.
    `reaching` gives the vector with what else adds to it."""
    best = squares(vector)
    length = np.sqrt(best.max(axis=1))
    if not len(discs.radii):
        return length
    toward = vector if reaching is None else reaching()
    moved, radius = discs.shifted(vector, discs.shifts(toward, best.argmax(axis=1)))
    return np.minimum(length + discs.radii.sum(), np.sqrt(squares(moved).max(axis=1)) + radius)


def _among(intervals: Array) -> Array:
    """sum_jk |interval_j . interval_k| (N, points)."""
    products = np.zeros((len(intervals), intervals.shape[3]))
    for j in range(intervals.shape[1]):
        for k in range(j + 1):
            share = 1.0 if k == j else 2.0
            products += share * np.abs((intervals[:, j] * intervals[:, k]).sum(axis=1))
    return products


def _pulled(vector: Array, intervals: Array) -> Array:
    """The vector with each interval on the side to which it points."""
    side = np.where(np.einsum("nip,nkip->nkp", vector, intervals) >= 0.0, 1.0, -1.0)
    return vector + np.einsum("nkp,nkip->nip", side, intervals)


def bound(played: PlayedVector, known: float, *, gap: float, effort: int, narrow: Narrowing | None = None) -> float:
    """A length that the vector exceeds nowhere: the longest within a relative `gap` where `effort` control points
    beyond the first cells' are enough for that, else the best bound so far. `known` is a length that is reached. Only
    what `narrow` leaves of cells counts.
    """
    lower, upper = np.array([axis.lower for axis in played.axes]), np.array([axis.upper for axis in played.axes])
    parts = [max(1, math.ceil((axis.upper - axis.lower) / (2.0 * _WIDEST))) for axis in played.axes]
    span = (upper - lower) / parts
    ends = [lower[j] + span[j] * (np.arange(parts[j]) + 0.5) for j in range(len(parts))]
    centers = np.stack(np.meshgrid(*ends, indexing="ij"), axis=-1).reshape(-1, len(parts))
    half = np.broadcast_to(0.5 * span, centers.shape).copy()
    centers, half, _ = _narrowed(narrow, centers, half)
    tops, closed, curvature = played.longest(centers, half), known, played.curvature
    enough, spent = known * (1.0 + gap), 0
    while True:
        still = tops > enough
        closed = max(closed, float(tops[~still].max(initial=0.0)))
        centers, half, tops = centers[still], half[still], tops[still]
        if not len(tops) or spent > effort:
            return max(closed, float(tops.max(initial=0.0)))
        order = np.argsort(-tops, kind="stable")
        chosen, rest = order[: played.block], order[played.block :]
        halved, smaller = _halves(centers[chosen], half[chosen], curvature)
        spent += len(halved) * played.effort
        halved, smaller, inside = _narrowed(narrow, halved, smaller)
        whole = np.repeat(tops[chosen], 2)[inside]
        # A part is no worse than the whole, whatever rounding says.
        result = np.minimum(played.longest(halved, smaller), whole)
        centers, half = np.concatenate([centers[rest], halved]), np.concatenate([half[rest], smaller])
        tops = np.concatenate([tops[rest], result])


def _narrowed(narrow: Narrowing | None, centers: Array, half: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """What counts of cells, and which of them have any."""
    if narrow is None:
        return centers, half, np.ones(len(centers), dtype=bool)
    centers, half, inside = narrow(centers, half)
    return centers[inside], half[inside], inside


def _halves(centers: Array, half: Array, curvature: Array) -> tuple[Array, Array]:
    rows = np.arange(len(centers))
    split = np.argmax(half * half * curvature, axis=1)
    smaller, step = half.copy(), np.zeros_like(half)
    smaller[rows, split] *= 0.5
    step[rows, split] = smaller[rows, split]
    both = np.stack([centers - step, centers + step], axis=1).reshape(-1, centers.shape[1])
    return both, np.repeat(smaller, 2, axis=0)
