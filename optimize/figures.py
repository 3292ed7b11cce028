"""The figures of an evaluated design that limits are on, and whether it keeps them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from arm.evaluation import Evaluation

from .problem import Limit

KEPT_WITHIN = 1e-9
"""A limit counts as kept within this, relative."""


def figures_of(evaluation: Evaluation) -> dict[str, float]:
    """Every figure that a problem can limit, by its name (SI); NaN where it cannot be known or nothing has it."""
    strength, frequency, drives = evaluation.strength, evaluation.frequency, evaluation.drives
    use = None if drives is None else drives.greatest_use
    return {
        "max_error": evaluation.max_error,
        "mass": evaluation.mass,
        "total_mass": evaluation.total_mass,
        "reach": evaluation.reach,
        "cost": evaluation.cost if evaluation.cost is not None else math.nan,
        "safety_factor": strength.least_safety_factor or math.nan,
        "first_frequency": frequency.value if frequency is not None else math.nan,
        "buckling": strength.least_buckling or math.nan,
        "torque_use": math.nan if use is None else use,
    }


def excess(limit: Limit, value: float) -> float:
    """How far a value (SI) is beyond a limit, relative to it; not above zero where it keeps the limit, NaN for NaN."""
    ratio = value / limit.value - 1.0
    return abs(ratio) if limit.relation == "==" else -ratio if limit.relation == ">=" else ratio


def broken(limits: Sequence[Limit], figures: Mapping[str, float]) -> tuple[Limit, ...]:
    """The limits that figures break; a buckling factor that is not known is one that nothing presses."""
    return tuple(limit for limit in limits if excess(limit, figures[limit.name]) > KEPT_WITHIN)
