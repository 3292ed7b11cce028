"""Which physics is missing: gate, exhaustive search, a test of every finding, and what cannot be distinguished from
it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.fitting.fit import Fit, fit, impossible, unlikely
from linkwright.core.diagnose.fitting.prepare import Prepared, limits
from linkwright.core.diagnose.fitting.refit import refined_shapes
from linkwright.core.diagnose.fitting.room.small_causes import with_room
from linkwright.core.diagnose.patterns.forces import fitted_pull
from linkwright.core.diagnose.patterns.library import Candidate, Family, columns_of
from linkwright.core.diagnose.patterns.pool import Pool, with_group
from linkwright.core.diagnose.rules.search_rules import SearchRules
from linkwright.core.sections.numeric import Array

from .calibrate import FEW_DRAWS, Calibrated, Draws, each_given_others, one_more
from .exchanges import ROUNDING, better
from .geometry import beats, geometry_alone
from .subsets import Subset, best_subsets

_THOROUGH_DRAWS = 2999
"""Of each test where a thorough search was asked for, and at most of one that only decides: few are near the level."""


Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Named:
    """What was found: groups of the library (`members`) and forms (`outside`), the p-value of each member's test,
    the gate's two tests (library, forms), and the test of what is left. `without_forms` are the groups of the library
    that fit best where no form stands beside them or in their place: what a file can hold."""

    members: tuple[int, ...]
    outside: tuple[int, ...]
    p_values: tuple[float, ...]
    gate: tuple[Calibrated, Calibrated]
    left: tuple[Calibrated, Calibrated] | None
    without_forms: tuple[int, ...] = ()

    @property
    def everything(self) -> tuple[int, ...]:
        """All groups of the model."""
        return (*self.members, *self.outside)


class Namer:
    """Searches one prepared recording; holds the tests' random draws."""

    def __init__(self, prepared: Prepared, *, thorough: bool, seed: int) -> None:
        self.prepared = prepared
        self.rules: SearchRules = prepared.observed.rules.search
        self.draws = _THOROUGH_DRAWS if thorough else self.rules.draws
        self.seed, self.rng = seed, np.random.default_rng(seed)
        self.visits = prepared.visits
        self.library: Mask = prepared.library()
        self.criterion = prepared.criterion
        self._best_of_library: dict[int, Subset] | None = None
        self._fits: dict[tuple[int, ...], Fit] = {}
        self.exchanges: dict[tuple[frozenset[int], bool], tuple[tuple[int, ...], tuple[float, ...]] | None] = {}

    def with_prepared(self, prepared: Prepared) -> Namer:
        """A namer that searches the same recording prepared otherwise, with the same draws to come."""
        other = copy(self)
        other.prepared, other._best_of_library, other._fits, other.exchanges = prepared, None, {}, {}
        other.visits, other.library, other.criterion = prepared.visits, prepared.library(), prepared.criterion
        return other

    def with_room(self, members: Sequence[int], *, least: float = 0.0) -> Namer:
        """A namer that judges with room for causes too small to be named beside some groups, where what these leave
        speaks for such causes, or for causes of `least` times the noise's RMS anyhow."""
        prepared = with_room(self.prepared, members, least=least)
        return self if prepared is self.prepared else self.with_prepared(prepared)

    def refined(self, members: Sequence[int]) -> tuple[int, ...]:
        """The groups with their shapes moved off the grid to where they fit best; new groups where that helps.

        A lag or a knee between two points of the grid leaves a remainder that something else would be named for.
        """
        fitted = fit(self.prepared, members)
        numbers: list[int] = []
        for member, candidate in zip(members, refined_shapes(self.prepared, members, fitted), strict=True):
            columns = None if candidate is None else columns_of(self.prepared.observed, candidate)
            taken = None if candidate is None or columns is None else self._take_in(candidate, columns)
            numbers.append(member if taken is None else taken)
        better = self.criterion_of(numbers) < self.criterion_of(members) and self.possible(numbers)
        return tuple(numbers) if better else tuple(members)

    def numbers_of(self, candidates: Sequence[Candidate]) -> tuple[int, ...]:
        """The groups of the library that are these candidates, in their order; new ones where a shape was moved off
        the grid. What is no group here is left out, a family's second too."""
        known = {g.candidate.variant: number for number, g in enumerate(self.pool.groups) if self.library[number]}
        families = {family for family, *_ in known}
        numbers: dict[object, int] = {}
        for candidate in candidates:
            number = known.get(candidate.variant)
            if number is None and candidate.family in families:
                columns = columns_of(self.prepared.observed, candidate)
                number = None if columns is None else self._take_in(candidate, columns)
            if number is not None:
                numbers.setdefault(candidate.family, number)
        return tuple(numbers.values())

    def seek_pull(self, members: Sequence[int]) -> None:
        """Take in the pull towards a point that explains most beside some groups, wherever that is: on a coarse grid a
        magnet between two points is several small errors of the joints."""
        pull = fitted_pull(self.prepared.observed, self.pool, self.prepared.vector, members)
        if pull is not None:
            self._take_in(*pull)

    def _take_in(self, candidate: Candidate, columns: Array) -> int | None:
        """The number of a new group of these columns (N, C, d); None where nothing is seen of it."""
        white = self.prepared.observed.whitened(columns)
        fitting = self.prepared.observed.rules.fitting
        pool = with_group(self.pool, candidate, white, limits(candidate, columns, rules=fitting))
        if len(pool.groups) == len(self.pool.groups):
            return None
        self.prepared = replace(self.prepared, pool=pool, columns=self.prepared.columns.and_one(columns))
        self.library, self.criterion = self.prepared.library(), self.prepared.criterion
        self._fits, self.exchanges = {}, {}
        return len(pool.groups) - 1

    @property
    def pool(self) -> Pool:
        """The candidates."""
        return self.prepared.pool

    def families(self, members: Sequence[int]) -> set[Family]:
        """What these groups are variants of."""
        return {self.pool.groups[member].candidate.family for member in members}

    def test(self, members: Sequence[int], draws: int | None = None) -> tuple[Calibrated, Calibrated]:
        """Whether the library, and whether a form, explains more of what some groups leave than chance would."""
        how = replace(self._draws(), draws=draws or self.draws)
        of_library, of_forms = self._test(members, (self.library, ~self.library), how)
        return of_library, of_forms

    def test_of_library(self, members: Sequence[int], draws: int) -> Calibrated:
        """Whether the library does, by so many draws at most."""
        return self._test(members, (self.library,), replace(self._decisive(), draws=draws))[0]

    def test_of_forms(self, members: Sequence[int]) -> Calibrated:
        """Whether a form does."""
        return self._test(members, (~self.library,), self._decisive())[0]

    def tests_given_others(
        self, members: Sequence[int], others: Sequence[int] = (), level: float | None = None
    ) -> Iterator[tuple[int, float]]:
        """The place and the p-value of each group given all the others (and `others`), the weakest first: how often
        chance lets the best of the library explain as much as it does. It decides at a level, by default that of all
        tests."""
        how = replace(self._decisive(), level=self.rules.false_alarm if level is None else level)
        products, vector = self.prepared.products, self.prepared.vector
        return each_given_others(products, vector, members, others, self.criterion, how, self.library)

    def _draws(self) -> Draws:
        return Draws(self.visits, self.prepared.observed.residual.shape[1], self.draws, self.rng)

    def _decisive(self) -> Draws:
        return replace(self._draws(), draws=_THOROUGH_DRAWS, level=self.rules.false_alarm)

    def _test(self, members: Sequence[int], among: Sequence[Mask], how: Draws) -> list[Calibrated]:
        return one_more(self.prepared.products, self.prepared.vector, members, self.criterion, how, among)

    def possible(self, members: Sequence[int]) -> bool:
        """Whether the groups' fitted sizes are physically possible."""
        return not any(self.library[m] for m in members) or impossible(self.prepared, self.fitted(members)) is None

    def fitted(self, members: Sequence[int]) -> Fit:
        """Least squares of some groups, once for the criterion and for what is possible."""
        key = tuple(members)
        if key not in self._fits:
            self._fits[key] = fit(self.prepared, key)
        return self._fits[key]

    def best(self, allowed: Mask, largest: int) -> dict[int, Subset]:
        """The best possible subset of each size."""
        subsets_by_size = best_subsets(
            self.pool, self.prepared.vector, self.criterion, largest=largest, allowed=lambda m: bool(allowed[m])
        )
        taken: dict[int, Subset] = {}
        for size, subsets in subsets_by_size.items():
            for subset in subsets:
                if size in taken and subset.criterion >= taken[size].criterion:
                    break
                value = self.criterion_of(subset.members)
                if (size not in taken or value < taken[size].criterion) and self.possible(subset.members):
                    taken[size] = replace(subset, criterion=value)
        return taken

    def best_of_library(self) -> dict[int, Subset]:
        """The library's best possible subset of each size up to three."""
        if self._best_of_library is None:
            self._best_of_library = self.best(self.library, 3)
        return self._best_of_library

    def criterion_of(self, members: Sequence[int]) -> float:
        """The criterion of a subset, by how usual its sizes are too."""
        fitted = self.fitted(members)
        return self.criterion(fitted.rss, members) + unlikely(self.prepared, fitted)


def name_missing(
    namer: Namer,
    tell: Callable[[float], None],
    before: Sequence[Candidate] = (),
    accepted: Callable[[Namer, Sequence[int]], None] | None = None,
    *,
    few: bool = False,
) -> Named:
    """Gate, name and test; `tell` hears the share of the work done, `accepted` of the first groups that pass their
    tests, long before it is known whether they are the answer.

    `before` is what an earlier search of the same recording named, about something else: with many findings the search
    goes on from those, and is made anew only where they do not hold or the library's best few are better; where they
    are `few` too, when rows came back that fit them in shapes between those of the grid.
    """
    # What is drawn to one point may hide between the points of a grid: it is sought before anything is tested.
    namer.seek_pull(())
    gate = namer.test(())
    tell(0.2)
    if min(gate[0].p_value, gate[1].p_value) > namer.rules.false_alarm:
        gate = (replace(gate[0], p_value=min(gate[0].p_value, _two_at_once(namer))), gate[1])
    if min(gate[0].p_value, gate[1].p_value) > namer.rules.false_alarm:
        return Named((), (), (), gate, None)
    members, p_values = _of_library(namer)
    if accepted is not None:
        accepted(namer, members)
    tell(0.6)
    further, p_of_further = _on_from(namer, before, few=few)
    if further and namer.criterion_of(further) < namer.criterion_of(members) + ROUNDING:
        members, p_values = further, p_of_further
    else:
        members, p_values = _anew(namer, members, p_values, tell)
    without_forms = members
    members, outside, p_values = _against_forms(namer, members, p_values)
    left = namer.test((*members, *outside))
    tell(1.0)
    return Named(members, outside, p_values, gate, left, without_forms)


def _anew(
    namer: Namer, members: tuple[int, ...], p_values: tuple[float, ...], tell: Callable[[float], None]
) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """More findings beside the library's best answer of a few, or beside geometry alone: the better end counts."""
    members, p_values = _carried_on(namer, members, p_values) if members else (members, p_values)
    tell(0.8)
    geometry, p_of_geometry = _sound(namer, geometry_alone(namer))
    if not geometry:
        return members, p_values
    further, p_of_further = _carried_on(namer, geometry, p_of_geometry)
    enough = set(further) <= set(geometry)
    worse = beats(namer, members, further) if enough else namer.criterion_of(further) >= namer.criterion_of(members)
    return (members, p_values) if members and worse else (further, p_of_further)


def _on_from(namer: Namer, before: Sequence[Candidate], *, few: bool) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """What holds of what an earlier search named, exchanged and carried on, where that is much or `few` count too;
    nothing where it is not possible here."""
    again = namer.numbers_of(before) if few or len(before) > 3 else ()
    if not again or (len(again) <= 3 and not few) or not namer.possible(again):
        return (), ()
    again, p_values = _sound(namer, better(namer, again, one_by_one=True))
    return _carried_on(namer, again, p_values) if again else ((), ())


def _two_at_once(namer: Namer) -> float:
    """The p-value of the best two of the library where a mismatch is far above the noise, though none alone shows it:
    that of the less sure of both beside the other, times the number of candidates that the other was chosen among
    (Bonferroni). One where the mismatch is no more than noise may be."""
    vector = namer.prepared.vector
    loud = float(vector @ vector) > namer.prepared.observed.rules.fitting.far_above**2 * len(vector)
    pair = namer.best_of_library().get(2) if loud else None
    if pair is None:
        return 1.0
    among = int(namer.library.sum())
    tested = namer.tests_given_others(pair.members, level=namer.rules.false_alarm / among)
    return min(1.0, among * max(p for _, p in tested))


def _of_library(namer: Namer) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """The library's best answer of up to three, every part of which passes its test."""
    subsets = namer.best_of_library()
    members = [namer.refined(subset.members) for subset in subsets.values()]
    smallest = 99
    for chosen in sorted(members, key=namer.criterion_of):
        if len(chosen) >= smallest:
            continue
        smallest = len(chosen)
        failing, p_values = _tests_given_others(namer, chosen)
        if failing is None:
            return chosen, p_values
    return (), ()


def _carried_on(
    namer: Namer, members: tuple[int, ...], p_values: tuple[float, ...]
) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """More findings one by one, each chosen anew among all, as long as each passes its test and is worth it; and sets
    in the place of others while these are better."""
    while True:
        tested = namer.test_of_library(members, FEW_DRAWS)
        more = _best_addition(namer, members, tested) if tested.p_value <= namer.rules.false_alarm else members
        if len(more) > len(members):
            added, p_of_added = _exchanged(namer, more, (*p_values, tested.p_value), one_by_one=True)
            if _worth_it(namer, members, added):
                members, p_values = added, p_of_added
                continue
        other, p_of_others = _exchanged(namer, members, p_values)
        if other == members:
            break
        members, p_values = other, p_of_others
    return _pruned(namer, members, p_values) if len(members) > 3 else (members, p_values)


def _exchanged(
    namer: Namer, members: tuple[int, ...], p_values: tuple[float, ...], *, one_by_one: bool = False
) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Of a better set those that pass their tests beside each other, if they are better still; else the members.
    Ways that begin elsewhere come by the same sets: of each that is found out once."""
    key = (frozenset(members), one_by_one)
    if key not in namer.exchanges:
        other = better(namer, members, one_by_one=one_by_one)
        sound = _sound(namer, other) if other != members else None
        kept = sound is not None and namer.criterion_of(sound[0]) < namer.criterion_of(members)
        namer.exchanges[key] = sound if kept else None
    return namer.exchanges[key] or (members, p_values)


def _worth_it(namer: Namer, fewer: Sequence[int], more: Sequence[int]) -> bool:
    """Whether one more finding is worth it: by the criterion, and by the share of what is left that it takes off."""
    if namer.criterion_of(more) >= namer.criterion_of(fewer):
        return False
    worth = worth_of_one_more(namer.rules, namer.criterion.count)
    return namer.fitted(more).rss <= (1.0 - worth) * namer.fitted(fewer).rss


def _pruned(
    namer: Namer, members: tuple[int, ...], p_values: tuple[float, ...]
) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """The members without those that later ones have made superfluous: what stays is held to what was added."""
    while len(members) > 1:
        without = [[m for m in members if m != member] for member in members]
        least = min(range(len(members)), key=lambda place: namer.criterion_of(without[place]))
        if _worth_it(namer, without[least], members):
            break
        members = tuple(without[least])
        p_values = tuple(p for k, p in enumerate(p_values) if k != least)
    return members, p_values


def _best_addition(namer: Namer, members: tuple[int, ...], tested: Calibrated) -> tuple[int, ...]:
    """The members and the best group beside them that is possible with them."""
    taken = namer.families(members)
    for number in np.argsort(-tested.each)[:40].tolist():
        if not namer.library[number] or namer.pool.groups[number].candidate.family in taken:
            continue
        wider = (*members, int(number))
        if namer.possible(wider):
            return wider
    return members


def weighed_again(namer: Namer, named: Named, members: tuple[int, ...], p_values: tuple[float, ...]) -> Named:
    """What is named where only some members are left, as readings held out have refuted the rest: a form may be the
    better answer than those are, by the same margin as before, or stand beside them."""
    members, outside, p_values = _against_forms(namer, members, p_values)
    left = namer.test((*members, *outside))
    return replace(named, members=members, outside=outside, p_values=p_values, left=left)


def _against_forms(
    namer: Namer, members: tuple[int, ...], p_values: tuple[float, ...]
) -> tuple[tuple[int, ...], tuple[int, ...], tuple[float, ...]]:
    """Whether something outside the library is at work, instead of what was named or beside it."""
    if members:
        namer.seek_pull(members)
    everything = np.ones(len(namer.library), dtype=bool)
    rivals = [s for s in namer.best(everything, 2).values() if any(not namer.library[m] for m in s.members)]
    best = min(rivals, key=lambda subset: subset.criterion, default=None)
    # What small causes of the library do beside one or two names, forms describe as well, and are no better for it.
    few = 0 < len(members) <= namer.rules.sparing
    judged = namer.with_room(members) if few else namer
    criterion = judged.criterion_of(members)
    if (
        best is not None
        and judged.criterion_of(best.members) < criterion - margin_of_forms(namer.rules, len(members))
        and not (few and _near_enough(namer, members, best))
    ):
        outside = tuple(m for m in best.members if not namer.library[m])
        inside = tuple(m for m in best.members if namer.library[m])
        if namer.test_of_forms(inside).p_value <= namer.rules.false_alarm:
            return _still_there(namer, inside, outside)
    form = _form_beside(namer, judged, members, criterion)
    return (members, (), p_values) if form is None else _still_there(namer, members, (form,))


def _form_beside(namer: Namer, judged: Namer, members: Sequence[int], criterion: float) -> int | None:
    """A form that is worth it beside the members, whose criterion is given; None where none is."""
    tested = namer.test_of_forms(members)
    if tested.p_value > namer.rules.false_alarm or tested.best < 0:
        return None
    wider = [*members, tested.best]
    without, beside = fit(namer.prepared, members).rss, fit(namer.prepared, wider).rss
    whole = float(namer.prepared.vector @ namer.prepared.vector)
    needed = criterion - (namer.rules.confident if members else 0.0)
    material = without - beside > namer.rules.material**2 * (whole - beside)
    return tested.best if material and judged.criterion_of(wider) < needed and namer.possible(wider) else None


def margin_of_forms(rules: SearchRules, findings: int) -> float:
    """How much better a form's criterion must be than that of so many findings before they are given up for it.

    Never less than zero, however many: what fits worse than named physics does not take its place.
    """
    return rules.margin if findings <= rules.sparing else 0.0


def worth_of_one_more(rules: SearchRules, count: int) -> float:
    """The share of what is left that one more finding beyond three must take off, by so many observations."""
    return rules.worth * min(1.0, rules.many / max(count, 1))


def _near_enough(namer: Namer, members: Sequence[int], best: Subset) -> bool:
    """Whether one or two names explain so nearly what a form does that the form is no better answer.

    What a name misses of a form, readings of one pose and those held out still judge: they refute the name as the whole
    answer, or show it to be causes too small to be named. A form in its place would say less than is known: five
    kilograms too many were `a constant force`, since the base stood a degree out of plumb besides.
    """
    whole = float(namer.prepared.vector @ namer.prepared.vector)
    missed = fit(namer.prepared, members).rss - best.rss
    return missed < namer.rules.material**2 * (whole - best.rss)


def _still_there(
    namer: Namer, members: tuple[int, ...], outside: tuple[int, ...]
) -> tuple[tuple[int, ...], tuple[int, ...], tuple[float, ...]]:
    """The members that pass their test beside a form."""
    members, p_values = _sound(namer, members, outside)
    return members, outside, p_values


def _sound(
    namer: Namer, members: tuple[int, ...], outside: tuple[int, ...] = ()
) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """The members that pass their test beside each other (and `outside`), with its p-values."""
    while members:
        failing, p_values = _tests_given_others(namer, members, outside)
        if failing is None:
            return members, p_values
        members = tuple(m for k, m in enumerate(members) if k != failing)
    return (), ()


def _tests_given_others(
    namer: Namer, members: Sequence[int], outside: Sequence[int] = ()
) -> tuple[int | None, tuple[float, ...]]:
    """The place of the weakest member that does not pass its test beside the others (and `outside`), None where
    each does; then the p-values of all, and else of those that were tested until then."""
    known: dict[int, float] = {}
    for place, p in namer.tests_given_others(members, outside):
        known[place] = p
        if p > namer.rules.false_alarm:
            return place, tuple(known.values())
    return None, tuple(known[place] for place in range(len(members)))
