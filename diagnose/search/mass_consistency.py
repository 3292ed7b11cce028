"""What gives under links that nobody has weighed, held against one set of weights.

A search fits each thing that gives with weights of its own. So a base that could give by anything about both of its
axes, balanced by geometry, may seem to tell as much as the drive that does give, and names that fit alike beside such
weights need not do so under the one set that all share. What moves the tip by more than the whole mismatch can only
balance others: the search is made again without it, and it stays where the joint fit is far worse then.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.fit import beyond_nuisances, fit, remaining
from linkwright.core.diagnose.fitting.prepare import exchange
from linkwright.core.diagnose.fitting.refit import Refit, refit
from linkwright.core.diagnose.patterns.unknown_weights import only_products
from linkwright.core.diagnose.residual.observed import rms_length

from .aliases import renamed, stands
from .large_motions import candidates_of
from .naming import Named, Namer, name_missing

_SEARCHES = 2
"""Made again without what only balances others, at most."""


def under_one_set(namer: Namer, named: Named, tell: Callable[[float], None]) -> Named:
    """What was named, or what is named without what can only balance the rest where that is no worse under one set of
    weights.

    `tell` hears the share of the work done.
    """
    for number in range(_SEARCHES):
        refit = _joint(namer, named.members, named.outside)
        place = None if refit is None else _balanced(namer, refit)
        if refit is None or place is None:
            break
        other = _without(namer, named, place, tell)
        if other is None:
            break
        again = _fitted(namer, other.members, other.outside)
        before, after = _criterion(namer, refit, named.everything), _criterion(namer, again, other.everything)
        if after > before + namer.rules.refuted:
            break
        named = other
        tell((number + 1.0) / _SEARCHES)
    return named


def renamed_under_one_set(namer: Namer, named: Named) -> tuple[int, ...]:
    """The members of what was named under the names that go first, where they fit as well under one set of weights."""
    names, members = renamed(namer, named), named.members
    refit = _joint(namer, members, named.outside) if names != members else None
    if refit is None:
        return names
    value = _criterion(namer, refit, named.everything)
    for place, name in enumerate(names):
        if name == members[place]:
            continue
        trial = (*members[:place], name, *members[place + 1 :])
        other = _joint(namer, trial, named.outside)
        if other is None:
            continue
        reached = _criterion(namer, other, (*trial, *named.outside))
        accused = stands(namer, members[place]) and not stands(namer, name)
        if reached <= value + (namer.rules.refuted if accused else namer.rules.confident):
            members, value = trial, reached
    return members


def _joint(namer: Namer, members: tuple[int, ...], outside: tuple[int, ...]) -> Refit | None:
    """The joint fit of some groups; None where none of them gives under weights that are shared."""
    observed = namer.prepared.observed
    candidates = [candidate for candidate in candidates_of(namer, members) if not candidate.share]
    if not any(only_products(observed, EFFECTS[candidate.effect], candidate.at) for candidate in candidates):
        return None
    return _fitted(namer, members, outside)


def _fitted(namer: Namer, members: tuple[int, ...], outside: tuple[int, ...]) -> Refit:
    return refit(namer.prepared, members, outside, fit(namer.prepared, (*members, *outside)))


def _criterion(namer: Namer, refit: Refit, members: tuple[int, ...]) -> float:
    """The criterion of a joint fit: what gives under weights that others share has but one coefficient of its own."""
    further = max(sum(term.shared for term in refit.terms) - 1, 0)
    return namer.criterion(refit.rss, members) - further * math.log(namer.criterion.count)


def _balanced(namer: Namer, refit: Refit) -> int | None:
    """The place of what gives under unknown weights and moves the tip most, where that is by more than the whole
    mismatch; None where it is not."""
    width = namer.prepared.observed.components

    def moved(place: int) -> float:
        return rms_length(beyond_nuisances(namer.prepared, refit.terms[place].moved)[:, :width])

    most = max((place for place, term in enumerate(refit.terms) if term.shared), key=moved, default=None)
    mismatch = rms_length(remaining(namer.prepared, fit(namer.prepared, ()))[:, :width])
    return most if most is not None and moved(most) > namer.rules.balanced * mismatch else None


def _without(namer: Namer, named: Named, place: int, tell: Callable[[float], None]) -> Named | None:
    """What is named without one of the findings among the candidates; None where forms are, or nothing is."""
    pool, gone = namer.pool, namer.pool.groups[named.members[place]].candidate.family
    numbers = [number for number, group in enumerate(pool.groups) if group.candidate.family != gone]
    other = namer.with_prepared(exchange(namer.prepared, namer.prepared.observed, numbers, []))
    before = [candidate for candidate in candidates_of(namer, named.members) if candidate.family != gone]
    again = name_missing(other, tell, before)
    members = namer.numbers_of(candidates_of(other, again.members))
    if again.outside or not again.members or len(members) != len(again.members):
        return None
    return replace(again, members=members, gate=named.gate, left=namer.test(members))
