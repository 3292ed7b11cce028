"""Whether what visits scatter by is scatter: drawn anew at each, it knows nothing of the visits before.

An arm that returns badly stands off anew whenever it comes. What builds up or settles does not, nor what a block of
visits has in common: a visit is off like those before. Both are distinguished by draws of scatter and noise through the
same fit, which makes neighbours a little alike by itself (a Monte Carlo test: B. Phipson & G. K. Smyth, Statistical
Applications in Genetics and Molecular Biology 9 (2010) 39, doi:10.2202/1544-6115.1585).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.fitting.fit import solved
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .lack_of_fit import memory_at_most, remembering, split

_DRAWS = 299
_AT_ONCE = 3_000_000
"""Numbers that are drawn at once."""


def follows(observed: Observed, left: Array, columns: Array, *, seed: int, rules: Rules) -> float:
    """The p-value that visits which scatter by chance are as much like the visits before as what is left of the tip
    (N, D), m; `columns` (N, C, K) are what was fitted."""
    visit = np.unique(observed.block, return_inverse=True)[1].reshape(-1)
    memory = memory_at_most(left, visit, rules=rules)
    parts = split(left, visit, memory)
    reading = np.sqrt(parts.within / max(parts.expected[0], 1.0))
    apart = np.sqrt(np.maximum(parts.between - reading**2 * parts.expected[1], 0.0) / observed.rows)
    recording = _recording_of(observed, visit)
    rng, width, count = np.random.default_rng(seed), left.shape[1], _DRAWS
    size = max(1, _AT_ONCE // observed.residual.size)
    design, columns_white, hits = observed.whitened(columns), _like_before(left[..., None], visit, recording), 0
    for draws in np.diff([*range(0, count, size), count]).tolist():
        drawn = np.zeros((*observed.residual.shape, draws))
        drawn[:, :width] = reading[:, None] * remembering(rng, (observed.rows, width, draws), memory)
        drawn[:, :width] += (apart[:, None] * rng.standard_normal((visit[-1] + 1, width, draws)))[visit]
        drawn -= columns @ solved(design, observed.whitened(drawn))
        hits += int(np.sum(_like_before(drawn[:, :width], visit, recording) >= columns_white))
    return (1 + hits) / (1 + count)


def _like_before(values: Array, visit: NDArray[np.int64], recording: Array) -> Array:
    """How much the means over visits of values (N, D, k) are like those of the three visits before, the nearer counting
    for more, (k,)."""
    means = np.zeros((visit[-1] + 1, *values.shape[1:]))
    np.add.at(means, visit, values)
    means /= np.bincount(visit)[:, None, None]
    products = np.zeros(values.shape[2])
    for lag in range(1, min(3, len(means) - 1) + 1):
        same = recording[lag:] == recording[:-lag]
        products += np.einsum("vdk,vdk->k", means[lag:][same], means[:-lag][same]) / lag
    return products / np.maximum(np.einsum("vdk,vdk->k", means, means), 1e-300)


def _recording_of(observed: Observed, visit: NDArray[np.int64]) -> Array:
    """Which recording each visit (V,) is of."""
    return np.asarray(observed.which[np.unique(visit, return_index=True)[1]], dtype=np.float64)
