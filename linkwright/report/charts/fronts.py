"""The fronts of a trade-off: in words, as plotly draws them, and as a picture that stands by itself."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from linkwright.core.optimize.tradeoff.front import Front, Point, Tradeoff
from linkwright.core.optimize.tradeoff.question import Axis
from linkwright.report.page import figure_place
from linkwright.report.pictures.plots import Figure
from linkwright.report.pictures.svg import Plot, element, label, marks, text
from linkwright.results.document import Drawn
from linkwright.results.figures_in_words import figure, section_words, with_unit


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


COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a7a00", "#7f3c8d")
"""Apart for people who are colour-blind as well (after Okabe and Ito, Color Universal Design, 2008)."""
_GREY = "#b8c0cb"
_LOOK = (
    "svg{background:#fff;font-family:system-ui,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif}"
    "text{fill:#5b6675;stroke:#fff;stroke-width:4;stroke-linejoin:round;paint-order:stroke}.figures{fill:#1d2530}"
    ".axis{stroke:#d9dee5}.frame,.front{fill:none}.frame{stroke:#5b6675}.front{stroke-linejoin:round}"
)
"""The picture's styles: it stands by itself, on white."""


def span(axis: Axis, values: Sequence[float], *, log: bool) -> tuple[float, float]:
    """Where an axis begins and ends (in its unit), with a little air."""
    low, high = axis.factor * min(values), axis.factor * max(values)
    if log:
        air = (high / low) ** 0.07
        return low / air, high * air
    air = 0.07 * (high - low) or 0.05 * high
    return max(low - air, 0.0), high + air


def _axis(drawn: Sequence[Sequence[float | None]], *, log: bool) -> Figure:
    """An axis of a figure; one in logarithms is marked as that of the picture is, since plotly's marks between the
    powers of ten are too small to read."""
    if not log:
        return {"type": "linear", "zeroline": False}
    values = [value for values in drawn for value in values if value is not None]
    ticks = marks(min(values), max(values), log=True) if values else []
    marked = {"tickmode": "array", "tickvals": ticks, "ticktext": [figure(tick) for tick in ticks]}
    return {"type": "log", "zeroline": False, **(marked if len(ticks) > 1 else {"exponentformat": "power"})}


def tradeoff_picture(result: Tradeoff) -> str:
    """The picture as an SVG file: the fronts with their knee and both ends; of several their envelope too."""
    x, y = result.asked.x, result.asked.y
    across = span(x, [point.x for point in result.points], log=result.logs[0])
    up = span(y, [point.y for point in result.points], log=result.logs[1])
    several = len(result.fronts) > 1
    plot = Plot(
        738.0, 436.0, across, up, 92.0, 48.0 + 20.0 * (len(result.fronts) + 1) * several, 60.0, 30.0, result.logs
    )
    left, foot = plot.left, plot.top + plot.height + 54.0
    better = ", ".join(f"{'more' if axis.more_is_better else 'less'} {axis.title}" for axis in (x, y))
    title = f"{result.asked.given.arm.name}: {y.title} against {x.title}"
    parts = [label(left, 26.0, 17.0, title, "start", "figures"), label(left, 46.0, 12.5, f"better: {better}", "start")]
    drawn = [(front, COLOURS[k % len(COLOURS)], 2.0) for k, front in enumerate(result.fronts)]
    for number, (front, colour, wide) in enumerate([(result.envelope, _GREY, 7.0), *drawn] if several else drawn):
        at = [_curve_place(plot, result, x_, y_) for x_, y_, _ in _steps(result, front)]
        course = "M" + "L".join(f"{u:.2f},{v:.2f}" for u, v in at)
        parts.append(element("path", d=course, class_="front", stroke=colour, stroke_width=wide))
        if front is not result.envelope or not several:
            places = [_curve_place(plot, result, point.x, point.y) for point in result.of(front)]
            parts += [element("circle", cx=u, cy=v, r=2.6, fill=colour) for u, v in places]
        if several:
            row = foot + 20.0 * number
            parts.append(element("path", d=f"M{left},{row}h20", class_="front", stroke=colour, stroke_width=wide))
            parts.append(label(left + 26.0, row + 4.0, 12.0, "envelope" if not number else front.name, "start"))
    envelope = result.of(result.envelope)
    ends = [("", number) for number in dict.fromkeys((envelope[0].number, envelope[-1].number))]
    knees = [] if result.envelope.knee is None else [("knee: ", result.envelope.knee)]
    for what, number in (*ends, *knees):
        parts += _pointed_out(plot, result, result.points[number - 1], what)
    drawing = plot.drawn(picture_words(result), (x.heading, y.heading), element("style", _LOOK), *parts)
    return drawing.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1) + "\n"


def _curve_place(plot: Plot, result: Tradeoff, x: float, y: float) -> tuple[float, float]:
    """Where a point of both figures (SI) stands on the page."""
    factors = result.asked.x.factor, result.asked.y.factor
    return float(plot.x(np.array(factors[0] * x))), float(plot.y(np.array(factors[1] * y)))


def _steps(result: Tradeoff, front: Front) -> list[tuple[float, float, Point | None]]:
    """Where a front runs (SI): straight from point to point, at a step (None) level first, then down."""
    points, steps = result.of(front), set(front.steps)
    places: list[tuple[float, float, Point | None]] = [(points[0].x, points[0].y, points[0])]
    for before, point in pairwise(points):
        places += [(point.x, before.y, None)] if (before.number, point.number) in steps else []
        places.append((point.x, point.y, point))
    return places


def _pointed_out(plot: Plot, result: Tradeoff, point: Point, what: str) -> list[str]:
    """A ring around a point and its figures, on the side of the front where there is room for them."""
    u, v = _curve_place(plot, result, point.x, point.y)
    digits = 3 if what else 4
    words = f"{what}{shown(result.asked.x, point.x, digits)}, {shown(result.asked.y, point.y, digits)}"
    late = u > plot.left + 0.5 * plot.width
    above = (point is result.of(result.envelope)[0]) != result.asked.y.more_is_better and not what
    start = (u - 9.0, "end") if late else (u + 9.0, "start")
    ring = element("circle", cx=u, cy=v, r=5.0, fill="none", stroke="#1d2530", stroke_width=1.6)
    return [ring, label(start[0], v - 11.0 if above else v + 20.0, 12.0, words, start[1], "figures")]


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
    known = [item for item in result.asked.given.figures.values() if item.name not in (x.name, y.name)]
    shown_of = [(item.title, item.shown(point.figures.get(item.name)), item.unit) for item in known]
    others = [f"{title} {with_unit(value, unit)}".strip() for title, value, unit in shown_of if value is not None]
    lines += [", ".join(others[k : k + 3]) for k in range(0, len(others), 3)]
    lines += [
        f"link {number}: {figure(1e3 * link.length)} mm, {text(section_words(link))}"
        for number, link in enumerate(point.arm.links, start=1)
    ]
    return "<br>".join(lines)


def _trace(result: Tradeoff, front: Front, colour: str, wide: float, *, dots: bool, brief: bool) -> Figure:
    x, y = result.asked.x, result.asked.y
    places = _steps(result, front)
    trace: dict[str, Any] = {
        "type": "scatter",
        "mode": "lines+markers" if dots else "lines",
        "name": front.name,
        "x": [x.factor * at for at, _, _ in places],
        "y": [y.factor * at for _, at, _ in places],
        "line": {"color": colour, "width": wide},
        "hovertext": ["a step" if point is None else _hover(result, point, brief=brief) for _, _, point in places],
        "hoverinfo": "text" if dots else "skip",
    }
    if dots:
        trace["marker"] = {"color": colour, "size": [0 if point is None else 7 for _, _, point in places]}
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
    return {"data": data, "layout": _layout(result, y.heading, data, log=result.logs[1])}


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
    return {"data": data, "layout": _layout(result, f"price in {unit}", data, log=True)}


def _layout(result: Tradeoff, words: str, data: Sequence[Figure], *, log: bool) -> Figure:
    x = result.asked.x
    return {
        "xaxis": {"title": {"text": x.heading}, **_axis([trace["x"] for trace in data], log=result.logs[0])},
        "yaxis": {"title": {"text": words}, **_axis([trace["y"] for trace in data], log=log)},
        "margin": {"l": 70, "r": 10, "t": 10, "b": 50},
        "legend": {"orientation": "h", "y": -0.35, "yanchor": "top"},
        "showlegend": True,
        "hovermode": "closest",
    }
