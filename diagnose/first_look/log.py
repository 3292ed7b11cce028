"""Whether coordinates, speeds and torques of a motion log tell of the same motion, and of this arm.

A log is refused with the settings that would put it right where they leave plainly less; what dynamics cannot tell
apart is told beside it. Torques that were clipped are no torques, and speeds that lag are taken from the coordinates.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.reading.foreign.headers import Headers
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.lists import rows_text
from linkwright.core.units.quantities import InputError

from .smoothing import moving_average
from .units import refuse_grams
from .weights import look_at_weights, refuse_millimetres

_DEGREE = math.degrees(1.0)
_FINER = MappingProxyType({"ms": 1e3, "us": 1e6, "ns": 1e9})
_NEXT = 4
"""Values beside an extreme, which a torque that is not clipped holds about as often."""


def look_at_logs(logs: Sequence[tuple[MotionLog, Headers]], arm: Arm, rules: Rules) -> tuple[MotionLog, ...]:
    """Logs of one arm, less clipped torques and speeds that lag, with sentences on what is doubted.

    Args:
        logs: Each log, its samples checked, and the header of each of its columns by name (`q1`: `q1_rad`).
        arm: The arm; where a link's mass is not known, or nothing weighs, its torques tell nothing.
        rules: What counts as plainly wrong.

    Raises:
        InputError: A log is plainly meant otherwise, with what to write.
    """
    done: list[tuple[MotionLog, Headers]] = []
    for log, headers in logs:
        refuse_grams(log.file, log.payload_mass, arm, headers, rules)
        torques = _without_clipped(log, headers, rules)
        _refuse_speeds(torques, headers, rules)
        done.append((_without_lag(torques, headers, rules), headers))
        _refuse_coordinates(torques, arm, headers, rules)
        _refuse_beyond_effort(torques, arm, headers, rules)
    return look_at_weights(done, arm, rules)


def _without_clipped(log: MotionLog, headers: Headers, rules: Rules) -> MotionLog:
    """The log without torques that hold their extreme, as clipped ones do: those samples of that joint are unknown."""
    if log.drive.of_voltage:
        return log  # a loop at its limit gives what it gives
    base, torque, sentences = log.drive.base, log.torque.copy(), list[str]()
    moves = np.any(np.diff(log.q, axis=0, prepend=np.nan) != 0.0, axis=1)
    for k in range(torque.shape[1]):
        clipped = np.zeros(log.size, dtype=bool)
        for sign in (1.0, -1.0):
            clipped |= _held(sign * torque[:, k], moves, rules)
        if clipped.any():
            name = headers.get(f"{base}{k + 1}", f"{base}{k + 1}")
            extremes = " and ".join(f"{item:.4g}" for item in np.unique(torque[clipped, k]).tolist())
            unit = log.drive.unit if log.torque_constants_free else "N*m"
            sentences.append(
                f"{name} is clipped at {extremes} {unit}: {int(clipped.sum())} of {log.size} samples hold that value "
                f"({rows_text(log.row[clipped])}) and are set aside at joint {k + 1}."
            )
            torque[clipped, k] = np.nan
    return replace(log, torque=torque).saying(*sentences) if sentences else log


def _held(values: Array, moves: NDArray[np.bool_], rules: Rules) -> NDArray[np.bool_]:
    """Where values are their greatest, if they are so far oftener than they are anything beside it."""
    nothing = np.zeros(len(values), dtype=bool)
    if not np.isfinite(values).all():
        return nothing
    levels, counts = np.unique(values[moves], return_counts=True)
    if len(levels) <= _NEXT or counts[-1] < max(rules.log.clipped * len(values), _NEXT):
        return nothing
    usual = rules.log.clipped_beside * float(counts[-1 - _NEXT : -1].max())
    return values == levels[-1] if counts[-1] > usual else nothing


def _refuse_beyond_effort(log: MotionLog, arm: Arm, headers: Headers, rules: Rules) -> None:
    """Refuse torques that are far beyond what the arm file says that drives give: they are in another unit."""
    if log.torque_constants_free:
        return
    efforts = np.array([math.nan if joint.effort is None else joint.effort for joint in arm.joints])
    logged = np.where(np.isfinite(log.torque).any(axis=0), log.torque, np.nan)
    determined = np.flatnonzero(np.isfinite(logged).any(axis=0) & (efforts > 0.0))
    if not len(determined):
        return
    middle = np.nanmedian(np.abs(logged[:, determined]), axis=0)
    # One joint that is loaded beyond its drive tells of no unit: most of them do.
    if float(np.median(middle / efforts[determined])) > rules.log.least_gear:
        k = int(np.argmax(middle / efforts[determined]))
        gives = f"joint {determined[k] + 1} by the arm file gives {efforts[determined[k]]:.3g} N*m"
        message = (
            f"is {middle[k]:.3g} N*m in the middle at joint {determined[k] + 1}, and {gives} at most; is it in N*mm"
        )
        refuse_millimetres(log, arm, headers, message)


def _without_lag(log: MotionLog, headers: Headers, rules: Rules) -> MotionLog:
    """The log without speeds that a causal filter made late: they are then the coordinates' own."""
    if log.velocity is None:
        return log
    interval = log.interval
    width = max(1, round(rules.log.convention_window / interval))
    if interval > rules.log.convention_window:
        return log
    steps = moving_average(np.gradient(moving_average(log.q, width), log.time, axis=0), width)
    speeds = moving_average(log.velocity, width, 2)
    rates = np.gradient(steps, log.time, axis=0)
    lags: dict[int, float] = {}
    for k in range(log.q.shape[1]):
        apart, rate = speeds[:, k] - steps[:, k], rates[:, k]
        size = float(rate @ rate)
        if size <= 0.0:
            continue
        # A delay by a filter: what is logged is the speed of before.
        share = -float(apart @ rate) / math.sqrt(max(float(apart @ apart), 1e-300) * size)
        seconds = -float(apart @ rate) / size
        large = math.sqrt(float(apart @ apart) / max(float(steps[:, k] @ steps[:, k]), 1e-300)) > rules.log.lag
        if abs(share) > rules.log.explains and large and abs(seconds) > interval:
            lags[k] = seconds
    if not lags:
        return log
    names = ", ".join(
        f"{headers.get(f'v{k + 1}', '')} {'lags' if by > 0.0 else 'leads'} the angles by {1e3 * abs(by):.3g} ms"
        for k, by in lags.items()
    )
    return replace(log, velocity=None).saying(
        f"{names}, as by a filter: speeds are differences of the joint coordinates."
    )


def _refuse_speeds(log: MotionLog, headers: Headers, rules: Rules) -> None:
    """Refuse speeds that are not those of the coordinates: the other way, in another unit."""
    if log.velocity is None:
        return
    interval = log.interval
    width = max(1, round(rules.log.convention_window / interval))
    steps = np.gradient(moving_average(log.q, width), log.time, axis=0)
    speeds = moving_average(log.velocity, width)
    for k in range(log.q.shape[1]):
        size = math.sqrt(float(steps[:, k] @ steps[:, k]) * float(speeds[:, k] @ speeds[:, k]))
        if size <= 0.0 or abs(float(steps[:, k] @ speeds[:, k])) / size < rules.fitting.same_way:
            continue
        factor = float(speeds[:, k] @ steps[:, k]) / float(steps[:, k] @ steps[:, k])
        if rules.log.slowest < factor < 1.0 / rules.log.slowest:
            continue
        speed, place = headers.get(f"v{k + 1}", f"v{k + 1}"), headers.get(f"q{k + 1}", f"q{k + 1}")
        message = f"is {factor:.3g} times what {place} goes by in a second"
        unit = next((unit for unit, by in _FINER.items() if math.isclose(factor, by, rel_tol=0.2)), "")
        if interval > rules.log.convention_window and not unit:
            continue  # poses, from which no speed follows
        if math.isclose(factor, _DEGREE, rel_tol=0.05):
            factor = _DEGREE
        remedies = [{speed: f"{speed}/{factor:.7g}" if factor > 0.0 else f"-{speed}"}]
        if unit:
            message += f", as by a clock that counts {unit}"
            clock = headers.get("time", "time")
            remedies.insert(0, {headers.clock: f"{clock}/{_FINER[unit]:.0f}"})
        if math.isclose(abs(factor), 1.0 / _DEGREE, rel_tol=0.2):
            message += ", as of angles in degrees"
            remedies.insert(0, {place: f"{place}/{_DEGREE:.7g}"})
        raise headers.refusal(log.file, speed, message, *({"columns": remedy} for remedy in remedies))


def _refuse_coordinates(log: MotionLog, arm: Arm, headers: Headers, rules: Rules) -> None:
    """Refuse coordinates that go through several times what their joints can: of motors, or in another unit. What can
    turn a whole turn may turn on."""
    low, high = np.quantile(log.q, [0.01, 0.99], axis=0)
    for k, joint in enumerate(arm.joints):
        through, whole = float(high[k] - low[k]), joint.range[1] - joint.range[0]
        if through < rules.log.beyond_range * whole or (joint.revolute and whole > math.tau - rules.residual.turned):
            continue
        name, by = headers.get(f"q{k + 1}", f"q{k + 1}"), _DEGREE if joint.revolute else 1e3
        unit = "rad" if joint.revolute else "m"
        message = f"goes through {through:.3g} {unit}, and joint {k + 1} by {arm.name!r} through {whole:.3g} at most: "
        message += f"is it in {'degrees' if joint.revolute else 'mm'} or of the motor? For the one "
        write = headers.write({"columns": {name: f"{name}/{by:.7g}"}})
        raise InputError(log.file, name, f"{message}{write}, for the other its gear's ratio")
