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

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.fit import fit
from linkwright.core.diagnose.fitting.prepare import Patterns, Prepared, exchange, packed_up
from linkwright.core.diagnose.fitting.shared_masses import factors
from linkwright.core.diagnose.patterns.flexibility import entry, flexible, through_flexibility
from linkwright.core.diagnose.patterns.forces import forces
from linkwright.core.diagnose.patterns.library import Candidate, candidates
from linkwright.core.diagnose.patterns.unknown_weights import product_entry, weight_entries, weights_of
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.sections.numeric import Array

from .aliases import renamed
from .naming import Named, Namer, name_missing
from .subsets import Subset

_ROUNDS = 4
"""Of search and softening, until flexibility found is what was assumed."""


def softened(prepared: Prepared, entries: Sequence[EffectEntry], without: frozenset[str] = frozenset()) -> Prepared:
    """The same recording, loads acting through these entries of flexibility beyond the arm file's; what came in where
    that changes none of their patterns.

    `without` takes effects out by id.
    """
    observed = prepared.observed.softened(entries)
    held = list(zip(prepared.pool.groups, prepared.columns.parts, strict=True))
    others = frozenset(effect.id for effect in EFFECTS.values() if not effect.link.through_flexibility)
    loads = [*packed_up(candidates(observed, without | others)), *packed_up(forces(observed))]
    before = [(group.candidate, columns) for group, columns in held if through_flexibility(group.candidate)]
    if not _differ(before, loads, observed.rules.search.coupling_matters):
        return prepared
    numbers = [number for number, (group, _) in enumerate(held) if not through_flexibility(group.candidate)]
    again = exchange(prepared, observed, numbers, loads)
    invisible = [candidate for candidate in prepared.pool.invisible if not through_flexibility(candidate)]
    pool = again.pool.on_this_basis(again.pool.groups, (*invisible, *again.pool.invisible))
    return replace(again, pool=pool)


def may_couple(namer: Namer, named: Named) -> bool:
    """Whether loads may act through flexibility that nobody knows of: one of both is named, by the names that go first
    in their class, or something is left."""
    candidates_named = (namer.pool.groups[member].candidate for member in renamed(namer, named))
    acts = any(flexible(item) or through_flexibility(item) for item in candidates_named)
    left = named.left is None or min(test.p_value for test in named.left) <= namer.rules.false_alarm
    return bool(named.members) and (acts or left or bool(named.outside))


def coupled(namer: Namer, without: frozenset[str], tell: Callable[[float], None]) -> Namer:
    """The namer whose loads act through the flexibility that it finds, of all beginnings the one that explains best.

    The same namer where nothing found is coupled. `tell` hears the share of the work done.
    """
    best = namer.best_of_library()
    chosen = min(best.values(), key=lambda subset: subset.criterion)
    if len(chosen.members) < 2:
        return namer
    namer_, value = namer, chosen.criterion
    long = namer.prepared.observed.rows > namer.rules.long
    starts = list(itertools.islice(_starts(namer, best), 1 if long else None))
    for number, start in enumerate(starts):
        trial, criterion = _consistent(namer, start, without, 1 if long else _ROUNDS)
        if criterion < value:
            namer_, value = trial, criterion
        tell((number + 1.0) / len(starts))
    return namer_


def through_what_is_named(
    namer: Namer, named: Named, without: frozenset[str], tell: Callable[[float], None]
) -> tuple[Namer, Named]:
    """The search made again until loads that are named act through no flexibility but the arm file's and what is named
    beside them; through the arm file's alone where that does not settle.

    A load that needs what is not there to act through would move nothing in the corrected arm. `tell` hears the share
    of the work done.
    """
    for number in range(_ROUNDS + 1):
        assumed = namer.prepared.observed.softening
        if not assumed or not _loads(namer, named.members):
            break
        names = renamed(namer, named)
        entries = _entries(namer, names)
        if not _loads(namer, names) or _places(assumed) <= _places(entries):
            break
        settled = number == _ROUNDS
        prepared = softened(namer.prepared, () if settled else entries, without)
        if prepared is namer.prepared:
            break
        before = [namer.pool.groups[member].candidate for member in named.members]
        namer = namer.with_prepared(prepared)
        named = name_missing(namer, tell, before)
    return namer, named


def _loads(namer: Namer, members: Sequence[int]) -> bool:
    return any(through_flexibility(namer.pool.groups[member].candidate) for member in members)


def _places(entries: Sequence[EffectEntry]) -> set[tuple[str, tuple[int, ...]]]:
    return {(item.effect, item.at) for item in entries}


def _starts(namer: Namer, best: dict[int, Subset]) -> Iterator[tuple[EffectEntry, ...]]:
    """Flexibility to begin with: that of the best subset of each size, of any physics and of flexibility and loads."""
    seen: set[tuple[tuple[str, tuple[int, ...]], ...]] = set()
    order = sorted(best.values(), key=lambda subset: subset.criterion)
    for subset in itertools.chain(order, _best_among(namer)):
        entries = _entries(namer, subset.members)
        key = tuple(sorted((item.effect, item.at) for item in entries))
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
    entries: list[EffectEntry] = []
    products: list[tuple[Candidate, Array]] = []
    for member, sizes in zip(members, fitted.sizes, strict=True):
        candidate, values = namer.pool.groups[member].candidate, sizes.tolist()
        if flexible(candidate) and len(values) != len(candidate.sizes):
            products.append((candidate, sizes[:-1]))
            continue
        one = entry(candidate, candidate.from_slopes(values))
        if one is not None:
            entries.append(one)
    return (*entries, *_under_weights(namer.prepared.observed, products))


def _under_weights(observed: Observed, products: Sequence[tuple[Candidate, Array]]) -> tuple[EffectEntry, ...]:
    """What gives under unknown weights, as fitted one by one, with the one set of weights that comes nearest to all."""
    weights_here = [weights_of(observed, candidate.effect, candidate.at) for candidate, _ in products]
    weights = sorted({weight for item in weights_here for weight in item})
    if not products or not weights:
        return tuple(product_entry(item.effect, item.numbers, float(sizes[0])) for item, sizes in products)
    stacked = np.zeros((len(products), len(weights)))
    for row, of, (_, sizes) in zip(stacked, weights_here, products, strict=True):
        row[[weights.index(weight) for weight in of]] = sizes
    shared = factors(stacked)
    giving = [
        product_entry(item.effect, item.numbers, product)
        for (item, _), product in zip(products, shared.compliance.tolist(), strict=True)
        if product > 0.0
    ]
    return (*weight_entries(weights, shared.weight.tolist()), *giving)


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
        if not again or _close(entries, again, namer.rules.coupling_matters):
            break
        entries = again
    return trial, value


def _differ(before: Patterns, after: Patterns, matters: float) -> bool:
    """Whether patterns are others than before, by more than matters, or some are gone: nothing gives under them."""
    if {candidate.family for candidate, _ in before} - {candidate.family for candidate, _ in after}:
        return True
    known = {candidate.variant: columns for candidate, columns in before}
    for candidate, columns in after:
        was = known.get(candidate.variant)
        if was is None or was.shape != columns.shape:
            return True
        if np.linalg.norm(columns.whole() - was.whole()) > matters * np.linalg.norm(was.values):
            return True
    return False


def _close(entries: Sequence[EffectEntry], others: Sequence[EffectEntry], same: float) -> bool:
    have = {(item.effect, item.at): item.parameters for item in entries}
    if set(have) != _places(others):
        return False
    pairs = [
        (have[item.effect, item.at].get(name, 0.0), value) for item in others for name, value in item.parameters.items()
    ]
    return all(abs(a - b) <= same * max(abs(a), abs(b)) for a, b in pairs)
