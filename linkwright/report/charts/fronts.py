"""The fronts of a trade-off: in words, as plotly draws them, and as a picture that stands by itself."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from linkwright.core.optimize.tradeoff.front import Front, Point, Tradeoff
from linkwright.core.optimize.tradeoff.question import Axis
from linkwright.report.page import figure_place
from linkwright.report.pictures.plots import Figure
from linkwright.report.pictures.svg import element, nice_below, text
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


WIDTH, HEIGHT = 860.0, 560.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 92.0, 30.0, 60.0, 64.0
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a7a00", "#7f3c8d")
"""Apart for people who are colour-blind as well (after Okabe and Ito, Color Universal Design, 2008)."""
INK, MUTED, LINE = "#1d2530", "#5b6675", "#d9dee5"
Place = Callable[[float], float]


def ticks(low: float, high: float, *, log: bool) -> list[float]:
    """Values at which an axis is marked: round ones, on an axis in logarithms 1, 2 and 5 times powers of ten."""
    if log:
        powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
        steps = (1.0, 2.0, 5.0) if math.log10(high / low) < 2.5 else (1.0,)
        values = [step * 10.0**power for power in powers for step in steps]
    else:
        step = nice_below((high - low) / 5.0)
        values = [step * k for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]
    return [value for value in values if low * (1.0 - 1e-9) <= value <= high * (1.0 + 1e-9)]


def span(axis: Axis, values: Sequence[float], *, log: bool) -> tuple[float, float]:
    """Where an axis begins and ends (in its unit), with a little air."""
    low, high = axis.factor * min(values), axis.factor * max(values)
    if log:
        air = (high / low) ** 0.07
        return low / air, high * air
    air = 0.07 * (high - low) or 0.05 * high
    return max(low - air, 0.0), high + air


def _axis(drawn: Sequence[Sequence[float | None]], *, log: bool) -> Figure:
    """An axis of a figure; one in logarithms is marked as that of the picture is, since plotly's own marks between the
    powers of ten are too small to read."""
    if not log:
        return {"type": "linear", "zeroline": False}
    values = [value for values in drawn for value in values if value is not None]
    marks = ticks(min(values), max(values), log=True) if values else []
    own = {"tickmode": "array", "tickvals": marks, "ticktext": [figure(mark) for mark in marks]}
    return {"type": "log", "zeroline": False, **(own if len(marks) > 1 else {"exponentformat": "power"})}


def tradeoff_picture(result: Tradeoff) -> str:
    """The picture as an SVG file."""
    x, y = result.asked.x, result.asked.y
    across = span(x, [point.x for point in result.points], log=result.logs[0])
    up = span(y, [point.y for point in result.points], log=result.logs[1])
    place_x = _scale(across, (_LEFT, WIDTH - _RIGHT), log=result.logs[0])
    place_y = _scale(up, (HEIGHT - _BOTTOM, _TOP), log=result.logs[1])

    def at(point: Point) -> tuple[float, float]:
        return place_x(x.factor * point.x), place_y(y.factor * point.y)

    grouped = len(result.fronts) > 1
    legend, more = _legend(result) if grouped else ([], 0.0)
    parts = [element("rect", x=0, y=0, width=WIDTH, height=HEIGHT + more, fill="#ffffff"), *legend]
    parts += _frame(x, across, place_x, y, up, place_y, result.logs)
    parts += _ends(result, at)  # beneath the fronts, so that its words hide no point
    if grouped:
        parts.append(_curve(result, result.envelope, at, "#b8c0cb", 7.0))
    for number, front in enumerate(result.fronts):
        colour = COLOURS[number % len(COLOURS)]
        parts.append(_curve(result, front, at, colour, 2.0))
        parts += [_dot(at(point), 2.6, colour) for point in result.of(front)]
    parts += _knee(result, at)
    better = [f"{'more' if axis.more_is_better else 'less'} {axis.title}" for axis in (x, y)]
    title = f"{result.asked.given.arm.name}: {y.title} against {x.title}"
    parts.append(_words(_LEFT, 26.0, title, size=17, colour=INK, anchor="start", weight="600"))
    parts.append(_words(_LEFT, 46.0, f"better: {better[0]}, {better[1]}", size=12.5, anchor="start"))
    window = f"0 0 {WIDTH:g} {HEIGHT + more:g}"
    family = "system-ui, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{window}" width="{WIDTH:g}" height="{HEIGHT + more:g}" '
        f'role="img" aria-label="{text(picture_words(result)).replace(chr(34), "")}" font-family="{family}">'
        + "".join(parts)
        + "</svg>\n"
    )


def _scale(values: tuple[float, float], places: tuple[float, float], *, log: bool) -> Place:
    low, high = (math.log(value) for value in values) if log else values

    def place(value: float) -> float:
        share = ((math.log(value) if log else value) - low) / (high - low)
        return places[0] + share * (places[1] - places[0])

    return place


def _frame(
    x: Axis,
    across: tuple[float, float],
    place_x: Place,
    y: Axis,
    up: tuple[float, float],
    place_y: Place,
    logs: tuple[bool, bool],
) -> list[str]:
    bottom, right = HEIGHT - _BOTTOM, WIDTH - _RIGHT
    parts: list[str] = []
    for value in ticks(*across, log=logs[0]):
        at = place_x(value)
        parts.append(_line((at, _TOP), (at, bottom), LINE, 1.0))
        parts.append(_words(at, bottom + 18.0, figure(value), size=12.0))
    for value in ticks(*up, log=logs[1]):
        at = place_y(value)
        parts.append(_line((_LEFT, at), (right, at), LINE, 1.0))
        parts.append(_words(_LEFT - 8.0, at + 4.0, figure(value), size=12.0, anchor="end"))
    parts.append(_line((_LEFT, bottom), (right, bottom), MUTED, 1.2))
    parts.append(_line((_LEFT, _TOP), (_LEFT, bottom), MUTED, 1.2))
    parts.append(_words(0.5 * (_LEFT + right), bottom + 44.0, x.heading, size=13.5, colour=INK))
    middle = 0.5 * (_TOP + bottom)
    words = y.heading
    parts.append(
        element(
            "text",
            text(words),
            x=22.0,
            y=middle,
            font_size=13.5,
            fill=INK,
            text_anchor="middle",
            transform=f"rotate(-90 22 {middle:g})",
        )
    )
    return parts


def _curve(result: Tradeoff, front: Front, at: Callable[[Point], tuple[float, float]], colour: str, wide: float) -> str:
    """Straight from point to point; at a step level first, then down."""
    points = result.of(front)
    steps = set(front.steps)
    places = [at(point) for point in points]
    drawn = f"M{places[0][0]:.2f},{places[0][1]:.2f}"
    for k in range(1, len(points)):
        (_, before), (across, up) = places[k - 1], places[k]
        if (points[k - 1].number, points[k].number) in steps:
            drawn += f"L{across:.2f},{before:.2f}"
        drawn += f"L{across:.2f},{up:.2f}"
    return element(
        "path", d=drawn, fill="none", stroke=colour, stroke_width=wide, stroke_linejoin="round", stroke_linecap="round"
    )


def _knee(result: Tradeoff, at: Callable[[Point], tuple[float, float]]) -> list[str]:
    if result.envelope.knee is None:
        return []
    point = result.points[result.envelope.knee - 1]
    across, up = at(point)
    size = 7.0
    diamond = f"M{across - size:.2f},{up:.2f}l{size},{-size}l{size},{size}l{-size},{size}z"
    words = f"knee: {shown(result.asked.x, point.x, 3)}, {shown(result.asked.y, point.y, 3)}"
    # On the better side of the front, where nothing else is drawn, as far as there is room.
    room = 8.0 * len(words) + 12.0
    right, above = result.asked.x.more_is_better, result.asked.y.more_is_better
    if (not right and across - room < _LEFT) or (right and across + room > WIDTH - _RIGHT):
        right, above = not right, not above
    start = (across + 12.0, "start") if right else (across - 12.0, "end")
    mark = element("path", d=diamond, fill="#ffffff", stroke=INK, stroke_width=2.0)
    height = up - 12.0 if above else up + 20.0
    return [mark, _words(start[0], height, words, size=13.0, colour=INK, anchor=start[1], weight="600")]


def _ends(result: Tradeoff, at: Callable[[Point], tuple[float, float]]) -> list[str]:
    parts: list[str] = []
    points = result.of(result.envelope)
    for number in dict.fromkeys((points[0].number, points[-1].number)):
        point = result.points[number - 1]
        across, up = at(point)
        late = across > 0.5 * WIDTH
        # Beyond the end itself, where no front goes on: above the highest point, below the lowest.
        first = number == points[0].number
        height = up - 11.0 if first != result.asked.y.more_is_better else up + 20.0
        words = f"{shown(result.asked.x, point.x, 4)}, {shown(result.asked.y, point.y, 4)}"
        parts.append(element("circle", cx=across, cy=up, r=5.0, fill="none", stroke=INK, stroke_width=1.6))
        start = (across + 9.0, "end") if late else (across - 9.0, "start")
        parts.append(_words(start[0], height, words, size=12.0, anchor=start[1]))
    return parts


def _legend(result: Tradeoff) -> tuple[list[str], float]:
    """The fronts' names below the picture, in as many rows as they need, and the height that those take."""
    parts: list[str] = []
    across, up = _LEFT, HEIGHT + 2.0
    entries = [(front.name, COLOURS[k % len(COLOURS)], 3.0) for k, front in enumerate(result.fronts)]
    for name, colour, wide in [*entries, ("envelope", "#b8c0cb", 7.0)]:
        width = 48.0 + 7.0 * len(name)
        if across > _LEFT and across + width > WIDTH - _RIGHT:
            across, up = _LEFT, up + 20.0
        parts.append(_line((across, up), (across + 20.0, up), colour, wide))
        parts.append(_words(across + 26.0, up + 4.0, name, size=12.0, anchor="start"))
        across += width
    return parts, up + 16.0 - HEIGHT


def _dot(place: tuple[float, float], size: float, colour: str) -> str:
    return element("circle", cx=place[0], cy=place[1], r=size, fill=colour)


def _line(start: tuple[float, float], end: tuple[float, float], colour: str, wide: float) -> str:
    return element("line", x1=start[0], y1=start[1], x2=end[0], y2=end[1], stroke=colour, stroke_width=wide)


def _words(
    x: float, y: float, content: str, *, size: float, colour: str = MUTED, anchor: str = "middle", weight: str = "400"
) -> str:
    halo = {"stroke": "#ffffff", "stroke_width": 4.0, "stroke_linejoin": "round", "paint_order": "stroke"}
    placed = {"x": x, "y": y, "font_size": size, "fill": colour, "text_anchor": anchor, "font_weight": weight}
    return element("text", text(content), **placed, **halo)


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
