"""A load case's squared error as trigonometric polynomials: one function for each way in which the play can stand."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.chain.chain import PlayMode
from arm.errors.lost_motion import played, pushed_discs, sign_vertices
from arm.errors.model import CaseModel
from sections.numeric import Array

from .dependence import joints_that_matter
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
_MOST_VERTICES = 256


@dataclass(frozen=True)
class ErrorPolynomials:
    """|e + sum_j s_j I_j|^2 for each row of `signs`, as functions of the joints in `joints` (the others do not matter).

    The error is the root plus `radius` (m): exactly where `exact`, else at most that. With `seatings` a function counts
    only at poses where every load has the sign of its play (`loaded`).
    """

    case: int
    joints: tuple[int, ...]
    functions: Coefficients
    terms: Terms
    signs: Array
    radius: float
    exact: bool
    seatings: Coefficients | None
    seating_terms: Terms | None

    def values(self, q: Array) -> Array:
        """Squares (N, functions) at joint coordinates q (N, n), -inf where the play does not stand so."""
        values = evaluate(self.functions, q[:, self.joints])
        if self.seatings is None:
            return values
        loads = evaluate(self.seatings, q[:, self.joints])
        slack = 1e-12 * np.abs(self.seatings.tensor).max(initial=0.0)
        seated = np.all(loads[:, None, :] * self.signs[None] >= -slack, axis=2)
        return np.where(seated, values, -np.inf)

    def may_be_seated(self, centers: Array, half: Array, which: NDArray[np.intp]) -> NDArray[np.bool_]:
        """False only for cells (scaled coordinates of `joints`) in which function `which` counts nowhere."""
        inside = np.ones(len(centers), dtype=bool)
        if self.seating_terms is None:
            return inside
        terms = self.seating_terms
        second = terms.remainder(half, 1)
        slack = 1e-12 * np.abs(terms.amplitude).sum(axis=1)
        for play in range(len(terms.amplitude)):
            index = np.full(len(centers), play, dtype=np.intp)
            value, gradient, _ = terms.at(centers, index, order=1)
            most = self.signs[which, play] * value + (np.abs(gradient) * half).sum(axis=1) + second[play]
            inside &= most >= -slack[play]
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
) -> ErrorPolynomials:
    """The polynomials of load case `number` for a design p, of the joints that matter; `confined` keeps all that move,
    for a workspace where they decide what is in it.

    Raises `NotPolynomial` where the error is none (loaded clearance in space, statistical play) or has too many joints
    or ways of play.
    """
    count = len(case.error.intervals)
    if mode == "statistical" or 2**count > _MOST_VERTICES:
        raise NotPolynomial("statistical play, or too much of it")
    loaded = mode == "loaded"
    pushed = _pushed(case, p, coordinates) if loaded else np.zeros(len(case.error.discs), dtype=bool)
    held = bool(pushed.any())

    def columns(q: Array) -> Array:
        arrays = case.arrays(q, p)
        vector = arrays.vector
        if held:
            # In the plane a pin's load is a dead load, so the pin lies on the same side of its bore at every pose.
            only_discs = replace(
                arrays,
                intervals=arrays.intervals[:, :0],
                interval_seating=arrays.interval_seating[:, :0],
                taken=(0, arrays.taken[1]),
            )
            vector = played(only_discs, np.where(pushed, case.radii, 0.0), "loaded", planar=planar).vector
        rows = [vector, arrays.intervals.reshape(len(q), -1)]
        # Only the signs of the loads count: in parts of all loads they are pure numbers.
        loads = arrays.interval_seating / np.maximum(arrays.load_scale, 1e-300)[:, None]
        return np.concatenate([*rows, loads] if loaded else rows, axis=1)

    matter = coordinates.moving if confined else joints_that_matter(columns, 3 + 3 * count, case.state.arm, coordinates)
    if len(matter) > MOST_JOINTS:
        raise NotPolynomial("the error depends on too many joints")
    kept = coordinates.of(matter)
    # Vectors and loads are fitted apart, each by the measure of its own size.
    shapes = fit(lambda q: columns(coordinates.placed(matter, q))[:, : 3 + 3 * count], kept)
    signs = sign_vertices(count)
    functions = _squares(shapes, signs)
    seatings = None
    if loaded and count:
        seatings = fit(lambda q: columns(coordinates.placed(matter, q))[:, 3 + 3 * count :], kept)
    # Of a pin that nothing pushed a calibration took the middle.
    free = np.arange(len(pushed)) < len(pushed) - case.taken[1]
    radius = float(case.radii[~pushed & free].sum())
    return ErrorPolynomials(
        number,
        matter,
        functions,
        terms_of(functions),
        signs,
        radius,
        planar or radius == 0.0,
        seatings,
        terms_of(seatings) if seatings is not None else None,
    )


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


def _squares(shapes: Coefficients, signs: Array) -> Coefficients:
    """|vector + signs . intervals|^2 for each row of signs, of twice the degree."""
    count = signs.shape[1]
    values = shapes.values_on(2 * shapes.degree)
    grid = values.shape[1:]
    points = int(np.prod(grid, dtype=int))
    vector, reach = values[:3].reshape(3, points), values[3:].reshape(count, 3, points)
    vertices = vector[None] + np.einsum("vk,kix->vix", signs, reach)
    squares = (vertices * vertices).sum(axis=1).reshape(len(signs), *grid)
    return from_values(shapes.coordinates, 2 * shapes.degree, squares)
