"""An instrument that wanders: a random walk upon the noise of single readings, found, and taken out of what is tested.

White noise with a random walk below it is the local level model (A. C. Harvey, Forecasting, Structural Time Series
Models and the Kalman Filter, Cambridge 1989, 2.3). Differences of neighbouring readings are then correlated with the
next ones alone, so that their covariance is tridiagonal and whitening costs no more than the readings are many.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky_banded, solve_banded

from diagnose.recording import Recording
from diagnose.rules.fitting_rules import FittingRules
from sections.numeric import Array


def clock(recording: Recording) -> Array:
    """When each reading was taken (N,), s; where nobody knows, its number."""
    if recording.time is not None and bool((np.diff(recording.time) >= 0.0).all()):
        return recording.time
    return recording.row.astype(np.float64)


def without_wander(values: Array, grows: Array) -> Array:
    """Values (N, ...) of unit scatter and a random walk whose variance grows by `grows` (N - 1,) from one to the next,
    as independent ones of unit variance. The walk begins at nought."""
    factor = cholesky_banded(_band(grows), lower=True)
    flat = values.reshape(len(values), -1)
    # The factor is lower bidiagonal; `solve_banded` wants the diagonal first.
    found = solve_banded((1, 0), factor, _differences(flat))
    return found.reshape(values.shape)


@dataclass(frozen=True)
class Wander:
    """A random walk below values of some scatter: `rate`, how fast its variance grows per unit of time, of theirs;
    `scatter` of the values without it; `likelihood`, twice its logarithm."""

    rate: float
    scatter: float
    likelihood: float


def still(values: Array) -> Wander:
    """Values (V, D) in which nothing wanders."""
    return _walk(values, 0.0, np.zeros(len(values) - 1))


def wander_in(values: Array, time: Array, *, rules: FittingRules) -> Wander:
    """The random walk below values (V, D) at some times (V,) that is likeliest; none where it is not beyond doubt."""
    steps = np.maximum(np.diff(time), 0.0)
    usual = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
    none = still(values)
    if usual <= 0.0 or len(values) < rules.least_pairs:
        return none
    tried = np.geomspace(rules.least_wander, rules.most_wander, rules.wanders_tried) ** 2 / usual
    best = max((_walk(values, rate, steps) for rate in tried.tolist()), key=lambda each: each.likelihood)
    return best if best.likelihood > none.likelihood + rules.wander_beyond else none


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


def _walk(values: Array, rate: float, steps: Array) -> Wander:
    factor = cholesky_banded(_band(rate * steps), lower=True)
    left = solve_banded((1, 0), factor, _differences(values))
    variance = max(float(np.mean(left**2)), 1e-300)
    determinant = 2.0 * values.shape[1] * float(np.sum(np.log(factor[0])))
    return Wander(rate, float(np.sqrt(variance)), -values.size * float(np.log(variance)) - determinant)


def _band(grows: Array) -> Array:
    """The covariance of differences (the first value stands for itself), lower band form (2, N)."""
    band = np.zeros((2, len(grows) + 1))
    band[0, 0], band[0, 1:] = 1.0, 2.0 + grows
    band[1, :-1] = -1.0
    return band


def _differences(flat: Array) -> Array:
    return np.diff(flat, axis=0, prepend=np.zeros((1, flat.shape[1])))
