"""Sets of causes that could stand in the place of a set: two zeros for a tool's offset, one tilt for two couplings.

What cannot be told from one finding need not be one cause. Beside all other findings, pairs of the library are looked
at for each finding, and single causes for each two of them, by what they explain beside the rest (`Blocks`); what fits
as well by the criterion, and would not without one of its parts, is an exchange.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .naming import Namer
from .pairs import Blocks

_LOOKED_AT = 30
"""Sets, best first, whose sizes are fitted."""
_MOST = 3
"""Exchanges that are told of one set of findings."""


@dataclass(frozen=True)
class Exchanged:
    """Groups that could stand in the place of some members, and how much worse the criterion is then."""

    members: tuple[int, ...]
    others: tuple[int, ...]
    worse: float


def exchanged(namer: Namer, members: Sequence[int], outside: Sequence[int] = ()) -> tuple[Exchanged, ...]:
    """The sets that cannot be told from one or two members beside the others (and forms `outside`)."""
    exchanges: list[Exchanged] = []
    for size in (1, 2):
        for place in itertools.combinations(members, size):
            rest = [*(m for m in members if m not in place), *outside]
            exchanges += _instead(namer, place, rest)
    return tuple(exchanges)


def _instead(namer: Namer, place: tuple[int, ...], rest: Sequence[int]) -> list[Exchanged]:
    criterion, tied = namer.criterion_of((*place, *rest)), namer.rules.tied
    exchanges: list[Exchanged] = []
    for others in _sets(namer, rest, 3 - len(place), {namer.pool.groups[m].candidate.family for m in place}):
        worse = namer.criterion_of((*others, *rest)) - criterion
        parts = itertools.combinations(others, len(others) - 1)
        if worse > tied or not namer.possible((*others, *rest)):
            continue
        if len(others) == 1 or all(
            namer.criterion_of((*part, *rest)) - criterion > namer.rules.confident for part in parts
        ):
            exchanges.append(Exchanged(place, others, worse))
    return sorted(exchanges, key=lambda exchange: exchange.worse)[:_MOST]


def _sets(namer: Namer, rest: Sequence[int], size: int, families: set[object]) -> list[tuple[int, ...]]:
    """The one or two groups of the library, none of these families nor of the rest's, that explain most for what they
    cost beside the rest; of each family the variant that does alone."""
    pool, products = namer.pool, namer.prepared.products.beside(namer.pool.columns(rest))
    barred = families | {pool.groups[m].candidate.family for m in rest}
    worth = namer.criterion.of_many(products.rss, products.gains(), namer.criterion.price, pool.ranks)
    best: dict[object, int] = {}
    for number in np.argsort(worth, kind="stable").tolist():
        family = pool.groups[number].candidate.family
        if namer.library[number] and family not in barred:
            best.setdefault(family, number)
    if size == 1:
        return [(number,) for number in list(best.values())[:_LOOKED_AT]]
    among = np.array(sorted(best.values(), key=lambda number: int(pool.ranks[number])), dtype=np.int64)
    at, price, ranks = pool.columns(among.tolist()), namer.criterion.price[among], pool.ranks[among]
    gram = pool.rows(at)[:, at] - products.taken[at] @ products.taken[at].T
    gained = Blocks(gram, products.against[at], ranks).orthonormal().of_two()
    value = namer.criterion.of_many(products.rss, gained, price[:, None] + price, ranks[:, None] + ranks)
    first, second = np.triu_indices(len(among), 1)
    order = np.argsort(value[first, second], kind="stable")[:_LOOKED_AT]
    return [(int(among[first[k]]), int(among[second[k]])) for k in order.tolist()]
