"""The steps in order: noise floor, nuisances, gate, location, names, tests, confirmation, what cannot be
distinguished."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.diagnose.answer.conclusion import Conclusion
from linkwright.core.diagnose.answer.confirmation import Confirmed
from linkwright.core.diagnose.answer.sentences import label_of, of_branches, put_right
from linkwright.core.diagnose.answer.torques import of_torque_loads, of_unknown_weights
from linkwright.core.diagnose.first_look.zeros import refuse_another_zero
from linkwright.core.diagnose.fitting.geometry import about_geometry
from linkwright.core.diagnose.fitting.loads.torque_loads import loads_by_torque
from linkwright.core.diagnose.fitting.origins import located
from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options, Progress, silent
from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.free_origins import turned_by, with_origins_of
from linkwright.core.diagnose.residual.masses_from_torques import weighed_by_torque
from linkwright.core.diagnose.residual.noise import NoiseFloor, noise_floor
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.residual.orientation import with_sound_orientation
from linkwright.core.diagnose.residual.visits import one_condition, visits
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.diagnose.search.coupling import coupled, may_couple, through_what_is_named
from linkwright.core.diagnose.search.labels import mislabelled
from linkwright.core.diagnose.search.large_motions import ROUNDS, about_large, candidates_of
from linkwright.core.diagnose.search.mass_consistency import under_one_set
from linkwright.core.diagnose.search.naming import Named, Namer, name_missing
from linkwright.core.diagnose.search.set_aside import alike, asked_again, with_figures
from linkwright.core.diagnose.several.floors import floor_of_all
from linkwright.core.diagnose.several.recordings import Several

from .other_arms import of_different_arms, of_other_arms


class _SoFar:
    """Tells of the steps and, from the first findings on, of what is found until then: that is read while the rest is
    sought, and may still turn out otherwise."""

    def __init__(self, tell: Progress) -> None:
        self._tell, self._provisional = tell, ""

    def __call__(self, what: str, share: float) -> None:
        """`what` is being done now."""
        self._tell(f"{self._provisional}{what}", share)

    def provisional(self, namer: Namer, members: Sequence[int]) -> None:
        """What is named now, that by its name which explains most alone; nothing where it was given up again."""
        self._provisional = ""
        if members:
            alone = namer.prepared.products.gains()
            (first,) = candidates_of(namer, [max(members, key=lambda member: alone[member])])
            more = f" and {len(members) - 1} more" if len(members) > 1 else ""
            self._provisional = f"provisional: {label_of(first, namer.prepared.observed.recording)}{more}; "


def diagnose(
    arm: Arm, recording: Recording, options: Options | None = None, progress: Progress | None = None
) -> Diagnosis:
    """What an arm's model lacks, by a recording of the real arm, or by several of them (`Several`) at once.

    Raises `arm.bodies.beams.PropertyNeeded` and the materials' errors where the model lacks a figure that it needs.
    """
    request, tell = options or Options(), progress or silent
    rules = request.rules
    shown = weighed_by_torque(arm, recording, rules=rules.residual)
    arm = arm if shown is None else shown.arm
    loads, before = loads_by_torque(arm, recording, rules.residual), recording
    arm, recording = (arm, recording) if loads is None else (loads.arm, loads.recording)
    if arm.unknown_origins:
        tell("finding the fixed transforms that are free", 0.0)
    placed = located(arm, recording, rules=rules)
    diagnosis = _diagnosed(placed, recording, request, tell)
    for _ in range(2 if arm.unknown_origins else 0):
        again = with_origins_of(placed, diagnosis.corrected)
        if turned_by(placed, again) ** 2 * sum(arm.lengths) <= rules.search.motion_matters * diagnosis.rms_after:
            break
        placed = again
        diagnosis = _diagnosed(placed, recording, request, tell)
    if loads is not None:
        as_recorded = loads.as_recorded(diagnosis.recording, before)
        notes = (*of_torque_loads(loads, rules.residual), *diagnosis.notes)
        diagnosis = replace(diagnosis, recording=as_recorded, notes=notes)
    return diagnosis if shown is None else replace(diagnosis, notes=(*of_unknown_weights(shown), *diagnosis.notes))


def _diagnosed(arm: Arm, recording: Recording, options: Options, hear: Progress) -> Diagnosis:
    """What an arm's model lacks, its free transforms about where they stand."""
    began, tell = time.perf_counter(), _SoFar(hear)
    tell("estimating the noise floor", 0.0)
    rules = options.rules
    recording, noise, cleaned, floors = cleaned_of(arm, recording, rules)
    tell("setting the recording against the model", 0.05)
    searched = _thinned(arm, cleaned, options)
    enough = noise.degrees_of_freedom >= rules.fitting.enough
    known = noise.rms_m if noise.source == "repeats" and enough else None
    about_zeros = about_geometry(observe(arm, searched, rules=rules), options.without, known)
    prepared = prepare(about_zeros, options, known)
    if not isinstance(searched, Several):
        refuse_another_zero(arm, searched, prepared, options, known)
    if not floors and len(prepared.rejected) > rules.fitting.most_outliers * searched.size:
        noise = _less_doubtful(noise, noise_floor(prepared.observed.recording, arm, rules=rules.residual))
    tell("searching for what is missing", 0.3)
    namer = Namer(prepared, thorough=options.thorough, seed=options.seed)

    def anew(entries: tuple[EffectEntry, ...], before: Sequence[Candidate] | None = None) -> Namer:
        observed = observe(arm, searched, about=entries, rules=rules)
        again = prepare(observed, options, known, named=before)
        return Namer(again, thorough=options.thorough, seed=options.seed)

    def about(entries: tuple[EffectEntry, ...], before: Sequence[Candidate]) -> tuple[Namer, Named]:
        tell("searching again about what was found", 0.6)
        other = anew(entries)
        return other, name_missing(other, lambda _: None, before)

    def sought(namer: Namer, named: Named) -> tuple[Namer, Named]:
        tell.provisional(namer, named.members)
        if min(test.p_value for test in named.gate) <= rules.search.false_alarm:
            namer, named = about_large(namer, named, about)
        if may_couple(namer, named):
            again = coupled(namer, options.without, lambda part: tell("fitting loads", 0.6 + 0.05 * part))
            if again is not namer:
                before = candidates_of(namer, named.members)
                namer = again
                named = name_missing(namer, lambda share: tell("searching again", 0.65 + 0.05 * share), before)
            namer, named = through_what_is_named(namer, named, options.without, lambda _: tell("searching again", 0.69))
            named = under_one_set(namer, named, lambda _: tell("searching again", 0.69))
            tell.provisional(namer, named.members)
        return namer, named

    def whole_about(near: Observed) -> Observed:
        return observe(arm, searched, about=near.about, softening=near.softening, rules=rules)

    too_few = int(prepared.visits[-1]) + 1 < rules.search.least_visits
    too_few |= prepared.criterion.count < rules.search.least_observations
    nothing = not prepared.pool.groups or one_condition(prepared.observed)
    # The namer goes on with pools of its own; of a long recording this one is hundreds of megabytes.
    logged = prepared.observed
    del prepared
    if nothing or too_few:
        named = None
    else:
        searching = "searching for what is missing"
        named = name_missing(namer, lambda share: tell(searching, 0.3 + 0.3 * share), accepted=tell.provisional)
        namer, named = sought(namer, named)
        for _ in range(ROUNDS):
            if named.outside or not namer.prepared.rejected:
                break
            asked = asked_again(namer, named, whole_about(namer.prepared.observed), options, known)
            if asked.same:
                namer = with_figures(namer, asked.aside)
                break
            tell("searching again with other rows set aside", 0.69)
            entries = namer.prepared.observed.about
            del namer  # one pool at a time
            namer = anew(entries, asked.shaped)
            logged = namer.prepared.observed
            named = name_missing(namer, lambda _: None, asked.shaped, few=True)
            namer, named = sought(namer, named)
    aside = namer.prepared.rejected
    in_common = alike(whole_about(namer.prepared.observed), aside, options.seed) if aside else None
    tell("fitting and confirming", 0.7)
    whole = cleaned if len(searched.q) < len(cleaned.q) else None
    names = Confirmed(namer, named, noise, options, whole=whole, progress=tell, floors=floors, alike=in_common)
    diagnosis = Conclusion(names).result(arm, recording, began)
    diagnosis = replace(diagnosis, sentence=diagnosis.sentence + of_branches(arm, diagnosis.findings))
    if not isinstance(searched, Several):
        return _with_labels(diagnosis, logged, searched, options, known, tell)
    if searched.units or diagnosis.unknown is None:
        return diagnosis
    other = of_different_arms(arm, searched, options, known, diagnosis.rms_promised)
    if other is None:
        return diagnosis
    return replace(diagnosis, sentence=f"{of_other_arms(other)} {diagnosis.sentence}", other_arms=other)


def cleaned_of(
    arm: Arm, recording: Recording, rules: Rules
) -> tuple[Recording, NoiseFloor, Recording, tuple[NoiseFloor, ...]]:
    """The recording with sound orientations, its noise floor, and the readings that do not stand out from repeats; of
    several recordings each by itself, and each one's floor."""
    if isinstance(recording, Several):
        cleaned_parts = [cleaned_of(arm, item, rules) for item in recording.each]
        again = recording.of_parts([cleaned for _, _, cleaned, _ in cleaned_parts], arm, rules.residual)
        floors = tuple(noise for _, noise, _, _ in cleaned_parts)
        return again, floor_of_all(floors, again), again, floors
    arm = arm.on(recording.branch)
    recording = with_sound_orientation(arm, recording, rules=rules.residual)
    noise = noise_floor(recording, arm, rules=rules.residual)
    return recording, noise, _once_each(_without(recording, noise), arm, noise, rules), ()


def _with_labels(
    diagnosis: Diagnosis, logged: Observed, recording: Recording, options: Options, known: float | None, tell: Progress
) -> Diagnosis:
    """The result with what labels seem to be wrong, where it has no explanation of its own."""
    if known is None or (diagnosis.unknown is None and diagnosis.scatter is None):
        return diagnosis
    wrong = mislabelled(
        logged,
        recording,
        options,
        known,
        diagnosis.rms_promised,
        lambda share: tell("correcting labels", 0.96 + 0.04 * share),
    )
    if wrong is None:
        return diagnosis
    sentence = f"It looks as if {wrong.said}: with that put right, {put_right(wrong)}."
    return replace(diagnosis, labels=wrong, sentence=f"{diagnosis.sentence} {sentence}")


def _thinned(arm: Arm, recording: Recording, options: Options) -> Recording:
    """Whole visits of a long recording, picked at random: what to look for is plain from a few thousand readings."""
    longest = options.rules.search.longest
    observations = recording.tip.size
    if observations <= longest:
        return recording
    visit = visits(recording, arm, rules=options.rules.residual)
    share = longest / observations
    taken = np.random.default_rng(options.seed).random(int(visit[-1]) + 1) < share
    return recording.kept(taken[visit])


def _once_each(recording: Recording, arm: Arm, noise: NoiseFloor, rules: Rules) -> Recording:
    """One reading of each visit where repeats are rounded alike: they are off together, and tell nothing more."""
    if noise.resolution is None:
        return recording
    visit = visits(recording, arm, rules=rules.residual)
    return recording.kept(np.concatenate([[True], np.diff(visit) != 0]))


def _less_doubtful(before: NoiseFloor, after: NoiseFloor) -> NoiseFloor:
    """The noise floor once many readings were set aside beside a model: of pairs that disagreed it is known then which
    reading was wrong."""
    return replace(after, outliers=before.outliers) if after.rms_m is not None else before


def _without(recording: Recording, noise: NoiseFloor) -> Recording:
    """The recording without the rows that stand out from repeats of their pose."""
    bad = {outlier.row for outlier in noise.outliers}
    return recording.kept(np.array([int(row) not in bad for row in recording.row]))
