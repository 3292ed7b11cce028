"""The smallest size of each effect that a recording would have shown, with power 0.9 at the test's level."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import chndtr, ndtr

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.patterns.library import Candidate, kind_of, parameter_of
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.result import Detectable
from linkwright.core.diagnose.search.calibrate import Calibrated, gumbel
from linkwright.core.sections.numeric import Array

POWER = 0.9
"""With which an effect of the size shown would have been found, as is usual."""


def detectable(
    prepared: Prepared, test: Calibrated, unit: float, level: float, *, plainest: bool = False
) -> tuple[Detectable, ...]:
    """For every effect and place that can be seen, the least size that the gate would have found.

    `test` is the gate's, `unit` the scatter of whitened residuals, `level` the p-value at which the gate opens. The
    variant of each candidate that shows best counts (`plainest`: where one does without its shapes, that one); of
    several sizes the one that shows least.
    """
    price = prepared.criterion.price
    needed = _needed(prepared, _threshold(test.drawn, level))
    best: dict[tuple[str, tuple[int, ...]], Detectable] = {}
    every = [group.candidate for group in prepared.pool.groups]
    plain = {(item.effect, item.at) for item in every if is_plain(item)} if plainest else set()
    for number, group in enumerate(prepared.pool.groups):
        candidate = group.candidate
        if candidate.outside or candidate.only is not None:
            continue
        if (candidate.effect, candidate.at) in plain and not is_plain(candidate):
            continue
        noncentrality = needed(group.rank, float(price[number]))
        of_this_group = _of_group(prepared, number, unit * math.sqrt(noncentrality))
        key = (candidate.effect, candidate.at)
        if of_this_group is not None and (key not in best or of_this_group.rms < best[key].rms):
            best[key] = of_this_group
    return tuple(best.values())


def is_plain(candidate: Candidate) -> bool:
    """Whether a candidate is what its effect does where none of its shapes is given: each of them is zero."""
    return not any(candidate.shapes.values())


def _of_group(prepared: Prepared, number: int, norm: float) -> Detectable | None:
    group, raw = prepared.pool.groups[number], prepared.columns[number]
    candidate = group.candidate
    shown = group.forward  # (r, d): what one unit of each size shows of itself
    worst: Detectable | None = None
    for place, name in enumerate(candidate.sizes[: raw.shape[2]]):
        length = float(np.linalg.norm(shown[:, place]))
        if length <= 0.0:
            continue
        value = norm / length
        if value > largest_size(candidate, name):
            continue  # could not be that large: it cannot be seen at all
        tip = raw[:, : prepared.observed.components, place]
        rms = value * rms_length(tip)
        kind = kind_of(prepared.observed.arm, candidate, name)
        detected = Detectable(candidate.effect, candidate.numbers, rms, name, kind, value, group.visible)
        if worst is None or detected.rms > worst.rms:
            worst = detected
    return worst


def largest_size(candidate: Candidate, name: str) -> float:
    """The largest size that is physically possible."""
    if candidate.share:
        return math.inf
    parameter = parameter_of(EFFECTS[candidate.effect], name)
    return max(abs(parameter.lower), abs(parameter.upper))


def _threshold(drawn: Array, level: float) -> float:
    """The statistic that chance reaches with probability `level`."""
    location, spread = gumbel(drawn)
    return location - spread * math.log(-math.log1p(-level))


def _needed(prepared: Prepared, threshold: float) -> Callable[[int, float], float]:
    """The non-centrality that a group of some rank needs to pass the threshold with the power asked."""
    count = prepared.criterion.count

    @cache
    def needed(rank: int, price: float) -> float:
        ratio = math.expm1((threshold + price) / count)
        limit = max(count - rank, 1) * max(ratio, 1e-12)

        def short(noncentrality: float) -> float:
            missed = float(1.0 - chndtr(limit, rank, noncentrality))
            if math.isnan(missed):  # too large for the series; the root of what is so large is normal
                missed = float(ndtr(math.sqrt(noncentrality) - math.sqrt(limit)))
            return missed - POWER

        high = limit + 20.0
        while short(high) < 0.0:
            high *= 2.0
        root: Any = brentq(short, 0.0, high) if short(1e-9) < 0.0 else 0.0
        return float(root)

    return needed
