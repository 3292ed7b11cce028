"""Since when a log follows other torques: the effect and the instant from which on it acts otherwise than before."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.result import HALF
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

from .findings import parameters_of
from .model.candidates import Candidates, Group
from .model.identify import Identified
from .model.noise import covariance, usual_sizes
from .model.products import Products, products
from .model.rows import LogRows, joint_rows
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
    weights, pool = identified.noise.weights, identified.pool
    fit, best = _whole(identified, weights), None
    groups = [group for group in pool.groups if not (group.nuisance or group.tied)]
    for rows in identified.rows:
        parts = _by_part(rows, pool, np.arange(len(rows.target)) * _PARTS // len(rows.target))
        tried = [
            _further(group, fit, gram, against)
            for first in range(1, parts.blocks)
            for gram, against, _ in (parts.whole(weights, np.arange(parts.blocks) >= first),)
            for group in groups
        ]
        further = max(tried, key=lambda item: item.gain, default=None)
        if further is None or further.gain <= np.log(len(tried)) + rules.search.margin:
            continue
        change = _settled(identified, rows, fit, further, rules=rules)
        if change.share > HALF and (best is None or change.share > best.share):
            best = change
    return best


def _settled(identified: Identified, rows: LogRows, fit: _Fit, further: _Further, *, rules: Rules) -> Change:
    """The change with its instant, sizes and noise in turn until the instant stands: what the library left without it
    was no noise."""
    given, pool, group = identified.noise.weights, identified.pool, further.group
    constant, weights, start = np.sum(_left(rows, fit.sizes) ** 2, axis=0), given, -1
    for _ in range(_ROUNDS):
        earlier = start
        start, worse, left = _instant(rows, further, weights)
        if start == earlier:
            break
        weights = given * constant / np.maximum(left, 1e-12 * constant)
        halves = _by_part(rows, pool, (np.arange(len(rows.target)) >= start).astype(np.int64))
        gram, against, _ = halves.whole(weights, np.array([False, True]))
        further = _further(group, _whole(identified, weights), gram, against)
    start, worse, left = _instant(rows, further, weights)
    clock = rows.prepared.motion.time[rows.prepared.kept]
    likely: NDArray[np.int64] = np.flatnonzero(worse <= _NATS) + 1
    scatter = np.sqrt(np.diagonal(further.covariance))
    shown = scatter < rules.motion.shown * group.usual
    return Change(
        group.effect.id,
        group.at,
        parameters_of(group, rows.prepared.motion.arm, further.numbers, _SURE * np.stack((scatter, scatter)), shown),
        rows.prepared.log.file,
        float(clock[start]),
        (float(clock[likely[0] - 1]), float(clock[likely[-1]])),
        1.0 - float(given @ left) / float(given @ constant),
    )


def _by_part(rows: LogRows, pool: Candidates, part: NDArray[np.int64]) -> Products:
    """Products of a log's rows by the `part` (M,) that each belongs to."""
    return products([replace(row, block=part) for row in joint_rows([rows])], pool.width, near=False)


def _whole(identified: Identified, weights: Array) -> _Fit:
    """The fit of the whole library to all rows, joints weighed by `weights` (n,)."""
    pool = identified.pool
    whole = products(joint_rows(identified.rows), pool.width, near=False)
    gram, against, _ = whole.whole(weights)
    usual = usual_sizes(pool)
    spread = covariance(gram, usual) * usual[:, None] * usual
    return _Fit(spread @ against, spread)


def _further(group: Group, fit: _Fit, gram: Array, against: Array) -> _Further:
    """A group with numbers of its own in the rows after an instant, of which these are the products."""
    across = gram[:, group.columns] @ group.mixing
    score = group.mixing.T @ against[group.columns] - across.T @ fit.sizes
    told = group.mixing.T @ across[group.columns] - across.T @ fit.covariance @ across
    precision = np.diag(1.0 / group.usual**2)
    spread = np.asarray(np.linalg.inv(told + precision), dtype=float)
    numbers = spread @ score
    widths = np.linalg.slogdet(told + precision)[1] - np.linalg.slogdet(precision)[1]
    sizes = fit.sizes - fit.covariance @ across @ numbers
    return _Further(group, numbers, spread, sizes, float(0.5 * (score @ numbers - widths)))


def _left(rows: LogRows, sizes: Array) -> Array:
    """What sizes (W,) leave of each joint's torque where it counts (M, n), N*m."""
    return (rows.target - rows.explained(sizes)) * rows.prepared.moving


def _instant(rows: LogRows, further: _Further, weights: Array) -> tuple[int, Array, Array]:
    """The row from which on the change fits best, for each row how much less likely it is than that (nats), and the
    sum of squares (n,) that is left of each joint's torque."""
    later = np.zeros_like(further.sizes)
    later[further.group.columns] = further.group.values(further.numbers)
    before, after = (_left(rows, sizes) ** 2 for sizes in (further.sizes, further.sizes + later))
    cost = np.cumsum(before @ weights)[:-1] + np.cumsum((after @ weights)[::-1])[::-1][1:]
    start = int(np.argmin(cost)) + 1
    return start, 0.5 * (cost - cost.min()), before[:start].sum(axis=0) + after[start:].sum(axis=0)
