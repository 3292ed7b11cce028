"""Readings at one pose that are no plain repeats: a long stay in which the arm drifts, and visits that come back.

Repeats are the noise where nothing but noise can have happened between them. In a stay of hours the arm warms: then
only neighbours are repeats, and what lies between them is drift. Where a pose is only ever come back to (the cycles of
ISO 9283), visits next to each other in time are the nearest to repeats that there is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import f as f_distribution

from diagnose.rules.residual_rules import ResidualRules
from diagnose.rules.rules import RULES
from sections.numeric import Array

Rows = NDArray[np.int64]


def without_drift(
    residual: Array, groups: Sequence[Rows], *, rules: ResidualRules = RULES.residual
) -> tuple[Rows, ...]:
    """Groups of repeats (indices of `residual`, (N, D) m), long ones that drift cut into short runs.

    Whether they drift tells the scatter of the runs' means against that within runs (F test over all components).
    """
    found: list[Rows] = []
    for group in groups:
        drifts = len(group) >= rules.long_stay and _drifts(residual[group], rules)
        found += _runs(group, rules.neighbours) if drifts else [group]
    return tuple(found)


def _runs(group: Rows, together: int) -> list[Rows]:
    return np.array_split(group, len(group) // together)


def _drifts(values: Array, rules: ResidualRules) -> bool:
    runs = [values[run] for run in _runs(np.arange(len(values)), rules.neighbours)]
    within = sum(float(np.sum((run - run.mean(axis=0)) ** 2)) for run in runs)
    middle = values.mean(axis=0)
    between = sum(len(run) * float(np.sum((run.mean(axis=0) - middle) ** 2)) for run in runs)
    width = values.shape[1]
    of_within, of_between = width * (len(values) - len(runs)), width * (len(runs) - 1)
    if within <= 0.0:
        return between > 0.0
    ratio = between / of_between / (within / of_within)
    return float(f_distribution.sf(ratio, of_between, of_within)) < rules.drift_false_alarm


def differences_of_revisits(residual: Array, visits: Sequence[Rows]) -> Array:
    """Differences (m, D), m, of readings at one pose and condition that follow each other in time, each with the
    variance of one reading; `visits` are the readings of each pose and condition in the order of time.

    Slow drift is nearly out of them (J. von Neumann, Ann. Math. Statist. 12 (1941) 367, doi:10.1214/aoms/1177731677).
    """
    found = [np.diff(residual[rows], axis=0) / np.sqrt(2.0) for rows in visits if len(rows) > 1]
    return np.concatenate(found) if found else np.zeros((0, residual.shape[1]))
