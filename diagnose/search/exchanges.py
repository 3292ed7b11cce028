"""Sets of causes that could stand in the place of a set: two zeros for a tool's offset, one tilt for two couplings.

What cannot be told from one finding need not be one cause. Beside all other findings, pairs of the library are looked
at for each finding, and single causes for each two of them, by what they explain beside the rest (`Blocks`). What
explains more, and is better by the criterion, takes their place: a name that was taken early may stand for two that
only together explain more (a bent link for two drives that give). What fits as well, and would not without one of its
parts, is told.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from linkwright.core.diagnose.patterns.library import Family

from .pairs import Blocks

if TYPE_CHECKING:
    from .naming import Namer

_LOOKED_AT = 30
"""Sets, best first, whose sizes are fitted."""
_MOST = 3
"""Exchanges that are told of one set of findings."""
_ROUNDING = 1e-6
"""Of a criterion, what rounding makes of two that are the same."""


@dataclass(frozen=True)
class Exchanged:
    """Groups that could stand in the place of some members, and how much worse the criterion is then."""

    members: tuple[int, ...]
    others: tuple[int, ...]
    worse: float


def better(namer: Namer, members: Sequence[int], *, one_by_one: bool = False) -> tuple[int, ...]:
    """The members after exchanges for the possible sets that make the criterion least, as long as any explains more and
    makes it less: one for one (those alone with `one_by_one`), one for two and two for one."""
    sizes = [(1, 1)] if one_by_one else [(1, 1), (1, 2), (2, 1)]
    best, least, before = tuple(members), namer.criterion_of(members), ()
    while best != before:
        before = best
        for taken, given in sizes:
            for place in itertools.combinations(before, taken):
                rest = [m for m in before if m not in place]
                families = namer.families(place) if given + taken > 2 else set[Family]()
                for bound, others in _sets(namer, rest, given, families):
                    if bound >= least - _ROUNDING:
                        break
                    trial = (*rest, *others)
                    more = namer.fitted(trial).rss < (1.0 - _ROUNDING) * namer.fitted(best).rss
                    if more and namer.criterion_of(trial) < least - _ROUNDING and namer.possible(trial):
                        best, least = trial, namer.criterion_of(trial)
    return best


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
    for _, others in _sets(namer, rest, 3 - len(place), namer.families(place)):
        worse = namer.criterion_of((*others, *rest)) - criterion
        parts = itertools.combinations(others, len(others) - 1)
        if worse > tied or not namer.possible((*others, *rest)):
            continue
        if len(others) == 1 or all(
            namer.criterion_of((*part, *rest)) - criterion > namer.rules.confident for part in parts
        ):
            exchanges.append(Exchanged(place, others, worse))
    return sorted(exchanges, key=lambda exchange: exchange.worse)[:_MOST]


def _sets(namer: Namer, rest: Sequence[int], size: int, families: set[Family]) -> list[tuple[float, tuple[int, ...]]]:
    """The one or two groups of the library, none of these families nor of the rest's, that explain most for what they
    cost beside the rest, best first, each with the criterion of usual sizes, which is the least it can be; of each
    family the variant that does alone."""
    pool, products = namer.pool, namer.prepared.products.beside(namer.pool.columns(rest))
    barred = families | namer.families(rest)
    gains = products.gains()
    worth = namer.criterion.of_many(products.rss, gains, namer.criterion.price, pool.ranks)
    best: dict[Family, int] = {}
    for number in np.argsort(worth, kind="stable").tolist():
        family = pool.groups[number].candidate.family
        if namer.library[number] and family not in barred:
            best.setdefault(family, number)

    def bounded(others: tuple[int, ...], gained: float) -> tuple[float, tuple[int, ...]]:
        return namer.criterion(products.rss - gained, (*rest, *others)), others

    if size == 1:
        return [bounded((number,), float(gains[number])) for number in list(best.values())[:_LOOKED_AT]]
    if len(best) < size:
        return []
    among = np.array(sorted(best.values(), key=lambda number: int(pool.ranks[number])), dtype=np.int64)
    at, price, ranks = pool.columns(among.tolist()), namer.criterion.price[among], pool.ranks[among]
    gram = pool.rows(at)[:, at] - products.taken[at] @ products.taken[at].T
    gained = Blocks(gram, products.against[at], ranks).orthonormal().of_two()
    value = namer.criterion.of_many(products.rss, gained, price[:, None] + price, ranks[:, None] + ranks)
    first, second = np.triu_indices(len(among), 1)
    order = np.argsort(value[first, second], kind="stable")[:_LOOKED_AT]
    pairs = [(int(first[k]), int(second[k])) for k in order.tolist()]
    return [bounded((int(among[i]), int(among[j])), float(gained[i, j])) for i, j in pairs]
