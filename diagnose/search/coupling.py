"""Loads that the model does not know of act through flexibility that it does not know of either.

A payload heavier than declared bends the arm by what gives in it, an extra compliance that was found included: the two
multiply. So the patterns of such loads are worked out anew with the flexibility found so far in the arm, and the search
is made again, until what it finds is what it assumed. Several beginnings are tried, since a wrong flexibility may have
been found just because the loads' patterns were wrong.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from arm.chain import EffectEntry
from arm.effects import EFFECTS

from .candidates import candidates
from .fit import fit
from .flexibility import LOADS, entry, flexible, through_flexibility
from .forces import forces
from .naming import Namer
from .prepare import Patterns, Prepared, set_up
from .search import Subset

_ROUNDS = 4
_SAME = 0.01
"""Flexibility that has changed by no more than this share is what was assumed."""
_MATTERS = 0.02
"""Loads whose patterns a flexibility changes by less than this share need no second look."""
_SHORT = 2000
"""Readings up to which several beginnings are tried."""


def softened(prepared: Prepared, entries: Sequence[EffectEntry], without: frozenset[str] = frozenset()) -> Prepared:
    """The same recording, loads acting through these entries of flexibility beyond the arm file's; what came in where
    that changes none of their patterns.

    `without` takes effects out by id.
    """
    observed = prepared.observed.softened(entries)
    held = list(zip(prepared.pool.groups, prepared.columns, strict=True))
    loads = [*candidates(observed, without | (frozenset(EFFECTS) - LOADS)), *forces(observed)]
    before = [(group.candidate, columns) for group, columns in held if through_flexibility(group.candidate)]
    if not _differ(before, loads):
        return prepared
    kept = [(group.candidate, columns) for group, columns in held if not through_flexibility(group.candidate)]
    again = set_up(observed, [*kept, *loads], prepared.rejected)
    invisible = [candidate for candidate in prepared.pool.invisible if not through_flexibility(candidate)]
    pool = replace(again.pool, invisible=(*invisible, *again.pool.invisible))
    return replace(again, pool=pool, independent=prepared.independent)


def coupled(namer: Namer, without: frozenset[str], tell: Callable[[float], None]) -> Namer:
    """The namer whose loads act through the flexibility that it finds, of all beginnings the one that explains best.

    The same namer where nothing found is coupled. `tell` hears the share of the work done.
    """
    best = namer.best_of_library()
    chosen = min(best.values(), key=lambda subset: subset.criterion)
    if len(chosen.members) < 2:
        return namer
    found, value = namer, chosen.criterion
    long = namer.prepared.observed.rows > _SHORT
    starts = list(itertools.islice(_starts(namer, best), 1 if long else None))
    for number, start in enumerate(starts):
        trial, criterion = _consistent(namer, start, without, 1 if long else _ROUNDS)
        if criterion < value:
            found, value = trial, criterion
        tell((number + 1.0) / len(starts))
    return found


def _starts(namer: Namer, best: dict[int, Subset]) -> Iterator[tuple[EffectEntry, ...]]:
    """Flexibility to begin with: that of the best subset of each size, of any physics and of flexibility and loads."""
    seen: set[tuple[tuple[str, tuple[int, ...]], ...]] = set()
    order = sorted(best.values(), key=lambda subset: subset.criterion)
    for subset in itertools.chain(order, _best_among(namer)):
        entries = _entries(namer, subset.members)
        key = tuple(sorted((each.effect, each.at) for each in entries))
        if entries and key not in seen:
            seen.add(key)
            yield entries


def _best_among(namer: Namer) -> Iterator[Subset]:
    """The best subsets of flexibility and loads alone."""
    among = np.array([flexible(g.candidate) or through_flexibility(g.candidate) for g in namer.pool.groups], dtype=bool)
    yield from namer.best(among & namer.library, 3).values()


def _entries(namer: Namer, members: Sequence[int]) -> tuple[EffectEntry, ...]:
    """The flexibility among some groups, as fitted."""
    fitted = fit(namer.prepared, members)
    found: list[EffectEntry] = []
    for member, sizes in zip(members, fitted.sizes, strict=True):
        candidate, values = namer.pool.groups[member].candidate, sizes.tolist()
        if candidate.effect == "link_modulus":
            # The pattern is that of a small excess x, and what the link gives goes with 1/(1 + x).
            values = [1.0 / (1.0 - value) - 1.0 if value < 1.0 else np.inf for value in values]
        one = entry(candidate, values)
        if one is not None:
            found.append(one)
    return tuple(found)


def _consistent(
    namer: Namer, entries: tuple[EffectEntry, ...], without: frozenset[str], rounds: int
) -> tuple[Namer, float]:
    """Search and soften in turn until the flexibility found is that assumed; the namer and its best criterion."""
    trial, value = namer, np.inf
    for _ in range(rounds):
        prepared = softened(namer.prepared, entries, without)
        if prepared is namer.prepared:
            break
        trial = namer.with_prepared(prepared)
        best = min(trial.best_of_library().values(), key=lambda subset: subset.criterion)
        value = best.criterion
        again = _entries(trial, best.members)
        if not again or _close(entries, again):
            break
        entries = again
    return trial, value


def _differ(before: Patterns, after: Patterns) -> bool:
    """Whether patterns are others than before, by more than matters."""
    own = {(candidate.family, tuple(candidate.shapes.items())): columns for candidate, columns in before}
    for candidate, columns in after:
        was = own.get((candidate.family, tuple(candidate.shapes.items())))
        if was is None or was.shape != columns.shape or np.linalg.norm(columns - was) > _MATTERS * np.linalg.norm(was):
            return True
    return False


def _close(entries: Sequence[EffectEntry], others: Sequence[EffectEntry]) -> bool:
    have = {(each.effect, each.at): each.parameters for each in entries}
    if set(have) != {(each.effect, each.at) for each in others}:
        return False
    pairs = [(have[each.effect, each.at][name], value) for each in others for name, value in each.parameters.items()]
    return all(abs(a - b) <= _SAME * max(abs(a), abs(b)) for a, b in pairs)
