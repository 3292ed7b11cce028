"""How large a gain chance alone produces: residuals turned about by visit, everything searched anew.

D. Freedman & D. Lane, J. Business & Economic Statistics 1 (1983) 292, doi:10.1080/07350015.1983.10509354: what the
smaller model leaves is drawn anew and added back to its fit. Visits stay whole and where they are, and each visit's
sign is drawn anew (A. M. Winkler et al., NeuroImage 92 (2014) 381, doi:10.1016/j.neuroimage.2014.01.060): that asks
for errors that are as often one way as the other, not for errors alike at all poses. Those of joints are not: a
stretched arm scatters more, just where its joints show most, and visits exchanged freely call one such null in five
something. Only where visits are too few for signs alone are they exchanged as well. The statistic is the largest over
all candidates, which makes the p-value that of the whole search for one more effect.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array

from .subsets import Criterion, Products

FEW_DRAWS = 99
"""For each finding beyond three, and whatever the size of a test."""
_CHUNK = 32
_GONE = 1e-8
"""Directions of which the smaller model leaves less than this share (squared) are gone."""
_WORK = 4e9
"""Numbers of a basis that the draws of one test may go through."""
_AT_ONCE = 1 << 18
"""Numbers of a basis that are worked on at once: fewer than a cache holds."""


@dataclass(frozen=True)
class Calibrated:
    """A test of the best of some candidates: the largest statistic, which group it belongs to, its p-value, the
    statistics of the draws, and that of every group."""

    statistic: float
    best: int
    p_value: float
    drawn: Array
    each: Array


def one_more(
    initial: Products,
    vector: Array,
    members: Sequence[int],
    criterion: Criterion,
    visits: NDArray[np.int64],
    width: int,
    *,
    draws: int,
    rng: np.random.Generator,
    among: Sequence[NDArray[np.bool_]],
) -> list[Calibrated]:
    """Test whether one more group than `members` explains more of a vector, from which nuisances are projected out,
    than chance would, for each set of groups in `among`.

    `initial` are the pool's products with the vector, `width` is the number of columns of a reading. The same draws
    serve all sets.
    """
    pool, columns = initial.pool, initial.pool.columns(members)
    covered = np.any(among, axis=0)
    given = covered.copy()
    given[list(members)] = True
    beside = initial.of(given).beside(columns).of(covered)
    basis = pool.basis[:, columns] @ beside.root if len(columns) else np.zeros((len(vector), 0))
    residual = vector - basis @ (basis.T @ vector)
    unit = _unit(beside)
    statistic = _statistic(beside, unit, beside.against[:, None], residual @ residual, criterion)[:, 0]
    among = [usable & criterion.fits for usable in among]
    rules = pool.rules.search
    draws = max(FEW_DRAWS, min(draws, int(_WORK / max(pool.basis.size, 1))))
    few = int(visits[-1]) + 1 < rules.enough_visits
    anew = (_Shuffled if few else _Flipped)(beside, basis, residual, visits, width)
    drawn: list[list[Array]] = [[] for _ in among]
    for start in range(0, draws, _CHUNK):
        statistics = _statistic(beside, unit, *anew.drawn(rng, min(_CHUNK, draws - start)), criterion)
        for values, usable in zip(drawn, among, strict=True):
            values.append(statistics[usable].max(axis=0, initial=-np.inf))
    return [_tested(statistic, np.concatenate(values), usable) for values, usable in zip(drawn, among, strict=True)]


def _tested(statistic: Array, drawn: Array, usable: NDArray[np.bool_]) -> Calibrated:
    allowed = np.where(usable, statistic, -np.inf)
    if not usable.any():
        return Calibrated(-math.inf, -1, 1.0, drawn, allowed)
    best = int(np.argmax(allowed))
    return Calibrated(float(allowed[best]), best, p_value(float(allowed[best]), drawn), drawn, allowed)


def permutation(visits: NDArray[np.int64], rng: np.random.Generator) -> NDArray[np.int64]:
    """Row numbers with whole visits in random order, beginning anywhere within a cycle."""
    count = int(visits[-1]) + 1
    rows = np.argsort(rng.permutation(count)[visits], kind="stable")
    return np.roll(rows, int(rng.integers(len(rows)))) if count < len(rows) else rows


def shuffled(table: Array, visits: NDArray[np.int64], rng: np.random.Generator) -> Array:
    """Readings (N, C) with whole visits (N, numbered from 0, ascending) in random order, each with a random sign."""
    flips = rng.choice((-1.0, 1.0), int(visits[-1]) + 1)
    rows = permutation(visits, rng)
    return table[rows] * flips[visits[rows], None]


class _Shuffled:
    """Residuals with few visits in random order, each under a random sign, beside the smaller model, of which an
    orthonormal `basis` is given."""

    def __init__(self, beside: Products, basis: Array, residual: Array, visits: NDArray[np.int64], width: int) -> None:
        self._pool, self._at, self._basis, self._visits = beside.pool, beside.at, basis, visits
        self._table = residual.reshape(-1, width)

    def drawn(self, rng: np.random.Generator, count: int) -> tuple[Array, Array]:
        """Products of so many draws with the columns that count (M, count), and their sums of squares (count,)."""
        drawn = np.stack([shuffled(self._table, self._visits, rng).reshape(-1) for _ in range(count)], axis=1)
        drawn = self._pool.projected(drawn)
        drawn -= self._basis @ (self._basis.T @ drawn)
        return self._pool.basis[:, self._at].T @ drawn, np.sum(drawn * drawn, axis=0)


class _Flipped:
    """Residuals with each visit under a random sign, beside the smaller model. A draw's products are sums of those of
    the visits, which are worked out but once."""

    def __init__(self, beside: Products, basis: Array, residual: Array, visits: NDArray[np.int64], width: int) -> None:
        starts, table = np.flatnonzero(np.diff(visits, prepend=-1)), residual.reshape(-1, width)
        self._mixed, self._rss = beside.taken, float(residual @ residual)
        # Flipped, a residual is no longer orthogonal to the nuisances either.
        self._taken = _by_visit(np.concatenate([beside.pool.nuisance, basis], axis=1).T, table, starts)
        self._along = np.empty((len(beside.at), len(starts)))
        step = max(1, _AT_ONCE // len(residual))
        for some in (slice(k, k + step) for k in range(0, len(self._along), step)):
            self._along[some] = _by_visit(beside.pool.basis.T[beside.at[some]], table, starts)

    def drawn(self, rng: np.random.Generator, count: int) -> tuple[Array, Array]:
        """Products of so many draws with the columns that count (M, count), and their sums of squares (count,)."""
        signs = np.stack([rng.choice((-1.0, 1.0), self._along.shape[1]) for _ in range(count)], axis=1)
        taken = self._taken @ signs
        given = taken[len(taken) - self._mixed.shape[1] :]
        return self._along @ signs - self._mixed @ given, self._rss - np.sum(taken**2, axis=0)


def _by_visit(columns: Array, table: Array, starts: NDArray[np.int64]) -> Array:
    """What each visit, which begins at the readings `starts`, adds to the products of columns (M, n) with a table of
    readings (N, C)."""
    each = np.einsum("mnc,nc->mn", columns.reshape(len(columns), *table.shape), table)
    return each if len(starts) == len(table) else np.add.reduceat(each, starts, axis=1)


def gumbel(drawn: Array) -> tuple[float, float]:
    """Location and spread of the Gumbel distribution through the moments of draws, each the largest of many (E. J.
    Gumbel, Statistics of Extremes, 1958)."""
    spread = float(np.std(drawn)) * math.sqrt(6.0) / math.pi
    return float(np.mean(drawn)) - 0.5772156649 * spread, spread


def p_value(observed: float, drawn: Array) -> float:
    """The p-value of a statistic among permuted ones: counted where draws reach it, else by the tail of `gumbel`."""
    reached = int(np.sum(drawn >= observed))
    counted = (1.0 + reached) / (1.0 + len(drawn))
    if reached >= 5 or len(drawn) < 50:
        return counted
    location, spread = gumbel(drawn)
    if spread <= 0.0:
        return counted
    return float(min(counted, -math.expm1(-math.exp(-(observed - location) / spread))))


@dataclass(frozen=True)
class _Unit:
    """What turns products with columns beside a smaller model into those with a basis that is orthonormal within each
    group again: `scale` (M,) serves groups of one column, `wide` holds for each rank the groups' matrices (g, r, r)."""

    scale: Array
    wide: tuple[Array, ...]


def _unit(beside: Products) -> _Unit:
    """From the Gram matrix alone: vectors come in orthogonal to the smaller model, so only lengths matter."""
    size, blocks = beside.own
    scale = np.where(size > _GONE, 1.0 / np.sqrt(np.where(size > _GONE, size, 1.0)), 0.0)
    wide: list[Array] = []
    for block in blocks:
        values, vectors = np.linalg.eigh(block)
        root = np.where(values > _GONE, 1.0 / np.sqrt(np.where(values > _GONE, values, 1.0)), 0.0)
        wide.append((vectors * root[:, None, :]).transpose(0, 2, 1))
    return _Unit(scale, tuple(wide))


def _statistic(beside: Products, unit: _Unit, along: Array, rss: Array, criterion: Criterion) -> Array:
    """The drop of the criterion that each group brings to vectors orthogonal to the smaller model, (G, V), but for the
    prior that all share, from their products with the columns that count (M, V) and their sums of squares (V,)."""
    layout = beside.layout
    explained = np.zeros((layout.groups, along.shape[1]))
    single = layout.single_columns
    explained[layout.single_groups] = (unit.scale[single, None] * along[single]) ** 2
    for (which, at), turned in zip(layout.wide, unit.wide, strict=True):
        explained[which] = np.sum((turned @ along[at]) ** 2, axis=1)
    share = np.minimum(explained / np.where(rss > 0.0, rss, 1.0), 1.0 - 1e-12)
    return -criterion.count * np.log1p(-share) - criterion.price[:, None]
