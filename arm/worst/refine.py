"""Local searches for worse poses where the error is no polynomial, or the workspace more than a box of joint angles."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from linkwright.core.sections.numeric import Array

from .certificate import climb
from .workspace import Motion, Workspace, distance_to_path, path_points, pull

Bounds = tuple[Array, Array]
ErrorFunction = Callable[[Array], Array]
"""Poses (N, n) to errors (N,), m."""

_ON_REGION = 1e-7


def uphill(error: ErrorFunction, starts: Array, bounds: Bounds, *, step: float = 1e-4, steps: int = 25) -> Array:
    """Local maxima of an error from `starts`, by Newton steps with central differences; bounds may be infinite."""
    return uphill_each(lambda q, _: error(q), starts, bounds, step=step, steps=steps)


def uphill_each(
    error: Callable[[Array, NDArray[np.intp]], Array],
    starts: Array,
    bounds: Bounds,
    *,
    step: float = 1e-4,
    steps: int = 25,
) -> Array:
    """As `uphill`, each start by its error: of poses (N, n) and the starts (N,) that they are on the way from."""
    size = starts.shape[1]
    unit = step * np.eye(size)
    pairs = list(itertools.combinations(range(size), 2))
    mixed = [sign * unit[a] + other * unit[b] for a, b in pairs for sign in (1.0, -1.0) for other in (1.0, -1.0)]
    offsets = np.vstack([np.zeros((1, size)), unit, -unit, *([mixed] if mixed else [])])
    scale = max(float(error(starts, np.arange(len(starts))).max()), 1e-30)

    def at(q: Array, rows: NDArray[np.intp]) -> tuple[Array, Array, Array]:
        around = (q[:, None, :] + offsets).reshape(-1, size)
        values = (error(around, np.repeat(rows, len(offsets))) / scale).reshape(len(q), -1)
        middle, ahead, behind = values[:, 0], values[:, 1 : size + 1], values[:, size + 1 : 2 * size + 1]
        hessian = np.empty((len(q), size, size))
        diagonal = np.arange(size)
        hessian[:, diagonal, diagonal] = (ahead + behind - 2.0 * middle[:, None]) / step**2
        for k, (a, b) in enumerate(pairs):
            corner = values[:, 2 * size + 1 + 4 * k :]
            cross = (corner[:, 0] - corner[:, 1] - corner[:, 2] + corner[:, 3]) / (4.0 * step**2)
            hessian[:, a, b] = hessian[:, b, a] = cross
        return middle, (ahead - behind) / (2.0 * step), hessian

    return climb(at, starts, *bounds, steps=steps)[0]


def in_region(workspace: Workspace, places: Array) -> NDArray[np.bool_]:
    """Whether tips (N, 3) lie in the box, or on the path, to 0.1 um."""
    axes = 2 if workspace.in_plane else 3
    if workspace.kind == "path":
        return distance_to_path(places[:, :axes], workspace) < _ON_REGION
    points = np.array(workspace.points)[:, :axes]
    low, high = points.min(axis=0) - _ON_REGION, points.max(axis=0) + _ON_REGION
    return np.all((places[:, :axes] >= low) & (places[:, :axes] <= high), axis=1)


def uphill_in_region(
    value_and_gradient: Callable[[Array], tuple[float, Array]],
    start: Array,
    workspace: Workspace,
    motion: Motion,
    bounds: Bounds,
) -> Array:
    """A constrained local maximum from `start` with the tip in a box or on its segment of a path (SLSQP).

    The start itself comes back where the search does not better it.
    """
    axes = 2 if workspace.in_plane else 3
    points = np.array(workspace.points)[:, :axes]

    @lru_cache(maxsize=2)
    def place(q: bytes) -> tuple[Array, Array]:
        """The tip and its slopes: values and derivatives of all constraints are asked for at one pose after another."""
        tips, slopes = motion(np.frombuffer(q)[None])
        return tips[0, :axes], slopes[0, :axes]

    def constraint(kind: str, matrix: Array, constant: Array) -> dict[str, object]:
        def value(q: Array) -> Array:
            return matrix @ place(q.tobytes())[0] + constant

        def slope(q: Array) -> Array:
            return matrix @ place(q.tobytes())[1]

        return {"type": kind, "fun": value, "jac": slope}

    scale = max(abs(value_and_gradient(start)[0]), 1e-30)

    def objective(q: Array) -> tuple[float, Array]:
        value, gradient = value_and_gradient(q)
        return -value / scale, -gradient / scale

    if workspace.kind == "box":
        rows = _in_box(points.min(axis=0), points.max(axis=0))
    else:
        rows = _on_segment(place(start.tobytes())[0], workspace)
    result = minimize(
        objective,
        start,
        jac=True,
        bounds=list(zip(*bounds, strict=True)),
        constraints=[constraint(*row) for row in rows if len(row[1])],
        method="SLSQP",
        options={"maxiter": 100, "ftol": 1e-14},
    )
    reached = np.clip(np.asarray(result.x, dtype=float), *bounds)
    better = -objective(reached)[0] >= 1.0 - 1e-9 and bool(in_region(workspace, motion(reached[None])[0])[0])
    return reached if better else start


def _in_box(low: Array, high: Array) -> list[tuple[str, Array, Array]]:
    """Matrices and constants that a place in the box makes not negative (`ineq`) or zero (`eq`)."""
    free, eye = high > low, np.eye(len(low))
    inside = np.vstack([eye[free], -eye[free]]), np.concatenate([-low[free], high[free]])
    return [("ineq", *inside), ("eq", eye[~free], -low[~free])]


def _on_segment(here: Array, path: Workspace) -> list[tuple[str, Array, Array]]:
    """Matrices and constants that a place on the segment nearest to `here` makes zero (`eq`) or not negative."""
    away = [float(distance_to_path(here[None], replace(path, points=ends))[0]) for ends in path.pieces]
    a, b = np.array(path.pieces[int(np.argmin(away))])[:, : len(here)]
    along = b - a
    length = float(np.sqrt(along @ along))
    across = np.linalg.svd(along[None] / length)[2][1:] if length > 0.0 else np.eye(len(a))
    off_line = ("eq", across, -across @ a)
    if length == 0.0:
        return [off_line]
    unit = along / length
    return [off_line, ("ineq", np.vstack([unit, -unit]), np.array([-a @ unit, b @ unit]))]


def wander_in_region(
    error: ErrorFunction, starts: Array, workspace: Workspace, motion: Motion, bounds: Bounds, *, seed: int = 5
) -> Array:
    """Worse poses near `starts` with the tip in a box or on a path: ever closer random neighbours, pulled back."""
    generator = np.random.default_rng(seed)
    best, value, reach = starts, error(starts), 0.1
    axes = 2 if workspace.in_plane else 3
    used = np.array([1.0, 1.0, float(not workspace.in_plane)])
    path = path_points(workspace) if workspace.kind == "path" else np.empty((0, 3))
    per_start = 8
    for _ in range(16):
        trial = np.repeat(best, per_start, axis=0)
        trial = np.clip(trial + reach * generator.standard_normal(trial.shape), *bounds)
        if workspace.kind == "path":
            gaps = ((path[None, :, :axes] - motion(trial)[0][:, None, :axes]) ** 2).sum(axis=2)
            trial, _ = pull(motion, trial, path[gaps.argmin(axis=1)], *bounds, used, steps=20)
        values = np.where(in_region(workspace, motion(trial)[0]), error(trial), -np.inf).reshape(len(best), per_start)
        better = values.max(axis=1) > value
        picked = trial.reshape(len(best), per_start, -1)[np.arange(len(best)), values.argmax(axis=1)]
        best = np.where(better[:, None], picked, best)
        value = np.where(better, values.max(axis=1), value)
        reach *= 0.6
    return best
