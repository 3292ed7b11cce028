"""A smooth model of what nothing explains: a Gaussian process orthogonal to the known physics.

For compensation, not for insight. One process for each component, with a common squared-exponential kernel over joint
coordinates (and time, temperature and payload where the recording has them), a length scale for each input and the
noise found by the marginal likelihood: C. E. Rasmussen & C. K. I. Williams, Gaussian Processes for Machine Learning
(MIT Press, 2006), ch. 2 and 5. Known physics and nuisances enter as columns with wide priors (ch. 2.7), so the process
takes nothing of what they can describe.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize

from linkwright.core.sections.numeric import Array

_STEPS = 40
_MOST = 300
"""Readings that make the model: its cost grows with their third power; of more as many are picked at random."""


@dataclass(frozen=True)
class SmoothModel:
    """A fitted process: inputs (N, k) scaled, their length scales, and weights (N, D) in m."""

    inputs: Array
    center: Array
    spread: Array
    lengths: Array
    variance: float
    weights: Array
    logarithms: Array

    def predict(self, inputs: Array) -> Array:
        """The displacement (M, D), m, at inputs (M, k)."""
        scaled = (inputs - self.center) / self.spread
        return _kernel(scaled, self.inputs, self.lengths, self.variance) @ self.weights


def smooth_model(
    inputs: Array, residual: Array, known: Sequence[Array], seed: int = 1, alike: SmoothModel | None = None
) -> SmoothModel:
    """Fit the process to residuals (N, D), m; `known` are displacements (N, D) per unit of what is known. Scales are
    those of the model `alike` where there is one."""
    center, spread = inputs.mean(axis=0), np.ptp(inputs, axis=0)
    spread = np.where(spread > 0.0, spread, 1.0)
    rows = np.arange(len(inputs))
    if len(rows) > _MOST:
        rows = np.sort(np.random.default_rng(seed).choice(rows, _MOST, replace=False))
    scaled, target = ((inputs - center) / spread)[rows], residual[rows]
    size = float(np.sqrt(np.mean(target**2))) or 1.0
    target = target / size
    beside = _left_alone([np.asarray(part)[rows] / size for part in known], len(rows))
    start = np.concatenate([np.full(scaled.shape[1], np.log(0.7)), [np.log(0.5), np.log(0.5)]])

    def cost(logarithms: Array) -> float:
        factor, weights, _ = _solve(scaled, target, beside, logarithms)
        determinant = 2.0 * float(np.sum(np.log(np.diag(factor[0]))))
        fit = float(np.sum(target * weights))
        return 0.5 * fit + 0.5 * target.shape[1] * determinant + 0.05 * float(np.sum((logarithms - start) ** 2))

    if alike is None:
        bounds = [(-3.0, 4.0)] * scaled.shape[1] + [(-6.0, 3.0)] * 2
        minimum = minimize(cost, start, method="L-BFGS-B", bounds=bounds, options={"maxiter": _STEPS})
        best = np.asarray(minimum.x, dtype=float)
    else:
        best = alike.logarithms
    _, weights, variance = _solve(scaled, target, beside, best)
    return SmoothModel(scaled, center, spread, np.exp(best[:-2]), variance, weights * size, best)


def _kernel(a: Array, b: Array, lengths: Array, variance: float) -> Array:
    a, b = a / lengths, b / lengths
    squared = np.sum(a * a, axis=1)[:, None] + np.sum(b * b, axis=1)[None, :] - 2.0 * a @ b.T
    return variance * np.exp(-0.5 * np.maximum(squared, 0.0))


def _left_alone(known: Sequence[Array], rows: int) -> Array:
    """What covariance (n, n) keeps the process off known columns (n, D) each. Each component has its own; for the
    factor's sake they are pooled, which only widens what the process must leave alone."""
    columns = np.concatenate([np.zeros((rows, 0)), *(part.reshape(rows, -1) for part in known)], axis=1)
    length = np.linalg.norm(columns, axis=0)
    columns = columns[:, length > 0.0] / length[length > 0.0] * np.sqrt(rows)
    return 100.0 * columns @ columns.T


def _solve(inputs: Array, target: Array, beside: Array, logarithms: Array) -> tuple[tuple[Array, bool], Array, float]:
    """Cholesky factor of one component's covariance, the weights (N, D), and the variance; `beside` (N, N) is that of
    what is known."""
    lengths = np.exp(logarithms[:-2])
    variance, noise = np.exp(2.0 * logarithms[-2:]).tolist()
    covariance = _kernel(inputs, inputs, lengths, variance) + (noise + 1e-8) * np.eye(len(inputs)) + beside
    factor = cho_factor(covariance, lower=True)
    return (factor[0], bool(factor[1])), np.asarray(cho_solve(factor, target)), variance
