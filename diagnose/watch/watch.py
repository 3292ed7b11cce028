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
from linkwright.core.diagnose.diagnosis import diagnose
from linkwright.core.diagnose.fitting.fit import t_quantile
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.rules.watch_rules import WatchRules
from linkwright.core.diagnose.several.recordings import names_of, together
from linkwright.core.sections.numeric import Array

from .course import FEWEST, Course, Kind, Measured, Series, course_of
from .estimates import Chosen, Estimates, Parameter, Unwatched, choose, estimate, parameters_of
from .evidence import in_common, level, scatter

LEFT = "left"
"""The name of what is left in each recording, as a parameter."""


@dataclass(frozen=True)
class Moved:
    """A change of a parameter (`kind` as in `Turn`).

    A step lies between the recordings `last` and `first` (from 0); one that is off alone is `first`, and a drift goes
    on since `first`. `earliest` and `latest` are the bounds (95 %) of `first`. `size` is by how much, SI, with its 95 %
    `interval`; a drift's is what has come since then, and `rate` is that per day. `told` is the recording after which
    it was beyond chance; `p_value` how likely a year of quiet recordings raises as strong an alarm.
    """

    kind: Kind
    first: int
    earliest: int
    latest: int
    size: float
    interval: tuple[float, float]
    rate: float | None
    rate_interval: tuple[float, float] | None
    told: int
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
    `deviation` is how far one recording scatters, of which `between` is beyond its standard error (nought: nothing);
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
    """One recording of a watch: date, name, file, readings used and left out, RMS length (m) of what is left."""

    date: datetime.date
    name: str
    file: str
    rows: int
    left_out: int
    rms: float


@dataclass(frozen=True)
class Watch:
    """An arm over dated recordings, in the order of time.

    `parameters` hold each one's course, `left` that of what is left in the recordings (its values are lengths, m).
    `together` is the diagnosis that said what there is (None: none was made), of the recordings `searched` (from 0).
    """

    arm: Arm
    recordings: tuple[Dated, ...]
    parameters: tuple[Watched, ...]
    left: Watched
    unwatched: tuple[Unwatched, ...]
    together: Diagnosis | None
    searched: tuple[int, ...]
    rules: WatchRules

    @property
    def moved(self) -> tuple[Watched, ...]:
        """What changed, what is left in the recordings last."""
        return tuple(each for each in (*self.parameters, self.left) if each.moved)


def basics() -> tuple[str, ...]:
    """What is watched beside what was found, where nobody asks for anything else: zeros that slip, drives that wear."""
    return tuple(effect.id for effect in EFFECTS.values() if effect.watched)


def dates_of(recordings: Sequence[Recording]) -> list[datetime.date]:
    """The dates of recordings that each have one."""
    return [datetime.date.fromisoformat(each.date) for each in recordings]


def _silent(what: str, share: float) -> None:
    del what, share


def watch(
    arm: Arm,
    recordings: Sequence[Recording],
    asked: Collection[str] | None = None,
    options: Options | None = None,
    progress: Callable[[str, float], None] | None = None,
    *,
    search: bool = True,
) -> Watch:
    """Watch an arm over at least three recordings, each with a date of its own; `asked` names effects to watch beside
    what a diagnosis finds (`search`), by default `basics()`.

    Raises `arm.errors.model.PropertyNeeded` and the materials' errors where the model lacks a figure.
    """
    options = options or Options()
    tell = progress or _silent
    rules = options.rules
    recordings = sorted(recordings, key=lambda each: each.date)
    count = len(recordings)
    searched = tuple(np.unique(np.linspace(0, count - 1, min(count, rules.watch.pooled)).round().astype(int)).tolist())
    found: Diagnosis | None = None
    if search:
        held = together([recordings[k] for k in searched], arm, rules=rules.residual)
        found = diagnose(arm, held, options, lambda text, share: tell(text, 0.7 * share))
    tell("choosing what to watch", 0.7)
    wanted = basics() if asked is None else asked
    asked = [name for name in wanted if name not in options.without]
    chosen = choose(arm, recordings, () if found is None else found.findings, asked, rules=rules)
    tell("fitting each recording", 0.8)
    estimates = estimate(arm, recordings, chosen, rules=rules)
    tell("searching for changes", 0.95)
    return watched(arm, recordings, chosen, estimates, found, searched if search else (), rules=rules.watch)


def watched(
    arm: Arm,
    recordings: Sequence[Recording],
    chosen: Chosen,
    estimates: Estimates,
    found: Diagnosis | None,
    searched: tuple[int, ...],
    *,
    rules: WatchRules,
) -> Watch:
    """The watch of recordings in the order of time whose parameters are estimated."""
    days = dates_of(recordings)
    when = np.array([float((each - days[0]).days) for each in days])
    known = parameters_of(arm, chosen)
    remains = Parameter(LEFT, (), LEFT, "length", found=True)
    values = np.column_stack([estimates.values, np.log(np.maximum(estimates.rms, 1e-12))])
    # The standard deviation of the logarithm of a root mean square.
    errors = np.column_stack([estimates.errors, np.sqrt(0.5 / estimates.freedom)])
    parameters = (*known, remains)
    courses = courses_of(values, errors, when, rules)
    made = [
        _watched(each, values[:, k], errors[:, k], estimates.freedom, when, courses[k], len(parameters), rules)
        for k, each in enumerate(parameters)
    ]
    names = names_of(recordings)
    dated = tuple(
        Dated(day, name, each.file, rows, aside, float(rms))
        for day, name, each, rows, aside, rms in zip(
            days, names, recordings, estimates.rows, estimates.left_out, estimates.rms, strict=True
        )
    )
    left = _as_lengths(made[-1])
    return Watch(arm, dated, tuple(made[:-1]), left, chosen.left_out, found, searched, rules)


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
    asked = level(rules.false_alarm, rules.over, rules.tests, width)
    found: list[Course | None] = []
    for k in range(width):
        own = shown[:, k]
        series = Series(values[own, k], errors[own, k], when[own], common[own], rules)
        found.append(course_of(series, asked) if own.sum() >= FEWEST else None)
    return found


def _watched(
    parameter: Parameter,
    values: Array,
    errors: Array,
    freedom: Array,
    when: Array,
    course: Course | None,
    series: int,
    rules: WatchRules,
) -> Watched:
    count = len(values)
    shown = np.isfinite(errors) & (errors > 0.0)
    reach = np.array([t_quantile(int(each)) for each in freedom]) * np.where(shown, errors, np.nan)
    values = np.where(shown, values, np.nan)
    intervals = np.column_stack([values - reach, values + reach])
    nothing = np.full(count, np.nan)
    if course is None:
        empty = np.full((count, 2), np.nan)
        return Watched(parameter, values, errors, intervals, nothing, empty, np.nan, np.nan, np.nan, ())
    asked = level(rules.false_alarm, rules.over, rules.tests, series)
    quantile = float(stats.t.isf(0.5 * asked, course.freedom))

    def spread(of: Array) -> Array:
        placed = nothing.copy()
        placed[shown] = of
        return placed

    half = quantile * course.deviations * np.sqrt(1.0 + 1.0 / shown.sum())
    limits = np.column_stack([spread(course.began - half), spread(course.began + half)])
    mean = float(np.sqrt(np.mean(course.deviations**2)))
    between = float(np.sqrt(max(0.0, mean**2 - float(np.mean(errors[shown] ** 2)))))
    several = np.sqrt(1.0 / shown.sum() + 1.0 / rules.soon)
    step = (quantile + float(stats.norm.ppf(rules.power))) * mean * several
    places, days = np.flatnonzero(shown).tolist(), when[shown]
    changes = tuple(_moved(each, course, places, days, series, rules) for each in course.changes)
    return Watched(parameter, values, errors, intervals, spread(course.level), limits, mean, between, step, changes)


def _moved(each: Measured, course: Course, places: Sequence[int], days: Array, series: int, rules: WatchRules) -> Moved:
    turn = each.turn
    reach = t_quantile(max(int(course.freedom), 1)) * each.error
    whole = float(days[-1] - days[0])
    share = float(days[-1] - days[turn.at]) / whole if turn.kind == "drift" else 1.0
    ends = (each.size - reach, each.size + reach)
    p = 1.0 - (1.0 - min(1.0, turn.p * rules.tests * series)) ** rules.over
    drift = turn.kind == "drift"
    return Moved(
        kind=turn.kind,
        first=places[turn.at],
        earliest=places[each.earliest],
        latest=places[each.latest],
        size=share * each.size,
        interval=(share * ends[0], share * ends[1]),
        rate=each.size / whole if drift else None,
        rate_interval=(ends[0] / whole, ends[1] / whole) if drift else None,
        told=places[turn.told],
        p_value=p,
    )


def _as_lengths(found: Watched) -> Watched:
    """What is left as lengths: its series is that of their logarithms, in which a change is a ratio."""
    changes = tuple(_as_length(each, found) for each in found.changes)
    middle = float(np.exp(np.nanmean(found.level)))
    return replace(
        found,
        values=np.exp(found.values),
        errors=found.errors * np.exp(found.values),
        intervals=np.exp(found.intervals),
        level=np.exp(found.level),
        limits=np.exp(found.limits),
        deviation=middle * found.deviation,
        between=middle * found.between,
        smallest_step=middle * float(np.expm1(found.smallest_step)),
        changes=changes,
    )


def _as_length(change: Moved, found: Watched) -> Moved:
    before = float(np.exp(found.level[change.first] - (0.0 if change.kind == "drift" else change.size)))
    low, high = change.interval
    size, ends = before * float(np.expm1(change.size)), (before * float(np.expm1(low)), before * float(np.expm1(high)))
    rate, rates = change.rate, change.rate_interval
    if rate is not None and rates is not None:
        rate, rates = before * rate, (before * rates[0], before * rates[1])
    return replace(change, size=size, interval=ends, rate=rate, rate_interval=rates)
