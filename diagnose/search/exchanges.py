"""Sets of causes that could stand in the place of a set: two zeros for a tool's offset, one tilt for two couplings.

What cannot be distinguished from one finding need not be one cause. Beside all other findings, pairs of the library are
looked at for each finding, and single causes for each two of them, by what they explain beside the rest (`Blocks`).
What explains more, and is better by the criterion, takes their place: a name that was taken early may stand for two
that only together explain more (a bent link for two drives that give). What fits as well, and would not without one of
its parts, is reported.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .pairs import Blocks
from .subsets import Products

if TYPE_CHECKING:
    from .naming import Namer

_LOOKED_AT = 30
"""Sets, best first, whose sizes are fitted."""
_MOST = 3
"""Exchanges that are told of one set of findings."""
ROUNDING = 1e-6
"""Of a criterion, what rounding makes of two that are the same."""


@dataclass(frozen=True)
class Exchanged:
    """Groups that could stand in the place of some members, and how much worse the criterion is then."""

    members: tuple[int, ...]
    others: tuple[int, ...]
    worse: float


def better(namer: Namer, members: Sequence[int], *, one_by_one: bool = False) -> tuple[int, ...]:
    """The members after exchanges for the possible sets that make the criterion least, as long as any explains more and
    makes it less: one for one (those alone with `one_by_one`), one for two and two for one.

    What explains more than two members does so in the place of either as well, beside the other."""
    sizes = [(1, 1)] if one_by_one else [(1, 1), (1, 2), (2, 1)]
    best, least, before = tuple(members), namer.criterion_of(members), ()
    library = namer.prepared.products.of(namer.library)
    while best != before:
        before = best
        explains_more: dict[int, NDArray[np.bool_]] = {}
        for taken, given in sizes:
            some = itertools.combinations(before, taken)
            if taken == 2:
                some = (pair for pair in some if (explains_more[pair[0]] & explains_more[pair[1]]).any())
            for place, beside in _leaving(namer, library, before, [*some]):
                if taken == given == 1:
                    gains = np.where(namer.library, beside.gains(), 0.0)
                    explains_more[place[0]] = beside.rss - gains < namer.fitted(before).rss
                rest = [m for m in before if m not in place]
                for rss, others in _sets(namer, beside, (*rest, *(place if given + taken > 2 else ())), given):
                    trial = (*rest, *others)
                    if namer.criterion(rss, trial) >= least - ROUNDING:
                        break
                    more = rss < (1.0 - ROUNDING) * namer.fitted(best).rss
                    if more and namer.criterion_of(trial) < least - ROUNDING and namer.possible(trial):
                        best, least = trial, namer.criterion_of(trial)
    return best


def exchanged(namer: Namer, members: Sequence[int], outside: Sequence[int] = ()) -> tuple[Exchanged, ...]:
    """The sets that cannot be distinguished from one or two members beside the others (and forms `outside`)."""
    exchanges: list[Exchanged] = []
    for size in (1, 2):
        for place in itertools.combinations(members, size):
            rest = [*(m for m in members if m not in place), *outside]
            exchanges += _instead(namer, place, rest)
    return tuple(exchanges)


def _instead(namer: Namer, place: tuple[int, ...], rest: Sequence[int]) -> list[Exchanged]:
    criterion, tied = namer.criterion_of((*place, *rest)), namer.rules.tied
    exchanges: list[Exchanged] = []
    beside = namer.prepared.products.beside(namer.pool.columns(rest))
    for _, others in _sets(namer, beside, (*rest, *place), 3 - len(place)):
        worse = namer.criterion_of((*others, *rest)) - criterion
        parts = itertools.combinations(others, len(others) - 1)
        if worse > tied or not namer.possible((*others, *rest)):
            continue
        if len(others) == 1 or all(
            namer.criterion_of((*part, *rest)) - criterion > namer.rules.confident for part in parts
        ):
            exchanges.append(Exchanged(place, others, worse))
    return sorted(exchanges, key=lambda exchange: exchange.worse)[:_MOST]


def _leaving(
    namer: Namer, products: Products, members: Sequence[int], parts: Sequence[tuple[int, ...]]
) -> Iterator[tuple[tuple[int, ...], Products]]:
    """Some parts of the members, the last first, with the products beside the others: what is beside all is worked out
    once."""
    if not parts:
        return
    pool, edges = namer.pool, np.cumsum([0, *(namer.pool.groups[member].rank for member in members)])
    whole = products.beside(pool.columns(members))
    for left_out in reversed(parts):
        some = [members.index(member) for member in left_out]
        if whole.root.shape[0] == whole.root.shape[1]:
            yield left_out, whole.leaving(np.concatenate([np.arange(edges[k], edges[k + 1]) for k in some]))
        else:
            yield left_out, products.beside(pool.columns([m for m in members if m not in left_out]))


def _sets(namer: Namer, beside: Products, without: Sequence[int], size: int) -> Iterator[tuple[float, tuple[int, ...]]]:
    """The one or two groups of the library, no variants of those `without`, that explain most for what they cost by the
    products `beside` others, best first, each with the sum of squares that is left; of each family the variant that
    does alone."""
    pool, criterion, gains = namer.pool, namer.criterion, beside.gains()
    barred = pool.family[np.array(without, dtype=np.int64)]
    order = np.argsort(criterion.of_many(beside.rss, gains, criterion.price, pool.ranks), kind="stable")
    order = order[(namer.library & ~np.isin(pool.family, barred))[order]]
    best = order[np.sort(np.unique(pool.family[order], return_index=True)[1])]
    if size == 1:
        sets = ((gains[number], (number,)) for number in best[:_LOOKED_AT].tolist())
    elif len(best) > 1:
        among = best[np.argsort(pool.ranks[best], kind="stable")]
        at, price, ranks = pool.columns(among.tolist()), criterion.price[among], pool.ranks[among]
        gained = Blocks(beside.among(at), beside.against[beside.place(at)], ranks).orthonormal().of_two()
        value = criterion.of_many(beside.rss, gained, price[:, None] + price, ranks[:, None] + ranks)
        first, second = np.triu_indices(len(among), 1)
        pairs = np.argsort(value[first, second], kind="stable")[:_LOOKED_AT]
        places = zip(first[pairs].tolist(), second[pairs].tolist(), strict=True)
        sets = ((gained[i, j], (int(among[i]), int(among[j]))) for i, j in places)
    else:
        return
    for gain, others in sets:
        yield beside.rss - float(gain), others
