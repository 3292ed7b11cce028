"""The steps in order: noise floor, nuisances, gate, location, names, tests, confirmation, what cannot be told apart."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from arm.chain import Arm
from arm.effects import EFFECTS

from .candidates import columns_of
from .correct import corrected_arm
from .coupling import coupled
from .detectable import detectable
from .fit import Fit, beyond_nuisances, displacement, fit, remaining
from .held_out import Folds, HeldOut, hardest, splits
from .iso_figures import iso_figures
from .locate import dependences, depends_on, direction, joint_shares
from .naming import FALSE_ALARM, Named, Namer, Rival, name_missing, preferred, rivals
from .next_poses import next_poses
from .noise import NoiseFloor, noise_floor
from .observed import Observed, kept, looks_quieter, observe, rms_length, visits
from .options import Options, Progress
from .prepare import FAR_ABOVE, Prepared, prepare, set_up
from .recording import Recording
from .refit import Refit, refit, tether
from .result import Alternative, Detectable, Diagnosis, Finding, Location, Rung, Unknown, Verdict
from .sentences import name_of, null_vectors, reading_of, verdict_sentence
from .unknown import describe, predictable, rejected_forms
from .whole_search import LEVEL, whole_search_p

Array = NDArray[np.float64]
Item = TypeVar("Item")

_ENOUGH_REPEATS = 20
"""Degrees of freedom (for each component) from which repeats are trusted to tell noise from physics."""
_FARTHER = 2.0
"""Where nothing was found, so many times the noise floor must be left before that is called unknown: heavy tails and a
memory of the noise together make repeats look up to twice too quiet."""
_ENOUGH_RETURNS = 8
"""Poses that were visited again (less one for each) from which that tells what lasts from what does not."""
_LASTING = 0.2
"""The share of a remainder that must be there again, or predict itself elsewhere, for it to be the model's fault."""
_REFUTED = 0.05
"""By how much (as a share of the RMS) held-out readings must be better without a finding for it to be dropped."""
_LOCAL = 0.25
"""The median remainder over its RMS below which it sits at a few visits."""
_LONG = 3000
"""Readings that are searched at most; the findings are then fitted to all of them."""
_LEAST_VISITS = 8
_LEAST = 12
"""Fewer observations than this beyond the nuisances decide nothing."""


def _silent(what: str, share: float) -> None:
    del what, share


def diagnose(
    arm: Arm, recording: Recording, options: Options | None = None, progress: Progress | None = None
) -> Diagnosis:
    """What an arm's model leaves out, by a recording of the real arm.

    Raises `arm.model.PropertyNeeded` and the materials' errors where the model lacks a figure that it needs.
    """
    began = time.perf_counter()
    asked, tell = options or Options(), progress or _silent
    tell("noise floor", 0.0)
    noise = noise_floor(recording, arm)
    cleaned = _without(recording, noise)
    tell("setting the recording against the model", 0.05)
    searched = _thinned(arm, cleaned, asked.seed)
    known = noise.rms_m if noise.source == "repeats" and noise.degrees_of_freedom >= _ENOUGH_REPEATS else None
    prepared = prepare(observe(arm, searched), asked, known)
    tell("searching for what is missing", 0.3)
    namer = Namer(prepared, thorough=asked.thorough, seed=asked.seed)
    too_few = int(prepared.visits[-1]) + 1 < _LEAST_VISITS or prepared.criterion.count < _LEAST
    if not prepared.pool.groups or too_few:
        named = None
    else:
        named = name_missing(namer, lambda share: tell("searching for what is missing", 0.3 + 0.3 * share))
        if named.members:
            again = coupled(namer, asked.without, lambda share: tell("loads and flexibility", 0.6 + 0.05 * share))
            if again is not namer:
                namer = again
                named = name_missing(namer, lambda share: tell("searching again", 0.65 + 0.05 * share))
        if asked.thorough and named.everything:
            told = "calibrating the whole search"
            p = whole_search_p(namer, named, asked.seed, lambda share: tell(told, 0.7 * share))
            named = replace(named, whole_p=p) if p <= LEVEL else Named((), (), (), named.gate, None, p)
    tell("fitting and confirming", 0.7)
    whole = cleaned if len(searched.q) < len(cleaned.q) else None
    return _Report(namer, named, noise, asked, whole=whole, progress=tell).result(arm, recording, began)


def _thinned(arm: Arm, recording: Recording, seed: int) -> Recording:
    """Whole visits of a long recording, picked at random: what to look for is plain from a few thousand readings."""
    if recording.size <= _LONG:
        return recording
    visit = visits(recording, arm)
    share = _LONG / recording.size
    taken = np.random.default_rng(seed).random(int(visit[-1]) + 1) < share
    return kept(recording, taken[visit])


def _without(recording: Recording, noise: NoiseFloor) -> Recording:
    """The recording without the rows that stand out from repeats of their own pose."""
    bad = {each.row for each in noise.outliers}
    return kept(recording, np.array([int(row) not in bad for row in recording.row])) if bad else recording


class _Report:
    """Turns what was found into a result; each method is one part of it."""

    def __init__(
        self,
        namer: Namer,
        named: Named | None,
        noise: NoiseFloor,
        options: Options,
        *,
        whole: Recording | None,
        progress: Progress,
    ) -> None:
        self.namer, self.named = namer, named
        self.noise, self.options, self.tell = noise, options, progress
        self.search: Prepared = namer.prepared
        self.found, self.alternatives = self._renamed()
        self.p_values = named.p_values if named is not None else ()
        self.forms: tuple[int, ...] = named.outside if named is not None else ()
        self.prepared, number = self._fitted_to(whole)
        self.members = tuple(number[m] for m in self.found)
        self.outside = tuple(number[m] for m in self.forms)
        self.observed: Observed = self.prepared.observed
        self.folds: dict[str, Folds] = splits(self.observed, options.seed)
        self.unconfirmed: list[str] = []
        self._fit()
        while (refuted := self._refuted()) is not None:
            self.unconfirmed.append(self._label(self.members[refuted]))
            self.found, self.members = _less(self.found, refuted), _less(self.members, refuted)
            self.alternatives, self.p_values = _less(self.alternatives, refuted), _less(self.p_values, refuted)
            self._fit()
        self.scattered = False
        self.left_over = self._left_over()

    def _fit(self) -> None:
        """Fit what was found to all readings, and in turn to all but some."""
        self.fitted: Fit = fit(self.prepared, [*self.members, *self.outside])
        self.refit: Refit = refit(self.prepared, self.members, self.outside, self.fitted)
        self.held_out = {name: self._held_out(folds) for name, folds in self.folds.items()}

    def _refuted(self) -> int | None:
        """The place of the finding, if any, that only makes worse what was held out: it describes the readings that it
        was fitted to, and no others."""
        whole = hardest(self.held_out).rms()
        without = [self._rms_held_out([*_less(self.members, k), *self.outside]) for k in range(len(self.members))]
        if not without or min(without) >= (1.0 - _REFUTED) * whole:
            return None
        return int(np.argmin(without))

    def _fitted_to(self, whole: Recording | None) -> tuple[Prepared, dict[int, int]]:
        """What the findings are fitted to: all readings where only some were searched (and no form won, whose places
        belong to those searched). With it, the numbers that the search's groups have there."""
        searched = self.search
        if whole is None or self.forms:
            return searched, {m: m for m in (*self.found, *self.forms)}
        near = searched.observed
        rejected = {each.row for each in searched.rejected}
        rows = kept(whole, np.array([int(row) not in rejected for row in whole.row]))
        observed = observe(near.arm_given, rows, scale=near.scale, correlation=near.correlation)
        observed = observed.softened(near.softening)
        patterns = [(c, columns_of(observed, c)) for c in (searched.pool.groups[m].candidate for m in self.found)]
        prepared = set_up(observed, [(c, columns) for c, columns in patterns if columns is not None], searched.rejected)
        return prepared, {m: k for k, m in enumerate(self.found)}

    def _left_over(self) -> bool:
        """Whether far more is left beside the findings than repeats of a pose differ by, though no form fits it, and
        it is there again when a pose is visited again or predicts itself elsewhere."""
        if self.named is None or self.outside or self.noise.source != "repeats" or self.noise.rms_m is None:
            return False
        remainder = remaining(self.prepared, self.fitted)[:, : self.observed.components]
        left = rms_length(remainder)
        floor = self.noise.rms_m * looks_quieter(self.observed)
        limit = (FAR_ABOVE if self.members else _FARTHER) * floor
        if self.noise.degrees_of_freedom < _ENOUGH_REPEATS or left <= limit:
            return False
        if self.noise.drift_m is not None and self.noise.drift_degrees_of_freedom >= _ENOUGH_RETURNS:
            lasting = self.noise.drift_m**2 < (1.0 - _LASTING) * (left**2 - floor**2)
        else:
            folds = hardest(splits(self.search.observed, self.options.seed))
            # Scatter is everywhere; what sits at a few visits alone is something that happened there.
            local = float(np.median(np.linalg.norm(remainder, axis=1))) < _LOCAL * left
            lasting = local or predictable(self.namer, self.found, folds) > _LASTING
        self.scattered = not lasting
        return lasting

    def _renamed(self) -> tuple[tuple[int, ...], tuple[list[Rival], ...]]:
        """The members under the name of each class that goes first, with what cannot be told from each."""
        if self.named is None:
            return (), ()
        members = list(self.named.members)
        for place, member in enumerate(members):
            whole = [*members, *self.named.outside]
            members[place] = preferred(self.namer, whole, member, rivals(self.namer, whole, member))
        whole = [*members, *self.named.outside]
        return tuple(members), tuple(rivals(self.namer, whole, member) for member in members)

    def result(self, arm: Arm, recording: Recording, began: float) -> Diagnosis:
        """The whole result."""
        width = self.observed.components
        before = remaining(self.prepared, fit(self.prepared, ()))[:, :width]
        after = self._after()
        rows = self._joint_of_forms()
        shares = joint_shares(self.search)
        rng = np.random.default_rng(self.options.seed + 1)
        found = () if not self._anything else dependences(self.search, int(np.argmax(shares)), rng)
        self.tell("describing what is unknown" if self.outside else "confirming", 0.8)
        unknown = None
        if self.outside or self.left_over:
            folds = hardest(splits(self.search.observed, self.options.seed))
            unknown = describe(self.namer, self.found, self.forms, found, folds)
        findings = self._findings()
        corrected, notes = corrected_arm(arm, self.refit)
        self.tell("next poses", 0.95)
        poses, note = next_poses(
            self.namer,
            [*self.found, *self.forms],
            list(zip(self.found, self.alternatives, strict=True)),
            self.options.seed,
        )
        held = {name: part.rms() for name, part in self.held_out.items()}
        rms_before, rms_after = rms_length(before), rms_length(after)
        p_value = self._gate_p()
        moved = displacement(self.prepared, self.fitted)[:, :width]
        return Diagnosis(
            arm=arm,
            recording=self.observed.recording,
            verdict=self._verdict(),
            sentence=self._sentence(findings, unknown, rms_before, rms_after, p_value),
            noise_floor=self.noise.rms_m,
            noise_source=self.noise.sentence,
            rms_before=rms_before,
            rms_after=rms_after,
            rms_after_held_out=hardest(self.held_out).rms(),
            gate_p=p_value,
            findings=findings,
            where=Location(
                joint=self._joint(shares, rows),
                joint_shares=shares,
                depends_on=depends_on(found),
                direction=direction(self.observed, moved),
                since=None if unknown is None else unknown.since,
                dependences=found,
            ),
            unknown=unknown,
            ladder=self._ladder(),
            rejected_rows=(*recording.rejected, *self.noise.outliers, *self.prepared.rejected),
            rejected_forms=rejected_forms(self.namer, self.found, self.forms) if self._anything else (),
            detectable=self._detectable(),
            invisible=self._invisible(),
            next_poses=poses,
            next_poses_note=note,
            null_vectors=null_vectors(self.search),
            splits=MappingProxyType(held),
            figures=iso_figures(self.observed.recording, arm),
            residual_before=before,
            residual_after=after,
            corrected=corrected,
            notes=(*recording.warnings, *self.noise.warnings, *notes, *self._notes()),
            seconds=time.perf_counter() - began,
        )

    @property
    def _anything(self) -> bool:
        return bool(self.members or self.outside or self.left_over)

    def _verdict(self) -> Verdict:
        if self.named is None:
            return "insufficient_data"
        if self.outside or self.left_over:
            return "unknown"
        if not self.members:
            return "none"
        return "alias_class" if any(self.alternatives) else "named"

    def _gate_p(self) -> float:
        if self.named is None:
            return 1.0
        if self.named.whole_p is not None:
            return self.named.whole_p
        return min(1.0, 2.0 * min(test.p_value for test in self.named.gate))

    def _after(self) -> Array:
        width = self.observed.components
        if self.outside:
            return remaining(self.prepared, self.fitted)[:, :width]
        return self.refit.residual[:, :width]

    def _held_out(self, folds: Folds) -> HeldOut:
        """Nuisances, members (at the refitted shapes) and forms, to be fitted to all folds but one."""
        terms = self.refit.terms
        forms = [self.prepared.columns[m] for m in self.outside]
        parts = [self.prepared.beside, *(term.columns for term in terms), *forms]
        tethers = [None, *(tether(term, self.fitted.unit) for term in terms), *(None for _ in forms)]
        return HeldOut(self.observed, parts, folds, tethers)

    def _rms_held_out(self, members: Sequence[int]) -> float:
        """What some of the members and forms leave of parts of the workspace that their fit has not seen."""
        whole = [*self.members, *self.outside]
        return hardest(self.held_out).rms([0, *(1 + whole.index(m) for m in members)])

    def _findings(self) -> tuple[Finding, ...]:
        width = self.observed.components
        found: list[Finding] = []
        p_values = self.p_values
        whole = [*self.members, *self.outside]
        for place, member in enumerate(self.members):
            candidate = self.prepared.pool.groups[member].candidate
            others = tuple(self._alternative(rival) for rival in self.alternatives[place])
            parameters = self.refit.parameters[place]
            rest = [m for m in whole if m != member]
            without = remaining(self.prepared, fit(self.prepared, rest))[:, :width]
            at = tuple(index + 1 for index in candidate.at)
            found.append(
                Finding(
                    effect=candidate.effect,
                    at=at,
                    alternatives=others,
                    parameters=parameters,
                    rms_explained=self._moved([place]),
                    p_value=p_values[place] if place < len(p_values) else FALSE_ALARM,
                    rms_without=rms_length(without),
                    rms_without_held_out=self._rms_held_out(rest),
                    reading=reading_of(candidate.effect, at, parameters, others),
                )
            )
        return tuple(sorted(found, key=lambda finding: -finding.rms_explained))

    def _moved(self, places: Sequence[int]) -> float:
        """The RMS length (m) of what some findings move together, beyond what the nuisances take up."""
        total = sum((self.refit.terms[place].moved for place in places), np.zeros(self.observed.residual.shape))
        return rms_length(beyond_nuisances(self.prepared, total)[:, : self.observed.components])

    def _causes(self) -> list[tuple[str, float]]:
        """The kinds of physics found, with what each moves (m), the largest first."""
        places: dict[str, list[int]] = {}
        for place, member in enumerate(self.members):
            cause = EFFECTS[self.prepared.pool.groups[member].candidate.effect].cause
            places.setdefault(cause, []).append(place)
        return sorted(((cause, self._moved(at)) for cause, at in places.items()), key=lambda each: -each[1])

    def _alternative(self, rival: Rival) -> Alternative:
        candidate = self.search.pool.groups[rival.member].candidate
        at = tuple(index + 1 for index in candidate.at)
        return Alternative(candidate.effect, at, rival.likeness, rival.worse)

    def _joint_of_forms(self) -> int | None:
        for member in self.outside:
            at = self.prepared.pool.groups[member].candidate.at
            if len(at) == 1:
                return at[0] + 1
        return None

    def _joint(self, shares: Sequence[float], of_form: int | None) -> int | None:
        """The joint that the strongest finding names; else the one whose motion alone describes clearly most."""
        if not self._anything:
            return None
        if self.members:
            size = [self._moved([place]) for place in range(len(self.members))]
            candidate = self.prepared.pool.groups[self.members[int(np.argmax(size))]].candidate
            if len(candidate.at) == 1:
                return candidate.at[0] + 1
            return None
        if of_form is not None:
            return of_form
        ranked = sorted(shares, reverse=True)
        clear = len(ranked) == 1 or ranked[0] > ranked[1] + 0.15
        return int(np.argmax(shares)) + 1 if clear else None

    def _ladder(self) -> tuple[Rung, ...]:
        """The model as given, each finding added (the strongest first), and each left out of the whole in turn."""
        size = {m: self._moved([place]) for place, m in enumerate(self.members)}
        for m in self.outside:
            size[m] = rms_length(displacement(self.prepared, self.fitted, (m,))[:, : self.observed.components])
        order = sorted(size, key=lambda m: -size[m])
        rungs = [self._rung("model as given", [])]
        rungs += [self._rung(f"+ {self._label(m)}", order[: k + 1]) for k, m in enumerate(order)]
        if len(order) > 1:
            rungs += [self._rung(f"without {self._label(m)}", [o for o in order if o != m]) for m in order]
        return tuple(rungs)

    def _rung(self, label: str, members: Sequence[int]) -> Rung:
        left = remaining(self.prepared, fit(self.prepared, members))[:, : self.observed.components]
        length = np.sqrt(np.sum(left**2, axis=1))
        held = self._rms_held_out(members)
        return Rung(label, rms_length(left), float(length.mean()), float(length.max()), held)

    def _label(self, member: int) -> str:
        candidate = self.prepared.pool.groups[member].candidate
        return name_of(candidate.effect, tuple(index + 1 for index in candidate.at))

    def _detectable(self) -> tuple[Detectable, ...]:
        if self.named is None:
            return ()
        # What is left after the findings is scatter; the gate's own draws still hold what was found.
        test = self.named.gate[0] if self.named.left is None else self.named.left[0]
        return detectable(self.search, test, self.fitted.unit, FALSE_ALARM)

    def _invisible(self) -> tuple[tuple[str, tuple[int, ...]], ...]:
        """What this recording cannot show: swallowed by the nuisances, or without a trace for want of a column."""
        shown = {group.candidate.family for group in self.search.pool.groups}
        swallowed = {c.family for c in self.search.pool.invisible if not c.outside} - shown
        found = {(effect, tuple(index + 1 for index in at)) for effect, at, _ in swallowed}
        present = {effect for effect, _, _ in shown} | {effect for effect, _ in found}
        absent = [
            name for name, effect in EFFECTS.items() if _fitted(name) and name not in present and not effect.automatic
        ]
        found |= {(name, ()) for name in absent if name not in self.options.without}
        return tuple(sorted(found))

    def _sentence(
        self,
        findings: tuple[Finding, ...],
        unknown: Unknown | None,
        rms_before: float,
        rms_after: float,
        p_value: float,
    ) -> str:
        if self.named is None:
            return "Too few readings: nothing can be told from this recording."
        floor = self.noise.rms_m
        return verdict_sentence(findings, unknown, rms_before, rms_after, floor, p_value, self._causes())

    def _notes(self) -> tuple[str, ...]:
        found: list[str] = []
        if self.observed.correlation > 0.0:
            shared = f"correlation {self.observed.correlation:.2f}"
            found.append(f"Neighbouring readings share noise ({shared}), which was allowed for.")
        found += [
            f"The {each} was beyond chance among the readings fitted, but made the held-out ones worse: left out again."
            for each in self.unconfirmed
        ]
        if self.scattered:
            found.append(
                "What is left is more than readings of one visit differ by, but it is not there again when a pose is "
                "visited again, or nothing recorded predicts it from pose to pose: the arm does not return more "
                "exactly than that, or the cause changes faster than these readings can follow. Visit some poses "
                "three times or more, with others between."
            )
        if self.named is not None and self.named.left is not None and not self.outside:
            p = min(test.p_value for test in self.named.left)
            if p <= FALSE_ALARM:
                found.append(f"A remainder is more than chance (p = {p:.2g}), but small beside what was found.")
        return tuple(found)


def _less(values: tuple[Item, ...], place: int) -> tuple[Item, ...]:
    """A tuple without one of its items."""
    return (*values[:place], *values[place + 1 :])


def _fitted(effect: str) -> bool:
    return any(parameter.role == "size" for parameter in EFFECTS[effect].parameters)
