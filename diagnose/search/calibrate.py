"""How large a gain chance alone produces: residuals turned about by visit, everything searched anew.

D. Freedman & D. Lane, J. Business & Economic Statistics 1 (1983) 292, doi:10.1080/07350015.1983.10509354: what the
smaller model leaves is drawn anew and added back to its fit. Visits stay whole and where they are, and each visit's
sign is drawn anew (A. M. Winkler et al., NeuroImage 92 (2014) 381, doi:10.1016/j.neuroimage.2014.01.060): that asks
for errors that are as often one way as the other, not for errors alike at all poses. Those of joints are not: a
stretched arm scatters more, just where its joints show most, and visits exchanged freely call one such null in five
something. Only where visits are too few for signs alone are they exchanged as well. The statistic is the largest over
all candidates, which makes the p-value that of the whole search for one more effect.

Where a p-value only decides, draws go where they do: they end once enough have reached the statistic (J. Besag & P.
Clifford, Biometrika 78 (1991) 301, doi:10.1093/biomet/78.2.301), and once it lies far beyond all that is drawn.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array

from .subsets import Criterion, Products

FEW_DRAWS = 99
"""For each finding beyond three, and whatever the size of a test."""
_CHUNK = 32
_REACHED, _FAR = 10, 1e-3
"""No more draws are made once so many have reached the statistic, or once the p-value is below this share of the level:
an eighth of the tail's spread, by which it is unsure after fifty draws, is a factor of five there."""
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


@dataclass(frozen=True)
class Draws:
    """How chance is drawn: with which `visits` (N, numbered from 0, ascending) whole, of readings of `width` columns,
    so many `draws` at most. With a `level` a test only decides: its draws end where its p-value is plainly on one side
    of that."""

    visits: NDArray[np.int64]
    width: int
    draws: int
    rng: np.random.Generator
    level: float | None = None


def one_more(
    initial: Products,
    vector: Array,
    members: Sequence[int],
    criterion: Criterion,
    how: Draws,
    among: Sequence[NDArray[np.bool_]],
) -> list[Calibrated]:
    """Test whether one more group than `members` explains more of a vector, from which nuisances are projected out,
    than chance would, for each set of groups in `among`.

    `initial` are the pool's products with the vector. The same draws serve all sets.
    """
    columns, covered = initial.pool.columns(members), np.any(among, axis=0)
    beside = initial.of(_with(covered, members)).beside(columns).of(covered)
    basis = initial.pool.basis[:, columns] @ beside.root if len(columns) else np.zeros((len(vector), 0))
    return _tested(_Smaller(beside, basis, vector), criterion, how, among, None)


def each_given_others(
    initial: Products,
    vector: Array,
    members: Sequence[int],
    others: Sequence[int],
    criterion: Criterion,
    how: Draws,
    among: NDArray[np.bool_],
) -> Iterator[tuple[int, float]]:
    """The place and the p-value of each of some groups (all of them `among` those that are searched) given the rest of
    them and `others`, the weakest first: how often chance lets the best of those searched explain as much as it does.

    What is beside all is worked out once, and no test that is not asked for."""
    pool, everything = initial.pool, [*members, *others]
    edges, columns = np.cumsum([0, *pool.ranks[everything]]), pool.columns(everything)
    given = initial.of(_with(among, everything))
    whole = given.beside(columns)
    square = whole.root.shape[0] == whole.root.shape[1]
    spans = [np.arange(edges[place], edges[place + 1]) for place in range(len(members))]
    left = [whole.leaving(span) if square else given.beside(np.delete(columns, span)) for span in spans]
    rss = np.array([item.rss for item in left])
    statistic = criterion.count * (np.log(rss) - np.log(whole.rss)) - criterion.price[list(members)]
    basis = pool.basis[:, columns] @ whole.root
    for place in np.argsort(statistic, kind="stable").tolist():
        if square:
            alone = basis @ np.linalg.qr(whole.root[spans[place]].T)[0]
            directions = np.concatenate([basis, alone], axis=1)
        else:
            directions = pool.basis[:, np.delete(columns, spans[place])] @ left[place].root
        smaller = _Smaller(left[place].of(among), directions, vector)
        yield place, _tested(smaller, criterion, how, [among], members[place])[0].p_value


def _with(groups: NDArray[np.bool_], more: Sequence[int]) -> NDArray[np.bool_]:
    """Some groups, and more by their numbers."""
    wider = groups.copy()
    wider[list(more)] = True
    return wider


class _Smaller:
    """A smaller model: the products `beside` it, and the `basis` (n, k) of the directions that these have taken, each
    as often as they say; what it leaves of a vector (n,)."""

    def __init__(self, beside: Products, basis: Array, vector: Array) -> None:
        self.beside, self.basis = beside, basis
        self.left = self.off(vector)

    def off(self, vectors: Array) -> Array:
        """Vectors (n, ...), from which nuisances are projected out, less what the model explains."""
        times = self.beside.times.reshape(-1, *(1,) * (vectors.ndim - 1))
        return vectors - self.basis @ (times * (self.basis.T @ vectors))


def _tested(
    smaller: _Smaller,
    criterion: Criterion,
    how: Draws,
    among: Sequence[NDArray[np.bool_]],
    member: int | None,
) -> list[Calibrated]:
    """The tests of the best group of each set beside a smaller model, or of one `member`."""
    beside, residual = smaller.beside, smaller.left
    pool = beside.pool
    unit = _unit(beside)
    statistic = _statistic(beside, unit, beside.against[:, None], residual @ residual, criterion)[:, 0]
    allowed = [np.where(usable & criterion.fits, statistic, -np.inf) for usable in among]
    best = [int(np.argmax(values)) if member is None else member for values in allowed]
    reached = [float(values[number]) for values, number in zip(allowed, best, strict=True)]
    rules = pool.rules.search
    draws = max(FEW_DRAWS, min(how.draws, int(_WORK / max(pool.basis.size, 1))))
    few = int(how.visits[-1]) + 1 < rules.enough_visits
    anew = (_Shuffled if few else _Flipped)(smaller, how.visits, how.width)
    drawn = [np.zeros(0) for _ in among]
    for start in range(0, draws, _CHUNK):
        statistics = _statistic(beside, unit, *anew.drawn(how.rng, min(_CHUNK, draws - start)), criterion)
        for place, usable in enumerate(among):
            largest = statistics[usable & criterion.fits].max(axis=0, initial=-np.inf)
            drawn[place] = np.concatenate([drawn[place], largest])
        if how.level is not None and all(map(_plain, reached, drawn, [how.level] * len(drawn))):
            break
    return [
        Calibrated(value, number, p_value(value, values), values, each)
        if value > -np.inf
        else Calibrated(-math.inf, -1, 1.0, values, each)
        for value, number, values, each in zip(reached, best, drawn, allowed, strict=True)
    ]


def _plain(statistic: float, drawn: Array, level: float) -> bool:
    """Whether the p-value of a statistic is plainly above a level, or plainly below, by what was drawn so far."""
    reached = int(np.sum(drawn >= statistic))
    return reached >= _REACHED or p_value(statistic, drawn) < _FAR * level


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
    """Residuals with few visits in random order, each under a random sign, beside the smaller model."""

    def __init__(self, smaller: _Smaller, visits: NDArray[np.int64], width: int) -> None:
        self._smaller, self._visits = smaller, visits
        self._table = smaller.left.reshape(-1, width)

    def drawn(self, rng: np.random.Generator, count: int) -> tuple[Array, Array]:
        """Products of so many draws with the columns that count (M, count), and their sums of squares (count,)."""
        drawn = np.stack([shuffled(self._table, self._visits, rng).reshape(-1) for _ in range(count)], axis=1)
        beside = self._smaller.beside
        drawn = self._smaller.off(beside.pool.projected(drawn))
        return beside.pool.basis[:, beside.at].T @ drawn, np.sum(drawn * drawn, axis=0)


class _Flipped:
    """Residuals with each visit under a random sign, beside the smaller model. A draw's products are sums of those of
    the visits, which are worked out but once."""

    def __init__(self, smaller: _Smaller, visits: NDArray[np.int64], width: int) -> None:
        beside, residual = smaller.beside, smaller.left
        starts, table = np.flatnonzero(np.diff(visits, prepend=-1)), residual.reshape(-1, width)
        self._mixed, self._times, self._rss = beside.taken, beside.times, float(residual @ residual)
        # Flipped, a residual is no longer orthogonal to the nuisances either.
        self._nuisance = _by_visit(beside.pool.nuisance.T, table, starts)
        self._taken = _by_visit(smaller.basis.T, table, starts)
        self._along = np.empty((len(beside.at), len(starts)))
        step = max(1, _AT_ONCE // len(residual))
        for some in (slice(k, k + step) for k in range(0, len(self._along), step)):
            self._along[some] = _by_visit(beside.pool.basis.T[beside.at[some]], table, starts)

    def drawn(self, rng: np.random.Generator, count: int) -> tuple[Array, Array]:
        """Products of so many draws with the columns that count (M, count), and their sums of squares (count,)."""
        signs = np.stack([rng.choice((-1.0, 1.0), self._along.shape[1]) for _ in range(count)], axis=1)
        given = self._taken @ signs
        times = self._times[:, None] * given
        left = self._rss - np.sum((self._nuisance @ signs) ** 2, axis=0) - np.sum(times * given, axis=0)
        return self._along @ signs - self._mixed @ times, left


def _by_visit(columns: Array, table: Array, starts: NDArray[np.int64]) -> Array:
    """What each visit, which begins at the readings `starts`, adds to the products of columns (M, n) with a table of
    readings (N, C)."""
    products = columns * table.reshape(-1)
    each = sum((products[:, k :: table.shape[1]] for k in range(1, table.shape[1])), products[:, :: table.shape[1]])
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
    size, blocks = beside.blocks
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
