"""How much a series of estimates says that a change is in it, and how far the estimates of a quiet one scatter.

A change is a column z(t) beside those that are in the series already (its level, earlier changes), fitted by weighted
least squares: a meta-regression of estimates with standard errors. Estimates scatter from recording to recording by
more than their errors (a frame mounted anew, a warmer hall), or by less (a pattern that is nowhere modelled and is the
same each week is in the errors). So errors only give the weights, with a variance between recordings added that comes
from the differences of neighbours, which a step leaves alone; the scale is that of what the model with the change
leaves (G. Knapp & J. Hartung, Stat. Med. 22 (2003) 2693, doi:10.1002/sim.1482). With few recordings that scale is
itself unknown: it is drawn to what the parameters have in common, and the t that follows has so many more degrees of
freedom (G. K. Smyth, Stat. Appl. Genet. Mol. Biol. 3 (2004) 3, doi:10.2202/1544-6115.1027).

Everything takes many series at once: (S, n) holds S series of n recordings, all with the same columns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from linkwright.core.sections.numeric import Array

TESTS = 7.0
"""As many independent tests as all dates of a step and one steady drift come to, each time they are looked at: by
simulation of quiet series, frames mounted anew."""
_MEDIAN = float(stats.chi2.median(1))
"""The median of a squared standard normal."""
_LEAST_SCALE = 1e-200
"""What estimates scatter by is never nothing: floats divide by it."""
_NOTHING = 1e-9
"""A column that others describe to this share of its square is none."""


@dataclass(frozen=True)
class Scatter:
    """The variances (S, n) that estimates of a quiet series have but for a factor, as large on average as those of
    their errors, and that factor (S,) by the differences of neighbours."""

    variances: Array
    factor: Array


def scatter(values: Array, errors: Array) -> Scatter:
    """How estimates (S, n) with standard errors (S, n) scatter from recording to recording."""
    variances = errors**2
    apart = np.diff(values, axis=1) ** 2
    mean = variances.mean(axis=1, keepdims=True)
    between = 0.5 * np.median(apart, axis=1, keepdims=True) / _MEDIAN - mean
    whole = variances + np.maximum(between, 0.0)
    whole = whole * (mean / whole.mean(axis=1, keepdims=True))
    factor = np.median(apart / (whole[:, 1:] + whole[:, :-1]), axis=1) / _MEDIAN
    return Scatter(whole, factor)


def in_common(factor: Array) -> Array:
    """The factor (G,) that the parameters of each watch (G, P) have in common: the median of all and of one, which is
    what their standard errors say."""
    return np.median(np.concatenate([factor, np.ones((len(factor), 1))], axis=1), axis=1)


@dataclass(frozen=True)
class Tried:
    """Columns tried one at a time beside those in the model: sizes, t statistics and sums of squares left (S, K), the
    scales (S, K) of the variances with each, and the degrees of freedom of t; t is zero for what is no column."""

    sizes: Array
    t: Array
    left: Array
    scale: Array
    information: Array
    freedom: float

    @property
    def errors(self) -> Array:
        """The standard errors of the sizes (S, K); infinite for what is no column."""
        with np.errstate(divide="ignore"):
            return np.sqrt(self.scale / self.information)


def tried(values: Array, variances: Array, model: Array, columns: Array, common: Array, prior: float) -> Tried:
    """Try columns (n, K) beside those of the model (n, c) in series (S, n) of such variances but for a factor, which is
    `common` (S,) by so many degrees of freedom, `prior`, beside what each series says itself."""
    weight = 1.0 / variances
    size = values.shape[1]
    products = np.einsum("sn,nc,nd->scd", weight, model, model)
    against = np.einsum("sn,sn,nc->sc", weight, values, model)
    beside = np.einsum("snc,nk->sck", weight[:, :, None] * model, columns)
    solved = np.linalg.solve(products, np.concatenate([against[:, :, None], beside], axis=2))
    level, hidden = solved[:, :, 0], solved[:, :, 1:]
    rest = values - level @ model.T
    whole = np.sum(weight * rest**2, axis=1)[:, None]
    score = (weight * rest) @ columns
    full = weight @ columns**2
    information = full - np.sum(beside * hidden, axis=1)
    real = information > _NOTHING * np.maximum(full, 1e-300)
    information = np.where(real, information, 0.0)
    sizes = np.where(real, score, 0.0) / np.where(real, information, 1.0)
    left = np.maximum(whole - sizes * score, 0.0)
    freedom = size - model.shape[1] - 1
    scale = np.maximum((prior * common[:, None] + left) / (prior + freedom), _LEAST_SCALE)
    t = sizes * np.sqrt(information / scale)
    return Tried(sizes, t, left, scale, information, prior + freedom)


def doubted(
    values: Array, errors: Array, model: Array, columns: Array, common: Array, prior: float
) -> tuple[Array, float]:
    """The size of the t (S, K) of further columns as far as it is beyond doubt, and its degrees of freedom: scatter
    goes with the standard errors (S, n), or has nothing to do with them, whichever says less. Where errors are alike
    that is the same; where they are not, neither a precise recording nor a poor one counts for more than it can."""
    variances = errors**2
    same_variances = np.broadcast_to(variances.mean(axis=1, keepdims=True), variances.shape)
    two = [tried(values, item, model, columns, common, prior) for item in (variances, same_variances)]
    return np.minimum(np.abs(two[0].t), np.abs(two[1].t)), two[0].freedom


def steps(count: int) -> Array:
    """Columns (n, n - 1): a step after each recording but the last."""
    return np.tri(count, count - 1, -1)


def kink(when: Array, start: int) -> Array:
    """A column (n,): a steady change from one recording (from 0) on, one over the whole time."""
    span = float(when[-1] - when[0])
    return np.maximum(when - when[start], 0.0) / span


def looked_for(when: Array) -> Array:
    """What a quiet series is searched for, (n, K): a step at any date, and a steady change all along."""
    return np.column_stack([steps(len(when)), kink(when, 0)])


def level(false_alarm: float, over: int, series: int) -> float:
    """The p-value below which one test of one series is an alarm."""
    return (1.0 - (1.0 - false_alarm) ** (1.0 / over)) / (TESTS * series)
