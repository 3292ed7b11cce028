"""The fronts of a trade-off as plotly draws them: the front to look into, and the price along it."""

from __future__ import annotations

from typing import Any

from linkwright.core.optimize.tradeoff.front import Front, Point, Tradeoff
from linkwright.report.page import figure_place
from linkwright.report.pictures.plots import Figure
from linkwright.report.pictures.svg import text
from linkwright.report.pictures.tradeoff import COLOURS, picture_words, price_words, shown, slope_factor
from linkwright.results.document import Drawn
from linkwright.results.figures_in_words import figure, section_words, with_unit

_ENVELOPE = "rgba(140,150,165,0.45)"


def front(result: Tradeoff) -> Drawn:
    """The front to look into."""
    words = picture_words(result)
    return Drawn(figure_place("front", words, text(words)), {"front": front_figure(result)})


def price(result: Tradeoff) -> Drawn:
    """The price along the front."""
    place = figure_place("price", f"Price in {slope_factor(result)[1]} along the front")
    return Drawn(place, {"price": price_figure(result)})


def _hover(result: Tradeoff, point: Point, *, brief: bool) -> str:
    x, y = result.asked.x, result.asked.y
    lines = [
        f"<b>point {point.number}</b> {text(point.front)}",
        f"{x.title} {shown(x, point.x, 5)}",
        f"{y.title} {shown(y, point.y, 5)}",
        f"price {price_words(result, point)}",
    ]
    if brief:
        return "<br>".join(lines)
    known = [each for each in result.asked.given.figures.values() if each.name not in (x.name, y.name)]
    shown_of = [(each.title, each.shown(point.figures[each.name]), each.unit) for each in known]
    others = [f"{title} {with_unit(value, unit)}".strip() for title, value, unit in shown_of if value is not None]
    lines += [", ".join(others[k : k + 3]) for k in range(0, len(others), 3)]
    lines += [
        f"link {number}: {figure(1e3 * link.length)} mm, {text(section_words(link))}"
        for number, link in enumerate(point.arm.links, start=1)
    ]
    return "<br>".join(lines)


def _trace(result: Tradeoff, front: Front, colour: str, wide: float, *, dots: bool, brief: bool) -> Figure:
    x, y = result.asked.x, result.asked.y
    across: list[float] = []
    up: list[float] = []
    words: list[str] = []
    sizes: list[int] = []
    steps = set(front.steps)
    points = result.of(front)
    for before, point in zip((None, *points), points, strict=False):
        if before is not None and (before.number, point.number) in steps:
            across.append(x.factor * point.x)
            up.append(y.factor * before.y)
            words.append("a step")
            sizes.append(0)
        across.append(x.factor * point.x)
        up.append(y.factor * point.y)
        words.append(_hover(result, point, brief=brief))
        sizes.append(7)
    trace: dict[str, Any] = {
        "type": "scatter",
        "mode": "lines+markers" if dots else "lines",
        "name": front.name,
        "x": across,
        "y": up,
        "line": {"color": colour, "width": wide},
        "hovertext": words,
        "hoverinfo": "text" if dots else "skip",
    }
    if dots:
        trace["marker"] = {"color": colour, "size": sizes}
    return trace


def front_figure(result: Tradeoff, *, brief: bool = False) -> Figure:
    """The fronts as plotly draws them; `brief` where a design that is pointed at is told of elsewhere."""
    x, y = result.asked.x, result.asked.y
    grouped = len(result.fronts) > 1
    data: list[Figure] = []
    if grouped:
        data.append(_trace(result, result.envelope, _ENVELOPE, 9.0, dots=False, brief=brief))
    data += [
        _trace(result, front, COLOURS[k % len(COLOURS)], 2.0, dots=True, brief=brief)
        for k, front in enumerate(result.fronts)
    ]
    if result.envelope.knee is not None:
        knee = result.points[result.envelope.knee - 1]
        data.append(
            {
                "type": "scatter",
                "mode": "markers",
                "name": "knee",
                "x": [x.factor * knee.x],
                "y": [y.factor * knee.y],
                "hovertext": [_hover(result, knee, brief=brief)],
                "hoverinfo": "text",
                "marker": {"symbol": "diamond-open", "size": 15, "color": "#e5383b", "line": {"width": 2.5}},
            }
        )
    return {"data": data, "layout": _layout(result, y.heading, log=result.logs[1])}


def price_figure(result: Tradeoff) -> Figure:
    """The size of the slope along each front."""
    factor, unit = slope_factor(result)
    data: list[Figure] = []
    for k, front in enumerate(result.fronts):
        points = [point for point in result.of(front) if point.slope is not None and abs(point.slope) > 0.0]
        sizes = [abs(factor * point.slope) for point in points if point.slope is not None]
        # Where the limit does not hold, the multiplier is what the solver leaves of zero.
        least = 1e-7 * max(sizes, default=0.0)
        data.append(
            {
                "type": "scatter",
                "mode": "lines+markers",
                "name": front.name,
                "x": [result.asked.x.factor * point.x for point in points],
                "y": [size if size > least else None for size in sizes],
                "line": {"color": COLOURS[k % len(COLOURS)], "width": 2},
                "hovertemplate": f"%{{x:.5g}} {result.asked.x.unit}: %{{y:.3g}} {unit}<extra></extra>",
            }
        )
    return {"data": data, "layout": _layout(result, f"price in {unit}", log=True)}


def _layout(result: Tradeoff, words: str, *, log: bool) -> Figure:
    x = result.asked.x
    plain = {"zeroline": False, "exponentformat": "power"}
    return {
        "xaxis": {"title": {"text": x.heading}, "type": "log" if result.logs[0] else "linear", **plain},
        "yaxis": {"title": {"text": words}, "type": "log" if log else "linear", **plain},
        "margin": {"l": 70, "r": 10, "t": 10, "b": 50},
        "legend": {"orientation": "h", "y": 1.12},
        "showlegend": True,
        "hovermode": "closest",
    }
