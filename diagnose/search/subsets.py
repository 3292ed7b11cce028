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
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.patterns.pool import GONE, Layout, Pool, inverse_root
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

from .pairs import Blocks, blocks_of

_KEPT, _IN_TRIPLES = 60, 160
"""Subsets of each size that are looked at closely; groups of which triples are made, those that explain most alone."""
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
    """A pool's products with one vector, perhaps beside columns that are taken as given: with each column (M,) that it
    covers (their numbers `at`; of which groups, `layout` says), what is left of the vector in sum of squares, and the
    products (M, k) with an orthonormal basis of what is taken. Beside that the pool's Gram matrix is less by the last
    times itself, each direction as often as `times` (k,) says. No more of it is worked out than is asked for, and each
    group's `blocks` part: the diagonal (M,) and blocks (g, r, r) as `layout.wide`. `root` (c, r) makes that basis of
    the columns that were taken last, `along` (r,) is what the vector has in it."""

    pool: Pool
    layout: Layout
    at: NDArray[np.int64]
    against: Array
    rss: float
    taken: Array
    times: Array
    blocks: tuple[Array, tuple[Array, ...]]
    root: Array
    along: Array

    def of(self, groups: NDArray[np.bool_]) -> Products:
        """The same of some of the groups that it covers."""
        columns = self.pool.columns(np.flatnonzero(groups).tolist())
        layout, place = self.pool.layout_of(groups), self.place(columns)
        rows = [groups[which] for which, _ in self.layout.wide]
        wide_blocks = tuple(block[some] for block, some in zip(self.blocks[1], rows, strict=True) if some.any())
        against, taken = self.against[place], self.taken[place]
        return replace(
            self, layout=layout, at=columns, against=against, taken=taken, blocks=(self.blocks[0][place], wide_blocks)
        )

    def place(self, columns: NDArray[np.int64]) -> NDArray[np.int64]:
        """Where columns of the pool, all of which are covered, stand among those."""
        places = np.empty(self.pool.basis.shape[1], dtype=np.int64)
        places[self.at] = np.arange(len(self.at))
        return places[columns]

    def rows(self, columns: NDArray[np.int64]) -> Array:
        """What is left of the products (c, M) of some of the columns covered with all of these."""
        taken = self.taken[self.place(columns)] * self.times
        return self.pool.rows(columns, self.at) - taken @ self.taken.T

    def among(self, columns: NDArray[np.int64]) -> Array:
        """The same of some with each other (c, c)."""
        taken = self.taken[self.place(columns)]
        return self.pool.among(columns) - (taken * self.times) @ taken.T

    def beside(self, columns: NDArray[np.int64]) -> Products:
        """The same beside further columns, of those covered, that are taken as given."""
        if not len(columns):
            return self
        place, rows = self.place(columns), self.rows(columns)
        root = inverse_root(rows[:, place])
        mixed, along = rows.T @ root, root.T @ self.against[place]
        left = replace(self, rss=max(self.rss - float(along @ along), 0.0), root=root, along=along)
        return left._with(mixed, along, 1.0)

    def leaving(self, places: NDArray[np.int64]) -> Products:
        """The same beside all that is taken but those of the columns taken last that stand at some `places` there, none
        of which the others hold (then `root` is square): what they alone have is given back."""
        alone = np.linalg.qr(self.root[places].T)[0]
        along = alone.T @ self.along
        back = replace(self, rss=self.rss + float(along @ along))
        return back._with(self.taken[:, -len(self.along) :] @ alone, along, -1.0)

    def _with(self, mixed: Array, along: Array, times: float) -> Products:
        """With directions taken, or given back (`times` -1): the columns' products (M, k) with them, and what the
        vector has in them (k,)."""
        diagonal, blocks = self.blocks
        parts = [mixed[at] for _, at in self.layout.wide]
        less = tuple(b - times * (part @ part.transpose(0, 2, 1)) for b, part in zip(blocks, parts, strict=True))
        return replace(
            self,
            against=self.against - times * (mixed @ along),
            taken=np.concatenate([self.taken, mixed], axis=1),
            times=np.concatenate([self.times, np.full(len(along), times)]),
            blocks=(diagonal - times * np.einsum("ij,ij->i", mixed, mixed), less),
        )

    def gains(self) -> Array:
        """What each group explains (G,), in sum of squares, beside what is taken as given; zero of those that are not
        covered."""
        layout, (diagonal, blocks) = self.layout, self.blocks
        gained, at = np.zeros(layout.groups), layout.single_columns
        diagonal_here = diagonal[at]
        gained[layout.single_groups] = np.where(
            diagonal_here > GONE, self.against[at] ** 2 / np.where(diagonal_here > GONE, diagonal_here, 1.0), 0.0
        )
        for (which, columns), block in zip(layout.wide, blocks, strict=True):
            along = self.against[columns]
            ridged = block + _RIDGE * np.eye(columns.shape[1])
            gained[which] = np.einsum("gi,gi->g", along, np.linalg.solve(ridged, along[:, :, None])[:, :, 0])
        return gained


def products(pool: Pool, vector: Array) -> Products:
    """The products of a pool with a vector (n,) from which nuisances are projected out."""
    against, none = pool.basis.T @ vector, np.zeros(0)
    at, taken = np.arange(len(against)), np.zeros((len(against), 0))
    rss, empty = float(vector @ vector), np.zeros((0, 0))
    return Products(pool, pool.layout, at, against, rss, taken, none, pool.blocks, empty, none)


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
    families_ = families(pool)
    price: Array = pool.ranks.astype(float) * math.log(count)
    weighed = [g for g in pool.groups if not g.candidate.outside and len(g.candidate.sizes) < len(g.length)]
    widest = max((group.rank for group in weighed if group.candidate.of_drives), default=0)
    for number, group in enumerate(pool.groups):
        if not group.candidate.outside and len(group.candidate.sizes) < len(group.length):
            # Links of unknown weight still have masses, positive and of an ordinary size: no free coefficient each.
            # What can do more with them than any drive pays for that.
            further = 0 if group.candidate.of_drives else max(group.rank - widest, 0)
            price[number] = (min(group.rank, 2) + further) * math.log(count)
    for members in families_:
        # A shape found anywhere on a line is a coefficient like any other; one of a few is a choice among so many.
        choice = 2.0 * math.log(len(members))
        free = np.array([len(pool.groups[member].candidate.free_shapes) for member in members])
        price[members] = price[members] + np.maximum(choice, free * math.log(count))
    return Criterion(count, max(len(families_), 1), price, pool.ranks, pool.rules.search.most_fitted)


def _log_choose(total: int, taken: int) -> float:
    return math.lgamma(total + 1) - math.lgamma(taken + 1) - math.lgamma(total - taken + 1)


def families(pool: Pool) -> list[NDArray[np.int64]]:
    """The groups of each family: variants of one candidate, of which a model takes one."""
    order = np.argsort(pool.family, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(pool.family[order])) + 1) if len(order) else []


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
    by_size = {0: [Subset((), start.rss, criterion(start.rss, ()))]}
    if not usable.any():
        return by_size
    alone = np.where(usable, start.gains(), -1.0)
    singles = [(float(gain), (number,)) for number, gain in enumerate(alone.tolist()) if gain >= 0.0]
    by_size[1] = _ranked(start.rss, singles, criterion)
    if largest >= 2:
        by_size[2] = _ranked(start.rss, _pairs(pool, start, usable, criterion), criterion)
    if largest >= 3 and by_size.get(2):
        reduced = _worth_a_triple(pool, start, by_size, usable)
        by_size[3] = _ranked(start.rss, _triples(pool, start, reduced, criterion), criterion)
    return {size: subsets for size, subsets in by_size.items() if subsets}


def _ranked(rss: float, gained: Sequence[tuple[float, tuple[int, ...]]], criterion: Criterion) -> list[Subset]:
    subsets = [
        Subset(tuple(sorted(members)), rss - float(gain), criterion(rss - float(gain), members))
        for gain, members in gained
    ]
    return sorted(subsets, key=lambda subset: subset.criterion)[:_KEPT]


def _ordered(pool: Pool, start: Products, members: Sequence[int]) -> tuple[NDArray[np.int64], Blocks]:
    """Some groups by their rank, and their products."""
    among = np.array(members, dtype=np.int64)
    order = among[np.argsort(pool.ranks[among], kind="stable")]
    return order, blocks_of(pool.gram, start.against, [pool.columns([number]) for number in order.tolist()])


def _pairs(
    pool: Pool, start: Products, usable: NDArray[np.bool_], criterion: Criterion
) -> list[tuple[float, tuple[int, ...]]]:
    """What the pairs of the smallest criterion gain: a group of many coefficients always gains much."""
    order, blocks = _ordered(pool, start, np.flatnonzero(usable).tolist())
    family, price, ranks = pool.family[order], criterion.price[order], pool.ranks[order]
    gained = blocks.of_two()
    value = criterion.of_many(start.rss, gained, price[:, None] + price, ranks[:, None] + ranks)
    value[(family[:, None] == family) | ~np.triu(np.ones(value.shape, dtype=bool), 1) | (gained <= 0.0)] = np.inf
    return [(gained[at], tuple(order[list(at)].tolist())) for at in _smallest(value, _KEPT)]


def _triples(
    pool: Pool, start: Products, reduced: Sequence[int], criterion: Criterion
) -> list[tuple[float, tuple[int, ...]]]:
    """The same of triples among some groups."""
    order, blocks = _ordered(pool, start, reduced)
    family, price, ranks = pool.family[order], criterion.price[order], pool.ranks[order]
    alone = blocks.alone()
    triples: list[tuple[float, float, tuple[int, ...]]] = []
    for first in range(len(order) - 2):
        rest = slice(first + 1, None)
        family_of_rest = family[rest]
        gained = alone[first] + blocks.without(first).beside(0).without(1).of_two()
        whole, rank = (
            price[first] + price[rest][:, None] + price[rest],
            ranks[first] + ranks[rest][:, None] + ranks[rest],
        )
        value = criterion.of_many(start.rss, gained, whole, rank)
        apart = (
            (family_of_rest[:, None] != family_of_rest)
            & (family_of_rest != family[first])
            & (family_of_rest[:, None] != family[first])
        )
        value[~np.triu(apart, 1) | (gained <= 0.0)] = np.inf
        for at in _smallest(value, _KEPT):
            members = order[[first, first + 1 + at[0], first + 1 + at[1]]]
            triples.append((float(value[at]), float(gained[at]), tuple(members.tolist())))
    return [(gain, members) for _, gain, members in heapq.nsmallest(_KEPT, triples)]


def _smallest(value: Array, count: int) -> list[tuple[int, int]]:
    """Where the smallest finite values of a matrix stand, at most so many."""
    flat = value.reshape(-1)
    best = np.argpartition(flat, count)[:count] if len(flat) > count else np.arange(len(flat))
    return [(int(k) // value.shape[1], int(k) % value.shape[1]) for k in best if flat[k] < np.inf]


def _worth_a_triple(
    pool: Pool, start: Products, subsets: dict[int, list[Subset]], usable: NDArray[np.bool_]
) -> list[int]:
    """Of each family the variants that explain most alone, beside the best single, and beside the best pair."""
    beside = [(), subsets[1][0].members, subsets[2][0].members]
    gained = [start.beside(pool.columns(members)).gains() for members in beside]
    taken: set[int] = set()
    for members in families(pool):
        able = members[usable[members]].tolist()
        if able:
            taken |= {max(able, key=lambda m, g=gain: g[m]) for gain in gained}
    taken |= set(subsets[2][0].members)
    if len(taken) > _IN_TRIPLES:
        strength = np.max(np.stack(gained), axis=0)
        taken = set(sorted(taken, key=lambda m: -strength[m])[:_IN_TRIPLES]) | set(subsets[2][0].members)
    return sorted(taken)
