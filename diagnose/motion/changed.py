"""Since when a log follows other torques: the effect and the instant from which on it acts otherwise than before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .findings import parameters_of
from .model.candidates import Candidates, Group
from .model.identify import Identified
from .model.rows import LogRows
from .result import Change

_PARTS = 40
"""Parts of a log between which a change is looked for first; within them every sample is tried."""
_ROUNDS = 20
"""Instants and sizes in turn, until the instant stands."""
_NATS = 2.0
"""How much less likely than the best an instant may be to lie in the 95 % interval (half of chi-squared, 3.84)."""
_SURE = 1.96
"""Standard deviations to each end of a 95 % interval."""


@dataclass(frozen=True)
class _Fit:
    """A fit of the whole library, sizes held to what is usual: `sizes` (W,) and their covariance (W, W)."""

    sizes: Array
    covariance: Array


@dataclass(frozen=True)
class _Further:
    """What a group would be by more after an instant: its numbers (d,) and their covariance (d, d), what the other
    sizes (W,) turn into with it, and how much likelier the log is, its choice not yet paid for (nats)."""

    group: Group
    numbers: Array
    covariance: Array
    sizes: Array
    gain: float


def change_of(identified: Identified, *, rules: Rules) -> Change | None:
    """The change within a log that explains most of the square that is left; None where none explains half of it.

    The whole library is fitted with one group of the candidates that has other sizes from an instant on; of all groups
    and instants the likeliest is taken, if it pays for having been chosen.
    """
    best: Change | None = None
    weights, pool = identified.noise.weights, identified.pool
    for rows in identified.rows:
        edges = np.linspace(0, len(rows.target), _PARTS + 1).astype(np.int64)
        parts = [_normal(rows, weights, pool.width, slice(a, b)) for a, b in pairwise(edges)]
        others = [_normal(other, weights, pool.width, slice(None)) for other in identified.rows if other is not rows]
        fit = _whole([*parts, *others], pool)
        after = [_together(parts[k:]) for k in range(1, _PARTS)]
        tried = [
            (edge, _further(group, fit, gram, against))
            for edge, (gram, against) in zip(edges[1:].tolist(), after, strict=False)
            for group in pool.groups
            if not (group.nuisance or group.tied)
        ]
        if not tried:
            continue
        _, further = max(tried, key=lambda item: item[1].gain)
        if further.gain <= np.log(len(tried)) + rules.search.margin:
            continue
        start = 0
        for _ in range(_ROUNDS):
            earlier, start = start, _instant(rows, further, weights)[0]
            if start == earlier:
                break
            further = _further(further.group, fit, *_normal(rows, weights, pool.width, slice(start, None)))
        change = _change(rows, fit, further, weights, rules=rules)
        if change.share > 0.5 and (best is None or change.share > best.share):
            best = change
    return best


def _normal(rows: LogRows, weights: Array, width: int, part: slice) -> tuple[Array, Array]:
    """Gram matrix (W, W) of the model's columns in some rows, and their products (W,) with the target."""
    gram, against = np.zeros((width, width)), np.zeros(width)
    for joint, at in enumerate(rows.columns):
        use = rows.prepared.moving[part, joint]
        design, target = rows.design[joint][part][use], rows.target[part, joint][use]
        gram[np.ix_(at, at)] += weights[joint] * design.T @ design
        against[at] += weights[joint] * design.T @ target
    return gram, against


def _together(parts: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Products of the rows of several parts."""
    return np.sum([gram for gram, _ in parts], axis=0), np.sum([against for _, against in parts], axis=0)


def _whole(parts: Sequence[tuple[Array, Array]], pool: Candidates) -> _Fit:
    """The fit of the whole library to some rows."""
    usual = np.zeros(pool.width)
    for group in pool.groups:
        if not group.tied:
            usual[group.columns] = np.maximum(usual[group.columns], np.abs(group.mixing) @ group.usual)
    gram, against = _together(parts)
    scaled = gram * usual[:, None] * usual + np.eye(pool.width)
    size = 1.0 / np.sqrt(np.diagonal(scaled))
    inverse = np.asarray(np.linalg.inv(scaled * size[:, None] * size), dtype=float) * size[:, None] * size
    covariance = inverse * usual[:, None] * usual
    return _Fit(covariance @ against, covariance)


def _further(group: Group, fit: _Fit, gram: Array, against: Array) -> _Further:
    """A group with numbers of its own in the rows after an instant, of which these are the products."""
    across = gram[:, group.columns] @ group.mixing
    score = group.mixing.T @ against[group.columns] - across.T @ fit.sizes
    told = group.mixing.T @ across[group.columns] - across.T @ fit.covariance @ across
    precision = np.diag(1.0 / group.usual**2)
    covariance = np.asarray(np.linalg.inv(told + precision), dtype=float)
    numbers = covariance @ score
    widths = np.linalg.slogdet(told + precision)[1] - np.linalg.slogdet(precision)[1]
    sizes = fit.sizes - fit.covariance @ across @ numbers
    return _Further(group, numbers, covariance, sizes, float(0.5 * (score @ numbers - widths)))


def _left(rows: LogRows, sizes: Array, weights: Array) -> Array:
    """What sizes leave of each joint's torque where it counts (M, n), in units of its noise."""
    return (rows.target - rows.explained(sizes)) * rows.prepared.moving * np.sqrt(weights)


def _instant(rows: LogRows, further: _Further, weights: Array) -> tuple[int, Array]:
    """The row from which on the change fits best, and for each row how much less likely it is than that (nats)."""
    later = np.zeros_like(further.sizes)
    later[further.group.columns] = further.group.values(further.numbers)
    before = np.sum(_left(rows, further.sizes, weights) ** 2, axis=1)
    after = np.sum(_left(rows, further.sizes + later, weights) ** 2, axis=1)
    cost = np.cumsum(before)[:-1] + np.cumsum(after[::-1])[::-1][1:]
    start = int(np.argmin(cost)) + 1
    return start, np.asarray(0.5 * (cost - cost.min()))


def _change(rows: LogRows, fit: _Fit, further: _Further, weights: Array, *, rules: Rules) -> Change:
    """The change as it is said, with intervals."""
    start, worse = _instant(rows, further, weights)
    clock = rows.prepared.motion.time[rows.prepared.kept]
    later = np.zeros_like(further.sizes)
    later[further.group.columns] = further.group.values(further.numbers)
    before, after = _left(rows, further.sizes, weights), _left(rows, further.sizes + later, weights)
    left = np.vstack((before[:start], after[start:]))
    constant = float(np.sum(_left(rows, fit.sizes, weights) ** 2))
    # The noise is now what the change leaves, less than what the library left: intervals are by that.
    quieter = float(np.sum(left**2)) / constant
    likely: NDArray[np.int64] = np.flatnonzero(worse <= _NATS * quieter) + 1
    group = further.group
    reach = _SURE * np.sqrt(quieter * np.diagonal(further.covariance))
    shown = np.sqrt(np.diagonal(further.covariance)) < rules.motion.shown * group.usual
    return Change(
        group.effect.id,
        group.at,
        parameters_of(group, rows.prepared.motion.arm, further.numbers, np.stack((reach, reach)), shown),
        rows.prepared.log.file,
        float(clock[start]),
        (float(clock[likely[0] - 1]), float(clock[likely[-1]])),
        1.0 - quieter,
    )
