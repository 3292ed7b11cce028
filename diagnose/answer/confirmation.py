"""What was found, fitted to all readings and confirmed on those held out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.fitting.fit import Fit, beyond_nuisances, fit, remaining
from linkwright.core.diagnose.fitting.held_out import Folds, HeldOut, hardest, parts_of_workspace, splits
from linkwright.core.diagnose.fitting.joint.sizes import tether
from linkwright.core.diagnose.fitting.prepare import Prepared, packed_up, set_up
from linkwright.core.diagnose.fitting.refit import Refit, impossible_term, refit, shared_of
from linkwright.core.diagnose.fitting.relinearize import relinearized
from linkwright.core.diagnose.fitting.room.unnamed import Unnamed, unnamed
from linkwright.core.diagnose.options import Options, Progress
from linkwright.core.diagnose.patterns.library import columns_of
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.noise import NoiseFloor
from linkwright.core.diagnose.residual.observe import observed_about
from linkwright.core.diagnose.residual.observed import Observed, kept, rms_length
from linkwright.core.diagnose.result import Alike
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.diagnose.search.aliases import Rival, rivals
from linkwright.core.diagnose.search.mass_consistency import renamed_under_one_set
from linkwright.core.diagnose.search.naming import Named, Namer, weighed_again
from linkwright.core.sections.numeric import Array

from .sentences import label_of
from .together import only_with

Item = TypeVar("Item")


class Confirmed:
    """What was found in a recording: names that go first in their class, the joint fit, folds, and what is left."""

    def __init__(
        self,
        namer: Namer,
        named: Named | None,
        noise: NoiseFloor,
        options: Options,
        *,
        whole: Recording | None,
        progress: Progress,
        floors: Sequence[NoiseFloor] = (),
        alike: Alike | None = None,
        forms: bool = True,
    ) -> None:
        self.namer, self.named, self.alike_aside = namer, named, alike
        self.floors, self.whole, self.may_have_forms = floors, whole, forms
        self.noise, self.options, self.tell = noise, options, progress
        self.rules: Rules = namer.prepared.observed.rules
        self.unconfirmed: list[str] = []
        self.impossible: list[str] = []
        self.too_little: list[str] = []
        self._take_up(whole)
        while (wrong := self._wrong()) is not None:
            places, reasons, reason, unexplained = wrong
            reasons += [f"{self.label(self.members[place])}{reason}" for place in places]
            for place in sorted(places, reverse=True):
                self.named_members, self.members = _less(self.named_members, place), _less(self.members, place)
                self.alternatives, self.alike = _less(self.alternatives, place), _less(self.alike, place)
                self.p_values = _less(self.p_values, place)
            if not (unexplained and self._form_instead(whole)):
                self._fit()
        if self.members:
            # What is said of sizes leaves room for what is not named; what is kept was judged without it.
            room = self.unnamed()
            self.refit = refit(self.prepared, self.members, self.outside, self.fitted, room)
            self._test_what_is_left()
        self.together = only_with(self.prepared, self.refit, rules=self.rules.answer)

    def of_the_library(self, members: Sequence[int]) -> Confirmed:
        """Some groups of the library confirmed on the same readings, with no form beside them or in their place."""
        assert self.named is not None
        named = replace(self.named, members=tuple(members), outside=(), p_values=(math.nan,) * len(members))
        return Confirmed(
            self.namer,
            named,
            self.noise,
            self.options,
            whole=self.whole,
            progress=self.tell,
            floors=self.floors,
            alike=self.alike_aside,
            forms=False,
        )

    def _test_what_is_left(self) -> None:
        """Test anew what seems to be beyond chance in what is left, where motion beyond first order was part of it."""
        named, left = self.named, self.with_what_is_left()
        if named is None or named.left is None or left is self.search:
            return
        if min(test.p_value for test in named.left) <= self.rules.search.false_alarm:
            again = self.namer.with_prepared(left).test((*self.named_members, *self.forms))
            self.named = replace(named, left=again)

    def _take_up(self, whole: Recording | None) -> None:
        """Take up what was named under the names that go first, and fit it to what it is to be confirmed by."""
        self.search: Prepared = self.namer.prepared
        self.named_members, self.alternatives, self.alike = self._renamed()
        self.p_values = self.named.p_values if self.named is not None else ()
        self.forms: tuple[int, ...] = self.named.outside if self.named is not None else ()
        self.prepared, number = self._fitted_to(whole)
        self.members = tuple(number[m] for m in self.named_members)
        self.outside = tuple(number[m] for m in self.forms)
        self.folds: dict[str, Folds] = splits(self.prepared.observed, self.options.seed)
        self._fit()
        self.describes_nothing = False
        if self.outside and self.rms_held_out([*self.members, *self.outside]) > self.rms_held_out(self.members):
            # A form that readings held out are worse for describes nothing, however well it bends to those fitted.
            # One that was tried in the place of what was refuted has never been an answer.
            self.unconfirmed = self.unconfirmed or [self.label(member) for member in self.outside]
            self.forms, self.outside, self.describes_nothing = (), (), True
            self._fit()

    def _form_instead(self, whole: Recording | None) -> bool:
        """Take up a form where it is a better answer than what is left of the findings, or stands beside it: what the
        refuted one was named for is unexplained again. Whether there is one."""
        if self.named is None or not self.may_have_forms:
            return False
        namer = self.namer.with_prepared(self.search)
        again = weighed_again(namer, self.named, self.named_members, self.p_values)
        if not again.outside:
            return False
        self.namer, self.named = namer, again
        self._take_up(whole)
        # Beside a form, what was refuted without one may be confirmed.
        named = {self.label(member) for member in self.members}
        self.unconfirmed = [label for label in self.unconfirmed if label not in named]
        return True

    def _fit(self) -> None:
        """Fit what was found to all readings, about the arm as it makes it, and in turn to all but some."""
        relinearized_ = relinearized(self.prepared, self.members, self.outside)
        self.prepared, self.members, self.outside = relinearized_.prepared, relinearized_.members, relinearized_.outside
        self.fitted: Fit = relinearized_.fitted
        self.refit: Refit = relinearized_.refit
        self.observed: Observed = self.prepared.observed
        self.held_out = {name: self.held_out_of(folds) for name, folds in self.folds.items()}

    def unnamed(self) -> Unnamed:
        """What the recording leaves room for beside what is named."""
        rivals = [rival.member for others in self.alike for rival in others]
        width = self.observed.residual.shape[1]
        rows = (self.searched()[:, None] * width + np.arange(width)).reshape(-1)
        room = unnamed(self.with_what_is_left(), [*self.named_members, *self.forms], rivals, rows)
        if len(self.members) > 1:
            # One finding may be all there is; a second says that the arm has more.
            room = room.at_least(self.rules.fitting.least_unnamed)
        weak = self._weak()
        if not weak:
            return room
        moved = sum((self.refit.terms[place].moved for place in weak), self.refit.residual)
        left = self.search.observed.whitened(moved[self.searched()])
        among = replace(self.search, vector=self.search.pool.projected(left))
        strong = [member for place, member in enumerate(self.named_members) if place not in weak]
        return room.no_less_than(unnamed(among, [*strong, *self.forms], rivals, rows))

    def _weak(self) -> list[int]:
        """The places of findings that move the tip by less than noise does, beside one that moves it most: that one
        says nothing of others. None where they are too few for a sample: one alone is a separate cause."""
        if self.noise.rms_m is None:
            return []
        moved = [self.moved([place]) for place in range(len(self.members))]
        weak = [place for place, item in enumerate(moved) if item < min(self.noise.rms_m, max(moved))]
        return weak if len(weak) > 1 else []

    def searched(self) -> NDArray[np.int64]:
        """Where the readings that were searched stand among those that are fitted."""
        number = {name: k for k, name in enumerate(self.observed.recording.names_of_readings())}
        searched = self.search.observed.recording.names_of_readings()
        return np.array([number[name] for name in searched], dtype=np.int64)

    def with_what_is_left(self) -> Prepared:
        """The search's patterns over what the fit leaves, where that was made about another shape than the search: what
        lay beyond first order there is no sign of anything unnamed."""
        if self.observed.about == self.search.observed.about:
            return self.search
        left = self.search.observed.whitened(self.refit.residual[self.searched()])
        return replace(self.search, vector=self.search.pool.projected(left))

    def _wrong(self) -> tuple[list[int], list[str], str, bool] | None:
        """The places of the findings, if any, that are none, the list of those left out for that, why as a clause, and
        whether something else may stand in their place: first what cannot be (sizes that the search found possible one
        step at a time may run off together), then what does not carry over, then what is too little for a name."""
        cannot = impossible_term(self.prepared, self.refit)
        if cannot is not None:
            return [cannot[0]], self.impossible, f" ({cannot[1]})", False
        refuted = self._refuted()
        if refuted is not None:
            return [refuted], self.unconfirmed, "", not self.forms
        # A form takes up much of whatever else there is: beside one, what is needless is not told by what is held out.
        needless = [] if self.forms else self._not_carried_over()
        if needless:
            return needless, self.unconfirmed, "", False
        little = self._too_little()
        return None if little is None else ([little], self.too_little, "", False)

    def _too_little(self) -> int | None:
        """The place of the finding, if any of several, that moves the tip by next to nothing beside the noise."""
        moved = [self.moved([place]) for place in range(len(self.members))]
        if len(moved) < 2 or self.noise.rms_m is None:
            return None
        least = int(np.argmin(moved))
        return least if moved[least] < self.rules.answer.least_moved * self.noise.rms_m else None

    def _refuted(self) -> int | None:
        """The place of the finding, if any, that only makes worse what was held out: it describes the readings that it
        was fitted to, and no others. What forms make of readings that they have not seen is no finding's fault."""
        nothing = self._under_weights_for_nothing()
        if nothing is not None:
            return nothing
        whole = self.rms_held_out(self.members)
        without = [self.rms_held_out(_less(self.members, k)) for k in range(len(self.members))]
        if not without or min(without) >= (1.0 - self.rules.answer.refuted) * whole:
            return None
        return int(np.argmin(without))

    def _not_carried_over(self) -> list[int]:
        """The places of the findings, of several, without which the others tell readings held out as well: one after
        the other the least. What moves much of the mismatch is kept, as others may take its place and be wrong; and
        all is where the workspace has too few parts to judge by."""
        rules, part = self.rules.answer, parts_of_workspace(self.observed)
        kept, held_out = list(range(len(self.members))), hardest(self.held_out)
        if len(kept) < 2 or int(part.max()) + 1 < self.rules.fitting.least_parts:
            return []
        most = rules.kept_anyway * self.left(())
        judged = [place for place in kept if self.moved([place]) <= most]

        def gain(place: int) -> float:
            fewer = [k for k in kept if k != place]
            mine, other = ([0, *(1 + k for k in some)] for some in (kept, fewer))
            return held_out.better_by(mine, other, part)

        while judged and len(kept) > 1:
            gains = {place: gain(place) for place in judged}
            least = min(gains, key=lambda place: gains[place])
            # One standard error, of the difference: L. Breiman et al., Classification and Regression Trees (1984).
            if gains[least] >= 1.0:
                break
            kept.remove(least)
            judged.remove(least)
        return [place for place in range(len(self.members)) if place not in kept]

    def left(self, members: Sequence[int]) -> float:
        """The RMS length (m) of what some groups leave of the tip."""
        return rms_length(remaining(self.prepared, fit(self.prepared, members))[:, : self.observed.components])

    def _under_weights_for_nothing(self) -> int | None:
        """The place of what gives under unknown weights, if any, that the weights which all share leave no part: by
        itself it took weights of its own for one."""
        for place, term in enumerate(self.refit.terms):
            low, high = self.refit.parameters[place][0].interval if term.shared else (1.0, 1.0)
            if low <= 0.0 <= high:
                return place
        return None

    def _fitted_to(self, whole: Recording | None) -> tuple[Prepared, dict[int, int]]:
        """What the findings are fitted to: all readings where only some were searched (and no form won, whose places
        belong to those searched). With it, the numbers that the search's groups have there."""
        searched = self.search
        if whole is None or self.forms:
            return searched, {m: m for m in (*self.named_members, *self.forms)}
        near = searched.observed
        rejected = {item.row for item in searched.rejected}
        rows = kept(whole, np.array([int(row) not in rejected for row in whole.row]))
        observed = observed_about(near, near.about, (), rows).softened(near.softening)
        patterns = [
            (c, columns_of(observed, c)) for c in (searched.pool.groups[m].candidate for m in self.named_members)
        ]
        packed = packed_up((c, columns) for c, columns in patterns if columns is not None)
        prepared = set_up(observed, packed, searched.rejected)
        return prepared, {m: k for k, m in enumerate(self.named_members)}

    def wandered(self) -> float:
        """The RMS length (m) of what wanders with the instrument."""
        left = self.after()
        return float(np.sqrt(max(rms_length(left) ** 2 - rms_length(self.observed.still(left)) ** 2, 0.0)))

    def after(self) -> Array:
        """What is left of the tip (N, D), m."""
        width = self.observed.components
        if self.outside:
            return remaining(self.prepared, self.fitted)[:, :width]
        return self.refit.residual[:, :width]

    def _renamed(self) -> tuple[tuple[int, ...], tuple[list[Rival], ...], tuple[list[Rival], ...]]:
        """The members under the name of each class that goes first, with what cannot be distinguished from each, and
        what could not if they were all there is."""
        if self.named is None:
            return (), (), ()
        members = renamed_under_one_set(self.namer, self.named)
        whole = [*members, *self.named.outside]
        rivals_of_members = tuple(rivals(self.namer, whole, member) for member in members)
        judge = self._with_room(whole)
        if judge is self.namer:
            return members, rivals_of_members, rivals_of_members
        return members, tuple(rivals(self.namer, whole, member, (judge,)) for member in members), rivals_of_members

    def _with_room(self, members: Sequence[int]) -> Namer:
        """The namer with as much room for causes too small to be named as intervals have, where names are many."""
        rules = self.rules.fitting
        return self.namer.with_room(
            members, least=rules.least_unnamed if len(members) > self.rules.search.sparing else 0.0
        )

    def held_out_of(self, folds: Folds, small: Array | None = None, *, as_filed: bool = False) -> HeldOut:
        """Nuisances, members (at the refitted shapes) and forms, to be fitted to all folds but one; small causes (N, C,
        K) too, each of a size of the noise's deviation. A file has one set of unknown weights (`as_filed`)."""
        terms = self.refit.terms
        forms = [self.prepared.columns[m] for m in self.outside]
        further = [] if small is None else [small]
        parts = [self.prepared.beside, *(term.columns for term in terms), *forms, *further]
        tethers = [
            None,
            *(tether(term, self.fitted.unit, rules=self.rules.fitting) for term in terms),
            *(None for _ in forms),
            *(np.ones(part.shape[2]) for part in further),
        ]
        shared = shared_of(self.prepared, self.refit) if as_filed else None
        return HeldOut(self.observed, parts, folds, tethers, nuisances=1, shared=shared)

    def rms_held_out(self, members: Sequence[int]) -> float:
        """What some of the members and forms leave of parts of the workspace that their fit has not seen."""
        whole = [*self.members, *self.outside]
        return hardest(self.held_out).rms([0, *(1 + whole.index(m) for m in members)])

    def moved(self, places: Sequence[int]) -> float:
        """The RMS length (m) of what some findings move together, beyond what the nuisances take up."""
        total = sum((self.refit.terms[place].moved for place in places), np.zeros(self.observed.residual.shape))
        return rms_length(beyond_nuisances(self.prepared, total)[:, : self.observed.components])

    def place(self, place: int) -> tuple[str, tuple[int, ...]]:
        """A finding's effect, and the joints or links (from 1) where it acts."""
        candidate = self.prepared.pool.groups[self.members[place]].candidate
        return candidate.effect, candidate.numbers

    def label(self, member: int) -> str:
        """A group and where it acts, in words."""
        candidate = self.prepared.pool.groups[member].candidate
        return label_of(candidate, self.observed.recording)


def _less(values: tuple[Item, ...], place: int) -> tuple[Item, ...]:
    """A tuple without one of its items."""
    return (*values[:place], *values[place + 1 :])
