"""The best subset of candidates: exhaustive up to three, from one Gram matrix.

Criterion: the extended BIC of J. Chen & Z. Chen, Biometrika 95 (2008) 759, doi:10.1093/biomet/asn034, with gamma = 1:
n log(RSS/n) + k log n + 2 log C(P, s) for s of P families of candidates with k coefficients in all, and 2 log V for
each member that was picked from V variants, or log n for each of its shapes that may take any value, if that is more.
Greedy selection names a wrong effect in one mixture in five; so pairs are all looked at, and all triples of what any
smaller model wants.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.patterns.pool import Layout, Pool
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

from .pairs import Blocks, blocks_of

_GONE = 1e-9
"""A direction whose squared norm falls below this share beside the others adds nothing that rounding does not."""
_RIDGE = 1e-8
"""Added to blocks of unit scale, so that directions which others have taken wholly count nothing."""


@dataclass(frozen=True)
class Subset:
    """Some groups of a pool (their numbers, ascending), the sum of squares that they leave, and the criterion."""

    members: tuple[int, ...]
    rss: float
    criterion: float


@dataclass(frozen=True)
class Products:
    """A pool's products with one vector: its Gram matrix and projections, perhaps beside some groups already taken."""

    gram: Array
    against: Array
    rss: float

    def beside(self, columns: NDArray[np.int64]) -> Products:
        """The same beside further columns that are taken as given."""
        mixed, explained = taken_off(self, columns)
        return Products(
            self.gram - mixed @ mixed.T,
            self.against - mixed @ explained,
            max(self.rss - float(explained @ explained), 0.0),
        )


def products(pool: Pool, vector: Array) -> Products:
    """The products of a pool with a vector (n,) from which nuisances are projected out."""
    return Products(pool.gram, pool.basis.T @ vector, float(vector @ vector))


def gains(pool: Pool, given: Products) -> Array:
    """What each group explains (G,), in sum of squares, beside what `given` takes as given."""
    return _gains(pool.layout, given.gram.diagonal(), _blocks(pool, given.gram), given.against)


def gains_beside(
    pool: Pool, given: Products, columns: NDArray[np.int64], blocks: Sequence[Array]
) -> tuple[Array, float]:
    """The same beside further columns, and what those explain, without working out the whole Gram matrix.

    `blocks` are the groups' own blocks of `given.gram` (see `own_blocks`).
    """
    mixed, explained = taken_off(given, columns)
    diagonal = given.gram.diagonal() - np.einsum("ij,ij->i", mixed, mixed)
    less: list[Array] = []
    for (_, at), block in zip(pool.layout.wide, blocks, strict=True):
        part = mixed[at]
        less.append(block - part @ part.transpose(0, 2, 1))
    return _gains(pool.layout, diagonal, less, given.against - mixed @ explained), float(explained @ explained)


def own_blocks(pool: Pool, given: Products) -> list[Array]:
    """The groups' own blocks of a Gram matrix, for groups of rank 2 and more, gathered by rank."""
    return _blocks(pool, given.gram)


def _blocks(pool: Pool, gram: Array) -> list[Array]:
    return [gram[at[:, :, None], at[:, None, :]] for _, at in pool.layout.wide]


def taken_off(given: Products, columns: NDArray[np.int64]) -> tuple[Array, Array]:
    """The products with an orthonormal basis of some columns: (M, k) of all columns, (k,) of the vector. Beside those
    columns the Gram matrix is less by the first times itself, and products with the vector by the first times the
    second."""
    values, vectors = np.linalg.eigh(given.gram[np.ix_(columns, columns)])
    good = values > _GONE
    root = vectors[:, good] / np.sqrt(values[good])
    return given.gram[:, columns] @ root, root.T @ given.against[columns]


def _gains(layout: Layout, diagonal: Array, blocks: Sequence[Array], against: Array) -> Array:
    gained = np.zeros(layout.groups)
    at = layout.single_columns
    own = diagonal[at]
    gained[layout.single_groups] = np.where(own > _GONE, against[at] ** 2 / np.where(own > _GONE, own, 1.0), 0.0)
    for (which, columns), block in zip(layout.wide, blocks, strict=True):
        along = against[columns]
        ridged = block + _RIDGE * np.eye(columns.shape[1])
        gained[which] = np.einsum("gi,gi->g", along, np.linalg.solve(ridged, along[:, :, None])[:, :, 0])
    return gained


@dataclass(frozen=True)
class Criterion:
    """The extended BIC for `count` observations (nuisances already counted off) and `families` candidates.

    `price` (G,) is what each group costs for its coefficients and for being picked from its variants, `ranks` (G,) its
    coefficients. A subset with more than `most_fitted` coefficients an observation explains nothing: it is infinite.
    """

    count: int
    families: int
    price: Array
    ranks: NDArray[np.int64]
    most_fitted: float = RULES.search.most_fitted

    def __call__(self, rss: float, members: Sequence[int]) -> float:
        """The criterion of a subset; smaller is better."""
        if sum(int(self.ranks[member]) for member in members) > self.most_fitted * self.count:
            return math.inf
        prior = 2.0 * _log_choose(max(self.families, len(members)), len(members))
        priced = float(sum(self.price[member] for member in members))
        return self.count * math.log(max(rss, 1e-300) / self.count) + priced + prior

    @property
    def fits(self) -> NDArray[np.bool_]:
        """Which groups have few enough coefficients to explain anything."""
        return self.ranks <= self.most_fitted * self.count

    def of_many(self, rss: float, gained: Array, price: Array, rank: NDArray[np.int64]) -> Array:
        """The criterion of subsets of one size, but for the prior that they share: what each gains, costs and fits."""
        value = self.count * np.log(np.maximum(rss - gained, 1e-300)) + price
        return np.where(rank > self.most_fitted * self.count, np.inf, value)


def criterion_for(pool: Pool, count: int) -> Criterion:
    """The criterion for a pool's candidates and `count` observations."""
    alike = families(pool)
    price: Array = pool.ranks.astype(float) * math.log(count)
    weighed = [g for g in pool.groups if not g.candidate.outside and len(g.candidate.sizes) < len(g.length)]
    widest = max((group.rank for group in weighed if group.candidate.of_drives), default=0)
    for number, group in enumerate(pool.groups):
        if not group.candidate.outside and len(group.candidate.sizes) < len(group.length):
            # Links of unknown weight still have masses, positive and of an ordinary size: no free coefficient each.
            # What can do more with them than any drive pays for that.
            further = 0 if group.candidate.of_drives else max(group.rank - widest, 0)
            price[number] = (min(group.rank, 2) + further) * math.log(count)
    for members in alike:
        # A shape found anywhere on a line is a coefficient like any other; one of a few is a choice among so many.
        choice = 2.0 * math.log(len(members))
        free = np.array([len(pool.groups[member].candidate.free_shapes) for member in members])
        price[members] = price[members] + np.maximum(choice, free * math.log(count))
    return Criterion(count, max(len(alike), 1), price, pool.ranks, pool.rules.search.most_fitted)


def _log_choose(total: int, taken: int) -> float:
    return math.lgamma(total + 1) - math.lgamma(taken + 1) - math.lgamma(total - taken + 1)


def families(pool: Pool) -> list[list[int]]:
    """The groups of each family: variants of one candidate, of which a model takes one."""
    found: dict[object, list[int]] = {}
    for number, group in enumerate(pool.groups):
        found.setdefault(group.candidate.family, []).append(number)
    return list(found.values())


def best_subsets(
    pool: Pool,
    vector: Array,
    criterion: Criterion,
    *,
    largest: int = 3,
    allowed: Callable[[int], bool] | None = None,
) -> dict[int, list[Subset]]:
    """The best subsets of every size up to `largest` (0 included), best first.

    Singles and pairs are taken over all variants; triples over the variant of each family that explains most alone,
    beside the best single or beside the best pair. `allowed` keeps groups out.
    """
    usable = np.array([allowed is None or allowed(number) for number in range(len(pool.groups))], dtype=bool)
    start = products(pool, vector)
    found = {0: [Subset((), start.rss, criterion(start.rss, ()))]}
    if not usable.any():
        return found
    alone = np.where(usable, gains(pool, start), -1.0)
    singles = [(float(gain), (number,)) for number, gain in enumerate(alone.tolist()) if gain >= 0.0]
    kept = pool.rules.search.kept
    found[1] = _ranked(start.rss, singles, criterion, kept)
    if largest >= 2:
        found[2] = _ranked(start.rss, _pairs(pool, start, usable, criterion), criterion, kept)
    if largest >= 3 and found.get(2):
        reduced = _worth_a_triple(pool, start, found, usable)
        found[3] = _ranked(start.rss, _triples(pool, start, reduced, criterion), criterion, kept)
    return {size: subsets for size, subsets in found.items() if subsets}


def _ranked(
    rss: float, gained: Sequence[tuple[float, tuple[int, ...]]], criterion: Criterion, kept: int
) -> list[Subset]:
    subsets = [
        Subset(tuple(sorted(members)), rss - float(gain), criterion(rss - float(gain), members))
        for gain, members in gained
    ]
    return sorted(subsets, key=lambda subset: subset.criterion)[:kept]


def _ordered(pool: Pool, start: Products, members: Sequence[int]) -> tuple[NDArray[np.int64], Blocks]:
    """Some groups by their rank, and their products."""
    among = np.array(members, dtype=np.int64)
    order = among[np.argsort(pool.ranks[among], kind="stable")]
    return order, blocks_of(start.gram, start.against, [pool.columns([number]) for number in order.tolist()])


def _pairs(
    pool: Pool, start: Products, usable: NDArray[np.bool_], criterion: Criterion
) -> list[tuple[float, tuple[int, ...]]]:
    """What the pairs of the smallest criterion gain: a group of many coefficients always gains much."""
    order, blocks = _ordered(pool, start, np.flatnonzero(usable).tolist())
    family, price, ranks = _family_of(pool)[order], criterion.price[order], pool.ranks[order]
    gained = blocks.of_two()
    value = criterion.of_many(start.rss, gained, price[:, None] + price, ranks[:, None] + ranks)
    value[(family[:, None] == family) | ~np.triu(np.ones(value.shape, dtype=bool), 1) | (gained <= 0.0)] = np.inf
    return [(gained[at], tuple(order[list(at)].tolist())) for at in _smallest(value, pool.rules.search.kept)]


def _triples(
    pool: Pool, start: Products, reduced: Sequence[int], criterion: Criterion
) -> list[tuple[float, tuple[int, ...]]]:
    """The same of triples among some groups."""
    order, blocks = _ordered(pool, start, reduced)
    family, price, ranks = _family_of(pool)[order], criterion.price[order], pool.ranks[order]
    alone = blocks.alone()
    found: list[tuple[float, float, tuple[int, ...]]] = []
    for first in range(len(order) - 2):
        rest = slice(first + 1, None)
        own = family[rest]
        gained = alone[first] + blocks.without(first).beside(0).without(1).of_two()
        whole, rank = (
            price[first] + price[rest][:, None] + price[rest],
            ranks[first] + ranks[rest][:, None] + ranks[rest],
        )
        value = criterion.of_many(start.rss, gained, whole, rank)
        apart = (own[:, None] != own) & (own != family[first]) & (own[:, None] != family[first])
        value[~np.triu(apart, 1) | (gained <= 0.0)] = np.inf
        for at in _smallest(value, pool.rules.search.kept):
            members = order[[first, first + 1 + at[0], first + 1 + at[1]]]
            found.append((float(value[at]), float(gained[at]), tuple(members.tolist())))
    return [(gain, members) for _, gain, members in heapq.nsmallest(pool.rules.search.kept, found)]


def _smallest(value: Array, count: int) -> list[tuple[int, int]]:
    """Where the smallest finite values of a matrix stand, at most so many."""
    flat = value.reshape(-1)
    best = np.argpartition(flat, count)[:count] if len(flat) > count else np.arange(len(flat))
    return [(int(k) // value.shape[1], int(k) % value.shape[1]) for k in best if flat[k] < np.inf]


def _worth_a_triple(
    pool: Pool, start: Products, found: dict[int, list[Subset]], usable: NDArray[np.bool_]
) -> list[int]:
    """Of each family the variants that explain most alone, beside the best single, and beside the best pair."""
    beside = [(), found[1][0].members, found[2][0].members]
    blocks = own_blocks(pool, start)
    gained = [gains_beside(pool, start, pool.columns(members), blocks)[0] for members in beside]
    taken: set[int] = set()
    for members in families(pool):
        able = [m for m in members if usable[m]]
        if able:
            taken |= {max(able, key=lambda m, g=gain: g[m]) for gain in gained}
    taken |= set(found[2][0].members)
    most = pool.rules.search.most_in_triples
    if len(taken) > most:
        strength = np.max(np.stack(gained), axis=0)
        taken = set(sorted(taken, key=lambda m: -strength[m])[:most]) | set(found[2][0].members)
    return sorted(taken)


def _family_of(pool: Pool) -> NDArray[np.int64]:
    number = np.zeros(len(pool.groups), dtype=np.int64)
    for index, members in enumerate(families(pool)):
        number[members] = index
    return number
