"""Lengths made to keep the limits on their sum, and lengths beside others."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from linkwright.core.optimize.problem import Problem
from linkwright.core.sections.numeric import Array

_HALVED = 200


def fitted(problem: Problem, lengths: Sequence[float]) -> tuple[float, ...]:
    """The lengths (m) of all links, those of elastic ones scaled alike and cut to the problem's range, so that the
    reach is within its limits."""
    least, most = np.array(problem.length_spans).T
    free = np.array([link.section is not None for link in problem.arm.links])
    values = np.array(lengths, dtype=float)

    def scaled(factor: float) -> Array:
        return np.where(free, np.clip(factor * values, least, most), values)

    now = scaled(1.0)
    low, high = _reach(problem)
    total = float(now.sum())
    if low <= total <= high:
        return tuple(now.tolist())
    wanted = low if total < low else high
    ends = [float((least / values)[free].min()), float((most / values)[free].max())]
    for _ in range(_HALVED):
        middle = 0.5 * (ends[0] + ends[1])
        ends[0 if scaled(middle).sum() < wanted else 1] = middle
    fitted_lengths = scaled(ends[1])
    # What rounding leaves is taken from a link that has room for it.
    rest = wanted - float(fitted_lengths.sum())
    room = np.where(free & (fitted_lengths + rest >= least) & (fitted_lengths + rest <= most), fitted_lengths, 0.0)
    fitted_lengths[int(room.argmax())] += rest
    return tuple(fitted_lengths.tolist())


def _reach(problem: Problem) -> tuple[float, float]:
    """The least and the greatest reach (m) that the limits allow."""
    low, high = 0.0, np.inf
    for limit in problem.limit("reach"):
        low = max(low, limit.value) if limit.relation in ("==", ">=") else low
        high = min(high, limit.value) if limit.relation in ("==", "<=") else high
    return low, high


def moved(problem: Problem, lengths: Sequence[float], links: Sequence[int], step: float) -> Iterator[tuple[float, ...]]:
    """Lengths (m) beside others, as near as the problem allows: one link longer or shorter by a share, or two of them,
    one at the expense of the other."""
    values = np.array(lengths)
    steps = step * np.diag(values)
    pairs = [steps[one] - steps[other] * values[one] / values[other] for one, other in itertools.combinations(links, 2)]
    for change in (*(steps[one] for one in links), *pairs):
        for trial in (values + change, values - change):
            yield fitted(problem, trial)
