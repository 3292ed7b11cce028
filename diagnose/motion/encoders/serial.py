"""Least squares of a series in time whose rows repeat each other: covariance and degrees of freedom."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct
from scipy.stats import t as student

from linkwright.core.sections.numeric import Array

_LEAST = 1e-3
"""Share of a frequency that a fit leaves, at least: below it that frequency alone determines a number."""


@dataclass(frozen=True)
class Serial:
    """The covariance (K, K) of K fitted numbers, and the degrees of `freedom` (K,) of Student's t of each: how many
    independent rows tell it."""

    covariance: Array
    freedom: Array

    @property
    def error(self) -> Array:
        """Standard errors (K,)."""
        return np.sqrt(np.diagonal(self.covariance))

    @property
    def half(self) -> Array:
        """How far 95 % intervals reach (K,)."""
        return np.asarray(student.ppf(0.975, self.freedom)) * self.error

    def chance(self, place: int, size: float, beside: float = 0.0) -> float:
        """How often a number is as large as this by noise and a standard error `beside` it."""
        error = max(float(np.hypot(self.error[place], beside)), 1e-300)
        return float(2.0 * student.sf(abs(size) / error, self.freedom[place]))


def serial(
    design: Array,
    left: Array,
    used: NDArray[np.bool_],
    ridge: Array | float = 0.0,
    width: Array | float = 0.0,
) -> Serial:
    """The covariance of a fit by least squares of which the rows are correlated in time.

    Amplitudes of a stationary series at different frequencies are uncorrelated (E. J. Hannan, Regression for time
    series, in M. Rosenblatt (ed.), Time Series Analysis, Wiley 1963), of a variance that goes with the frequency. So
    the fit is one of independent rows after a cosine transform, and its covariance that for unequal variances of J. G.
    MacKinnon & H. White, J. Econometrics 29 (1985) 305 (HC3), with degrees of freedom by how few frequencies determine
    a number (G. W. Imbens & M. Kolesar, Rev. Econ. Stat. 98 (2016) 701, doi:10.1162/REST_a_00552). No length of blocks
    is chosen, and a cycle that repeats itself tells no more than once.

    Args:
        design: (R, K) columns of the rows used.
        left: (R,) what they leave.
        used: (M,) which samples of an even clock the rows are; logs stand one behind the other.
        ridge: (K,) what is added to the diagonal of the normal equations; 0: nothing.
        width: (K,) standard deviation of each number that is held by that, as it is known beforehand.

    >>> column, random = np.cos(0.1 * np.arange(400.0))[:, None], np.random.default_rng(1)
    >>> quick, slow = random.standard_normal(400), np.repeat(random.standard_normal(10), 40)
    >>> all_rows = np.ones(400, dtype=bool)
    >>> bool(serial(column, slow, all_rows).error[0] > 2.0 * serial(column, quick, all_rows).error[0])
    True
    """
    norm = np.linalg.norm(design, axis=0)
    size = np.where(norm > 0.0, norm, 1.0)
    rows, apart = _by_frequency(design / size, used), _by_frequency(left, used)
    held = np.diag(ridge / size**2)
    inverse = np.linalg.pinv(rows.T @ rows + held)
    influence = rows @ inverse
    alone = np.maximum(1.0 - np.sum(influence * rows, axis=1), _LEAST)
    each = influence * (apart / alone)[:, None]
    known = inverse @ held * (width * size)
    square = influence**2
    freedom = square.sum(axis=0) ** 2 / np.maximum((square**2).sum(axis=0), 1e-300)
    return Serial((each.T @ each + known @ known.T) / size[:, None] / size, np.maximum(freedom, 1.0))


def _by_frequency(rows: Array, used: NDArray[np.bool_]) -> Array:
    """Rows (R, ...) on their clock (M, ...) after an orthonormal cosine transform, which leaves sums of products."""
    series = np.zeros((len(used), *rows.shape[1:]))
    series[used] = rows
    return np.asarray(dct(series, axis=0, norm="ortho"), dtype=float)


def residual(columns: Array, values: Array) -> Array:
    """What columns (R, K) leave of values (R, ...)."""
    return values - columns @ np.linalg.lstsq(columns, values, rcond=None)[0]


def rms(values: Array) -> float:
    """Root mean square; 0 of nothing."""
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0
