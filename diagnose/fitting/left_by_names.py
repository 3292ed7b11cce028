"""What is left beside what was named, in whatever shape of it suits all readings best: rows that a rough model took for
bad readings are asked again here, since they may be all that tells a shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.residual.robust_scale import HUBER
from linkwright.core.sections.numeric import Array

from .noise_left import bad_rows_down
from .thresholds import at_best

Variants = list[tuple[Candidate, Array]]
"""One finding in the shapes that it may have, each with its columns (N, C, d); the first is how it was found."""


def left_by_names(observed: Observed, named: Sequence[Variants], beside: Array) -> tuple[Array, tuple[Candidate, ...]]:
    """What the findings leave (N, C), m and rad, with nuisances `beside` them (N, C, b) and rows that lie far off
    weighed down, each in the shape that leaves least, and those shapes."""
    now = _fitted(observed, [variants[0] for variants in named], beside)
    for place, variants in enumerate(named):
        trials = [[*now.chosen[:place], variant, *now.chosen[place + 1 :]] for variant in variants[1:]]
        each = [now, *(_fitted(observed, trial, beside, now.weight) for trial in trials)]
        bound = HUBER * float(np.median(_sizes(observed, now.left)))
        now = each[int(np.argmin([_loss(_sizes(observed, item.left), bound) for item in each]))]
    return now.left, tuple(candidate for candidate, _ in now.chosen)


@dataclass(frozen=True)
class _Fitted:
    """Findings in some shapes, what they leave (N, C), and the rows' weights there (N,)."""

    chosen: Variants
    left: Array
    weight: Array


def _fitted(observed: Observed, chosen: Variants, beside: Array, weight: Array | None = None) -> _Fitted:
    """Findings with their thresholds sought where rows weigh what another choice left them, by default this one at the
    thresholds given."""
    candidates, columns = [item for item, _ in chosen], [part for _, part in chosen]
    if weight is None:
        weight = bad_rows_down(observed, [beside, *columns])[2]
    chosen = at_best(observed, candidates, columns, beside, weight)
    stacked, values, weight = bad_rows_down(observed, [beside, *(part for _, part in chosen)])
    return _Fitted(chosen, observed.residual - stacked @ values, weight)


def _sizes(observed: Observed, left: Array) -> Array:
    return np.sqrt(np.sum(observed.scaled(left) ** 2, axis=1))


def _loss(size: Array, bound: float) -> float:
    """What is left by P. J. Huber's loss (Annals of Mathematical Statistics 35 (1964) 73): rows beyond a bound count in
    proportion."""
    return float(np.sum(np.where(size <= bound, 0.5 * size**2, bound * (size - 0.5 * bound))))
