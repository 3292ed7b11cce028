"""An arm watched over dated recordings: which parameters there are, the course of each, what moved and when.

A few recordings are diagnosed together to see what there is; then every recording is fitted by itself with one set of
parameters, frame and tool its own where they are free, and each parameter's series is searched for changes
(`diagnose.watch.course`). What is left in each recording is watched as well: it grows where anything happens that no
parameter holds.
"""

from __future__ import annotations

import datetime
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.answer.detectable import POWER
from linkwright.core.diagnose.fitting.fit import t_quantile
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.result import MotionDiagnosis
from linkwright.core.diagnose.options import Options, silent
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.rules.watch_rules import WatchRules
from linkwright.core.diagnose.several.recordings import names_of, together
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.sections.numeric import Array

from .course import FEWEST, Course, Kind, Measured, Series, course_of
from .estimates import Estimates, Parameter, Unwatched, choose, estimate, parameters_of
from .evidence import TESTS, in_common, level, scatter

SOON = 3
"""Recordings after which the smallest step told would be found."""
_POOLED = 5
"""Recordings that are diagnosed together, of more, to see which parameters there are to watch."""
LEFT = "left"
"""The name of what is left in each recording, as a parameter."""


@dataclass(frozen=True)
class Moved:
    """A change of a parameter (`kind` as in `Turn`).

    A step lies between the recordings `last` and `first` (from 0); one that is off alone is `first`, and a drift goes
    on since `first`. `earliest` and `latest` are the bounds (95 %) of `first`. `size` is by how much, SI, with its 95 %
    `interval`; a drift's is what has come since then, and `rate` is that per day. `detected` is the recording after
    which it was beyond chance; `p_value` how likely a year of quiet recordings raises as strong an alarm.
    """

    kind: Kind
    first: int
    earliest: int
    latest: int
    size: float
    interval: tuple[float, float]
    rate: float | None
    rate_interval: tuple[float, float] | None
    detected: int
    p_value: float

    @property
    def last(self) -> int:
        """The last recording before a step."""
        return max(self.first - 1, 0)


@dataclass(frozen=True)
class Watched:
    """A parameter over the recordings. Arrays are (N,), SI; not a number where a recording does not show it.

    `values` with `errors` and 95 % `intervals` (N, 2); `level` what the values scatter about, changes and all;
    `limits` (N, 2) what one recording keeps to as long as the parameter stays at the level that it began with.
    `deviation` is how far one recording scatters, of which `between` is beyond its standard error (zero: nothing);
    `smallest_step` is the least that the next few recordings would tell.
    """

    parameter: Parameter
    values: Array
    errors: Array
    intervals: Array
    level: Array
    limits: Array
    deviation: float
    between: float
    smallest_step: float
    changes: tuple[Moved, ...]

    @property
    def moved(self) -> bool:
        """Whether anything changed."""
        return bool(self.changes)


@dataclass(frozen=True)
class Dated:
    """One recording of a watch: date, name, file, readings used and left out, RMS of what is left (m; N*m)."""

    date: datetime.date
    name: str
    file: str
    rows: int
    left_out: int
    rms: float


@dataclass(frozen=True)
class Watch:
    """An arm over dated recordings, in the order of time.

    `parameters` hold each one's course, `left` that of what is left in the recordings: lengths, m, or of motion logs
    torques, N*m.
    `together` is the diagnosis that said what there is (None: none was made), of the recordings `searched` (from 0).
    """

    arm: Arm
    recordings: tuple[Dated, ...]
    parameters: tuple[Watched, ...]
    left: Watched
    unwatched: tuple[Unwatched, ...]
    together: Diagnosis | MotionDiagnosis | None
    searched: tuple[int, ...]
    rules: WatchRules

    @property
    def of_motion(self) -> bool:
        """Whether the recordings are motion logs."""
        return isinstance(self.together, MotionDiagnosis)

    @property
    def moved(self) -> tuple[Watched, ...]:
        """What changed, what is left in the recordings last."""
        return tuple(parameter for parameter in (*self.parameters, self.left) if parameter.moved)


def basics() -> tuple[str, ...]:
    """What is watched beside what was found, where nobody asks for anything else: zeros that slip, drives that wear."""
    return tuple(effect.id for effect in EFFECTS.values() if effect.watch.always)


def dates_of(recordings: Sequence[Recording | MotionLog]) -> list[datetime.date]:
    """The dates of recordings that each have one."""
    return [datetime.date.fromisoformat(recording.date) for recording in recordings]


def watch(
    arm: Arm,
    recordings: Sequence[Recording],
    asked: Collection[str] | None = None,
    options: Options | None = None,
    progress: Callable[[str, float], None] | None = None,
    *,
    search: bool = True,
) -> Watch:
    """Watch an arm over at least three recordings, each with a separate date; `asked` names effects to watch beside
    what a diagnosis finds (`search`), by default `basics()`.

    Raises `arm.bodies.beams.PropertyNeeded` and the materials' errors where the model lacks a figure.
    """
    options = options or Options()
    tell = progress or silent
    rules = options.rules
    recordings = sorted(recordings, key=lambda recording: recording.date)
    count = len(recordings)
    searched = tuple(np.unique(np.linspace(0, count - 1, min(count, _POOLED)).round().astype(int)).tolist())
    diagnosis: Diagnosis | None = None
    if search:
        held = together([recordings[k] for k in searched], arm, rules=rules.residual)
        diagnosis = diagnose(arm, held, options, lambda text, share: tell(text, 0.7 * share))
    tell("choosing what to watch", 0.7)
    wanted = basics() if asked is None else asked
    asked = [name for name in wanted if name not in options.without]
    chosen = choose(arm, recordings, () if diagnosis is None else diagnosis.findings, asked, rules=rules)
    estimates = estimate(arm, recordings, chosen, lambda text, share: tell(text, 0.8 + 0.15 * share), rules=rules)
    tell("searching for changes", 0.95)
    known, unwatched = parameters_of(arm, chosen), chosen.left_out
    searched = searched if search else ()
    return watched(arm, recordings, known, estimates, diagnosis, searched, unwatched=unwatched, rules=rules.watch)


def watched(
    arm: Arm,
    recordings: Sequence[Recording | MotionLog],
    parameters: Sequence[Parameter],
    estimates: Estimates,
    diagnosis: Diagnosis | MotionDiagnosis | None,
    searched: tuple[int, ...],
    *,
    unwatched: tuple[Unwatched, ...] = (),
    rules: WatchRules,
) -> Watch:
    """The watch of recordings or logs in the order of time whose parameters are estimated: the course of each, and of
    what is left."""
    days = dates_of(recordings)
    when = np.array([float((day - days[0]).days) for day in days])
    kind = "torque" if isinstance(diagnosis, MotionDiagnosis) else "length"
    known = (*parameters, Parameter(LEFT, (), LEFT, kind, identified=True))
    values = np.column_stack([estimates.values, np.log(np.maximum(estimates.rms, 1e-12))])
    # The standard deviation of the logarithm of a root mean square.
    errors = np.column_stack([estimates.errors, np.sqrt(0.5 / estimates.freedom)])
    of_each = zip(known, values.T, errors.T, courses_of(values, errors, when, rules), strict=True)
    made = [_watched(*each, estimates.freedom, when, len(known), rules) for each in of_each]
    figures = zip(estimates.rows, estimates.left_out, estimates.rms.tolist(), strict=True)
    dated = tuple(
        Dated(day, name, recording.file, rows, aside, rms)
        for day, name, recording, (rows, aside, rms) in zip(
            days, names_of(recordings), recordings, figures, strict=True
        )
    )
    return Watch(arm, dated, tuple(made[:-1]), _as_sizes(made[-1]), unwatched, diagnosis, searched, rules)


def courses_of(values: Array, errors: Array, when: Array, rules: WatchRules) -> list[Course | None]:
    """The course of each parameter by estimates (N, P) with their standard errors; None of one that too few recordings
    show."""
    count, width = values.shape
    shown = np.isfinite(errors) & (errors > 0.0)
    common = np.ones(count)
    whole = [k for k in range(width) if shown[:, k].all()]
    for so_far in range(3, count + 1):
        if whole:
            factor = scatter(values[:so_far, whole].T, errors[:so_far, whole].T).factor
            common[so_far - 1] = in_common(factor[None])[0]
    threshold = level(rules.false_alarm, rules.over, width)
    courses_: list[Course | None] = []
    for k in range(width):
        visible = shown[:, k]
        series = Series(values[visible, k], errors[visible, k], when[visible], common[visible], rules)
        courses_.append(course_of(series, threshold) if visible.sum() >= FEWEST else None)
    return courses_


def _watched(
    parameter: Parameter,
    values: Array,
    errors: Array,
    course: Course | None,
    freedom: Array,
    when: Array,
    series: int,
    rules: WatchRules,
) -> Watched:
    count = len(values)
    shown = np.isfinite(errors) & (errors > 0.0)
    reach = np.array([t_quantile(int(item)) for item in freedom]) * np.where(shown, errors, np.nan)
    values = np.where(shown, values, np.nan)
    intervals = np.column_stack([values - reach, values + reach])
    nothing = np.full(count, np.nan)
    if course is None:
        empty = np.full((count, 2), np.nan)
        return Watched(parameter, values, errors, intervals, nothing, empty, np.nan, np.nan, np.nan, ())
    threshold = level(rules.false_alarm, rules.over, series)
    quantile = float(stats.t.isf(0.5 * threshold, course.freedom))

    def spread(of: Array) -> Array:
        placed = nothing.copy()
        placed[shown] = of
        return placed

    half = quantile * course.deviations * np.sqrt(1.0 + 1.0 / shown.sum())
    limits = np.column_stack([spread(course.began - half), spread(course.began + half)])
    mean = float(np.sqrt(np.mean(course.deviations**2)))
    between = float(np.sqrt(max(0.0, mean**2 - float(np.mean(errors[shown] ** 2)))))
    several = np.sqrt(1.0 / shown.sum() + 1.0 / SOON)
    step = (quantile + float(stats.norm.ppf(POWER))) * mean * several
    places, days = np.flatnonzero(shown).tolist(), when[shown]
    changes = tuple(_moved(change, course, places, days, series, rules) for change in course.changes)
    return Watched(parameter, values, errors, intervals, spread(course.level), limits, mean, between, step, changes)


def _moved(
    measured: Measured, course: Course, places: Sequence[int], days: Array, series: int, rules: WatchRules
) -> Moved:
    turn = measured.turn
    reach = t_quantile(max(int(course.freedom), 1)) * measured.error
    whole = float(days[-1] - days[0])
    share = float(days[-1] - days[turn.at]) / whole if turn.kind == "drift" else 1.0
    ends = (measured.size - reach, measured.size + reach)
    p = 1.0 - (1.0 - min(1.0, turn.p * TESTS * series)) ** rules.over
    drift = turn.kind == "drift"
    return Moved(
        kind=turn.kind,
        first=places[turn.at],
        earliest=places[measured.earliest],
        latest=places[measured.latest],
        size=share * measured.size,
        interval=(share * ends[0], share * ends[1]),
        rate=measured.size / whole if drift else None,
        rate_interval=(ends[0] / whole, ends[1] / whole) if drift else None,
        detected=places[turn.detected],
        p_value=p,
    )


def _as_sizes(watched_: Watched) -> Watched:
    """What is left in its unit: its series is that of their logarithms, in which a change is a ratio."""
    changes = tuple(_as_size(change, watched_) for change in watched_.changes)
    middle = float(np.exp(np.nanmean(watched_.level)))
    return replace(
        watched_,
        values=np.exp(watched_.values),
        errors=watched_.errors * np.exp(watched_.values),
        intervals=np.exp(watched_.intervals),
        level=np.exp(watched_.level),
        limits=np.exp(watched_.limits),
        deviation=middle * watched_.deviation,
        between=middle * watched_.between,
        smallest_step=middle * float(np.expm1(watched_.smallest_step)),
        changes=changes,
    )


def _as_size(change: Moved, watched_: Watched) -> Moved:
    before = float(np.exp(watched_.level[change.first] - (0.0 if change.kind == "drift" else change.size)))
    low, high = change.interval
    size, ends = before * float(np.expm1(change.size)), (before * float(np.expm1(low)), before * float(np.expm1(high)))
    rate, rates = change.rate, change.rate_interval
    if rate is not None and rates is not None:
        rate, rates = before * rate, (before * rates[0], before * rates[1])
    return replace(change, size=size, interval=ends, rate=rate, rate_interval=rates)
