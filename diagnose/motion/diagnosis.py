"""The diagnosis of motion logs: what a model lacks in the torques of a moving arm."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.effect import Effect
from linkwright.core.arm.motion.rigid import link_parameters
from linkwright.core.diagnose.options import Options, Progress, silent
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .causes.curves import curves_left
from .causes.rotors import with_rotors
from .conclusion import RestsOn, conclusion, too_little
from .corrected import entry_of
from .differing import differing
from .encoders.between import Between, between_encoders
from .encoders.findings import with_like_encoders
from .encoders.load_rows import Torques
from .events.found import next_event, set_aside
from .judged import Judged, as_written, judged
from .log import MotionLog
from .model.candidates import Candidates, acting, candidates, scanned, with_variants
from .model.identify import Identified, identify
from .model.intervals import estimates
from .model.noise import Noise, noise
from .model.products import products
from .model.ripple import Ripple, ripples
from .model.rows import LogRows, joint_rows, log_rows, with_sources
from .preparation import PreparedLog, prepare
from .result import Event, MotionDiagnosis
from .rollout.rollout import rollout
from .unknown import beyond_noise, residual_structures, sensor_noise
from .weighed import weighed

_ALIKE = 0.5
"""Of two waves over the angles of a motion: they are one to it."""
_ROTORS = 2
"""Times that rotors are told by the whole library, beside what they showed of drives that give."""


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
    arm: Arm, logs: Sequence[MotionLog], options: Options | None = None, progress: Progress | None = None
) -> tuple[MotionDiagnosis, RestsOn | None]:
    """The same beside what it rests on; None where the logs hold too little."""
    begun = time.perf_counter()
    result, rests_on = _diagnosed(arm, logs, options or Options(), progress or silent)
    return replace(result, seconds=time.perf_counter() - begun), rests_on


def _diagnosed(
    arm: Arm, whole: Sequence[MotionLog], request: Options, tell: Progress, events: tuple[Event, ...] = ()
) -> tuple[MotionDiagnosis, RestsOn | None]:
    """The diagnosis of whole logs, in which `events` are set aside."""
    rules = request.rules
    tell("preparing logs", 0.0)
    logs, notes = with_like_encoders(whole)
    prepared = _all_prepared(arm, logs, rules)
    if np.sum([_moving_time(each) for each in prepared], axis=0).max() < rules.motion.least_moving:
        return too_little(arm, prepared), None
    effects = [each for each in _effects(request, prepared) if not (each.drive.by_load and _two_encoders(prepared))]
    library = _library_fit(arm, effects, prepared, tell, rules)
    event = next_event(arm, library.pool, library.rows, library.noise, events, rules=rules)
    if event is not None:
        return _diagnosed(arm, set_aside(whole, library.rows, event), request, tell, (*events, event))
    scans = scanned(effects)
    pool, given = _with_ripples(arm, library, scans, request)
    different = differing(arm, pool, given, rules=rules)
    identified = identify(pool, different.rows, request.seed, tell, rules=rules)
    identified = _with_curves(arm, pool, identified, different.rows, request, tell)
    seen = residual_structures(identified, request)
    fast = _fast_ripples(identified, scans, request)
    sizes = estimates(
        identified.system,
        identified.products,
        identified.noise.weights,
        identified.fitted,
        identified.spread,
        rules=rules,
    )
    tell("testing what is left", 0.95)
    judge = judged(arm, identified, sizes.numbers, [entry_of(effect, item) for effect, item in fast], rules=rules)
    sizes = as_written(sizes, identified, judge)
    shown = _between(judge, identified, request) if _two_encoders(prepared) else ()
    rests_on = RestsOn(given, identified, sizes, different, judge, seen, fast, shown)
    result = conclusion(arm, rests_on, events, notes, rules=rules)
    if request.rollout:
        tell("simulating the logs", 0.97)
        rolled = rollout(arm, judge.written, identified.pool, given, identified.folds, rules=rules)
        result = replace(result, rollout=rolled)
    return result, rests_on


@dataclass(frozen=True)
class _LibraryFit:
    """The whole library fitted to all logs: its candidates, the logs' rows, and the noise that it leaves of them."""

    pool: Candidates
    rows: Sequence[LogRows]
    noise: Noise


def _library_fit(
    arm: Arm, effects: Sequence[Effect], prepared: Sequence[PreparedLog], tell: Progress, rules: Rules
) -> _LibraryFit:
    """The fit; where drives give and encoders are behind them, by the rotors that it shows itself."""
    masses, clock = link_parameters(arm), rules.motion.of_a_sample / max(1.0 / each.log.interval for each in prepared)
    pool = candidates(arm, effects, prepared[0].motion, masses, clock, rules=rules)
    rows = []
    for number, each in enumerate(prepared):
        tell(f"fitting {Path(each.log.file).name}", 0.05 + 0.3 * number / len(prepared))
        rows.append(log_rows(each, pool, rules=rules))
    tell("fitting ripple by order", 0.35)
    heard = noise(pool, products(joint_rows(rows), pool.width, near=False))
    for _ in range(_ROTORS if any(each.motion.beyond_drive for each in prepared) else 0):
        pool, prepared = with_rotors(arm, effects, pool, prepared, masses, heard.sizes, rules=rules)
        rows = [log_rows(each, pool, rules=rules) for each in prepared]
        heard = noise(pool, products(joint_rows(rows), pool.width, near=False))
    return _LibraryFit(pool, rows, heard)


def _widened(
    arm: Arm,
    pool: Candidates,
    rows: Sequence[LogRows],
    more: Sequence[tuple[Effect, int, Mapping[str, float]]],
    rules: Rules,
) -> tuple[Candidates, list[LogRows]]:
    """Candidates with more effects at joints (from 0), and the rows with their columns."""
    wider = with_variants(pool, arm, link_parameters(arm), more, rules=rules)
    return wider, [with_sources(row, wider.sources[len(pool.sources) :]) for row in rows]


def _with_ripples(
    arm: Arm, library: _LibraryFit, scans: Sequence[tuple[Effect, Sequence[float]]], request: Options
) -> tuple[Candidates, Sequence[LogRows]]:
    """The candidates with the orders of ripple that stand out, and the rows with their columns."""
    proposed = {
        (item.joint, item.order): effect
        for fast in (False, True)
        for effect, item in _ripples(library.rows, library.noise.sizes, scans, request, fast=fast)
    }
    if not proposed:
        return library.pool, library.rows
    more = [(effect, joint, {effect.shapes[0].name: order}) for (joint, order), effect in proposed.items()]
    return _widened(arm, library.pool, library.rows, more, request.rules)


def _fast_ripples(
    identified: Identified, scans: Sequence[tuple[Effect, Sequence[float]]], request: Options
) -> list[tuple[Effect, Ripple]]:
    """The ripples beyond the low-pass that make a share of their joint's torque, and that no name holds."""
    return [
        (effect, item)
        for effect, item in _ripples(identified.rows, identified.noise.sizes, scans, request, fast=True)
        if item.rms > request.rules.motion.turning * identified.torque[item.joint]
        and not _is_named(effect, item, identified)
    ]


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
    arm: Arm, pool: Candidates, identified: Identified, rows: Sequence[LogRows], request: Options, tell: Progress
) -> Identified:
    """What was identified, or what is with torques of any shape where these explain what nothing else does."""
    rules, prepared = request.rules, [row.prepared for row in rows]
    heard = sensor_noise(prepared)
    beyond = beyond_noise(identified.noise.sigma, identified.torque, heard, rules)
    loud = np.logical_and(beyond, identified.noise.sigma > heard)
    effects, left = _effects(request, prepared), residual_structures(identified, request)
    curves = curves_left(arm, pool, left, loud, effects, rules=rules)
    while curves:
        wider, more = _widened(arm, pool, rows, curves, rules)
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


def _effects(options: Options, prepared: Sequence[PreparedLog]) -> list[Effect]:
    """The effects that such logs may show."""
    every = acting(voltages=all(each.log.drive.of_voltage for each in prepared))
    return [effect for effect in every if effect.id not in options.without]


def _all_prepared(arm: Arm, logs: Sequence[MotionLog], rules: Rules) -> list[PreparedLog]:
    """The logs prepared, currents as torques."""
    prepared = [prepare(arm, log, rules=rules) for log in logs]
    if not prepared:
        raise InputError("", "", "no motion log; name at least one")
    if any(log.torque_constants_free for log in logs):
        logs = weighed(arm, prepared, rules=rules)
        prepared = [prepare(arm, log, rules=rules) for log in logs]
    return prepared


def _moving_time(prepared: PreparedLog) -> Array:
    """How long (n,) s each joint moves steadily."""
    times = prepared.motion.time[prepared.kept]
    return prepared.moving.sum(axis=0) * (float(np.median(np.diff(times))) if len(times) > 1 else 0.0)
