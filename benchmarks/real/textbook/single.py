"""Least squares of one joint or one column, where there is no arm to calibrate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.real.textbook.chain import Array


@dataclass(frozen=True)
class Spring:
    """A level lever of `length` m whose joint is off by `middle` rad and gives `compliance` rad/(N*m)."""

    length: float
    middle: float
    compliance: float

    def left(self, q: Array, tip: Array, force: Array) -> Array:
        """What it leaves (N, 2) m of places (N, 2 or 3) under forces (N, 2 or 3) at the tip."""
        angle = q + self.middle + self.compliance * _moment(q, force, self.length)
        return tip[:, :2] - self.length * np.column_stack([np.cos(angle), np.sin(angle)])


def _moment(q: Array, force: Array, length: float) -> Array:
    return length * (np.cos(q) * force[:, 1] - np.sin(q) * force[:, 0])


def spring(q: Array, tip: Array, force: Array, length: float) -> Spring:
    """The lever that fits angles q (N,), places and forces best."""
    turn = np.arctan2(tip[:, 1], tip[:, 0]) - q
    columns = np.column_stack([np.ones(len(q)), _moment(q, force, length)])
    middle, compliance = np.linalg.lstsq(columns, turn, rcond=None)[0]
    return Spring(length, float(middle), float(compliance))


def slope(covariate: Array, height: Array) -> float:
    """How much a height (N,) rises per unit of a covariate (N,)."""
    away = covariate - covariate.mean()
    return float(away @ (height - height.mean()) / (away @ away))


def left(covariate: Array, height: Array, rise: float) -> float:
    """RMS of a height beside a rise, its own zero taken off."""
    rest = height - rise * covariate
    return float(np.std(rest))
