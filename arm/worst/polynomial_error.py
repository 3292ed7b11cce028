"""A load case's squared error as trigonometric polynomials: one function for each way in which the play can stand, and
for each zone in which drives that stiffen under load can be."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import PlayMode
from linkwright.core.arm.effects.functions import wound_up
from linkwright.core.arm.errors.drive_zones import ZoneCombination, zone_combinations
from linkwright.core.arm.errors.lost_motion import played, pushed_discs, sign_vertices
from linkwright.core.arm.errors.model import CaseModel
from linkwright.core.sections.numeric import Array

from .dependence import joints_that_matter, still_all_that_matter
from .polynomial import (
    Coefficients,
    Coordinates,
    NotPolynomial,
    Terms,
    evaluate,
    fit,
    from_values,
    sample_grid,
    terms_of,
)

MOST_JOINTS = 4
"""Branch and bound over more joints than this takes too many cells."""
_MOST_FUNCTIONS = 512


@dataclass(frozen=True)
class ErrorPolynomials:
    """|e + sum_j w_j V_j|^2 for each row of `weights`, as functions of the joints in `joints` (the others do not
    matter): V_j are the intervals of play, and what drives with zones of stiffness move.

    The error is the root plus `radius` (m): exactly where `exact`, else at most that. With `seatings` (loads, in parts
    of all loads) a function counts only at poses where each load is between its `least` and `most` (functions, loads):
    where it has the sign of its play (`loaded`), and lies in the zone.
    """

    case: int
    joints: tuple[int, ...]
    functions: Coefficients
    terms: Terms
    weights: Array
    radius: float
    exact: bool
    seatings: Coefficients | None
    seating_terms: Terms | None
    least: Array
    most: Array

    def values(self, q: Array) -> Array:
        """Squares (N, functions) at joint coordinates q (N, n), -inf where the play and the drives do not stand so."""
        values = evaluate(self.functions, q[:, self.joints])
        if self.seatings is None:
            return values
        loads = evaluate(self.seatings, q[:, self.joints])[:, None, :]
        slack = 1e-12 * np.abs(self.seatings.tensor).max(initial=0.0)
        seated = np.all((loads >= self.least[None] - slack) & (loads <= self.most[None] + slack), axis=2)
        return np.where(seated, values, -np.inf)

    def may_be_seated(self, centers: Array, half: Array, which: NDArray[np.intp]) -> NDArray[np.bool_]:
        """False only for cells (scaled coordinates of `joints`) in which function `which` counts nowhere."""
        inside = np.ones(len(centers), dtype=bool)
        if self.seating_terms is None:
            return inside
        terms = self.seating_terms
        second = terms.remainder(half, 1)
        slack = 1e-12 * np.abs(terms.amplitude).sum(axis=1)
        for load in range(len(terms.amplitude)):
            index = np.full(len(centers), load, dtype=np.intp)
            value, gradient, _ = terms.at(centers, index, order=1)
            reach = (np.abs(gradient) * half).sum(axis=1) + second[load] + slack[load]
            inside &= (value + reach >= self.least[which, load]) & (value - reach <= self.most[which, load])
        return inside


def error_polynomials(
    case: CaseModel,
    number: int,
    p: NDArray[np.float64],
    coordinates: Coordinates,
    mode: PlayMode,
    *,
    planar: bool,
    confined: bool,
    matter: tuple[int, ...] | None = None,
) -> ErrorPolynomials:
    """The polynomials of load case `number` for a design p, of the joints that matter; `confined` keeps all that move,
    for a workspace where they decide what is in it. `matter` are those that mattered for another design: they are taken
    if they are all that matter for this one.

    Raises `NotPolynomial` where the error is none (loaded clearance in space, statistical play) or has too many joints
    or ways of play.
    """
    count, zones = len(case.error.intervals), case.zones
    if mode == "statistical" or 2**count > _MOST_FUNCTIONS:
        raise NotPolynomial("statistical play, or too much of it")
    loaded = mode == "loaded"
    pushed = _pushed(case, p, coordinates) if loaded else np.zeros(len(case.error.discs), dtype=bool)
    size = 1.0
    if zones:
        size = max(float(case.arrays(sample_grid(coordinates, 1), p).load_scale.max()), 1e-300)
    columns = _columns(case, p, pushed, size, loaded=loaded, planar=planar)
    vectors = 3 + 3 * count + 6 * len(zones)
    known = coordinates.moving if confined else matter
    if known is None or not (confined or still_all_that_matter(columns, vectors, coordinates, known)):
        known = joints_that_matter(columns, vectors, case.state.arm, coordinates)
    if len(known) > MOST_JOINTS:
        raise NotPolynomial("the error depends on too many joints")
    matter = known
    joints = coordinates.of(matter)
    # Vectors and loads are fitted apart, each by the measure of its size.
    shapes = fit(lambda q: columns(coordinates.placed(matter, q))[:, :vectors], joints)
    seatings = None
    if (loaded and count) or zones:
        seatings = fit(lambda q: columns(coordinates.placed(matter, q))[:, vectors:], joints)
    seating_terms = None if seatings is None else terms_of(seatings)
    greatest = np.zeros(0)
    if seating_terms is not None and zones:
        greatest = size * (np.abs(seating_terms.amplitude).sum(axis=1) + seating_terms.neglected)[-len(zones) :]
    regions = zone_combinations(zones, greatest, size, _MOST_FUNCTIONS // 2**count)
    weights, least, most = _standings(count, regions, loaded=loaded)
    functions = _squares(shapes, weights)
    # Of a pin that nothing pushed a calibration took the middle.
    free = np.arange(len(pushed)) < len(pushed) - case.taken[1]
    radius = float(case.radii[~pushed & free].sum())
    return ErrorPolynomials(
        number,
        matter,
        functions,
        terms_of(functions),
        weights,
        radius,
        (planar or radius == 0.0) and all(region.exact for region in regions),
        seatings,
        seating_terms,
        least.reshape(len(weights), -1),
        most.reshape(len(weights), -1),
    )


def _standings(count: int, regions: Sequence[ZoneCombination], *, loaded: bool) -> tuple[Array, Array, Array]:
    """The weights of each function, and the least and most of the loads between which it counts."""
    signs = sign_vertices(count)
    weights = np.array([[*item, *region.weights] for item, region in _pairs(signs, regions)])
    seats = signs if loaded else np.zeros((len(signs), 0))
    least = np.array([[*np.where(item > 0.0, 0.0, -np.inf), *region.least] for item, region in _pairs(seats, regions)])
    most = np.array([[*np.where(item > 0.0, np.inf, 0.0), *region.most] for item, region in _pairs(seats, regions)])
    return weights, least, most


def _columns(
    case: CaseModel, p: Array, pushed: NDArray[np.bool_], size: float, *, loaded: bool, planar: bool
) -> Callable[[Array], Array]:
    """The columns that are fitted, of poses (N, n): the vector, what adds to it in the ways that play and drives stand,
    and the loads that say which way (those on drives in parts of `size`); `pushed` discs lie where loads push them."""

    def columns(q: Array) -> Array:
        arrays = case.arrays(q, p)
        vector = arrays.vector
        if pushed.any():
            # In the plane a pin's load is a dead load, so the pin lies on the same side of its bore at every pose.
            only_discs = replace(
                arrays,
                intervals=arrays.intervals[:, :0],
                interval_seating=arrays.interval_seating[:, :0],
                taken=(0, arrays.taken[1]),
            )
            vector = played(only_discs, np.where(pushed, case.radii, 0.0), "loaded", planar=planar).vector
        rows = [arrays.intervals.reshape(len(q), -1)]
        for k, item in enumerate(case.zones):
            # What a drive winds up by is no polynomial, but within each zone it is its load and a constant.
            load, moved = arrays.kink_loads[:, k], arrays.kinks[:, k]
            vector = vector - wound_up(load, item)[:, None] * moved
            rows += [load[:, None] * moved / item[0][1], moved * (item[0][0] / item[0][1])]
        rows = [vector, *rows]
        if loaded:
            # Only the signs of the loads count: in parts of all loads they are pure numbers.
            rows.append(arrays.interval_seating / np.maximum(arrays.load_scale, 1e-300)[:, None])
        return np.concatenate([*rows, arrays.kink_loads / size] if case.zones else rows, axis=1)

    return columns


def _pairs(signs: Array, regions: Sequence[ZoneCombination]) -> list[tuple[Array, ZoneCombination]]:
    return list(itertools.product(signs, regions))


def _pushed(case: CaseModel, p: Array, coordinates: Coordinates) -> NDArray[np.bool_]:
    """Which discs have a load that pushes them; those without one count as worst (`loaded`).

    Raises `NotPolynomial` where that differs from pose to pose.
    """
    arrays = case.arrays(sample_grid(coordinates, 1), p)
    pushed = pushed_discs(arrays)
    always = np.asarray(pushed.all(axis=0), dtype=bool)
    if not np.array_equal(always, pushed.any(axis=0)):
        raise NotPolynomial("a pin is pushed at some poses and free at others")
    return always


def _squares(shapes: Coefficients, weights: Array) -> Coefficients:
    """|vector + weights . vectors|^2 for each row of weights, of twice the degree."""
    count = weights.shape[1]
    values = shapes.values_on(2 * shapes.degree)
    grid = values.shape[1:]
    points = int(np.prod(grid, dtype=int))
    vector, reach = values[:3].reshape(3, points), values[3:].reshape(count, 3, points)
    vertices = vector[None] + np.einsum("vk,kix->vix", weights, reach)
    squares = (vertices * vertices).sum(axis=1).reshape(len(weights), *grid)
    return from_values(shapes.coordinates, 2 * shapes.degree, squares)
