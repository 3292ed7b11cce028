"""From what was found to a result: findings, location, ladder, what cannot be seen, sentences."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.assumptions import default_gravity
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.corrected_arm import corrected_arm
from linkwright.core.diagnose.fitting.fit import displacement, fit, remaining
from linkwright.core.diagnose.fitting.held_out import hardest, splits
from linkwright.core.diagnose.fitting.identified_origins import identified_origins
from linkwright.core.diagnose.judge.contradictions import contradictions
from linkwright.core.diagnose.judge.for_file import ForFile, for_file
from linkwright.core.diagnose.judge.needed import Needed, needed
from linkwright.core.diagnose.judge.placements import placements
from linkwright.core.diagnose.judge.predict import residual_under
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.residual.visits import one_condition
from linkwright.core.diagnose.result import (
    Alternative,
    Detectable,
    Diagnosis,
    Exchange,
    Finding,
    Location,
    OfRecording,
    Rung,
    Unknown,
    Verdict,
)
from linkwright.core.diagnose.search.aliases import Rival
from linkwright.core.diagnose.search.exchanges import exchanged
from linkwright.core.diagnose.several.differences import differences
from linkwright.core.diagnose.several.each import determined_without, from_others, of_recordings
from linkwright.core.sections.numeric import Array

from .cameras import of_camera
from .confirmation import Confirmed
from .detectable import detectable
from .iso_figures import iso_figures
from .locate import dependences, depends_on, direction, joint_shares
from .next_poses import next_poses
from .notes import beyond_first_order_of, notes, set_aside
from .remainder import Remainder
from .sentences import (
    MANY_FINDINGS,
    mm,
    null_vectors,
    of_exchange,
    put_in_first,
    reading_of,
    recording_of,
    said_of_no_weight,
    verdict_sentence,
    what_differs,
    what_was_free,
)
from .together import may_be_nothing
from .unknown import describe, largest_first, rejected_forms
from .unseen import unseen

_COME_BACK = (
    "visit some poses three times or more, with others between. An error that recurs there is no scatter of an arm "
    "with poor repeatability"
)


class Conclusion:
    """Turns what was confirmed (`names`) and what is left beside it (`rest`) into a result; each method is one part of
    that."""

    def __init__(self, names: Confirmed) -> None:
        self.names, self.rest = names, Remainder(names)
        self.observed, self.prepared = names.observed, names.prepared
        self.search, self.rules = names.search, names.rules

    def result(self, arm: Arm, recording: Recording, began: float) -> Diagnosis:
        """The whole result."""
        width = self.observed.components
        before = remaining(self.prepared, fit(self.prepared, ()))[:, :width]
        after = self.names.after()
        rows = self._joint_of_forms()
        shares = joint_shares(self.search)
        rng = np.random.default_rng(self.names.options.seed + 1)
        depends = () if not self._anything else dependences(self.search, int(np.argmax(shares)), rng)
        self.names.tell("describing what is unknown" if self.names.outside else "confirming", 0.8)
        unknown = None
        if self.rest.unexplained:
            folds = hardest(splits(self.search.observed, self.names.options.seed))
            there = self.observed.recording
            unknown = describe(
                self.names.namer,
                self.names.named_members,
                self.names.forms,
                depends,
                folds,
                self.names.noise.rms_m,
                there,
            )
            if self.rest.may_scatter:
                unknown = replace(unknown, decide=_COME_BACK)
        needed_, exchanges = self._needed(), self._exchanges()
        findings = self._findings(needed_)
        apart = differences(self.prepared, self.names.refit, self.names.outside, self.names.p_values)
        file = for_file(self.names)
        corrected, of_arm = corrected_arm(arm, file.written.refit, rules=self.rules.fitting)
        room = self.names.unnamed() if self.names.members and arm.unknown_origins else None
        corrected, origins = identified_origins(
            file.written.prepared, file.written.refit, file.written.outside, corrected, room, self.search
        )
        free = any("free" in (one.frame, one.tool) for one in self.observed.recording.singles)
        about = self.names.unnamed() if free and self.names.members else None
        placed = placements(file.written.prepared, file.written.refit, file.written.outside, about)
        self.names.tell("choosing the next poses", 0.95)
        proposed = next_poses(
            self.names.namer,
            [*self.names.named_members, *self.names.forms],
            list(zip(self.names.named_members, self.names.alternatives, strict=True)),
            self.names.options.seed,
        )
        held = {name: part.rms() for name, part in self.names.held_out.items()}
        rejected = (*recording.rejected, *self.names.noise.outliers, *self.prepared.rejected)
        recordings = self._with_arms(arm, self._recordings(before, self.names.after(), rejected), file)
        if recordings:
            held["one recording at a time"] = from_others(recordings)
        rms_before, rms_after = rms_length(before), rms_length(after)
        p_value = self._gate_p()
        moved = displacement(self.prepared, self.names.fitted)[:, :width]
        return Diagnosis(
            arm=arm,
            recording=self.observed.recording,
            verdict=self._verdict(),
            sentence=said_of_no_weight(arm, self._verdict())
            + self._sentence(findings, unknown, rms_before, p_value, needed_.small)
            + (put_in_first(findings, arm) if beyond_first_order_of(self.names) else "")
            + what_differs(apart, recordings, rules=self.rules.mistakes)
            + what_was_free(origins),
            noise_floor=self.names.noise.rms_m,
            noise_source=self.names.noise.sentence,
            rms_before=rms_before,
            rms_after=rms_after,
            rms_after_held_out=hardest(self.names.held_out).rms(),
            gate_p=p_value,
            findings=findings,
            where=Location(
                joint=self._joint(shares, rows),
                joint_shares=shares,
                depends_on=depends_on(depends, rules=self.rules.residual),
                direction=direction(self.observed, moved),
                since=None if unknown is None else unknown.since,
                dependences=depends,
            ),
            unknown=unknown,
            ladder=self._ladder(),
            rejected_rows=rejected,
            rejected_forms=rejected_forms(self.names.namer, self.names.named_members, self.names.forms)
            if self._anything
            else (),
            detectable=self._detectable(),
            invisible=self._invisible(),
            next_poses=proposed.poses,
            next_poses_note=proposed.note,
            next_poses_enough=proposed.enough,
            noise_from=self.names.noise.source,
            wandered=self.names.wandered(),
            null_vectors=null_vectors(self.search),
            splits=MappingProxyType(held),
            figures=iso_figures(self.observed.recording, arm, rules=self.rules) if self._whole_places() else (),
            residual_before=before,
            residual_after=after,
            corrected=corrected,
            notes=(
                *of_camera(self.prepared, self.names.refit.terms, self.names.noise),
                *unseen(self.prepared),
                *default_gravity(arm),
                *self.observed.alignment.undetermined,
                *recording.warnings,
                *self.names.noise.warnings,
                *of_arm,
                *((said,) if (said := file.note()) is not None else ()),
                *contradictions(rms_after, held, mm, rules=self.rules, noise=self.names.noise.rms_m or 0.0),
                *notes(self.names, self.rest),
                *(of_exchange(exchange) for exchange in exchanges),
            ),
            seconds=time.perf_counter() - began,
            lack_of_fit=self.rest.lack_of_fit,
            small=self.rest.small,
            scatter=self.rest.scatter(),
            rms_promised=self._left_by_file(corrected, recordings),
            recordings=recordings,
            differences=apart,
            origins=origins,
            shown=None if self.observed.view is None else self.observed.view.shown,
            exchanges=exchanges,
            set_aside=set_aside(self.names),
            rivals=file.rivals,
            small_together=self.names.moved(needed_.small),
            placements=placed,
        )

    def _whole_places(self) -> bool:
        """Whether it is one recording, of the tip's whole place."""
        return not self.names.floors and self.observed.view is None

    def _recordings(self, before: Array, after: Array, rejected: Sequence[RejectedRow]) -> tuple[OfRecording, ...]:
        """What comes of each of several recordings, from the tip's residuals (N, D), m, before and after."""
        if not self.names.floors:
            return ()
        residuals = (before, after, hardest(self.names.held_out).residual(), self._from_others(self.observed.which))
        forms = [self.prepared.columns[m] for m in self.names.outside]
        columns = [
            np.zeros((*self.observed.residual.shape, 0)),
            *(term.columns for term in self.names.refit.terms),
            *forms,
        ]
        model = (self.prepared.beside, np.concatenate(columns, axis=2))
        return of_recordings(self.observed, self.names.floors, residuals, model, rejected)

    def _with_arms(self, arm: Arm, recordings: tuple[OfRecording, ...], file: ForFile) -> tuple[OfRecording, ...]:
        """The recordings, each with the corrected arm of its own where they are of several arms."""
        if not self.observed.recording.units:
            return recordings
        arms = [
            corrected_arm(arm, file.written.refit, only=index, rules=self.rules.fitting)[0]
            for index in range(len(recordings))
        ]
        files = zip(recordings, arms, self.observed.recording.parts(), strict=True)
        return tuple(
            replace(one, corrected=file_arm, rms_promised=rms_length(residual_under(file_arm, part)))
            for one, file_arm, part in files
        )

    def _left_by_file(self, corrected: Arm, recordings: Sequence[OfRecording]) -> float:
        """The RMS length (m) that what is written leaves, by the function that `predict` uses; of several arms what
        each one's file leaves."""
        if not self.observed.recording.units:
            return rms_length(residual_under(corrected, self.observed.recording))
        count = np.bincount(self.observed.which, minlength=len(recordings))
        squares = np.array([one.rms_promised for one in recordings]) ** 2
        return float(np.sqrt(count @ squares / count.sum()))

    def _from_others(self, which: NDArray[np.int64]) -> Array:
        """The tip's residuals (N, D), m, of each recording by what the others say, its frame still to be fitted."""
        held_out = self.names.held_out_of(which)
        left = np.zeros((self.observed.rows, self.observed.components))
        last = 1 + len(self.names.refit.terms) + len(self.names.outside)
        for index in np.unique(which).tolist():
            terms = determined_without(index, [term.candidate for term in self.names.refit.terms], int(which.max()) + 1)
            parts = [0, *(1 + k for k in terms), *range(1 + len(self.names.refit.terms), last)]
            left[which == index] = held_out.residual(parts)[which == index]
        return left

    @property
    def _anything(self) -> bool:
        return bool(self.names.members) or self.rest.unexplained

    def _verdict(self) -> Verdict:
        if self.names.named is None:
            return "insufficient_data"
        if self.rest.unexplained:
            return "unknown"
        if not self.names.members:
            return "none"
        return "alias_class" if any(self.names.alternatives) else "named"

    def _gate_p(self) -> float:
        if self.names.named is None:
            return 1.0
        return min(1.0, 2.0 * min(test.p_value for test in self.names.named.gate))

    def _needed(self) -> Needed:
        """The places of the names, those that held-out readings need most first."""
        members, mismatch = self.names.members, max(self.names.left(()), 1e-30)
        moves = [self.names.moved([place]) / mismatch for place in range(len(members))]

        def left(out: Sequence[int]) -> Array:
            kept = [member for place, member in enumerate(members) if place not in out]
            return np.array([self.names.rms_held_out([*kept, *self.names.outside])])

        return needed(moves, left, rules=self.rules)

    def _findings(self, needed_: Needed) -> tuple[Finding, ...]:
        findings: dict[int, Finding] = {}
        # Where neighbours tell as much as one, signs drawn for each visit give no p-value.
        p_values = self.names.p_values if self.prepared.together == 1 else ()
        whole = [*self.names.members, *self.names.outside]
        for place, member in enumerate(self.names.members):
            candidate = self.prepared.pool.groups[member].candidate
            others = tuple(self._alternative(rival) for rival in self.names.alternatives[place])
            recording = recording_of(candidate, self.observed.recording)
            parameters = self.names.refit.parameters[place]
            rest = [m for m in whole if m != member]
            beside = tuple(self.names.place(other) for other in self.names.together.get(place, ()))
            nothing = may_be_nothing(parameters, self.names.refit.terms[place].candidate.sizes)
            findings[place] = Finding(
                effect=candidate.effect,
                at=candidate.numbers,
                alternatives=others,
                parameters=parameters,
                rms_explained=self.names.moved([place]),
                p_value=p_values[place] if place < len(p_values) else math.nan,
                rms_without=self.names.left(rest),
                rms_without_held_out=float(needed_.without[place][0]),
                reading=reading_of(
                    candidate.effect, candidate.numbers, parameters, others, recording, beside, nothing=nothing
                ),
                recording=recording,
                together=beside,
                evidence=self._evidence(place),
                may_be_nothing=nothing,
                small=place in needed_.small,
            )
        return tuple(findings[place] for place in needed_.order)

    def _evidence(self, place: int) -> float:
        """How much likelier (nats) the readings that were searched are with a finding than without it."""
        namer, whole = self.names.namer.with_prepared(self.search), [*self.names.named_members, *self.names.forms]
        rest = [member for member in whole if member != self.names.named_members[place]]
        return 0.5 * (namer.criterion_of(rest) - namer.criterion_of(whole)) / self.prepared.together

    def _exchanges(self) -> tuple[Exchange, ...]:
        """The sets of causes that could stand in the place of one or two findings, where findings are few."""
        if len(self.names.named_members) > MANY_FINDINGS:
            return ()
        namer, groups = self.names.namer.with_prepared(self.search), self.search.pool.groups

        def named(members: Sequence[int]) -> tuple[tuple[str, tuple[int, ...], str], ...]:
            candidates = (groups[member].candidate for member in members)
            return tuple(
                (candidate.effect, candidate.numbers, recording_of(candidate, self.observed.recording))
                for candidate in candidates
            )

        return tuple(
            Exchange(named(item.members), named(item.others), item.worse)
            for item in exchanged(namer, self.names.named_members, self.names.forms)
        )

    def _causes(self, small: Sequence[int]) -> list[tuple[str, float]]:
        """The kinds of physics found, small findings aside, with what each moves (m), the largest first."""
        places: dict[str, list[int]] = {}
        for place in sorted({*range(len(self.names.members))} - {*small}):
            places.setdefault(EFFECTS[self.names.place(place)[0]].cause, []).append(place)
        return sorted(((cause, self.names.moved(at)) for cause, at in places.items()), key=lambda item: -item[1])

    def _alternative(self, rival: Rival) -> Alternative:
        candidate = self.search.pool.groups[rival.member].candidate
        recording = recording_of(candidate, self.search.observed.recording)
        return Alternative(candidate.effect, candidate.numbers, rival.likeness, rival.worse, recording)

    def _joint_of_forms(self) -> int | None:
        for member in largest_first(self.prepared, self.names.fitted, self.names.outside):
            at = self.prepared.pool.groups[member].candidate.at
            if at:
                return at[0] + 1
        return None

    def _joint(self, shares: Sequence[float], of_form: int | None) -> int | None:
        """The joint that the strongest finding names, or a form that moves more; else the one whose motion alone
        describes clearly most."""
        if not self._anything:
            return None
        size = [self.names.moved([place]) for place in range(len(self.names.members))]
        beyond = displacement(self.prepared, self.names.fitted, self.names.outside)[:, : self.observed.components]
        if self.names.members and (of_form is None or max(size) >= rms_length(beyond)):
            candidate = self.prepared.pool.groups[self.names.members[int(np.argmax(size))]].candidate
            if len(candidate.at) == 1:
                return candidate.at[0] + 1
            return None
        if of_form is not None:
            return of_form
        ranked = sorted(shares, reverse=True)
        clear = len(ranked) == 1 or ranked[0] > ranked[1] + self.rules.search.material
        return int(np.argmax(shares)) + 1 if clear else None

    def _ladder(self) -> tuple[Rung, ...]:
        """The model as given, each finding added (the strongest first), and each left out of the whole in turn."""
        size = {m: self.names.moved([place]) for place, m in enumerate(self.names.members)}
        for m in self.names.outside:
            size[m] = rms_length(displacement(self.prepared, self.names.fitted, (m,))[:, : self.observed.components])
        order = sorted(size, key=lambda m: -size[m])
        rungs = [self._rung("model as given", [])]
        rungs += [self._rung(f"+ {self.names.label(m)}", order[: k + 1]) for k, m in enumerate(order)]
        if len(order) > 1:
            rungs += [self._rung(f"without {self.names.label(m)}", [o for o in order if o != m]) for m in order]
        return tuple(rungs)

    def _rung(self, label: str, members: Sequence[int]) -> Rung:
        left = remaining(self.prepared, fit(self.prepared, members))[:, : self.observed.components]
        length = np.sqrt(np.sum(left**2, axis=1))
        held = self.names.rms_held_out(members)
        return Rung(label, rms_length(left), float(length.mean()), float(length.max()), held)

    def _detectable(self) -> tuple[Detectable, ...]:
        if self.names.named is None:
            return ()
        # What is left after the findings is scatter; the gate's draws still hold what was found.
        test = self.names.named.gate[0] if self.names.named.left is None else self.names.named.left[0]
        return detectable(self.search, test, self.names.fitted.unit, self.rules.search.false_alarm)

    def _invisible(self) -> tuple[tuple[str, tuple[int, ...]], ...]:
        """What this recording cannot show: swallowed by the nuisances, or without a trace for want of a column."""
        shown = {group.candidate.family for group in self.search.pool.groups}
        swallowed = {c.family for c in self.search.pool.invisible if not c.outside} - shown
        invisible = {(effect, tuple(index + 1 for index in at)) for effect, at, *_ in swallowed}
        present = {effect for effect, *_ in shown} | {effect for effect, _ in invisible}
        absent = [name for name, item in EFFECTS.items() if item.sizes and name not in present and not item.automatic]
        invisible |= {(name, ()) for name in absent if name not in self.names.options.without}
        return tuple(sorted(invisible))

    def _sentence(
        self,
        findings: tuple[Finding, ...],
        unknown: Unknown | None,
        rms_before: float,
        p_value: float,
        small: Sequence[int],
    ) -> str:
        if self.names.named is None:
            return self._too_few(rms_before)
        return verdict_sentence(
            findings,
            unknown,
            rms_before,
            self.rest.what_remains(),
            p_value,
            self._causes(small),
            self.names.moved(small),
            scatter=self.rest.scatter(),
            small=self.rest.small,
        )

    def _too_few(self, rms_before: float) -> str:
        if self.observed.rows < self.rules.search.least_visits or not one_condition(self.observed):
            return "Too few readings: nothing can be told from this recording."
        floor = "" if self.names.noise.rms_m is None else f" (its readings differ by {mm(self.names.noise.rms_m)})"
        return (
            f"One pose, read {self.observed.rows} times: it is {mm(rms_before)} off there{floor}, and nothing tells "
            "why. What an arm lacks shows by how its error changes from pose to pose."
        )
