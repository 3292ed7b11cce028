"""How clearance and backlash count: worst, loaded or statistical.

worst: the play that puts the tip farthest away. Exact in the plane, where the set of reachable errors is a zonotope
with a disc around it: its farthest point is a vertex, plus the sum of the radii. In space the discs have different
normals, and the farthest point is sought by climbing the support function v(d), d = v/|v|, from many directions
(each step cannot decrease |v|, since the set is convex).
loaded: each play lies where its load pushes it; play without load counts as worst. What a calibration took of it, where
its load had pushed it, comes off; of play that no load pushed it took the middle.
statistical: a quantile over seeded draws, uniform in each interval and over each disc, the same draws at every pose.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import PlayMode, Statistics
from linkwright.core.sections.numeric import Array

from .model import PoseArrays

_MOST_ENUMERATED = 4
_MOST_VERTICES_TRIED = 8
"""Intervals whose vertices are tried as starts of climbs in space."""
_CLIMBS = 20
_LAST_CLIMBS = 200
"""The best of the climbs goes on: where the set is nearly a ball around zero, they are slow."""
_CHUNK = 8192
_DRAWN = 1_000_000
"""Poses times draws at once: 24 MB."""
_NO_LOAD = 1e-12
"""A load below this share of what the arm carries is rounding, and seats nothing."""


@dataclass(frozen=True)
class PlayedError:
    """The error at N poses with the play where the mode puts it.

    `error` (N,) in m; `vector` (N, 3) the error vector with the play in it; `signs` (N, k) where each interval stands
    (-1 to 1), `shifts` (N, d, 3) where each disc's centre lies (m).
    """

    error: Array
    vector: Array
    signs: Array
    shifts: Array


def played(
    arrays: PoseArrays, radii: Array, mode: PlayMode, *, planar: bool, statistics: Statistics | None = None
) -> PlayedError:
    """The error at each pose of `arrays`, with the discs' `radii` (m), counted in a play mode."""
    count = len(arrays.vector)
    pieces = [_chunk(arrays, start, start + _CHUNK) for start in range(0, max(count, 1), _CHUNK)]
    done = [_played(piece, radii, mode, planar, statistics or Statistics()) for piece in pieces]
    return PlayedError(
        np.concatenate([piece.error for piece in done]),
        np.concatenate([piece.vector for piece in done]),
        np.concatenate([piece.signs for piece in done]),
        np.concatenate([piece.shifts for piece in done]),
    )


def _chunk(arrays: PoseArrays, start: int, stop: int) -> PoseArrays:
    part = slice(start, stop)
    return PoseArrays(
        arrays.vector[part],
        arrays.intervals[part],
        arrays.interval_seating[part],
        arrays.normals[part],
        arrays.disc_seating[part],
        arrays.load_scale[part],
        arrays.taken,
        arrays.projection,
    )


def _played(arrays: PoseArrays, radii: Array, mode: PlayMode, planar: bool, statistics: Statistics) -> PlayedError:
    if mode == "statistical":
        return _statistical(arrays, radii, statistics)
    every_radius = np.broadcast_to(radii, arrays.normals.shape[:2])
    if mode == "worst":
        return _worst(arrays.vector, arrays.intervals, arrays.normals, every_radius, planar, arrays.projection)
    return _loaded(arrays, every_radius, planar)


def sign_vertices(count: int) -> Array:
    """All 2^count rows of signs, (2^count, count)."""
    return np.array(list(itertools.product((-1.0, 1.0), repeat=count))).reshape(2**count, count)


def _length(vectors: Array) -> Array:
    return np.sqrt(np.einsum("...i,...i->...", vectors, vectors))


def _seen(shifts: Array, projection: Array | None) -> Array:
    """What counts of displacements (..., 3)."""
    return shifts if projection is None else shifts @ projection  # a projection is symmetric


def _worst(
    vector: Array, intervals: Array, normals: Array, radii: Array, planar: bool, projection: Array | None
) -> PlayedError:
    if planar:
        signs = _farthest_vertex(vector, intervals)
        center = vector + np.einsum("nk,nki->ni", signs, intervals)
        distance = _length(center)
        outward = center / np.where(distance > 0.0, distance, 1.0)[:, None]
        outward[distance == 0.0] = _any_direction(projection)
        shifts = radii[:, :, None] * outward[:, None, :]
        return PlayedError(distance + radii.sum(axis=1), center + shifts.sum(axis=1), signs, shifts)
    return _farthest_in_space(vector, intervals, normals, radii, projection)


def _any_direction(projection: Array | None) -> Array:
    """A unit vector of the plane that counts."""
    if projection is None:
        return np.array([1.0, 0.0, 0.0])
    longest = projection[int(np.argmax(np.linalg.norm(projection[:2], axis=1)))]
    return longest / np.linalg.norm(longest)


def _farthest_vertex(vector: Array, intervals: Array) -> Array:
    """The signs (N, k) of the farthest vertex of vector + zonotope in the x-y plane."""
    count, plays = intervals.shape[:2]
    if plays == 0:
        return np.zeros((count, 0))
    if plays <= _MOST_ENUMERATED:
        candidates = np.broadcast_to(sign_vertices(plays), (count, 2**plays, plays))
    else:
        candidates = _plane_vertices(intervals)
    points = vector[:, None, :] + np.einsum("nck,nki->nci", candidates, intervals)
    best = np.argmax(np.einsum("nci,nci->nc", points, points), axis=1)
    return candidates[np.arange(count), best].copy()


def _plane_vertices(intervals: Array) -> Array:
    """The signs (N, 4 k, k) of all vertices of a plane zonotope: the support changes only normal to a generator."""
    x, y = intervals[:, :, 0], intervals[:, :, 1]
    turning = x[:, :, None] * y[:, None, :] - y[:, :, None] * x[:, None, :]
    products = x[:, :, None] * x[:, None, :] + y[:, :, None] * y[:, None, :]
    size = np.sqrt(x * x + y * y)
    parallel = np.abs(turning) <= 1e-12 * (size[:, :, None] * size[:, None, :])
    rows: list[Array] = []
    for side, item in itertools.product((-1.0, 1.0), (-1.0, 1.0)):
        rows.append(np.where(parallel, item * np.where(products >= 0.0, 1.0, -1.0), side * np.sign(turning)))
    return np.concatenate(rows, axis=1)


def _farthest_in_space(
    vector: Array, intervals: Array, normals: Array, radii: Array, projection: Array | None
) -> PlayedError:
    """Climbs from the axes' and diagonals' directions, the error's own and the farthest vertices, all at once."""
    count, plays = intervals.shape[:2]
    corners = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    starts = [np.broadcast_to(row, (count, 3)) for row in np.vstack([np.eye(3), -np.eye(3), corners])]
    starts.append(vector)
    if plays:
        vertices = sign_vertices(min(plays, _MOST_VERTICES_TRIED))
        points = vector[:, None, :] + np.einsum("ck,nki->nci", vertices, intervals[:, : vertices.shape[1]])
        if not normals.shape[1] and plays <= _MOST_VERTICES_TRIED:
            # All vertices of what intervals alone reach: the farthest is among them.
            farthest = np.argmax(_length(points), axis=1)
            reached = points[np.arange(count), farthest]
            return PlayedError(_length(reached), reached, vertices[farthest], np.zeros((count, 0, 3)))
        order = np.argsort(-_length(points), axis=1)[:, :6]
        starts += [points[np.arange(count), order[:, column]] for column in range(order.shape[1])]
    repeated = [np.tile(array, (len(starts), *[1] * (array.ndim - 1))) for array in (vector, intervals, normals, radii)]
    climbed = _climb(repeated[0], repeated[1], repeated[2], repeated[3], np.concatenate(starts), projection)
    best = climbed.error.reshape(len(starts), count).argmax(axis=0) * count + np.arange(count)
    return _climb(vector, intervals, normals, radii, climbed.vector[best], projection, _LAST_CLIMBS)


def _climb(
    vector: Array,
    intervals: Array,
    normals: Array,
    radii: Array,
    direction: Array,
    projection: Array | None,
    climbs: int = _CLIMBS,
) -> PlayedError:
    signs = np.zeros(intervals.shape[:2])
    shifts = np.zeros((*normals.shape[:2], 3))
    reached, direction = vector, _seen(direction, projection)
    for _ in range(climbs):
        signs = np.where(np.einsum("nki,ni->nk", intervals, direction) >= 0.0, 1.0, -1.0)
        across = direction[:, None, :] - np.einsum("ndi,ni->nd", normals, direction)[:, :, None] * normals
        size = _length(across)[:, :, None]
        shifts = _seen(radii[:, :, None] * across / np.where(size > 0.0, size, 1.0), projection)
        new = vector + np.einsum("nk,nki->ni", signs, intervals) + shifts.sum(axis=1)
        if np.abs(new - reached).max(initial=0.0) <= 1e-15 * np.abs(new).max(initial=0.0):
            break
        reached = direction = new
    return PlayedError(_length(reached), reached, signs, shifts)


def farthest_by_fan(arrays: PoseArrays, radii: Array) -> Array:
    """The farthest distances (N,) that play leads to in space, for very many rows: one climb each, from that direction
    of a fan in which the set reaches farthest. The distance is the greatest support over all directions, so none of
    the fan is above it; a climb raises it further."""
    fan = _fan()
    return np.concatenate(
        [_from_fan(_chunk(arrays, start, start + _CHUNK), radii, fan) for start in range(0, len(arrays.vector), _CHUNK)]
    )


def _from_fan(arrays: PoseArrays, radii: Array, fan: Array) -> Array:
    support = arrays.vector @ fan.T
    for k in range(arrays.intervals.shape[1]):
        support += np.abs(arrays.intervals[:, k] @ fan.T)
    for k, radius in enumerate(radii.tolist()):
        along = arrays.normals[:, k] @ fan.T
        support += radius * np.sqrt(np.maximum(0.0, 1.0 - along * along))
    every_radius = np.broadcast_to(radii, arrays.normals.shape[:2])
    start = fan[np.argmax(support, axis=1)]
    return _climb(arrays.vector, arrays.intervals, arrays.normals, every_radius, start, None).error


def _fan() -> Array:
    """Directions spread over the sphere, 26 of them along axes and diagonals of a cube and 192 on a spiral."""
    cube = np.array([row for row in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(row)])
    step = np.arange(192) + 0.5
    up, turn = 1.0 - step / 96.0, np.pi * (1.0 + np.sqrt(5.0)) * step
    level = np.sqrt(1.0 - up * up)
    spiral = np.stack([level * np.cos(turn), level * np.sin(turn), up], axis=1)
    return np.vstack([cube / np.linalg.norm(cube, axis=1)[:, None], spiral]).astype(np.float64)


def _across(arrays: PoseArrays) -> Array:
    """The loads that lie in the discs' planes (N, d, 3), N."""
    along = np.einsum("ndi,ndi->nd", arrays.normals, arrays.disc_seating)
    return arrays.disc_seating - along[:, :, None] * arrays.normals


def pushed_discs(arrays: PoseArrays) -> NDArray[np.bool_]:
    """Whether a load pushes each disc (N, d) to one side; a pin without load may lie anywhere."""
    return _length(_across(arrays)) > _NO_LOAD * arrays.load_scale[:, None]


def _loaded(arrays: PoseArrays, radii: Array, planar: bool) -> PlayedError:
    seated = np.abs(arrays.interval_seating) > _NO_LOAD * arrays.load_scale[:, None]
    signs = np.where(seated, np.sign(arrays.interval_seating), 0.0)
    across = _across(arrays)
    load = _length(across)
    pushed = pushed_discs(arrays)
    shifts = np.where(pushed, radii / np.where(load > 0.0, load, 1.0), 0.0)[:, :, None] * across
    shifts = _seen(shifts, arrays.projection)
    vector = arrays.vector + np.einsum("nk,nki->ni", signs, arrays.intervals) + shifts.sum(axis=1)
    settled_intervals, settled_discs = seated.copy(), pushed.copy()
    settled_intervals[:, seated.shape[1] - arrays.taken[0] :] = True
    settled_discs[:, pushed.shape[1] - arrays.taken[1] :] = True
    free = np.where(settled_intervals[:, :, None], 0.0, arrays.intervals)
    rest = _worst(vector, free, arrays.normals, np.where(settled_discs, 0.0, radii), planar, arrays.projection)
    signs = np.where(settled_intervals, signs, rest.signs)
    return PlayedError(rest.error, rest.vector, signs, shifts + rest.shifts)


def draws(statistics: Statistics, intervals: int, discs: int) -> tuple[Array, Array]:
    """The seeded draws: positions in the intervals (draws, k) and in unit discs (draws, d, 2)."""
    generator = np.random.default_rng(statistics.seed)
    positions = generator.uniform(-1.0, 1.0, (statistics.draws, intervals))
    radius = np.sqrt(generator.uniform(0.0, 1.0, (statistics.draws, discs)))
    angle = generator.uniform(0.0, 2.0 * np.pi, (statistics.draws, discs))
    return positions, np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=2)


def _disc_axes(normals: Array) -> tuple[Array, Array]:
    """Two unit vectors across each normal (N, d, 3)."""
    hint = np.where(np.abs(normals[..., :1]) < 0.9, np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
    first = hint - np.einsum("ndi,ndi->nd", normals, hint)[:, :, None] * normals
    first /= _length(first)[:, :, None]
    return first, np.asarray(np.cross(normals, first), dtype=float)


def _statistical(arrays: PoseArrays, radii: Array, statistics: Statistics) -> PlayedError:
    positions, places = draws(statistics, arrays.intervals.shape[1], arrays.normals.shape[1])
    first, second = _disc_axes(arrays.normals)
    count, rank = len(arrays.vector), min(int(np.ceil(statistics.level * statistics.draws)), statistics.draws) - 1
    chosen = np.empty(count, dtype=np.intp)
    reach = radii[:, None]
    first, second = _seen(first, arrays.projection), _seen(second, arrays.projection)
    generators = np.concatenate([arrays.intervals, reach * first, reach * second], axis=1)
    weights = np.concatenate([positions, places[:, :, 0], places[:, :, 1]], axis=1)
    step = max(1, min(256, _DRAWN // statistics.draws))
    for start in range(0, count, step):
        part = slice(start, start + step)
        points = arrays.vector[part, None, :] + np.einsum("sg,ngi->nsi", weights, generators[part])
        squares = np.einsum("nsi,nsi->ns", points, points)
        chosen[part] = np.argpartition(squares, rank, axis=1)[:, rank]
    signs = positions[chosen]
    shifts = reach * (places[chosen][:, :, :1] * first + places[chosen][:, :, 1:] * second)
    vector = arrays.vector + np.einsum("nk,nki->ni", signs, arrays.intervals) + shifts.sum(axis=1)
    return PlayedError(_length(vector), vector, signs, shifts)
