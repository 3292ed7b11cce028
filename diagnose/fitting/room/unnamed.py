"""How much physics that is not named may be in a recording, and how far that may move what is.

A machine has more causes than are found: those too small to be named stay in what is left, and move the sizes of those
that are by whatever part of their patterns is alike. Beside what is named, every other candidate of the library is
taken to move the tip by a random amount of one variance, which the restricted likelihood of what is left sets against
the noise's (H. D. Patterson & R. Thompson, Biometrika 58 (1971) 545, doi:10.1093/biomet/58.3.545). Where nothing
predicts what is left it is next to zero, and intervals are those of least squares.

What is left was made small by choosing names for it, and says too little of what others move. Weak findings beside a
strong one are a sample of the small causes of that arm: with them among the unnamed the likelihood sees those that are
not chosen as large as those that were. And readings of one visit share how exactly the arm came there: where their
means scatter by more than readings of a visit do, the means alone say how loud the noise is.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc

from linkwright.core.diagnose.fitting.noise_left import comes_anew
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.sections.numeric import Array

_TINY = 1e-9
_STEPS = 121
"""Standard deviations at which the likelihood is looked at."""


@dataclass(frozen=True)
class Unnamed:
    """What is not named: the columns `at` (M,) of a basis (n, ...), each times its `weight` (M,) and the `deviation`
    that each family of candidates moves in all, over the rows `rows` of the whitened observations that are fitted, and
    the noise's own `variance`."""

    basis: Array
    at: NDArray[np.int64]
    weight: Array
    deviation: float
    variance: float
    rows: NDArray[np.int64]

    def no_less_than(self, other: Unnamed) -> Unnamed:
        """The same, each family moving as much as another look at the recording says if that is more."""
        return replace(self, deviation=max(self.deviation, other.deviation))

    def at_least(self, times_the_noise: float) -> Unnamed:
        """The same, each family moving so many times the noise's RMS at least."""
        least = times_the_noise * float(np.sqrt(len(self.rows) * self.variance))
        return replace(self, deviation=max(self.deviation, least))

    def beside(self, operator: Array) -> Array:
        """How far unnamed physics may move some estimates: covariance (k, k) of what an operator (k, n) on all that is
        fitted makes of it, of which the rows searched are a fair sample."""
        return self._of(operator[:, self.rows] @ self.basis, operator.shape[1])

    def beside_fit(self, turned: Array, design: Array) -> Array:
        """The same of a fit's sizes, whose covariance (k, k) under noise of one is `turned` (k, r) times itself and
        whose whitened `design` is (n, k): the operator itself would be as large as that."""
        searched = design if len(self.rows) == len(design) else design[self.rows]
        return self._of(turned @ (turned.T @ (searched.T @ self.basis)), len(design))

    def _of(self, along: Array, count: int) -> Array:
        # The whole basis, and columns of the outcome: those of the basis would be hundreds of megabytes once more.
        moved = along[:, self.at] * self.weight * self.deviation * (count / len(self.rows))
        return moved @ moved.T


def unnamed(prepared: Prepared, members: Sequence[int], rivals: Collection[int], rows: NDArray[np.int64]) -> Unnamed:
    """What the remainder of a fit of some groups leaves room for; `rivals` are declared to be other names for them, and
    are no causes beside them. `rows` says where the observations stand among those that are fitted."""
    pool, rules = prepared.pool, prepared.observed.rules.fitting
    at, weight, _ = others_of(prepared, members, rivals)
    columns = pool.columns(members)
    mixed = pool.gram[np.ix_(at, columns)] * weight[:, None]
    inverse = np.linalg.pinv(pool.gram[np.ix_(columns, columns)], rcond=_TINY, hermitian=True)
    projection = pool.basis.T @ prepared.vector
    named = projection[columns]
    gram = pool.gram[np.ix_(at, at)] * np.outer(weight, weight) - mixed @ inverse @ mixed.T
    along = projection[at] * weight - mixed @ inverse @ named
    left = float(prepared.vector @ prepared.vector - named @ inverse @ named)
    freedom = len(prepared.vector) - pool.nuisance.shape[1] - len(columns)
    within, repeated = _within_visits(
        prepared, prepared.vector - pool.basis[:, columns] @ (inverse @ named), left, freedom
    )
    left, freedom, count = left - within, freedom - repeated, len(prepared.vector)
    ratio, variance = variances(gram, along, left, freedom, count, rules.largest_unnamed)
    return Unnamed(pool.basis, at, weight, float(np.sqrt(ratio * variance)), variance, rows)


def others_of(
    prepared: Prepared, members: Sequence[int], rivals: Collection[int]
) -> tuple[NDArray[np.int64], Array, tuple[int, ...]]:
    """Which columns of a pool's basis (M,) are of other families of the library, the weight (M,) of each with which all
    families move as much, and the groups."""
    pool = prepared.pool
    taken = {pool.groups[m].candidate.family for m in (*members, *rivals)}
    others = [k for k, g in enumerate(pool.groups) if not g.candidate.outside and g.candidate.family not in taken]
    variants = Counter(pool.groups[k].candidate.family for k in others)
    ranks = [pool.groups[k].rank for k in others]
    scales = [1.0 / np.sqrt(r * variants[pool.groups[k].candidate.family]) for k, r in zip(others, ranks, strict=True)]
    return pool.columns(others), np.repeat(scales, ranks), tuple(others)


def _within_visits(prepared: Prepared, remainder: Array, left: float, freedom: int) -> tuple[float, int]:
    """The sum of squares that readings of a visit differ by and its degrees of freedom, where visits differ by more
    than that explains, beyond chance; zero and none elsewhere, and where whitening allows for neighbours already."""
    observed = prepared.observed
    if observed.wander > 0.0 or observed.correlation > 0.0 or not comes_anew(observed):
        return 0.0, 0
    values, visit = remainder.reshape(observed.rows, -1), prepared.visits
    count = np.bincount(visit)
    means = np.stack([np.bincount(visit, weights=column) / count for column in values.T], axis=1)
    within = float(np.sum((values - means[visit]) ** 2))
    repeated = values.shape[1] * (len(visit) - len(count))
    between, apart = left - within, freedom - repeated
    if within <= 0.0 or apart <= 0:
        return 0.0, 0
    ratio = between / apart / (within / repeated)
    beyond = float(fdtrc(apart, repeated, ratio)) < observed.rules.residual.level
    return (within, repeated) if beyond else (0.0, 0)


def variances(gram: Array, along: Array, left: float, freedom: int, count: int, largest: float) -> tuple[float, float]:
    """The variance of each family's sum of squares over the noise's, and the noise's own, which the remainder tells.

    `gram` (M, M) are the families' patterns beside what is named, `along` (M,) their products with what is left, whose
    sum of squares is `left`, of so many degrees of freedom. The ratio is its mean given the recording; beforehand
    nothing else is there with even odds, and else every standard deviation up to `largest` times the noise's RMS over
    `count` observations is as likely as another.
    """
    if not len(along) or freedom <= 0 or left <= 0.0:
        return 0.0, max(left, 0.0) / max(freedom, 1)
    values, vectors = np.linalg.eigh(gram)
    good = values > _TINY * values[-1]
    values, squares = values[good], (vectors[:, good].T @ along) ** 2 / values[good]
    rest = max(left - float(squares.sum()), _TINY * left)

    def noise(ratio: float) -> float:
        return (rest + float(np.sum(squares / (1.0 + ratio * values)))) / freedom

    def unlikely(ratio: float) -> float:
        return freedom * float(np.log(noise(ratio))) + float(np.sum(np.log1p(ratio * values)))

    steps = np.linspace(0.0, largest, _STEPS)
    fit = np.array([unlikely(count * step**2) for step in steps])
    weight = np.exp(-0.5 * (fit - fit.min()))
    weight /= weight.sum() + weight[0] * len(steps)
    mean = count * float(weight @ steps**2)
    return mean, noise(mean)
