"""Fronts in words that page, pictures and files share: values of an axis, prices, the front in a sentence."""

from __future__ import annotations

from linkwright.core.optimize.tradeoff.front import Point, Tradeoff
from linkwright.core.optimize.tradeoff.question import Axis
from linkwright.results.figures_in_words import figure


def shown(axis: Axis, value: float, digits: int = 4) -> str:
    """A value (SI) of an axis with its unit."""
    return f"{figure(axis.factor * value, digits)} {axis.unit}".strip()


def slope_factor(result: Tradeoff) -> tuple[float, str]:
    """What one SI unit of the slope dy/dx is in the unit people read, and that unit."""
    x, y = result.asked.x, result.asked.y
    over = f"/{x.unit}" if x.unit else ""
    return y.factor / x.factor, f"{y.unit or '1'}{over}" if over else y.unit


def price_words(result: Tradeoff, point: Point) -> str:
    """The price at a point: what one unit more of x does to y."""
    if point.slope is None:
        return "–"
    factor, unit = slope_factor(result)
    return f"{figure(factor * point.slope, 3)} {unit}".strip()


def picture_words(result: Tradeoff) -> str:
    """The picture in a sentence, for those who cannot see it."""
    x, y = result.asked.x, result.asked.y
    first, last = result.of(result.envelope)[0], result.of(result.envelope)[-1]
    words = (
        f"{y.title} against {x.title}: from {shown(y, first.y)} at {shown(x, first.x)} to {shown(y, last.y)} at "
        f"{shown(x, last.x)}"
    )
    if result.envelope.knee is not None:
        knee = result.points[result.envelope.knee - 1]
        words += f", with the knee at {shown(x, knee.x, 3)} and {shown(y, knee.y, 3)}"
    return words + "."
