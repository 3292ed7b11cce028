"""The diagnosis of motion logs: what a model lacks in the torques of a moving arm."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.effect import Effect
from linkwright.core.arm.motion.rigid import link_parameters
from linkwright.core.diagnose.judge.contradictions import contradictions
from linkwright.core.diagnose.options import Options, Progress, silent
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .causes.curves import curves_left
from .causes.rotors import with_rotors
from .causes.swinging import eigenfrequency_notes
from .corrected import entry_of
from .differing import Differing, differing, differing_findings, squares_of
from .each_log import of_log
from .encoders.between import Between, between_encoders
from .encoders.findings import encoder_findings, encoder_notes, with_like_encoders
from .encoders.load_rows import Torques
from .events.changed import change_of
from .events.found import next_event, set_aside
from .findings import finding_of, findings
from .judged import Judged, as_written, judged, rms_together
from .log import MotionLog
from .model.candidates import Candidates, acting, candidates, scanned, with_variants
from .model.entries import with_entries
from .model.identify import Identified, identify
from .model.intervals import Estimates, estimates
from .model.noise import noise
from .model.products import products
from .model.ripple import Ripple, ripples
from .model.rows import LogRows, joint_rows, log_rows, with_sources
from .preparation import PreparedLog, prepare
from .result import Event, MotionDiagnosis, MotionFinding, OfJoint
from .rollout.rollout import rollout
from .sentences import answer, event_words, verdict_of
from .unknown import Structure, since, structure, unknown_of, variables
from .uses.traces import traces_of
from .weighed import as_the_constants, load_words, weighed

_ALIKE = 0.5
"""Of two waves over the angles of a motion: they are one to it."""
_ROTORS = 2
"""Times that rotors are told by the whole library, beside what they showed of drives that give."""
_HELD_OUT = "Held out are the sizes: they were fitted to the rest of the motion. Names were chosen by all of it."
"""What figures on motion that was not fitted rest on."""
_ALONE = (
    "The arm file holds what all logs share, and figures are of that file. What one log alone has counts beside it "
    "in the choice of the file, and in what is left with it."
)
"""What figures of logs that differ rest on."""


@dataclass(frozen=True)
class RestsOn:
    """What a diagnosis rests on: what was identified, its sizes, and what differs between the logs."""

    identified: Identified
    sizes: Estimates
    different: Differing


@dataclass(frozen=True)
class _Left:
    """RMS (n,) N*m by joint: as given, of the file, of the file held out, of the names held out, and noise; NaN where a
    joint stood still."""

    before: Array
    after: Array
    held_out: Array
    of_named: Array
    floor: Array


def diagnose_motion(
    arm: Arm, logs: Sequence[MotionLog], options: Options | None = None, progress: Progress | None = None
) -> MotionDiagnosis:
    """What a model lacks in the torques of motion logs.

    Args:
        arm: The model; what its `effects` hold already counts.
        logs: Logs of the arm; several share their physics.
        options: Seed, effects left out of the candidates.
        progress: Hears of the steps.

    Returns:
        Names with sizes and intervals, alternatives, what stays unknown, RMS by joint, and the corrected arm.

    Raises:
        InputError: No log, a log without a stretch of a second, or with other joints than the arm.
    """
    return diagnosed(arm, logs, options, progress)[0]


def diagnosed(
    arm: Arm,
    logs: Sequence[MotionLog],
    options: Options | None = None,
    progress: Progress | None = None,
    events: tuple[Event, ...] = (),
) -> tuple[MotionDiagnosis, RestsOn | None]:
    """The same beside what it rests on; None where the logs hold too little. `events` are set aside in the logs."""
    begun, whole = time.perf_counter(), logs
    request, tell = options or Options(), progress or silent
    rules = request.rules
    tell("preparing logs", 0.0)
    logs, of_logs = with_like_encoders(logs)
    logs, prepared = _all_prepared(arm, logs, rules)
    if (
        np.sum([item.moving.sum(axis=0) * _spacing(item) for item in prepared], axis=0).max()
        < rules.motion.least_moving
    ):
        return _too_little(arm, logs, prepared, begun), None
    masses = link_parameters(arm)
    effects = [effect for effect in _effects(request, logs) if not (effect.drive.by_load and _two_encoders(prepared))]
    pool = candidates(
        arm, effects, prepared[0].motion, masses, rules.motion.of_a_sample / max(_rates(logs)), rules=rules
    )
    rows = []
    for number, each in enumerate(prepared):
        tell(f"fitting {Path(each.log.file).name}", 0.05 + 0.3 * number / len(prepared))
        rows.append(log_rows(each, pool, rules=rules))
    scans = scanned(effects)
    tell("fitting ripple by order", 0.35)
    heard = noise(pool, products(joint_rows(rows), pool.width, near=False))
    for _ in range(_ROTORS if any(each.motion.beyond_drive for each in prepared) else 0):
        pool, prepared = with_rotors(arm, effects, pool, prepared, masses, heard.sizes, rules=rules)
        rows = [log_rows(each, pool, rules=rules) for each in prepared]
        heard = noise(pool, products(joint_rows(rows), pool.width, near=False))
    event = next_event(arm, pool, rows, heard, events, rules=rules)
    if event is not None:
        return diagnosed(arm, set_aside(whole, rows, event), options, progress, (*events, event))
    ordered = [each for fast in (False, True) for each in _ripples(rows, heard.sizes, scans, request, fast=fast)]
    if proposed := {(item.joint, item.order): effect for effect, item in ordered}:
        known = pool
        more = [(effect, joint, {effect.shapes[0].name: order}) for (joint, order), effect in proposed.items()]
        pool = with_variants(pool, arm, masses, more, rules=rules)
        rows = [with_sources(row, pool.sources[len(known.sources) :]) for row in rows]
    given, different = rows, differing(arm, pool, rows, rules=rules)
    identified = identify(pool, different.rows, request.seed, tell, rules=rules)
    identified = _with_curves(arm, pool, identified, different.rows, prepared, request, tell)
    seen = [_structure(identified, joint, request) for joint in range(arm.size)]
    swift = [
        (effect, item)
        for effect, item in _ripples(identified.rows, identified.noise.sizes, scans, request, fast=True)
        if item.rms > rules.motion.turning * identified.torque[item.joint] and not _is_named(effect, item, identified)
    ]
    sizes = estimates(
        identified.system,
        identified.products,
        identified.noise.weights,
        identified.fitted,
        identified.spread,
        rules=rules,
    )
    tell("testing what is left", 0.95)
    judge = judged(arm, identified, sizes.numbers, [entry_of(effect, item) for effect, item in swift], rules=rules)
    sizes = as_written(sizes, identified, judge)
    rests_on = RestsOn(identified, sizes, different)
    shown = _between(judge, identified, request) if _two_encoders(prepared) else ()
    result = _result(arm, logs, given, rests_on, judge, seen, swift, events, shown, rules, begun)
    result = replace(result, notes=(*result.notes, *of_logs))
    if request.rollout:
        tell("simulating the logs", 0.97)
        rolled = rollout(arm, judge.written, identified.pool, given, identified.folds, rules=rules)
        result = replace(result, rollout=rolled, seconds=time.perf_counter() - begun)
    return result, rests_on


def _two_encoders(prepared: Sequence[PreparedLog]) -> bool:
    return all(log.motion.joint_side_rates is not None for log in prepared)


def _between(judge: Judged, identified: Identified, request: Options) -> tuple[Between, ...]:
    """What two encoders at each drive show, by the loads of the arm as it is written."""
    filed, folds, start = judge.written, list[NDArray[np.int64]](), 0
    for row in filed.rows:
        folds.append(identified.folds[row.block + start])
        start += int(row.block.max()) + 1
    torques = Torques(
        tuple(row.target - row.explained(filed.sizes) for row in filed.rows),
        tuple(row.prepared.moving for row in filed.rows),
        tuple(folds),
    )
    logs = [row.prepared for row in identified.rows]
    return between_encoders(filed.arm, logs, torques, request.without, rules=request.rules)


def _with_curves(
    arm: Arm,
    pool: Candidates,
    identified: Identified,
    rows: Sequence[LogRows],
    prepared: Sequence[PreparedLog],
    request: Options,
    tell: Progress,
) -> Identified:
    """What was identified, or what is with torques of any shape where these explain what nothing else does."""
    heard, rules = _heard(prepared), request.rules
    seen = [_structure(identified, joint, request) for joint in range(arm.size)]
    beyond = _beyond_noise(identified.noise.sigma, identified.torque, heard, rules)
    loud = np.logical_and(beyond, identified.noise.sigma > heard)
    curves = curves_left(arm, pool, seen, loud, _effects(request, [item.log for item in prepared]), rules=rules)
    while curves:
        wider = with_variants(pool, arm, link_parameters(arm), curves, rules=rules)
        more = [with_sources(row, wider.sources[len(pool.sources) :]) for row in rows]
        again = identify(wider, more, request.seed, tell, rules=rules)
        groups = [again.pool.groups[member.group] for member in again.members]
        new = [group for group in groups if pool.width <= group.columns[0] < wider.width]
        twice = {group.at for group in new if group.effect.recording.last_resort}
        # A curve that is not named would only hide what is left, and one that is named holds its waves.
        if all(group.effect.recording.last_resort or group.at not in twice for group in new):
            return again if new else identified
        curves = [each for each in curves if each[0].recording.last_resort or (each[1] + 1,) not in twice]
    return identified


def _ripples(
    rows: Sequence[LogRows],
    sizes: Array,
    scans: Sequence[tuple[Effect, Sequence[float]]],
    options: Options,
    *,
    fast: bool,
) -> list[tuple[Effect, Ripple]]:
    """The orders of scanned effects that stand out at each joint."""
    arm = rows[0].prepared.motion.arm
    return [
        (effect, ripple)
        for effect, orders in scans
        for joint, axis in enumerate(arm.joints)
        if effect.can_act(joint, revolute=axis.revolute, passive=axis.passive)
        for ripple in ripples(rows, sizes, orders, joint, options.seed, fast=fast, rules=options.rules)
    ]


def _is_named(effect: Effect, ripple: Ripple, identified: Identified) -> bool:
    """Whether a name holds an order, or one that this motion hardly tells from it."""
    angle = np.concatenate([rows.prepared.motion.q[rows.prepared.kept, ripple.joint] for rows in identified.rows])
    orders = [
        group.shapes[effect.shapes[0].name] - ripple.order
        for group in (identified.pool.groups[member.group] for member in identified.members)
        if group.effect is effect and group.at == (ripple.joint + 1,)
    ]
    return any(abs(np.mean(np.exp(1j * apart * angle))) > _ALIKE for apart in orders)


def _effects(options: Options, logs: Sequence[MotionLog]) -> list[Effect]:
    """The effects that such logs may show."""
    every = acting(voltages=all(log.drive.of_voltage for log in logs))
    return [effect for effect in every if effect.id not in options.without]


def _all_prepared(arm: Arm, logs: Sequence[MotionLog], rules: Rules) -> tuple[Sequence[MotionLog], list[PreparedLog]]:
    """The logs, currents as torques, and the same prepared."""
    prepared = [prepare(arm, log, rules=rules) for log in logs]
    if not prepared:
        raise InputError("", "", "no motion log; name at least one")
    if any(log.torque_constants_free for log in logs):
        logs = weighed(arm, prepared, rules=rules)
        prepared = [prepare(arm, log, rules=rules) for log in logs]
    return logs, prepared


def _structure(identified: Identified, joint: int, options: Options) -> Structure:
    """What depends on something of what the whole library leaves of a joint's torque, over all logs."""
    residual, number, parts = [], [], []
    for log, rows in enumerate(identified.rows):
        use = rows.prepared.moving[:, joint]
        rows_here = rows.prepared.kept[use]
        motion = rows.prepared.motion
        residual.append((rows.target[:, joint] - rows.design[joint] @ identified.noise.sizes[rows.columns[joint]])[use])
        number.append(np.full(len(rows_here), log))
        temperature = None if motion.temperature is None else motion.temperature[rows_here]
        parts.append(
            variables(
                joint,
                motion.q[rows_here],
                motion.velocity[rows_here],
                motion.acceleration[rows_here],
                rows.nominal[rows_here],
                motion.time[rows_here],
                temperature,
            )
        )
    names = set.intersection(*(set(part) for part in parts))
    joined = {name: np.concatenate([part[name] for part in parts]) for name in parts[0] if name in names}
    way = np.sign(joined["speed"])
    return structure(np.concatenate(residual), way, np.concatenate(number), joined, options.seed, rules=options.rules)


def _result(
    arm: Arm,
    logs: Sequence[MotionLog],
    given: Sequence[LogRows],
    rests_on: RestsOn,
    judge: Judged,
    seen: Sequence[Structure],
    swift: Sequence[tuple[Effect, Ripple]],
    events: tuple[Event, ...],
    shown: Sequence[Between],
    rules: Rules,
    begun: float,
) -> MotionDiagnosis:
    identified, sizes, different = rests_on.identified, rests_on.sizes, rests_on.different
    prepared, squares = [row.prepared for row in given], squares_of(given, identified.pool.width)
    written, counts = judge.written, judge.counts
    left, heard = _left_by_joint(identified, judge, squares), _heard(prepared)
    per_joint = tuple(_of_joint(joint, left, identified, seen[joint], rules) for joint in range(arm.size))
    every = (
        *differing_findings(different, identified.pool, rules=rules),
        *findings(identified, sizes, judge, arm, rules=rules),
        *(finding_of(effect, item, left.held_out) for effect, item in swift),
    )
    every = (as_the_constants(item, logs, rules) for item in every)
    of_torques = tuple(sorted(every, key=lambda item: item.small))
    of_encoders = encoder_findings(arm, shown, left.held_out.tolist())
    named = (*of_encoders, *of_torques)
    small = {(item.effect, item.at) for item in named if item.small}
    together = tuple(judge.added_by(small, identified.pool).tolist())
    far = _far_from_floor(of_torques, left, identified.torque, rules)
    unexplained = {*_misleading(named, left), *far, *_open_joints(per_joint, seen, identified, heard, rules)}
    stays = {joint: float(left.of_named[joint - 1]) for joint in far}
    unknown = unknown_of(sorted(unexplained), seen, per_joint, stays)
    change = None if unknown is None else change_of(identified, rules=rules)
    if unknown is not None and change is not None:
        unknown = since(unknown, change)
    verdict = verdict_of(named, unknown, events)
    with_own = rms_together(judge.named.beside[1], counts) if different.differences else None
    return MotionDiagnosis(
        arm=arm,
        logs=tuple(logs),
        verdict=verdict,
        sentence=" ".join(
            [
                *map(event_words, events),
                answer(verdict, named, unknown, per_joint, judge.rivals, different.beyond, with_own, together),
                *load_words(named, logs),
            ]
        ),
        per_joint=per_joint,
        findings=named,
        unknown=unknown,
        rms_before=_together(left.before),
        rms_after=_together(left.after),
        rms_held_out=_together(left.held_out),
        noise_floor=_together(left.floor),
        gate_p=min(identified.gate_p, *(item.p_value for item in named if item.recording or item.apart), 1.0),
        split=identified.split,
        cutoff=prepared[0].low_pass,
        rates=_rates(logs),
        traces=tuple(traces_of(*rows, written.sizes, written.arm) for rows in zip(given, written.rows, strict=True)),
        of_logs=tuple(of_log(identified, judge, squares, number) for number in range(len(logs))),
        corrected=with_entries(written.arm, [entry for item in shown for entry in item.entries]),
        notes=(
            *_contradictions(arm, identified.split, left.after, left.held_out, heard, rules),
            _HELD_OUT,
            *([_ALONE] if different.differences else []),
            *_sparse(prepared),
            *encoder_notes(arm, prepared, shown),
            *eigenfrequency_notes(written.arm, named, [item.motion for item in prepared]),
        ),
        rivals=judge.rivals,
        beyond=different.beyond,
        small_together=together,
        rms_with_own=None if with_own is None else (rms_together(written.beside[0], counts), with_own),
        seconds=time.perf_counter() - begun,
        events=events,
    )


def _left_by_joint(identified: Identified, judge: Judged, squares: Array) -> _Left:
    counts = judge.counts
    squared = (squares, judge.written.left, judge.written.held_out, judge.named.beside[1])
    rms = (np.sqrt(each.sum(axis=0) / np.maximum(counts.sum(axis=0), 1)) for each in squared)
    # Nobody knows what a model is worth at a joint that stood still.
    return _Left(*(np.where(counts.sum(axis=0) > 0, each, np.nan) for each in (*rms, identified.noise.sigma)))


def _of_joint(joint: int, left: _Left, identified: Identified, seen: Structure, rules: Rules) -> OfJoint:
    return OfJoint(
        joint + 1,
        float(left.before[joint]),
        float(left.after[joint]),
        float(left.held_out[joint]),
        float(left.floor[joint]),
        float(left.held_out[joint] / identified.torque[joint]),
        seen.names if seen.p_value <= rules.residual.level else (),
        seen.p_value,
    )


def _open_joints(
    per_joint: Sequence[OfJoint], seen: Sequence[Structure], identified: Identified, heard: Array, rules: Rules
) -> list[int]:
    """The joints (from 1) of which more is left than noise, or something that depends on the motion."""
    floor = np.array([item.floor for item in per_joint])
    beyond = _beyond_noise(floor, identified.torque, heard, rules)
    least = np.minimum(rules.motion.unexplained * identified.torque, heard)
    return [
        item.joint
        for item, what, large in zip(per_joint, seen, beyond.tolist(), strict=True)
        if large or (item.depends_on and item.floor * max(what.shares) ** 0.5 > least[item.joint - 1])
    ]


def _misleading(named: Sequence[MotionFinding], left: _Left) -> list[int]:
    """The joints (from 1) at which what is named foretells no other motion, and so is not what is there."""
    claimed = np.sqrt(sum((np.square(item.rms_explained) for item in named), np.zeros(len(left.before))))
    return (np.flatnonzero((claimed > 0.5 * left.before) & (left.of_named > left.before)) + 1).tolist()


def _far_from_floor(named: Sequence[MotionFinding], left: _Left, torque: Array, rules: Rules) -> list[int]:
    """The joints (from 1) at which the names leave far more of other motion than the whole library leaves: a few names
    are not what is there, and many together say nothing."""
    if not named:
        return []
    most = np.maximum(rules.motion.above_noise * left.floor, rules.motion.filters * torque)
    return (np.flatnonzero(left.of_named > most) + 1).tolist()


def _heard(prepared: Sequence[PreparedLog]) -> Array:
    """The noise (n,) N*m that the sensors are heard to have."""
    return np.asarray(np.sqrt(np.mean([np.square(log.noise()) for log in prepared], axis=0)))


def _beyond_noise(floor: Array, torque: Array, heard: Array, rules: Rules) -> Array:
    """At which joints (n,) so much is left that it is no noise."""
    share = floor / torque
    beyond = (share > rules.motion.unexplained) & (
        share > np.minimum(rules.motion.uneven * np.nanmedian(share), rules.motion.never_noise)
    )
    # What depends on something is no noise where it is as loud as the noise that the sensors are heard to have.
    above = np.maximum(rules.motion.above_noise * heard, rules.motion.filters * torque)
    return beyond | (floor > above)  # well above what the sensors are heard to have, it is physics, if small


def _contradictions(arm: Arm, split: str, after: Array, held: Array, heard: Array, rules: Rules) -> tuple[str, ...]:
    """What held-out motion contradicts, at the joint that it is worst at where all together do not."""
    worst = int(np.nanargmax(held / after))
    unit = "N*m" if arm.joints[worst].revolute else "N"
    whole = contradictions(_together(after), {split: _together(held)}, "{:.3g} N*m".format, rules=rules)
    of_joint = contradictions(
        float(after[worst]), {split: float(held[worst])}, f"{{:.3g}} {unit}".format, rules=rules, noise=heard[worst]
    )
    return whole or tuple(f"Joint {worst + 1}: {line[0].lower()}{line[1:]}" for line in of_joint)


def _too_little(arm: Arm, logs: Sequence[MotionLog], prepared: Sequence[PreparedLog], begun: float) -> MotionDiagnosis:
    """The result of logs in which no joint moves long enough."""
    nan = float("nan")
    return MotionDiagnosis(
        arm=arm,
        logs=tuple(logs),
        verdict="insufficient_data",
        sentence=answer("insufficient_data", (), None, ()),
        per_joint=tuple(OfJoint(joint + 1, nan, nan, nan, nan, nan) for joint in range(arm.size)),
        findings=(),
        unknown=None,
        rms_before=nan,
        rms_after=nan,
        rms_held_out=nan,
        noise_floor=nan,
        gate_p=1.0,
        split="",
        cutoff=prepared[0].low_pass,
        rates=_rates(logs),
        traces=(),
        of_logs=(),
        corrected=arm,
        notes=_sparse(prepared),
        seconds=time.perf_counter() - begun,
    )


def _sparse(prepared: Sequence[PreparedLog]) -> tuple[str, ...]:
    """What samples that are far apart do not tell, log by log."""
    return tuple(
        f"{Path(item.log.file).name}: samples {1.0 / item.rate:.3g} s apart show {100.0 * item.motion.sampled:.0f} % "
        "of how fast things change. Inertia, delays and resonances count by this share, and speeds as logged."
        for item in prepared
        if item.motion.sampled < 1.0
    )


def _rates(logs: Sequence[MotionLog]) -> tuple[float, ...]:
    return tuple(1.0 / log.interval for log in logs)


def _together(each: Array) -> float:
    return float(np.sqrt(np.nanmean(np.square(each))))


def _spacing(prepared: PreparedLog) -> float:
    times = prepared.motion.time[prepared.kept]
    return float(np.median(np.diff(times))) if len(times) > 1 else 0.0
