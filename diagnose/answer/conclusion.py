"""From what was found to a result: findings, location, ladder, what cannot be seen, sentences."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from linkwright.core.arm.assumptions import default_gravity
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.corrected_arm import corrected_arm
from linkwright.core.diagnose.fitting.fit import beyond_nuisances, displacement, fit, remaining
from linkwright.core.diagnose.fitting.held_out import hardest, splits
from linkwright.core.diagnose.fitting.identified_origins import identified_origins
from linkwright.core.diagnose.fitting.torque_weights import with_weights
from linkwright.core.diagnose.mistakes.row_lists import rows_text
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.residual.observe import beyond_first_order
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.residual.visits import one_condition
from linkwright.core.diagnose.residual.wander_seen import seen_to_wander
from linkwright.core.diagnose.result import (
    Alternative,
    Detectable,
    Diagnosis,
    Finding,
    Location,
    OfRecording,
    Rung,
    Unknown,
    Verdict,
)
from linkwright.core.diagnose.search.aliases import Rival
from linkwright.core.diagnose.several.differences import differences
from linkwright.core.diagnose.several.each import from_others, of_recordings, told_without
from linkwright.core.diagnose.several.recordings import Several
from linkwright.core.sections.numeric import Array

from .cameras import of_camera
from .confirmation import Confirmed
from .detectable import detectable
from .iso_figures import iso_figures
from .locate import dependences, depends_on, direction, joint_shares
from .next_poses import next_poses
from .sentences import (
    mm,
    nothing_singly,
    null_vectors,
    of_small_causes,
    put_in_first,
    reading_of,
    recording_of,
    refutation,
    said_of_no_weight,
    verdict_sentence,
    what_differs,
    what_was_free,
)
from .together import may_be_nothing
from .torques import weights_by_torque
from .unknown import describe, largest_first, rejected_forms
from .unseen import unseen

_COME_BACK = (
    "come back to some poses three times or more, with others between: what is off there again is no scatter of an arm "
    "that returns badly"
)


class Conclusion(Confirmed):
    """Turns what was confirmed into a result; each method is one part of it."""

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
        if self._unexplained:
            folds = hardest(splits(self.search.observed, self.options.seed))
            there = self.observed.recording
            unknown = describe(self.namer, self.found, self.forms, found, folds, self.noise.rms_m, there)
            if self.may_scatter:
                unknown = replace(unknown, decide=_COME_BACK)
        findings = self._findings()
        apart = differences(self.prepared, self.refit, self.outside, self.p_values)
        corrected, notes = corrected_arm(arm, self.refit, rules=self.rules.fitting)
        room = self._unnamed() if self.members and arm.unknown_origins else None
        corrected, origins = identified_origins(self.prepared, self.refit, self.outside, corrected, room, self.search)
        corrected, of_weights = with_weights(self.observed, corrected)
        self.tell("next poses", 0.95)
        proposed = next_poses(
            self.namer,
            [*self.found, *self.forms],
            list(zip(self.found, self.alternatives, strict=True)),
            self.options.seed,
        )
        held = {name: part.rms() for name, part in self.held_out.items()}
        rejected = (*recording.rejected, *self.noise.outliers, *self.prepared.rejected)
        each = self._with_arms(arm, self._recordings(before, self._after(), rejected))
        if each:
            held["one recording at a time"] = from_others(each)
        rms_before, rms_after = rms_length(before), rms_length(after)
        p_value = self._gate_p()
        moved = displacement(self.prepared, self.fitted)[:, :width]
        return Diagnosis(
            arm=arm,
            recording=self.observed.recording,
            verdict=self._verdict(),
            sentence=said_of_no_weight(arm, self._verdict())
            + self._sentence(findings, unknown, rms_before, p_value)
            + (put_in_first(findings) if self._beyond_first_order() else "")
            + what_differs(apart, each, rules=self.rules.answer)
            + what_was_free(origins),
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
                depends_on=depends_on(found, rules=self.rules.answer),
                direction=direction(self.observed, moved),
                since=None if unknown is None else unknown.since,
                dependences=found,
            ),
            unknown=unknown,
            ladder=self._ladder(),
            rejected_rows=rejected,
            rejected_forms=rejected_forms(self.namer, self.found, self.forms) if self._anything else (),
            detectable=self._detectable(),
            invisible=self._invisible(),
            next_poses=proposed.poses,
            next_poses_note=proposed.note,
            next_poses_enough=proposed.enough,
            noise_from=self.noise.source,
            wandered=self._wandered(),
            null_vectors=null_vectors(self.search),
            splits=MappingProxyType(held),
            figures=iso_figures(self.observed.recording, arm, rules=self.rules) if self._whole_places() else (),
            residual_before=before,
            residual_after=after,
            corrected=corrected,
            notes=(
                *of_camera(self.prepared, self.refit.terms, self.noise),
                *unseen(self.prepared),
                *default_gravity(arm),
                *weights_by_torque(self.observed),
                *of_weights,
                *self.observed.alignment.undetermined,
                *recording.warnings,
                *self.noise.warnings,
                *notes,
                *self._notes(),
            ),
            seconds=time.perf_counter() - began,
            lack_of_fit=self.lack_of_fit,
            small=self.small,
            scatter=self._scatter(),
            rms_promised=rms_length(self._left_by_names()),
            recordings=each,
            differences=apart,
            origins=origins,
            shown=None if self.observed.view is None else self.observed.view.shown,
        )

    def _whole_places(self) -> bool:
        """Whether it is one recording, of the tip's whole place."""
        return not self.floors and self.observed.view is None

    def _recordings(self, before: Array, after: Array, rejected: Sequence[RejectedRow]) -> tuple[OfRecording, ...]:
        """What comes of each of several recordings, from the tip's residuals (N, D), m, before and after."""
        which = self.observed.which
        if which is None:
            return ()
        residuals = (before, after, hardest(self.held_out).residual(), self._from_others(which))
        forms = [self.prepared.columns[m] for m in self.outside]
        found = [np.zeros((*self.observed.residual.shape, 0)), *(term.columns for term in self.refit.terms), *forms]
        model = (self.prepared.beside, np.concatenate(found, axis=2))
        return of_recordings(self.observed, self.floors, residuals, model, rejected)

    def _with_arms(self, arm: Arm, each: tuple[OfRecording, ...]) -> tuple[OfRecording, ...]:
        """The recordings, each with the corrected arm of its own where they are of several arms."""
        several, which, left = self.observed.recording, self.observed.which, self._left_by_names()
        if not isinstance(several, Several) or not several.units:
            return each
        own = [corrected_arm(arm, self.refit, only=index, rules=self.rules.fitting)[0] for index in range(len(each))]
        return tuple(
            replace(
                one,
                corrected=with_weights(self.observed, own[index], several.names[index])[0],
                rms_promised=rms_length(left[which == index]),
            )
            for index, one in enumerate(each)
        )

    def _from_others(self, which: NDArray[np.int64]) -> Array:
        """The tip's residuals (N, D), m, of each recording by what the others say, its own frame still to be fitted."""
        held_out = self._held_out(which)
        left = np.zeros((self.observed.rows, self.observed.components))
        last = 1 + len(self.refit.terms) + len(self.outside)
        for index in np.unique(which).tolist():
            kept = told_without(index, [term.candidate for term in self.refit.terms], int(which.max()) + 1)
            parts = [0, *(1 + k for k in kept), *range(1 + len(self.refit.terms), last)]
            left[which == index] = held_out.residual(parts)[which == index]
        return left

    @property
    def _unexplained(self) -> bool:
        return bool(self.outside or self.left_over)

    @property
    def _anything(self) -> bool:
        return bool(self.members) or self._unexplained

    def _verdict(self) -> Verdict:
        if self.named is None:
            return "insufficient_data"
        if self._unexplained:
            return "unknown"
        if not self.members:
            return "none"
        return "alias_class" if any(self.alternatives) else "named"

    def _gate_p(self) -> float:
        if self.named is None:
            return 1.0
        return min(1.0, 2.0 * min(test.p_value for test in self.named.gate))

    def _left_by_names(self) -> Array:
        """What is left (N, D), m, where the forms' part is not taken off: no arm file can hold that."""
        width = self.observed.components
        if not self.outside:
            return self._after()
        moved = displacement(self.prepared, self.fitted, self.outside)
        return self._after() + beyond_nuisances(self.prepared, moved)[:, :width]

    def _findings(self) -> tuple[Finding, ...]:
        width = self.observed.components
        found: list[Finding] = []
        # Where neighbours tell as much as one, signs drawn for each visit give no p-value.
        p_values = self.p_values if self.prepared.together == 1 else ()
        whole = [*self.members, *self.outside]
        for place, member in enumerate(self.members):
            candidate = self.prepared.pool.groups[member].candidate
            others = tuple(self._alternative(rival) for rival in self.alternatives[place])
            own = recording_of(candidate, self.observed.recording)
            parameters = self.refit.parameters[place]
            rest = [m for m in whole if m != member]
            beside = tuple(self._place(other) for other in self.together.get(place, ()))
            nothing = may_be_nothing(parameters, self.refit.terms[place].candidate.sizes)
            without = remaining(self.prepared, fit(self.prepared, rest))[:, :width]
            found.append(
                Finding(
                    effect=candidate.effect,
                    at=candidate.numbers,
                    alternatives=others,
                    parameters=parameters,
                    rms_explained=self._moved([place]),
                    p_value=p_values[place] if place < len(p_values) else math.nan,
                    rms_without=rms_length(without),
                    rms_without_held_out=self._rms_held_out(rest),
                    reading=reading_of(
                        candidate.effect, candidate.numbers, parameters, others, own, beside, nothing=nothing
                    ),
                    recording=own,
                    together=beside,
                    evidence=self._evidence(place),
                    may_be_nothing=nothing,
                )
            )
        return tuple(sorted(found, key=lambda finding: -finding.rms_explained))

    def _evidence(self, place: int) -> float:
        """How much likelier (nats) the readings that were searched are with a finding than without it."""
        namer, whole = self.namer.with_prepared(self.search), [*self.found, *self.forms]
        rest = [member for member in whole if member != self.found[place]]
        return 0.5 * (namer.criterion_of(rest) - namer.criterion_of(whole)) / self.prepared.together

    def _place(self, place: int) -> tuple[str, tuple[int, ...]]:
        candidate = self.prepared.pool.groups[self.members[place]].candidate
        return candidate.effect, candidate.numbers

    def _causes(self) -> list[tuple[str, float]]:
        """The kinds of physics found, with what each moves (m), the largest first."""
        places: dict[str, list[int]] = {}
        for place, member in enumerate(self.members):
            cause = EFFECTS[self.prepared.pool.groups[member].candidate.effect].cause
            places.setdefault(cause, []).append(place)
        return sorted(((cause, self._moved(at)) for cause, at in places.items()), key=lambda each: -each[1])

    def _alternative(self, rival: Rival) -> Alternative:
        candidate = self.search.pool.groups[rival.member].candidate
        own = recording_of(candidate, self.search.observed.recording)
        return Alternative(candidate.effect, candidate.numbers, rival.likeness, rival.worse, own)

    def _joint_of_forms(self) -> int | None:
        for member in largest_first(self.prepared, self.fitted, self.outside):
            at = self.prepared.pool.groups[member].candidate.at
            if at:
                return at[0] + 1
        return None

    def _joint(self, shares: Sequence[float], of_form: int | None) -> int | None:
        """The joint that the strongest finding names, or a form that moves more; else the one whose motion alone
        describes clearly most."""
        if not self._anything:
            return None
        size = [self._moved([place]) for place in range(len(self.members))]
        beyond = displacement(self.prepared, self.fitted, self.outside)[:, : self.observed.components]
        if self.members and (of_form is None or max(size) >= rms_length(beyond)):
            candidate = self.prepared.pool.groups[self.members[int(np.argmax(size))]].candidate
            if len(candidate.at) == 1:
                return candidate.at[0] + 1
            return None
        if of_form is not None:
            return of_form
        ranked = sorted(shares, reverse=True)
        clear = len(ranked) == 1 or ranked[0] > ranked[1] + self.rules.answer.clearest
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

    def _detectable(self) -> tuple[Detectable, ...]:
        if self.named is None:
            return ()
        # What is left after the findings is scatter; the gate's own draws still hold what was found.
        test = self.named.gate[0] if self.named.left is None else self.named.left[0]
        return detectable(self.search, test, self.fitted.unit, self.rules.search.false_alarm)

    def _invisible(self) -> tuple[tuple[str, tuple[int, ...]], ...]:
        """What this recording cannot show: swallowed by the nuisances, or without a trace for want of a column."""
        shown = {group.candidate.family for group in self.search.pool.groups}
        swallowed = {c.family for c in self.search.pool.invisible if not c.outside} - shown
        found = {(effect, tuple(index + 1 for index in at)) for effect, at, *_ in swallowed}
        present = {effect for effect, *_ in shown} | {effect for effect, _ in found}
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
        p_value: float,
    ) -> str:
        if self.named is None:
            return self._too_few(rms_before)
        return verdict_sentence(
            findings,
            unknown,
            rms_before,
            self.what_remains(),
            p_value,
            self._causes(),
            scatter=self._scatter(),
            small=self.small,
        )

    def _too_few(self, rms_before: float) -> str:
        if self.observed.rows < self.rules.search.least_visits or not one_condition(self.observed):
            return "Too few readings: nothing can be told from this recording."
        floor = "" if self.noise.rms_m is None else f" (its readings differ by {mm(self.noise.rms_m)})"
        return (
            f"One pose, read {self.observed.rows} times: it is {mm(rms_before)} off there{floor}, and nothing tells "
            "why. What an arm lacks shows by how its error changes from pose to pose."
        )

    def _notes(self) -> tuple[str, ...]:
        found: list[str] = []
        if self.observed.recording.orientation is not None and self.observed.recording.seat == "unused":
            found.append("Orientations are left alone; `orientation: free` in recording.yaml has them fitted too.")
        if self.observed.wander > 0.0:
            timed = self.observed.recording.time is not None
            scale = rms_length(self.observed.scale[None, : self.observed.components])
            speed = mm(scale * float(np.sqrt(self.observed.wander * (60.0 if timed else 1.0))))
            walk = (
                f"a random walk of {speed} {'a minute' if timed else 'a reading'}, {mm(self._wandered())} RMS over the "
                "recording"
            )
            shown = seen_to_wander(self.observed, self._after())
            found.append(
                f"The instrument wanders, as {shown} shows: {walk}, which is no physics of the arm and was allowed for."
                if shown
                else f"The instrument may wander: {walk}, was allowed for, as what is left goes with time rather than "
                "with the pose. What changes with time in the arm looks like that too: come back to some poses during "
                "the recording, or read a fixed target as well, and it is seen which."
            )
        if self.prepared.together > 1:
            found.append(
                f"What is left goes with time as well as with the arm's path, {self.prepared.together} visits at a "
                "time: no pose far from the one before, and too few come back to, tell a wandering instrument from the "
                "arm. No p-value of a finding holds then, and none is given; come back to some poses during the "
                "recording."
            )
        if self.observed.correlation > 0.0:
            shared = f"correlation {self.observed.correlation:.2f}"
            by = "are off alike, by noise or by what is not explained" if self._unexplained else "share noise"
            found.append(f"Neighbouring readings {by} ({shared}), which was allowed for.")
        if self.left_over and self.members and self.lack_of_fit is not None and self._does_not_fit():
            found.append(refutation(self.lack_of_fit))
        if self.small is not None and self.lack_of_fit is not None:
            found.append(of_small_causes(self.small, self.lack_of_fit))
        found += [
            f"The {each} was beyond chance among the readings fitted, but those held out are told as well without it: "
            "left out again."
            for each in self.unconfirmed
        ]
        found += [f"Left out again, as it cannot be what it was named: {each}." for each in self.impossible]
        found += [f"Left out again, as it moves the tip by next to nothing: {each}." for each in self.too_little]
        if self.together:
            found.append(nothing_singly([self._place(k) for k in self.together], self._moved(list(self.together))))
        further = self._beyond_first_order()
        if further:
            found.append(
                f"What was found is so large that {1e3 * further:.2g} mm RMS of it lie beyond first order: that was "
                "allowed for here. Designs and worst cases (optimize, evaluate) are to first order, and evaluate says "
                "by how much that is off; put such a zero, length or tool into the arm file itself."
            )
        if self.may_scatter:
            found.append(
                f"{'No pose was' if self.noise.drift_m is None else 'Too few poses were'} come back to: what is left "
                "may also be that the arm does not return more exactly."
            )
        if self._scatter() is not None:
            found.append(
                "What is left is more than readings of one visit differ by, but it is not there again when a pose is "
                "visited again, or nothing recorded predicts it from pose to pose: the arm does not return more "
                "exactly than that, or the cause changes faster than these readings can follow. Visit some poses "
                "three times or more, with others between."
            )
        found += self._stray()
        if self.named is not None and self.named.left is not None and not self.outside:
            p = min(test.p_value for test in self.named.left)
            if p <= self.rules.search.false_alarm:
                found.append(f"What remains, {mm(rms_length(self._after()))} RMS, is more than chance (p = {p:.2g}).")
        return tuple(found)

    def _beyond_first_order(self) -> float:
        """The RMS length (m) of what was found moves the tip by beyond first order; nought where it does not matter."""
        further = rms_length(beyond_first_order(self.observed, self.observed.about)) if self.observed.about else 0.0
        scatter = rms_length(self.observed.scale[None, : self.observed.components])
        return further if further > self.rules.search.motion_matters * scatter else 0.0

    def _stray(self) -> list[str]:
        """What is said of readings that lie far off what is left by the middle ones, where they are too many to be set
        aside and no repeats bear the others out."""
        rules, width = self.rules.fitting, self.observed.components
        far_off = np.linalg.norm(self._after(), axis=1)
        scatter = float(np.median(far_off)) / np.sqrt(chi2.ppf(0.5, width))
        limit = rules.outlier_margin * np.sqrt(chi2.isf(rules.far_tail / len(far_off), width)) * scatter
        far = far_off > limit
        if self.named is None or scatter <= 0.0 or not rules.most_outliers < far.mean() < rules.most_alone:
            return []
        further, middle = mm(rms_length(self._after()[far])), mm(float(np.median(far_off)))
        recording = self.observed.recording
        rows = (
            recording.rows_of(recording.row[far].tolist())
            if isinstance(recording, Several)
            else rows_text(recording.row[far])
        )
        return [
            f"{int(far.sum())} of {len(far)} readings lie further off than scatter goes, {further} RMS, where the "
            f"middle one is {middle} off ({rows}): too many to be set aside with nothing to check them by. Read every "
            "pose three times, and bad readings show."
        ]


def _fitted(effect: str) -> bool:
    return any(parameter.role == "size" for parameter in EFFECTS[effect].parameters)
