"""Projections of an error: its component along a direction, or across it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import casadi as ca
import numpy as np

from linkwright.core.sections.numeric import Array

from .model import CaseModel, ErrorModel

Part = Literal["whole", "across", "along"]
"""What counts of an error on a path: its whole length, or that of what lies across or along the path."""


def onto(direction: Sequence[float], part: Part, *, planar: bool) -> Array:
    """The projection (3, 3) of an error onto a direction (`along`, of any length) or onto what lies across it; in the
    plane that is the other direction of the plane."""
    unit = np.asarray(direction, dtype=float) / np.linalg.norm(direction)
    if part == "whole":
        return np.eye(3)
    if part == "along":
        return np.outer(unit, unit)
    if planar:
        across = np.array([-unit[1], unit[0], 0.0])
        return np.outer(across, across)
    return np.eye(3) - np.outer(unit, unit)


def part_of(model: ErrorModel, projections: Sequence[Array]) -> ErrorModel:
    """The model of what projections (3, 3) leave of an error: its cases under the first, then under the next."""
    cases = tuple(_case(case, projection) for projection in projections for case in model.cases)
    return replace(model, cases=cases)


def _case(case: CaseModel, projection: Array) -> CaseModel:
    vector, intervals, *rest, kinks, kink_loads = case.outputs
    outputs = tuple(_projected(projection, item) for item in (vector, intervals))
    outputs = (*outputs, *rest, _projected(projection, kinks), kink_loads)
    function = ca.Function("part", [case.q, case.p], list(outputs))
    return replace(case, outputs=outputs, function=function, projection=projection)


def _projected(projection: Array, column: Any) -> Any:
    """A projection of each vector of a column of symbols, with nothing where the projection has nothing."""
    rows: list[Any] = []
    for start in range(0, column.numel(), 3):
        for row in projection:
            terms = [float(x) * column[start + k] for k, x in enumerate(row) if abs(x) > 1e-15]
            rows.append(sum(terms[1:], terms[0]) if terms else ca.SX(0.0))
    return ca.vertcat(*rows) if rows else column
