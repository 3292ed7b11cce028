"""Where no design of sizes that can be had keeps all limits: which breaks them least, and by how much.

Each design's worst excess over a limit is bounded from below by the poses known; the design with the least bound is
evaluated, until none can break less than the best evaluated so far.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.arm.figures import Limit, excess
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import NotRounded
from linkwright.core.optimize.sizes.judge import CHUNK, Judge
from linkwright.core.optimize.sizes.rows import Integers
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import NoAnswer, format_quantity

from .options import Rounding

MOST_EVALUATED = 12
"""Designs evaluated before the best of them is taken for the nearest."""


class NoRounding(NoAnswer):
    """No design of sizes that can be had keeps the limits; `not_rounded` has the one that breaks them least."""

    def __init__(self, not_rounded: NotRounded) -> None:
        self.not_rounded = not_rounded
        super().__init__(not_rounded.reason)

    def __reduce__(self) -> tuple[object, ...]:
        """Keep what was found when the error crosses between processes."""
        return NoRounding, (self.not_rounded,)


@dataclass(frozen=True)
class Nearest:
    """The design that breaks the limits least: its evaluation, and its worst excess over a limit (relative to it).

    `proven`: no other of the designs compared breaks them less.
    """

    evaluation: Evaluation
    excess: float
    proven: bool


def nearest_design(judge: Judge, picks: Integers) -> Nearest | None:
    """The design of `picks` (see `Table`) that breaks the limits least; None where none reaches the workspace."""
    picks = judge.table.agreeing(picks)
    over = np.concatenate([_bounds(judge, picks[k : k + CHUNK]) for k in range(0, len(picks), CHUNK)] or [np.zeros(0)])
    best: Nearest | None = None
    for _ in range(min(MOST_EVALUATED, len(picks))):
        at = int(np.argmin(over))
        if best is not None and not over[at] < best.excess:
            return Nearest(best.evaluation, best.excess, proven=True)
        over[at] = math.inf
        evaluation = _evaluated(judge.problem, judge, picks[at])
        if evaluation is not None and (best is None or evaluation.excess < best.excess):
            best = evaluation
    return best


def _bounds(judge: Judge, picks: Integers) -> Array:
    """How far each design exceeds some limit at least."""
    over = judge.exceeded(picks)
    known = [np.where(np.isnan(values), -math.inf, values) for values in over.values()]
    return np.max(known, axis=0) if known else np.full(len(picks), -math.inf)


def _evaluated(problem: Problem, judge: Judge, pick: Integers) -> Nearest | None:
    try:
        evaluation = evaluate(judge.table.arm_of([int(k) for k in pick]), problem.workspace, problem.load_cases)
    except Unreachable:
        return None
    if problem.must_reach and evaluation.unreached is not None:
        return None
    excesses = [excess(limit, limit.of(evaluation)) for limit in problem.limits]
    return Nearest(evaluation, max((value for value in excesses if not math.isnan(value)), default=0.0), proven=False)


def why_not(judge: Judge, rounding: Rounding) -> str:
    """Which limit no rounded design keeps."""
    sizes = "stock sizes" if rounding.step is None else f"sizes in steps of {rounding.text}"
    for limit in judge.problem.limits:
        over = judge.least.get(limit.text, 0.0)
        if over > 0.0 and not math.isinf(over):
            return f"no design of {sizes} near the optimum keeps {limit.text}: the nearest has {_had(limit, over)}"
    if judge.nearest is None:
        return f"no design of {sizes} near the optimum reaches the whole workspace"
    over, limit = judge.nearest
    broken_by = f"the nearest breaks {limit.text} with {_had(limit, over)}"
    return f"no design of {sizes} near the optimum keeps all limits at once: {broken_by}"


def _had(limit: Limit, over: float) -> str:
    way = -1.0 if limit.relation == ">=" else 1.0
    return format_quantity(limit.value * (1.0 + way * over), limit.figure.kind, digits=4)
