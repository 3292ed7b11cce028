"""How far a value is beyond a limit, and the figures of an evaluated design."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from .figure import Figure, Limit

if TYPE_CHECKING:
    from linkwright.core.arm.evaluation import Evaluation

KEPT_WITHIN = 1e-9
"""A limit counts as kept within this, relative."""


def figures_of(evaluation: Evaluation, figures: Mapping[str, Figure]) -> dict[str, float]:
    """Every figure that a problem can limit, by its name (SI); NaN where it cannot be known or nothing has it."""
    values = {name: figure.value(evaluation) for name, figure in figures.items()}
    return {name: math.nan if value is None else value for name, value in values.items()}


def excess(limit: Limit, value: float) -> float:
    """How far a value (SI) is beyond a limit, relative to it; not above zero where it keeps the limit, as an aim is
    kept by anything; NaN for NaN."""
    if limit.aim:
        return -math.inf
    ratio = value / limit.value - 1.0
    return abs(ratio) if limit.relation == "==" else -ratio if limit.relation == ">=" else ratio


def shortfall(limit: Limit, value: float) -> float:
    """By how much a value (SI) would have to improve to keep a limit, relative to the value itself or the limit."""
    return limit.value / value - 1.0 if limit.relation == ">=" else value / limit.value - 1.0


def broken(limits: Sequence[Limit], evaluation: Evaluation) -> tuple[Limit, ...]:
    """The limits that an evaluated design breaks; one on a figure that is not known is not judged."""
    return tuple(limit for limit in limits if excess(limit, limit.of(evaluation)) > KEPT_WITHIN)
