"""An instrument that wanders: a random walk upon the noise of single readings, found, and taken out of what is tested.

White noise with a random walk below it is the local level model (A. C. Harvey, Forecasting, Structural Time Series
Models and the Kalman Filter, Cambridge 1989, 2.3). Differences of neighbouring readings are then correlated with the
next ones alone, so that their covariance is tridiagonal and whitening costs no more than the readings are many.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky_banded, solve_banded

from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.fitting_rules import FittingRules
from linkwright.core.sections.numeric import Array


def clock(recording: Recording) -> Array:
    """When each reading was taken (N,), s; where nobody knows, its number."""
    if recording.time is not None and bool((np.diff(recording.time) >= 0.0).all()):
        return recording.time
    return recording.row.astype(np.float64)


def growth(time: Array, rate: float, which: NDArray[np.int64] | None) -> Array:
    """By how much the variance of a random walk grows from each reading at a time (N,) to the next, (N - 1,). Infinite
    where another recording begins (`which` (N,) numbers them): the instrument was set up anew, and so begins the walk.
    """
    grows = rate * np.maximum(np.diff(time), 0.0)
    return grows if which is None else np.where(np.diff(which) != 0, np.inf, grows)


def without_wander(values: Array, grows: Array) -> Array:
    """Values (N, ...) of unit scatter and a random walk whose variance grows by `grows` (N - 1,) from one to the next,
    as independent ones of unit variance. The walk begins at zero, and again after what is infinite."""
    if values.size == 0:
        return values
    factor = cholesky_banded(_band(grows), lower=True)
    flat = values.reshape(len(values), -1)
    # The factor is lower bidiagonal; `solve_banded` wants the diagonal first.
    solution = solve_banded((1, 0), factor, _differences(flat, np.isinf(grows)))
    return solution.reshape(values.shape)


def walks(grows: Array, drawn: Array) -> Array:
    """Random walks (N, ...) whose variance grows by `grows` (N - 1,), of steps of unit variance (N, ...): at zero
    first, and again after what is infinite."""
    begins = np.concatenate([[0], 1 + np.flatnonzero(np.isinf(grows)), [len(drawn)]])
    steps = np.sqrt(np.concatenate([[0.0], np.where(np.isinf(grows), 0.0, grows)]))
    moved = steps.reshape(-1, *(1,) * (drawn.ndim - 1)) * drawn
    parts = [np.cumsum(moved[begin:end], axis=0) for begin, end in pairwise(begins.tolist())]
    return np.concatenate(parts)


@dataclass(frozen=True)
class Wander:
    """A random walk below values of some scatter: `rate`, how fast its variance grows per unit of time, of theirs;
    `scatter` of the values without it; `likelihood`, twice its logarithm."""

    rate: float
    scatter: float
    likelihood: float


def still(values: Array, beside: Array) -> Wander:
    """Values (V, D) in which nothing wanders, nuisances (V, D, b) fitted."""
    return _walk(values, np.zeros(len(values) - 1), 0.0, beside)


def wander_in(
    values: Array, time: Array, which: NDArray[np.int64] | None, beside: Array, *, rules: FittingRules
) -> Wander:
    """The random walk below values (V, D) at some times (V,) that is likeliest, begun anew in each recording (V,); none
    where it is not beyond doubt. Nuisances (V, D, b) are fitted as the walk has them: what is slow in it they take for
    their own by plain least squares."""
    steps = growth(time, 1.0, which)
    within = steps[(steps > 0.0) & np.isfinite(steps)]
    usual = float(np.median(within)) if len(within) else 0.0
    none = still(values, beside)
    if usual <= 0.0 or len(values) < rules.enough:
        return none
    tried = np.geomspace(*rules.wander, 15) ** 2 / usual
    walks_tried = (_walk(values, growth(time, rate, which), rate, beside) for rate in tried.tolist())
    best = max(walks_tried, key=lambda item: item.likelihood)
    return best if best.likelihood > none.likelihood + rules.wander_beyond else none


def without(values: Array, beside: Array) -> Array:
    """What nuisances (V, D, b) leave of values (V, D), by least squares."""
    if beside.size == 0:
        return values
    design = beside.reshape(-1, beside.shape[2])
    return values - beside @ np.linalg.lstsq(design, values.reshape(-1), rcond=1e-9)[0]


def remembered(values: Array) -> int:
    """How many neighbours of values (V, D) tell as much as one: the integrated autocorrelation time, summed over pairs
    of lags while these are positive (C. J. Geyer, Statistical Science 7 (1992) 473, doi:10.1214/ss/1177011137)."""
    values = values - values.mean(axis=0)
    whole = max(float(np.sum(values**2)), 1e-300)
    time = 1.0
    for lag in range(1, len(values) - 1, 2):
        pair = sum(float(np.sum(values[k:] * values[:-k])) for k in (lag, lag + 1)) / whole
        if pair <= 0.0:
            break
        time += 2.0 * pair
    return int(np.ceil(time))


def _walk(values: Array, grows: Array, rate: float, beside: Array) -> Wander:
    factor = cholesky_banded(_band(grows), lower=True)
    left = without(without_wander(values, grows), without_wander(beside, grows))
    variance = max(float(np.mean(left**2)), 1e-300)
    determinant = 2.0 * values.shape[1] * float(np.sum(np.log(factor[0])))
    return Wander(rate, float(np.sqrt(variance)), -values.size * float(np.log(variance)) - determinant)


def _band(grows: Array) -> Array:
    """The covariance of differences (the first value stands for itself), lower band form (2, N)."""
    begins = np.isinf(grows)
    band = np.zeros((2, len(grows) + 1))
    band[0, 0], band[0, 1:] = 1.0, np.where(begins, 1.0, 2.0 + grows)
    band[1, :-1] = np.where(begins, 0.0, -1.0)
    return band


def _differences(flat: Array, begins: NDArray[np.bool_]) -> Array:
    """What values (N, D) differ by from those before; the first, and what begins anew (N - 1,), as it is."""
    differences = flat.copy()
    differences[1:][~begins] -= flat[:-1][~begins]
    return differences
