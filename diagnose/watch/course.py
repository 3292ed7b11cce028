"""The course of one parameter: what changed in it and when, found as the recordings came in, one after the other.

After each recording the series so far is searched for one more change: a step at any date, a steady change since the
last. What is beyond chance is taken in; how it is best told (a step, a recording that is off alone, a drift) and since
when is settled by all recordings in the end. That is the change-point model of D. M. Hawkins, P. Qiu & C. W. Kang,
J. Qual. Technol. 35 (2003) 355, doi:10.1080/00224065.2003.11980233, with the same chance of a false alarm after each
recording however many there are: what was told once stays told.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from linkwright.core.diagnose.rules.watch_rules import WatchRules
from linkwright.core.sections.numeric import Array

from .evidence import Tried, doubted, kink, looked_for, scatter, tried

Kind = Literal["step", "once", "drift"]
FEWEST = 3
"""A level, a change and something to measure its error by."""
_SWEEPS = 4
_LOCATED = 3.84
"""Chi-square, the 95 % point of one degree of freedom: dates that fit worse by no more belong to a date's interval."""


@dataclass(frozen=True)
class Turn:
    """A change in a series: a `step` after, one recording that is off alone (`once`) at, or a `drift` since recording
    `at` (from 0): a step is there from `at` on. `detected` is the recording by which it was beyond chance, `p` the
    p-value of the one test that told it."""

    kind: Kind
    at: int
    detected: int
    p: float


@dataclass(frozen=True)
class Measured:
    """A change with its size (SI; of a drift over the whole series) and standard error, and the first and last place
    that the series leaves open for it."""

    turn: Turn
    size: float
    error: float
    earliest: int
    latest: int


@dataclass(frozen=True)
class Course:
    """A series of n estimates: its level with the changes in it (n,), the level that it began with (n,), how far one
    quiet recording scatters (standard deviations (n,)), the degrees of freedom of that, and the changes."""

    level: Array
    began: Array
    deviations: Array
    freedom: float
    changes: tuple[Measured, ...]


def column(kind: Kind, at: int, when: Array) -> Array:
    """What a change of one unit adds to a series (n,)."""
    place = np.arange(len(when))
    if kind == "step":
        return (place >= at).astype(float)
    return (place == at).astype(float) if kind == "once" else kink(when, at)


def _model(turns: Sequence[Turn], when: Array) -> Array:
    return np.column_stack([np.ones(len(when)), *(column(turn.kind, turn.at, when) for turn in turns)])


@dataclass(frozen=True)
class Series:
    """One parameter's estimates (n,) with their errors at times `when` (n,), days; `common` (n,) is the factor that all
    parameters have in common by the time of each recording."""

    values: Array
    errors: Array
    when: Array
    common: Array
    rules: WatchRules

    def first(self, count: int) -> Series:
        """The series as it was after so many recordings."""
        return Series(self.values[:count], self.errors[:count], self.when[:count], self.common[:count], self.rules)

    def variances(self) -> Array:
        """The variances (1, n) of a quiet series but for a factor."""
        return scatter(self.values[None], self.errors[None]).variances

    def beside(self, turns: Sequence[Turn], columns: Array) -> Tried:
        """Further columns (n, K) tried one by one beside changes."""
        model = _model(turns, self.when)
        return tried(self.values[None], self.variances(), model, columns, self.common[-1:], self.rules.prior)


def turns_of(series: Series, level: float) -> list[Turn]:
    """The changes in a series, each found by a test of that level after the recording that told it."""
    turns: list[Turn] = []
    for count in range(FEWEST, len(series.values) + 1):
        so_far = series.first(count)
        turn = _one_more(so_far, turns, level)
        if turn is None:
            continue
        if turns:
            # What came since may have been an earlier change told wrongly: a drift told as a step, say.
            settled = _settled(so_far, turns)
            turn = _one_more(so_far, settled, level)
            if turn is None:
                turns = settled
                continue
        turns = _settled(so_far, [*turns, turn])
    return _settled(series, turns)


def _one_more(series: Series, turns: Sequence[Turn], level: float) -> Turn | None:
    """A further change since the last, where there is one."""
    count = len(series.values)
    if count - len(turns) - 2 < 1:
        return None
    since = max((turn.at for turn in turns), default=0)
    open_for = np.arange(since + 1, count)
    if not len(open_for):
        return None
    columns = looked_for(series.when)[:, [*(open_for - 1).tolist(), *([] if turns else [count - 1])]]
    model = _model(turns, series.when)
    every, freedom = doubted(
        series.values[None], series.errors[None], model, columns, series.common[-1:], series.rules.prior
    )
    t = every[0]
    best = int(np.argmax(t))
    p = float(2.0 * stats.t.sf(t[best], freedom))
    if p > level:
        return None
    kind: Kind = "step" if best < len(open_for) else "drift"
    return Turn(kind, int(open_for[best]) if kind == "step" else 0, count - 1, p)


def _open(turns: Sequence[Turn], place: int, count: int) -> list[tuple[Kind, int]]:
    """What a change may be told as, between its neighbours."""
    low = turns[place - 1].at + 1 if place else 0
    high = turns[place + 1].at if place + 1 < len(turns) else count
    steps: list[tuple[Kind, int]] = [("step", at) for at in range(max(low, 1), high)]
    once: list[tuple[Kind, int]] = [("once", at) for at in range(low, min(high, count - 1)) if at or count > FEWEST]
    drifts: list[tuple[Kind, int]] = [("drift", at) for at in range(low, min(high, count - 2))]
    return [*steps, *once, *drifts]


def _settled(series: Series, turns: list[Turn]) -> list[Turn]:
    """The changes told as the series fits them best, one after the other until nothing changes."""
    count = len(series.values)
    for _ in range(_SWEEPS):
        before = [(item.kind, item.at) for item in turns]
        for place, turn in enumerate(turns):
            ways = _open(turns, place, count)
            if not ways:
                continue
            others = [item for k, item in enumerate(turns) if k != place]
            beside = series.beside(others, np.column_stack([column(*way, series.when) for way in ways]))
            # What the others tell already (the first alone, beside a step after it) is no way of its own.
            left = np.where(beside.information[0] > 0.0, beside.left[0], np.inf)
            if not np.isfinite(left).any():
                continue
            kind, at = ways[int(np.argmin(left))]
            turns = [*turns[:place], Turn(kind, at, turn.detected, turn.p), *turns[place + 1 :]]
        if [(item.kind, item.at) for item in turns] == before:
            break
    return turns


def course_of(series: Series, level: float) -> Course:
    """What became of a parameter: its level, its changes, how far a quiet recording scatters."""
    turns = turns_of(series, level)
    variances, when = series.variances(), series.when
    model = _model(turns, when)
    weight = 1.0 / np.sqrt(variances[0])
    sizes = np.linalg.lstsq(model * weight[:, None], series.values * weight, rcond=None)[0]
    left = float(np.sum((weight * (series.values - model @ sizes)) ** 2))
    freedom, prior = max(len(when) - model.shape[1], 0), series.rules.prior
    scale = (prior * float(series.common[-1]) + left) / (prior + freedom)
    return Course(
        level=model @ sizes,
        began=np.full(len(when), sizes[0]),
        deviations=np.sqrt(scale * variances[0]),
        freedom=prior + freedom,
        changes=tuple(_measured(series, turns, place) for place in range(len(turns))),
    )


def _measured(series: Series, turns: Sequence[Turn], place: int) -> Measured:
    turn, others = turns[place], [item for k, item in enumerate(turns) if k != place]
    result = series.beside(others, column(turn.kind, turn.at, series.when)[:, None])
    ways = [way for way in _open(turns, place, len(series.values)) if way[0] == turn.kind]
    result_of_all = series.beside(others, np.column_stack([column(*way, series.when) for way in ways]))
    near = result_of_all.left[0] <= result.left[0, 0] + _LOCATED * result.scale[0, 0]
    places: NDArray[np.int64] = np.array([at for _, at in ways], dtype=np.int64)[near]
    size, error = float(result.sizes[0, 0]), float(result.errors[0, 0])
    if turn.kind == "once":
        return Measured(turn, size, error, turn.at, turn.at)
    return Measured(turn, size, error, int(places.min(initial=turn.at)), int(places.max(initial=turn.at)))
