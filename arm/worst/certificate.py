"""The certified worst case: branch and bound over a box of joint coordinates.

The squared error at each vertex of the play is a trigonometric polynomial (`arm.worst.polynomial`). Over a cell it is
bounded by its second-order Taylor polynomial at the centre, maximised coordinate by coordinate, and a bound on the
third-order remainder from the amplitudes. Cells that cannot beat the best pose found are dropped; the rest are halved.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array

from .polynomial import Terms

Index = NDArray[np.intp]
CellFilter = Callable[[Array, Array, Index], NDArray[np.bool_]]
"""(centres (N, n), half widths (N, n), functions (N,)) -> which cells may hold an admissible point."""

Derivatives = Callable[[Array, Index], tuple[Array, Array, Array]]
"""Points (N, n), and of which starts they come (N,), to values (N,), gradients (N, n) and Hessians (N, n, n)."""

_OUTWARD = 1e-12
_CHUNK = 8192
_NO_GAIN = 1e-14
"""A step that promises less than this share more is none."""
_LEAST_DAMPING = 1e-3
"""Where not even so small a share of a step leads upwards the climb is at its end."""


@dataclass(frozen=True)
class Certified:
    """The largest value found, where and of which function, and a bound that no point exceeds.

    `complete` is False where the cell budget ended the search before the gap was closed: the bound still holds.
    """

    value: float
    point: Array
    function: int
    bound: float
    cells: int
    complete: bool


def upper_bounds(terms: Terms, centers: Array, half: Array, which: Index) -> tuple[Array, Array]:
    """Values at the cells' centres and upper bounds over the cells, rounded outward."""
    value, gradient, hessian = terms.at(centers, which)
    slope = np.abs(gradient) * half
    curve = hessian * half[:, :, None] * half[:, None, :]
    diagonal = np.einsum("nii->ni", curve)
    # u' C u <= sum_i (C_ii + sum_j |C_ij|) u_i^2 for |u_i| <= 1: the coordinates separate.
    curvature = diagonal + np.abs(curve).sum(axis=2) - np.abs(diagonal)
    inside = (curvature < 0.0) & (slope < -curvature)
    peak = slope * slope / np.where(inside, -2.0 * curvature, 1.0)
    gain = np.where(inside, peak, slope + 0.5 * curvature)
    size = np.abs(terms.amplitude).sum(axis=1)
    tail = terms.remainder(half, 2)[which, np.arange(len(which))]
    slack = terms.neglected[which] + _OUTWARD * size[which]
    return value, value + gain.sum(axis=1) + tail + slack


def maximise(
    terms: Terms,
    lower: Array,
    upper: Array,
    *,
    gap: float,
    incumbent: float = -np.inf,
    keep: CellFilter | None = None,
    admissible: CellFilter | None = None,
    most_cells: int = 2_000_000,
) -> Certified:
    """The largest of all functions of `terms` over a box (scaled coordinates), to a relative `gap`.

    `incumbent` is a value known to be reached. `keep` drops cells that hold nothing admissible; `admissible` tells
    whether a cell's very centre counts as found (every centre does where there is no `keep`).
    """
    functions, size = terms.amplitude.shape[0], len(lower)
    best, best_point, best_function = incumbent, 0.5 * (lower + upper), -1
    span = upper - lower
    parts = np.maximum(1, np.ceil(span / 1.2)).astype(int) if size else np.zeros(0, dtype=int)
    axes = [lower[j] + span[j] * (np.arange(parts[j]) + 0.5) / parts[j] for j in range(size)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, size) if size else np.zeros((1, 0))
    centers = np.tile(grid, (functions, 1))
    which = np.repeat(np.arange(functions, dtype=np.intp), len(grid))
    half = np.broadcast_to(0.5 * span / np.maximum(parts, 1), centers.shape).copy()
    weight = np.sqrt(np.abs(terms.amplitude).max(axis=0) @ (np.abs(terms.frequency) + terms.power) ** 2)
    bound, cells, complete = best, 0, True
    while len(centers):
        if cells + len(centers) > most_cells:
            complete = False
        if keep is not None:
            inside = keep(centers, half, which)
            centers, half, which = centers[inside], half[inside], which[inside]
        cells += len(centers)
        values, tops = np.empty(len(centers)), np.empty(len(centers))
        for start in range(0, len(centers), _CHUNK):
            part = slice(start, start + _CHUNK)
            values[part], tops[part] = upper_bounds(terms, centers[part], half[part], which[part])
        result = values if admissible is None else np.where(admissible(centers, half, which), values, -np.inf)
        if len(result) and result.max() > best:
            top = int(np.argmax(result))
            best, best_point, best_function = float(result[top]), centers[top].copy(), int(which[top])
        enough = best + gap * abs(best) if np.isfinite(best) else -np.inf
        open_cells = tops > enough
        if np.any(~open_cells):
            bound = max(bound, float(tops[~open_cells].max()))
        if not complete or (size == 0):
            bound = max(bound, float(tops.max(initial=-np.inf)))
            break
        centers, half, which = _halved(centers[open_cells], half[open_cells], which[open_cells], weight)
    return Certified(best, best_point, best_function, max(bound, best), cells, complete)


def _halved(centers: Array, half: Array, which: Index, weight: Array) -> tuple[Array, Array, Index]:
    if not len(centers):
        return centers, half, which
    split = np.argmax(half * weight, axis=1)
    rows = np.arange(len(centers))
    smaller = half.copy()
    smaller[rows, split] *= 0.5
    step = np.zeros_like(half)
    step[rows, split] = smaller[rows, split]
    return (
        np.concatenate([centers - step, centers + step]),
        np.concatenate([smaller, smaller]),
        np.concatenate([which, which]),
    )


def climb(at: Derivatives, starts: Array, lower: Array, upper: Array, steps: int = 40) -> tuple[Array, Array]:
    """Local maxima of a function for each of `starts` (N, n) within a box, by projected Newton steps on all at once;
    each start may have a separate function.

    Infinite bounds leave a full-circle joint free to turn through. Returns points (N, n) and values (N,).
    """
    points = np.clip(starts, lower, upper)
    rows = np.arange(len(points), dtype=np.intp)
    value, gradient, hessian = at(points, rows)
    x, values = points, value.copy()
    damping = np.ones(len(x))
    for _ in range(steps):
        whole, promised = _newton_step(x, gradient, hessian, lower, upper)
        # Most are there after a few steps: only what still climbs is worked out again.
        going = (promised > _NO_GAIN * np.abs(value)) & (damping >= _LEAST_DAMPING)
        if not np.all(going):
            points[rows], values[rows] = x, value
            rows, x, value, gradient = rows[going], x[going], value[going], gradient[going]
            hessian, damping, whole = hessian[going], damping[going], whole[going]
        if not len(rows):
            break
        trial = np.clip(x + whole * damping[:, None], lower, upper)
        new_value, new_gradient, new_hessian = at(trial, rows)
        better = new_value > value
        damping = np.where(better, np.minimum(1.0, 2.0 * damping), 0.25 * damping)
        x = np.where(better[:, None], trial, x)
        value = np.where(better, new_value, value)
        gradient = np.where(better[:, None], new_gradient, gradient)
        hessian = np.where(better[:, None, None], new_hessian, hessian)
    points[rows], values[rows] = x, value
    return points, values


def _newton_step(x: Array, gradient: Array, hessian: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Steps uphill (N, n) from points within a box, and what each promises to first order (N,)."""
    held = ((x <= lower) & (gradient < 0.0)) | ((x >= upper) & (gradient > 0.0))
    free = ~held
    # A held coordinate takes the Hessian's size: one of another size would drown the others' curvatures.
    size = np.abs(hessian).max(axis=(1, 2), initial=0.0)[:, None, None]
    masked = hessian * free[:, :, None] * free[:, None, :] - size * np.eye(x.shape[1]) * held[:, :, None]
    eigenvalues, vectors = np.linalg.eigh(masked)
    floor = 1e-6 * np.abs(eigenvalues).max(axis=1, initial=1e-300, keepdims=True)
    uphill = np.einsum("nij,ni->nj", vectors, gradient * free) / np.maximum(np.abs(eigenvalues), floor)
    step = np.clip(np.einsum("nij,nj->ni", vectors, uphill), -0.6, 0.6)
    return step, np.einsum("ni,ni->n", gradient * free, step)
