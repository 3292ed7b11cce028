"""What others would do with the same recording: calibration, ridge, greedy BIC, lasso, a Gaussian process.

All but the last get the tool's own columns (`patterns`), and all work at their textbooks' settings. Each is fitted to
one recording and predicts another; a fit says which names it gives and whether it claims that anything is there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, optimize, stats

from benchmarks.blind.generator.vectors import Array
from benchmarks.blind.proof.patterns import Name, Patterns

GEOMETRY = ("frame_misalignment", "encoder_offset", "link_length", "tool_offset")
_LEVEL = 0.01
"""Level of those that test."""
_FOLDS = 5
_PATIENCE = 6
"""Strengths by which the lasso's path goes on beyond the best so far."""


@dataclass(frozen=True)
class Fitted:
    """A fit: `names` it gives (none where the method names nothing), whether it claims a mismatch (None where the
    method never says), and what it adds to the model at other readings, (rows, axes) in m."""

    names: tuple[Name, ...]
    claims: bool | None
    predict: Callable[[Patterns], Array]


@dataclass(frozen=True)
class _Linear:
    """Columns scaled to length 1 once the nuisance is projected out."""

    matrix: Array
    vector: Array
    scale: Array
    group: NDArray[np.int64]  # (d, 2) the candidate of each column, and which of its columns
    free: int  # degrees of freedom of the vector


def _linear(patterns: Patterns, chosen: list[int]) -> _Linear:
    whole = np.concatenate([patterns.columns[k] for k in chosen], axis=1)
    group = np.repeat(np.array(chosen), [patterns.columns[k].shape[1] for k in chosen])
    raw = np.linalg.norm(whole, axis=0)
    basis = _orthonormal(patterns.nuisance)
    matrix = whole - basis @ (basis.T @ whole)
    size = np.linalg.norm(matrix, axis=0)
    live = size > 1e-6 * np.maximum(raw, 1e-300)  # what the nuisance swallows is nobody's
    vector = patterns.vector - basis @ (basis.T @ patterns.vector)
    free = vector.size - basis.shape[1]
    return _Linear(matrix[:, live] / size[live], vector, size[live], _columns_of(group, live), free)


def _columns_of(group: NDArray[np.int64], live: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Pairs (candidate, its column) of the columns that are left, (d, 2)."""
    number = np.concatenate([np.arange(count) for count in np.unique(group, return_counts=True)[1]])
    order = np.argsort(group, kind="stable")
    column = np.empty(group.size, dtype=int)
    column[order] = number
    return np.stack([group, column], axis=1)[live]


def _orthonormal(matrix: Array, tolerance: float = 1e-9) -> Array:
    if matrix.shape[1] == 0:
        return matrix
    u, s, _ = np.linalg.svd(matrix / np.maximum(np.linalg.norm(matrix, axis=0), 1e-300), full_matrices=False)
    return u[:, s > tolerance * s[0]]


def _predictor(problem: _Linear, scaled: Array) -> Callable[[Patterns], Array]:
    def predict(other: Patterns) -> Array:
        total = np.zeros(other.vector.size)
        for (group, column), value in zip(problem.group.tolist(), (scaled / problem.scale).tolist(), strict=True):
            if value != 0.0:
                total += other.columns[group][:, column] * value
        return total.reshape(-1, other.axes)

    return predict


def _names(patterns: Patterns, problem: _Linear, scaled: Array) -> tuple[Name, ...]:
    """Names with a coefficient, those that move most first; variants of one candidate count once."""
    moved: dict[Name, float] = {}
    for k in np.unique(problem.group[scaled != 0.0, 0]).tolist():
        own = problem.group[:, 0] == k
        size = float(np.linalg.norm(problem.matrix[:, own] @ scaled[own]))
        moved[patterns.names[k]] = max(size, moved.get(patterns.names[k], 0.0))
    return tuple(sorted(moved, key=lambda name: -moved[name]))


def geometry_only(given: Patterns) -> Fitted:
    """Frame, encoder offsets, link lengths and tool by least squares of least norm: kinematic calibration.

    Claims by the F test of all of them at 1 %. B. W. Mooring, Z. S. Roth & M. R. Driels, Fundamentals of Manipulator
    Calibration (Wiley, 1991).
    """
    chosen = [k for k, (effect, at) in enumerate(given.names) if effect in GEOMETRY and len(at) < 2]
    problem = _linear(given, chosen)
    u, s, vt = np.linalg.svd(problem.matrix, full_matrices=False)
    kept = s > 1e-6 * s[0]
    along = u[:, kept].T @ problem.vector
    scaled = vt[kept].T @ (along / s[kept])
    rank = int(kept.sum())
    rest = float(problem.vector @ problem.vector - along @ along) / (problem.free - rank)
    claims = bool(stats.f.sf(float(along @ along) / rank / rest, rank, problem.free - rank) < _LEVEL)
    return Fitted((), claims, _predictor(problem, scaled))


def fit_everything(given: Patterns) -> Fitted:
    """All columns by ridge regression, its strength by generalised cross-validation (G. H. Golub, M. Heath & G. Wahba,
    Technometrics 21 (1979) 215, doi:10.1080/00401706.1979.10489751). It names nothing and always claims."""
    problem = _linear(given, list(range(len(given.names))))
    u, s, vt = np.linalg.svd(problem.matrix, full_matrices=False)
    along = u.T @ problem.vector
    outside = float(problem.vector @ problem.vector - along @ along)

    def criterion(strength: float) -> float:
        share = s**2 / (s**2 + strength)
        rss = outside + float(np.sum(((1.0 - share) * along) ** 2))
        return rss / max(problem.free - float(share.sum()), 1e-9) ** 2

    grid = s[0] ** 2 * np.logspace(-9.0, 3.0, 97)
    best = float(grid[int(np.argmin([criterion(float(x)) for x in grid]))])
    return Fitted((), None, _predictor(problem, vt.T @ (s / (s**2 + best) * along)))


def greedy_bic(given: Patterns, most: int = 25) -> Fitted:
    """Forward selection of candidates, the one that lowers BIC = n ln(RSS/n) + k ln n most, until none does.

    G. Schwarz, Ann. Statist. 6 (1978) 461, doi:10.1214/aos/1176344136.
    """
    problem = _linear(given, list(range(len(given.names))))
    groups = [np.flatnonzero(problem.group[:, 0] == k) for k in np.unique(problem.group[:, 0]).tolist()]
    left, matrix = problem.vector.copy(), problem.matrix.copy()
    taken: list[int] = []
    n, price = problem.free, np.log(problem.free)
    while len(taken) < most:
        rss = float(left @ left)
        sizes = matrix.T @ left
        best, gain = -1, 0.0
        for k, own in enumerate(groups):
            if k in taken:
                continue
            won = _won(matrix[:, own], sizes[own])
            better = -n * np.log(max(1.0 - won / rss, 1e-12)) - price * own.size
            if better > gain:
                best, gain = k, better
        if best < 0:
            break
        taken.append(best)
        basis = _orthonormal(matrix[:, groups[best]], 1e-6)
        matrix -= basis @ (basis.T @ matrix)
        left -= basis @ (basis.T @ left)
    scaled = np.zeros(problem.scale.size)
    if taken:
        own = np.concatenate([groups[k] for k in taken])
        scaled[own] = np.linalg.lstsq(problem.matrix[:, own], problem.vector, rcond=1e-8)[0]
    return Fitted(_names(given, problem, scaled), bool(taken), _predictor(problem, scaled))


def _won(columns: Array, against: Array) -> float:
    """How much of a vector's sum of squares columns explain, `against` their products with it."""
    if columns.shape[1] == 1:
        size = float(columns[:, 0] @ columns[:, 0])
        return float(against[0]) ** 2 / size if size > 1e-8 else 0.0
    values, vectors = np.linalg.eigh(columns.T @ columns)
    kept = values > 1e-8
    return float(np.sum((vectors[:, kept].T @ against) ** 2 / values[kept]))


def lasso(given: Patterns) -> Fitted:
    """The lasso by coordinate descent, its strength by cross-validation over visits with the one-standard-error rule.

    R. Tibshirani, J. R. Stat. Soc. B 58 (1996) 267, doi:10.1111/j.2517-6161.1996.tb02080.x; J. Friedman, T. Hastie &
    R. Tibshirani, J. Stat. Softw. 33 (2010), doi:10.18637/jss.v033.i01.
    """
    problem = _linear(given, list(range(len(given.names))))
    strengths = float(np.abs(problem.matrix.T @ problem.vector).max()) * np.logspace(0.0, -2.0, 30)
    fold = np.repeat(given.visit % _FOLDS, given.axes)
    parts = [fold == k for k in range(_FOLDS) if (fold == k).any()]
    shares = [float(np.mean(~out)) for out in parts]
    paths = [lasso_path(problem.matrix[~out], problem.vector[~out]) for out in parts]
    best = 0
    mean: list[float] = []
    error: list[float] = []
    for strength in strengths.tolist():
        sizes = [path(strength * share) for path, share in zip(paths, shares, strict=True)]
        scores = np.array(
            [np.mean((problem.vector[out] - problem.matrix[out] @ b) ** 2) for out, b in zip(parts, sizes, strict=True)]
        )
        mean.append(float(scores.mean()))
        error.append(float(scores.std(ddof=1)) / np.sqrt(len(parts)))
        best = int(np.argmin(mean))
        if len(mean) - best > _PATIENCE:
            break
    chosen = int(np.flatnonzero(np.array(mean) <= mean[best] + error[best])[0])
    whole = lasso_path(problem.matrix, problem.vector)
    scaled = np.zeros(problem.scale.size)
    for strength in strengths[: chosen + 1].tolist():
        scaled = whole(strength)
    return Fitted(_names(given, problem, scaled), bool(scaled.any()), _predictor(problem, scaled))


def lasso_path(matrix: Array, vector: Array, sweeps: int = 300) -> Callable[[float], Array]:
    """Gives the minimiser of |y - X b|^2 / 2 + s |b|_1 for a strength s; called with falling strengths, each starts
    from the last."""
    gram = matrix.T @ matrix
    diagonal = np.maximum(np.diag(gram), 1e-12)
    size = np.zeros(diagonal.size)
    gradient = matrix.T @ vector  # X'(y - X b)

    def sweep(coordinates: list[int], strength: float) -> float:
        largest = 0.0
        for j in coordinates:
            raw = gradient[j] + diagonal[j] * size[j]
            new = np.sign(raw) * max(abs(raw) - strength, 0.0) / diagonal[j]
            step = new - size[j]
            if step != 0.0:
                gradient[:] -= gram[j] * step
                largest = max(largest, abs(step))
                size[j] = new
        return largest

    def at(strength: float) -> Array:
        for _ in range(sweeps):
            active = np.flatnonzero((size != 0.0) | (np.abs(gradient) > strength * (1.0 + 1e-6))).tolist()
            if sweep(active, strength) <= 1e-3 * np.abs(size).max(initial=0.0):
                break
        return size.copy()

    return at


def gaussian_process(given: Patterns) -> Fitted:
    """A Gaussian process over joint coordinates and all else that was logged, by maximum likelihood.

    Squared exponential with a length for each input; the axes share it. It names nothing and claims by the likelihood
    ratio at 1 %. C. E. Rasmussen & C. K. I. Williams, Gaussian Processes for Machine Learning (MIT Press, 2006), ch. 2
    and 5. Readings of one visit enter as their mean, and their scatter with its own likelihood.
    """
    first, inverse = np.unique(given.visit, return_inverse=True)
    count = np.bincount(inverse).astype(float)
    raw, target = (_means(x, inverse, count) for x in (_inputs(given), given.residual))
    middle, spread = raw.mean(axis=0), raw.std(axis=0)
    live = spread > 1e-9
    inputs = (raw[:, live] - middle[live]) / spread[live]
    unit = float(np.sqrt(np.mean(given.residual**2)))
    target = target / unit
    within = float(np.sum((given.residual / unit - target[inverse]) ** 2))
    apart = np.stack([_distances(x[:, None], x[:, None]) for x in inputs.T])
    (rows, axes), more = given.residual.shape, given.residual.shape[0] - first.size

    def cost(log: Array) -> tuple[float, Array]:
        """Minus the log likelihood of all readings, and its gradient in the logs of signal, noise and lengths."""
        noise, squares = float(np.exp(2.0 * log[1])), np.exp(-2.0 * log[2:])
        smooth = np.exp(2.0 * log[0] - 0.5 * np.tensordot(squares, apart, axes=1))
        factor = linalg.cho_factor(smooth + np.diag(noise / count + 1e-9), lower=True, check_finite=False)
        weights = linalg.cho_solve(factor, target, check_finite=False)
        inner = axes * linalg.cho_solve(factor, np.eye(first.size), check_finite=False) - weights @ weights.T
        logs = axes * float(np.sum(np.log(np.diag(factor[0]))) + more * log[1])
        value = 0.5 * float(np.sum(target * weights)) + logs + 0.5 * within / noise
        product = inner * smooth
        slope = np.concatenate(
            [
                [float(product.sum())],
                [noise * float(np.sum(np.diag(inner) / count)) + axes * more - within / noise],
                0.5 * squares * np.tensordot(apart, product, axes=2),
            ]
        )
        return value, slope

    k = inputs.shape[1]
    bounds = [(-6.0, 2.0), (-6.0, 1.0), *[(-1.5, 5.0)] * k]
    starts = (np.array([-0.3, -0.7, *[length] * k]) for length in (1.0, 2.5))
    results = [optimize.minimize(cost, start, jac=True, method="L-BFGS-B", bounds=bounds) for start in starts]
    best = results[int(np.argmin([float(result.fun) for result in results]))]
    log = np.asarray(best.x)
    size = float(np.sum((given.residual / unit) ** 2))
    alone, _ = cost(np.array([-30.0, 0.5 * np.log(size / (rows * axes)), *[1.0] * k]))
    claims = bool(stats.chi2.sf(2.0 * (alone - float(best.fun)), k + 1) < _LEVEL)
    squares = np.exp(-2.0 * log[2:])

    def smooth_between(a: Array, b: Array) -> Array:
        return np.exp(2.0 * log[0] - 0.5 * _distances(a * np.sqrt(squares), b * np.sqrt(squares)))

    whole = smooth_between(inputs, inputs) + np.diag(np.exp(2.0 * log[1]) / count + 1e-9)
    weights = linalg.solve(whole, target, assume_a="pos")

    def predict(other: Patterns) -> Array:
        return unit * smooth_between((_inputs(other)[:, live] - middle[live]) / spread[live], inputs) @ weights

    return Fitted((), claims, predict)


def _inputs(patterns: Patterns) -> Array:
    return np.concatenate([patterns.joints, patterns.covariates], axis=1)


def _means(values: Array, inverse: NDArray[np.intp], count: Array) -> Array:
    return np.stack([np.bincount(inverse, weights=column) for column in values.T], axis=1) / count[:, None]


def _distances(a: Array, b: Array) -> Array:
    """Squared distances (rows of a, rows of b)."""
    return np.sum((a[:, None, :] - b[None, :, :]) ** 2, axis=2)


BASELINES: Mapping[str, Callable[[Patterns], Fitted]] = MappingProxyType(
    {
        "geometry only": geometry_only,
        "fit everything": fit_everything,
        "greedy BIC": greedy_bic,
        "lasso": lasso,
        "Gaussian process": gaussian_process,
    }
)
