"""`python -m benchmarks.watch`: false alarms of a watch of 50 weeks, and how soon it tells of a step.

Series by chance alone: estimates of eight parameters that scatter as their standard errors say, by more, by more in one
of them, with recordings of all kinds; and whole recordings from textbook kinematics that the watch knows nothing of,
measured from a frame that is mounted anew each week, zeros that scatter a little each time the arm is switched on.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from datetime import date, timedelta

import numpy as np

from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.watch.estimates import choose, estimate
from linkwright.core.diagnose.watch.watch import basics, watched
from tests.diagnose.several.days import arm, day

from .quiet import told_at

_WEEKS, _PARAMETERS, _AT_ONCE = 50, 8, 500
_SOFT, _OFF = 40e-6, 2e-5


def _scenarios() -> dict[str, tuple[np.ndarray, float]]:
    one = np.eye(_PARAMETERS)[0]
    return {
        "as their standard errors say": (0.0 * one, 0.0),
        "twice their errors more, all": (2.0 + 0.0 * one, 0.0),
        "one of them by its error more": (one, 0.0),
        "one of them by 5 times its error more": (5.0 * one, 0.0),
        "errors that differ threefold": (0.0 * one, 0.5),
        "the same, and by the error more": (1.0 + 0.0 * one, 0.5),
    }


def _by_chance(watches: int, between: np.ndarray, uneven: float, seed: int) -> int:
    """How many of so many watches alarm."""
    alarms = 0
    for part in range(watches // _AT_ONCE):
        rng = np.random.default_rng((seed, part))
        shape = (_AT_ONCE, _PARAMETERS, _WEEKS)
        errors = np.exp(uneven * rng.standard_normal((_AT_ONCE, 1, _WEEKS))) * np.ones(shape)
        values = errors * rng.standard_normal(shape) + between[:, None] * rng.standard_normal(shape)
        alarms += int((told_at(values, errors) > 0).any(axis=1).sum())
    return alarms


def _weeks_to_tell(step: float, at: int, watches: int) -> np.ndarray:
    """After how many weeks a step of so many standard errors in one parameter is told; nan: not within 50."""
    values = np.random.default_rng((int(10 * step), at)).standard_normal((watches, _PARAMETERS, _WEEKS))
    values[:, 0, at:] += step
    told = told_at(values, np.ones_like(values))[:, 0]
    return np.where(told > at, told - at, np.nan)


def _recordings(series: int) -> list[Recording]:
    """A year of quiet weeks, the frame mounted anew for each."""
    rng = np.random.default_rng((7, series))
    made: list[Recording] = []
    for week in range(_WEEKS):
        zeros = dict(zip((1, 2, 3), (_OFF * rng.standard_normal(3)).tolist(), strict=True))
        own = day(100 * series + week + 1, poses=10, compliance={2: _SOFT}, zeros=zeros)
        made.append(replace(own, date=(date(2026, 1, 5) + timedelta(weeks=week)).isoformat()))
    return made


def main() -> None:
    """Print what was measured."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--watches", type=int, default=4000, help="series by chance, of each kind")
    asked.add_argument("--series", type=int, default=100, help="series of whole recordings")
    given = asked.parse_args()
    if given.watches >= _AT_ONCE:
        watches = given.watches // _AT_ONCE * _AT_ONCE
        print(f"any alarm in {_WEEKS} quiet weeks, {_PARAMETERS} parameters, {watches} watches of each kind:")
        for seed, (name, (between, uneven)) in enumerate(_scenarios().items()):
            alarms = _by_chance(watches, between, uneven, seed)
            print(f"  {name}: {alarms} ({alarms / watches:.2%})", flush=True)
        for step in (3.0, 3.5, 4.0, 5.0):
            for at in (10, 25):
                weeks = _weeks_to_tell(step, at, 500)
                told = np.nan_to_num(weeks, nan=np.inf)
                share = float(np.mean(told <= 5))
                print(
                    f"  a step of {step:g} after {at} weeks: half told within {np.median(told):g}, {share:.0%} within 5"
                )
    alarms, off = 0, []
    for series in range(given.series):
        made = _recordings(series)
        if not series:
            chosen = choose(arm(), made[:5], (), basics())
        values = estimate(arm(), made, chosen)
        found = watched(arm(), made, chosen, values, None, (), rules=RULES.watch)
        alarms += bool(found.moved)
        off.append([each.deviation**2 / float(np.mean(each.errors**2)) for each in found.parameters])
        if found.moved:
            print(f"  series {series}: {[(each.parameter.effect, each.parameter.at) for each in found.moved]}")
    if given.series:
        print(f"whole recordings, {len(chosen.watched)} effects and what is left: {alarms} of {given.series} alarm")
        print(f"  scatter over standard errors, squared, by parameter: {np.round(np.median(off, axis=0), 2).tolist()}")


if __name__ == "__main__":
    main()
