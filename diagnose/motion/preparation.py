"""A motion log on an even clock: speeds, accelerations, the low-pass of both sides, and the samples that count. What is
sampled too slowly for any low-pass stands as it is, and rates of change count as far as every other sample foretells
them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics
from linkwright.core.diagnose.first_look.smoothing import bridged
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .encoders.sides import Sides, lateness, sides
from .log import MotionLog

_WORKING_RATE = 250.0
"""Hz; what is logged faster is thinned to this: gear ripple at slow speed stays below a tenth of it."""
STRETCH = 1.0
"""s; a shorter stretch of a log is the filters' ends."""
_MOST = 24_000
"""Samples kept of a log; more of one log tell nothing new."""
_HELD = 0.4
"""The part of a sampling rate up to which it holds frequencies without loss."""
_UNTOUCHED = 0.3
"""The part of a sampling rate up to which thinning leaves noise as it was."""
_ENOUGH = 30
"""Frequencies above the low-pass by which noise is measured."""
_LET_THROUGH = 0.833
"""Noise bandwidth of the low-pass over its cut-off: the integral of (1 + x^4)^-2 over all x above zero."""
_PIECE = 10_000
"""Samples whose columns are worked out at once."""


@dataclass(frozen=True)
class Stretch:
    """Samples `start:stop` without a gap."""

    start: int
    stop: int


@dataclass(frozen=True)
class PreparedLog:
    """A log on an even clock, or at its instants where its rate holds no low-pass: `cutoff` is then infinite.
    `motion` (N samples at `rate` Hz) has speeds and accelerations; `measured` (N, n) N*m is not filtered. `kept` (M,)
    are the samples whose filtered values count; `moving` (M, n) those where the joint moves steadily, `near` (M, n)
    those and reversals. `entries` are entries that hold in this log alone, beside those of the arm file; `motion.arm`
    has them. `encoders` says what two encoders at each drive are (None: there is one).
    """

    log: MotionLog
    motion: Motion
    measured: Array
    rate: float
    cutoff: float
    stretches: tuple[Stretch, ...]
    kept: NDArray[np.int64]
    moving: NDArray[np.bool_]
    near: NDArray[np.bool_]
    entries: tuple[EffectEntry, ...] = ()
    encoders: Sides | None = None

    @property
    def low_pass(self) -> float | None:
        """Hz; None where there is none."""
        return self.cutoff if np.isfinite(self.cutoff) else None

    def filtered(self, columns: Array) -> Array:
        """Columns (P, k) of a piece after the low-pass without phase; a piece lies within one stretch."""
        return low_pass(columns, self.cutoff, self.rate)

    def noise(self) -> Array:
        """Noise (n,) N*m within the low-pass: what the measured torque holds between twice the low-pass and what the
        rate holds, as white noise that reaches down to the motion. Infinite where nothing lies between."""
        frequency, spectrum = _spectrum([self.measured[part.start : part.stop] for part in self.stretches], self.rate)
        above = (frequency > 2.0 * self.cutoff) & (frequency < _UNTOUCHED * self.rate)
        if np.count_nonzero(above) < _ENOUGH:
            return np.full(self.measured.shape[1], np.inf)
        length = max(part.stop - part.start for part in self.stretches)
        of_a_sample = np.median(spectrum[above], axis=0) / (np.log(2.0) * np.sum(np.hanning(length) ** 2))
        return np.asarray(np.sqrt(of_a_sample * _LET_THROUGH * self.cutoff / (0.5 * self.rate)))

    def pieces(self) -> Iterator[tuple[slice, NDArray[np.int64], NDArray[np.int64]]]:
        """Pieces for columns: the samples to work out (with a margin in which the low-pass settles), which of the kept
        samples lie in each (numbers among the kept), and where those stand within the piece."""
        margin = int(np.ceil(2.0 * self.rate))
        for stretch in self.stretches:
            for start in range(stretch.start, stretch.stop, _PIECE):
                stop = min(start + _PIECE, stretch.stop)
                wide = slice(max(stretch.start, start - margin), min(stretch.stop, stop + margin))
                first, last = np.searchsorted(self.kept, (start, stop))
                numbers = np.arange(first, last)
                if len(numbers):
                    yield wide, numbers, self.kept[first:last] - wide.start

    def piece(self, part: slice, torque: Array | None = None) -> Motion:
        """The motion in a piece, with the model's torque (N, n) where it is known."""
        return replace(self.motion.at(part), torque=None if torque is None else torque[part])


def low_pass(columns: Array, cutoff: float, rate: float) -> Array:
    """Columns (N, ...) after a Butterworth low-pass of the fourth order forwards and backwards; as they are where the
    cut-off is beyond what the rate holds, or the stretch is too short."""
    if cutoff >= _HELD * rate or len(columns) < 16:
        return columns
    from scipy.signal import butter, sosfiltfilt  # here, for what no motion is prepared for loads none of it

    sections = butter(2, cutoff, fs=rate, output="sos")
    padding = min(len(columns) - 1, int(rate))
    return np.asarray(sosfiltfilt(sections, columns, axis=0, padlen=padding), dtype=float)


@dataclass(frozen=True)
class _Even:
    """Columns of a log at even instants of each stretch, and every how manyth of these is worked with. Instants
    are those of the samples where their rate does not hold a low-pass (`held`)."""

    time: Array
    instants: list[Array]
    rate: float
    divide: int
    held: bool

    @classmethod
    def of(cls, log: MotionLog, rules: Rules) -> _Even:
        """Those of a log. Raises `InputError` where it has no stretch of a second."""
        step = log.interval
        rate = 1.0 / step
        held = _HELD * rate >= min(log.cutoff or np.inf, rules.motion.low_pass[0])
        instants = _instants(log, max(rules.motion.gap, rules.log.gap * step), step if held else None)
        return cls(log.time, instants, rate, max(1, int(np.floor(rate / _WORKING_RATE + 1e-9))), held)

    @property
    def working(self) -> float:
        """Hz, the rate of what is worked with."""
        return self.rate / self.divide

    @property
    def clock(self) -> list[Array]:
        """The instants of each stretch that are worked with."""
        return [t[:: self.divide] for t in self.instants]

    def at(self, values: Array) -> list[Array]:
        """Samples (N,) or (N, k) at the instants (M, k) of each stretch."""
        columns = values.reshape(len(values), -1).T
        return [np.column_stack([np.interp(t, self.time, column) for column in columns]) for t in self.instants]

    def thinned(self, values: Array) -> list[Array]:
        """The same at the instants that are worked with, after a low-pass that these can hold."""
        even = self.at(values)
        if self.divide == 1:
            return even
        cutoff = _HELD * self.rate / self.divide
        return [low_pass(part, cutoff, self.rate)[:: self.divide] for part in even]

    def joined(self, values: Array | None) -> Array | None:
        """The same of all stretches, one below the other; None where the log has none."""
        return None if values is None else np.concatenate(self.thinned(values))


def prepare(arm: Arm, log: MotionLog, *, rules: Rules) -> PreparedLog:
    """A log prepared for an arm by rules.

    Raises `InputError` where it has other joints than the arm, or no stretch of a second.
    """
    if log.q.shape[1] != arm.size:
        raise InputError(log.file, "", f"the log has {log.q.shape[1]} joints, the arm {arm.size}")
    even = _Even.of(log, rules)
    q = even.thinned(log.q)
    torque, unknown = bridged(log.torque, log.time)
    measured = even.thinned(torque)
    cutoff = log.cutoff or _cutoff(q, even.working, rules) if even.held else np.inf
    slopes = _Slopes.of(q, even, cutoff, rules)
    motion = _motion(arm, log, even, q, slopes)
    encoders = None
    if log.joint_side is not None and even.held:
        filtered = [low_pass(each, cutoff, even.working) for each in measured]
        encoders, second = _encoders(log, motion, even, filtered, rules)
        motion = motion if encoders.unlike else _on_both_sides(motion, encoders, second, slopes)
    edges = np.cumsum([0, *map(len, even.clock)])
    stretches = tuple(Stretch(int(a), int(b)) for a, b in pairwise(edges))
    apart = max(1, int(even.working / (rules.motion.bands * cutoff)), int(np.ceil(motion.size / _MOST)))
    kept = np.concatenate([np.arange(stretch.start + apart // 2, stretch.stop, apart) for stretch in stretches])
    made_up = np.concatenate([part[:: even.divide] > 0.0 for part in even.at(unknown)])
    known = np.isfinite(np.concatenate(measured))
    known &= _known(log, motion, stretches, made_up, round(0.25 / cutoff * even.working))
    moving, near = (each & known for each in _counting(motion, stretches, even.working, cutoff, rules))
    near &= moving.any(axis=0)  # friction is told by steady motion first: a joint that only trembles tells none
    tidy = np.nan_to_num(np.concatenate(measured))
    return PreparedLog(
        log, motion, tidy, even.working, cutoff, stretches, kept, moving[kept], near[kept], encoders=encoders
    )


@dataclass(frozen=True)
class _Slopes:
    """How coordinates at `rate` Hz are differentiated over the `clock` s of each stretch: after a low-pass at `smooth`
    Hz, as far as samples tell slopes (`share`). Speeds that were logged must be quieter around `cutoff` Hz."""

    clock: list[Array]
    rate: float
    share: float
    smooth: float
    cutoff: float
    rules: Rules

    @classmethod
    def of(cls, q: list[Array], even: _Even, cutoff: float, rules: Rules) -> _Slopes:
        """Those of coordinates `q` that are worked with, beside a low-pass at a cut-off (Hz)."""
        rate, most = even.working, _HELD * even.working
        clock = [np.arange(len(t)) / rate if even.held else t for t in even.clock]
        share = 1.0 if even.held else _share_resolved(q, clock)
        return cls(clock, rate, share, min(rules.motion.bands * cutoff, most), min(cutoff, most), rules)

    def speeds(self, q: list[Array], logged: list[Array] | None = None) -> list[Array]:
        """Speeds: as logged where they agree with the coordinates' own, so far as samples tell these, and are quieter
        around the low-pass, else those."""
        slopes = [slope(low_pass(item, self.smooth, self.rate), t) for item, t in zip(q, self.clock, strict=True)]
        if logged is None:
            return [self.share * item for item in slopes]
        read = [low_pass(item, self.smooth, self.rate) for item in logged]
        speeds = [np.empty_like(item) for item in slopes]
        differentiated = _noise(q, self.rate) * (2.0 * np.pi * self.cutoff) ** 2
        quieter = self.share * _noise(logged, self.rate) <= differentiated
        for joint in range(q[0].shape[1]):
            a, b = (np.concatenate([item[:, joint] for item in many]) for many in (slopes, read))
            size = float(a @ a)
            most = self.rules.motion.speeds_agree * size
            agrees = size > 0.0 and np.isfinite(b).all() and self.share * float((a - b) @ (a - b)) < most
            for into, mine, theirs in zip(speeds, slopes, read, strict=True):
                into[:, joint] = theirs[:, joint] if agrees and quieter[joint] else self.share * mine[:, joint]
        return speeds

    def accelerations(self, speeds: list[Array], share: float) -> list[Array]:
        """Accelerations, of which samples tell a share."""
        return [share * slope(v, t) for v, t in zip(speeds, self.clock, strict=True)]


def _motion(arm: Arm, log: MotionLog, even: _Even, q: list[Array], slopes: _Slopes) -> Motion:
    """The motion of a log whose coordinates are `q` at the instants that are worked with."""
    speeds = slopes.speeds(q, None if log.velocity is None else even.thinned(log.velocity))
    sampled = 1.0 if even.held else slopes.share * _share_resolved(speeds, slopes.clock)
    payload, temperature = even.joined(log.payload_mass), even.joined(log.temperature)
    return Motion(
        arm,
        np.concatenate(even.clock),
        np.concatenate(q),
        np.concatenate(speeds),
        np.concatenate(slopes.accelerations(speeds, sampled)),
        None,
        even.joined(log.commanded),
        None,
        None,
        None if payload is None else payload[:, 0],
        None if temperature is None else temperature[:, 0],
        sampled,
        beyond_drive=log.beyond_drive,
    )


def _encoders(
    log: MotionLog, motion: Motion, even: _Even, torque: list[Array], rules: Rules
) -> tuple[Sides, list[Array]]:
    """What the second encoders are, and their coordinates (N, n) of each stretch on the clock and from the zeros of the
    first ones. `torque` is filtered."""
    assert log.joint_side is not None
    late = lateness(
        motion.q, np.concatenate(even.thinned(log.joint_side)), inverse_dynamics(motion), motion.velocity, rules=rules
    )
    # Read sooner by as much, within the log.
    at = np.clip(log.time + late, log.time[0], log.time[-1])
    second = even.thinned(CubicSpline(log.time, log.joint_side)(at))
    pushes, rates = np.nan_to_num(np.concatenate(torque)), (motion.velocity, motion.acceleration)
    result = sides(motion.q, np.concatenate(second), pushes, rates, said=log.beyond_drive, late=late, rules=rules)
    return result, [part - result.offset for part in second]


def _on_both_sides(motion: Motion, encoders: Sides, q: list[Array], slopes: _Slopes) -> Motion:
    """The motion of motors and links by two encoders at each drive, with coordinates `q` of the second one."""
    first = motion.q, motion.velocity, motion.acceleration
    speeds = slopes.speeds(q)
    second = tuple(np.concatenate(parts) for parts in (q, speeds, slopes.accelerations(speeds, 1.0)))
    motor, link = (second, first) if encoders.beyond_drive else (first, second)
    return replace(
        motion,
        q=motor[0],
        velocity=motor[1],
        acceleration=motor[2],
        joint_side=link[0],
        joint_side_rates=(link[1], link[2]),
        beyond_drive=False,
    )


def _known(
    log: MotionLog, motion: Motion, stretches: tuple[Stretch, ...], made_up: NDArray[np.bool_], blur: int
) -> NDArray[np.bool_]:
    """Where torques (N, n) are neither near one that was made up, as far as the low-pass blurs, nor set aside."""
    known = np.ones_like(made_up)
    for stretch in stretches:
        part = slice(stretch.start, stretch.stop)
        for joint in np.flatnonzero(made_up[part].any(axis=0)).tolist():
            places = np.flatnonzero(made_up[part, joint])
            known[part, joint] &= ~_around(places, blur, stretch.stop - stretch.start)
    for begin, end in log.aside:
        known &= ~((motion.time >= begin) & (motion.time <= end))[:, None]
    return known


def _instants(log: MotionLog, gap: float, step: float | None) -> list[Array]:
    """Instants of each stretch: even ones, or without a step those of the samples, which no low-pass will blur."""
    breaks = np.flatnonzero(np.diff(log.time) > gap) + 1
    edges = [0, *breaks.tolist(), log.size]
    times: list[Array] = []
    for a, b in pairwise(edges):
        if log.time[b - 1] - log.time[a] > STRETCH:
            clock = log.time[a:b]
            times.append(clock if step is None else np.arange(clock[0], clock[-1], step))
    if not times:
        raise InputError(log.file, "", "no stretch of the log is longer than a second")
    return times


def slope(values: Array, clock: Array) -> Array:
    """Derivative (N, n) of samples with time (N,) s, by a spline: differences of samples would be too small, by a share
    that grows with the square of the frequency. Zero of one sample."""
    return np.asarray(CubicSpline(clock, values)(clock, 1)) if len(clock) > 1 else np.zeros_like(values)


def _share_resolved(values: list[Array], clock: list[Array]) -> float:
    """How much of the square of slopes every other sample foretells: 1 of a motion, 0 of poses from which nobody knows
    how the arm went to the next."""
    whole = missed = 0.0
    for value, time in zip(values, clock, strict=True):
        slopes = slope(value, time)
        whole += float(np.sum(slopes**2))
        for part in (slice(0, None, 2), slice(1, None, 2)):
            missed += float(np.sum((slopes[part] - slope(value[part], time[part])) ** 2))
    return max(0.0, 1.0 - missed / whole) if whole > 0.0 else 1.0


def _noise(parts: list[Array], rate: float) -> Array:
    """Power density of what is faster than any motion, by column, from the longest part."""
    frequency, spectrum = _spectrum(parts, rate)
    return np.asarray(np.median(spectrum[frequency > _HELD * rate], axis=0))


def _spectrum(parts: list[Array], rate: float) -> tuple[Array, Array]:
    longest = max(parts, key=len)
    swung = (longest - longest.mean(axis=0)) * np.hanning(len(longest))[:, None]
    spectrum = np.asarray(np.abs(np.fft.rfft(swung, axis=0)) ** 2, dtype=float)
    return np.asarray(np.fft.rfftfreq(len(longest), 1.0 / rate), dtype=float), spectrum


def _cutoff(q: list[Array], rate: float, rules: Rules) -> float:
    """The low-pass that motion asks for: twice the frequency below which 99 % of the accelerations' power lies."""
    frequency, spectrum = _spectrum(q, rate)
    noise = _noise(q, rate)
    least, most = rules.motion.low_pass
    motion = np.where(spectrum > rules.motion.stands_out * noise, spectrum, 0.0)
    weight = np.where(frequency < most, frequency, 0.0)[:, None] ** 4 * motion
    total = weight.sum(axis=0)
    wanted = float(least)
    for joint in np.flatnonzero(total > 0.0).tolist():
        share = np.cumsum(weight[:, joint]) / total[joint]
        wanted = max(wanted, 2.0 * float(frequency[np.searchsorted(share, 0.95)]))
    return min(max(wanted, least), most, _HELD * rate)


def _counting(
    motion: Motion, stretches: tuple[Stretch, ...], rate: float, cutoff: float, rules: Rules
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Where each joint moves steadily, and where it moves or has just turned round."""
    fast = np.abs(motion.velocity) > rules.motion.slow
    moving, near = np.zeros_like(fast), np.zeros_like(fast)
    reach = round((rules.motion.reversal + 0.25 / cutoff) * rate)
    settle = round(rate / 8.0)
    for stretch in stretches:
        part = slice(stretch.start, stretch.stop)
        inner = np.zeros(stretch.stop - stretch.start, dtype=bool)
        inner[settle : len(inner) - settle] = True
        for joint in range(motion.q.shape[1]):
            v, quick = motion.velocity[part, joint], fast[part, joint]
            turns = np.flatnonzero(np.signbit(v[1:]) != np.signbit(v[:-1]))
            moving[part, joint] = quick & inner
            if reach:  # else no sample is known to be so near a turn
                moving[part, joint] &= ~_around(turns, reach, len(v))
            near[part, joint] = _around(np.flatnonzero(quick), int(2 * rules.motion.reversal * rate), len(v)) & inner
            near[part, joint] &= ~_at_rest(v, rate, cutoff, rules.motion.still)
    return moving, near


def _at_rest(v: Array, rate: float, cutoff: float, slowest: float) -> NDArray[np.bool_]:
    """Where a joint dwells, with what the low-pass blurs: friction there is whatever holds it."""
    still, blur = np.abs(v) < slowest, 0.25 / cutoff * rate
    edges = np.flatnonzero(np.diff(np.concatenate(([False], still, [False])).astype(np.int8)))
    dwells = [np.arange(a, b) for a, b in edges.reshape(-1, 2).tolist() if b - a > blur]
    if not dwells:
        return np.zeros(len(v), dtype=bool)
    return _around(np.concatenate(dwells), round(blur), len(v))


def _around(places: NDArray[np.int64], reach: int, count: int) -> NDArray[np.bool_]:
    """Which of `count` samples lie within `reach` of some places."""
    steps = np.zeros(count + 1, dtype=np.int64)
    np.add.at(steps, np.maximum(places - reach, 0), 1)
    np.add.at(steps, np.minimum(places + reach + 1, count), -1)
    return np.cumsum(steps[:-1]) > 0
