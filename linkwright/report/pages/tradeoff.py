"""The report page of a trade-off: the front to look into, its ends and knee, the price along it, and every point."""

from __future__ import annotations

from pathlib import PurePath
from typing import Any

from linkwright.screen.optimization import names_words
from linkwright.screen.tradeoff import (
    effort_words,
    ends_words,
    gap_words,
    knee_words,
    price_words,
    shown,
    slope_factor,
    spread,
)
from linkwright.tradeoff_data import point_file
from linkwright.words import figure, load_case_words, section_words, with_unit, workspace_words
from optimize.tradeoff_question import Axis
from optimize.tradeoff_result import Front, Point, Tradeoff

from . import parts
from .figures import Figure
from .page import figure_place, page, section, table
from .svg import element, text
from .tradeoff_picture import COLOURS, picture_words

MOST_LISTED = 30
_ENVELOPE = "rgba(140,150,165,0.45)"


def tradeoff_page(result: Tradeoff) -> str:
    """The page as one HTML file that loads nothing."""
    x, y = result.asked.x, result.asked.y
    figures = {"front": front_figure(result), "price": price_figure(result)}
    picture = picture_words(result)
    told = [*ends_words(result, result.envelope), *gap_words(result, result.envelope)]
    told += [f"{name} has no design: {reason}" for name, reason in result.without]
    price = (
        f"The slope of the front, from the multiplier of the limit on {x.title}: what one {x.unit} more does to "
        f"{y.title}. Its size is drawn."
    )
    ends = "Where the front ends, and where it jumps or rests."
    lead = "Point at a design for its figures; its number names its arm file. Names in the legend switch fronts off."
    body = [
        parts.tiles(_tiles(result)),
        section("The front", figure_place("front", picture, text(picture)), lead=lead),
        section("Ends, steps and idle stretches", _list(told), lead=ends),
        section("The price along the front", figure_place("price", price), lead=price),
        section("Points", *_points(result)),
        section("The problem as solved", table(("", ""), _problem(result)), element("p", text(effort_words(result)))),
    ]
    title = f"{result.asked.given.arm.name}: {y.title} against {x.title}"
    return page(title, picture[0].upper() + picture[1:], body, figures)


def _list(lines: list[str]) -> str:
    return element("ul", *(element("li", text(line)) for line in lines), class_="binding")


def _tiles(result: Tradeoff) -> list[tuple[str, str, str]]:
    x, y = result.asked.x, result.asked.y
    points = result.of(result.envelope)
    first, last = points[0], points[-1]
    entries = [
        (f"{_best(x)} {x.title}", shown(x, first.x), f"{y.title} {shown(y, first.y)}"),
        (f"{_best(y)} {y.title}", shown(y, last.y), f"{x.title} {shown(x, last.x)}"),
    ]
    if result.envelope.knee is not None:
        knee = result.points[result.envelope.knee - 1]
        entries.append((f"knee (point {knee.number})", shown(x, knee.x), shown(y, knee.y)))
        entries.append(("price at the knee", price_words(result, knee), f"for one {x.unit} more"))
    entries.append(("points", str(len(result.points)), f"{len(points)} of them on the envelope"))
    return entries


def _best(axis: Axis) -> str:
    return "most" if axis.more_is_better else "least"


def _hover(result: Tradeoff, point: Point) -> str:
    x, y = result.asked.x, result.asked.y
    found = point.figures
    lines = [
        f"<b>point {point.number}</b> {text(point.front)}",
        f"{x.title} {shown(x, point.x, 5)}",
        f"{y.title} {shown(y, point.y, 5)}",
        f"price {price_words(result, point)}",
        f"worst error {figure(1e3 * found['max_error'])} mm, links {figure(found['mass'])} kg",
        f"safety factor {figure(found['min_safety_factor'], 3)}, "
        f"first frequency {with_unit(found['first_frequency'], 'Hz', 3)}",
    ]
    lines += [
        f"link {number}: {figure(1e3 * link.length)} mm, {text(section_words(link))}"
        for number, link in enumerate(point.arm.links, start=1)
    ]
    return "<br>".join(lines)


def _trace(result: Tradeoff, front: Front, colour: str, wide: float, *, dots: bool) -> Figure:
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
        words.append(_hover(result, point))
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


def front_figure(result: Tradeoff) -> Figure:
    """The fronts as plotly draws them."""
    x, y = result.asked.x, result.asked.y
    grouped = len(result.fronts) > 1
    data: list[Figure] = []
    if grouped:
        data.append(_trace(result, result.envelope, _ENVELOPE, 9.0, dots=False))
    data += [_trace(result, front, COLOURS[k % len(COLOURS)], 2.0, dots=True) for k, front in enumerate(result.fronts)]
    if result.envelope.knee is not None:
        knee = result.points[result.envelope.knee - 1]
        data.append(
            {
                "type": "scatter",
                "mode": "markers",
                "name": "knee",
                "x": [x.factor * knee.x],
                "y": [y.factor * knee.y],
                "hovertext": [_hover(result, knee)],
                "hoverinfo": "text",
                "marker": {"symbol": "diamond-open", "size": 15, "color": "#e5383b", "line": {"width": 2.5}},
            }
        )
    return {"data": data, "layout": _layout(result, f"{y.title} in {y.unit}", log=result.logs[1])}


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
        "xaxis": {"title": {"text": f"{x.title} in {x.unit}"}, "type": "log" if result.logs[0] else "linear", **plain},
        "yaxis": {"title": {"text": words}, "type": "log" if log else "linear", **plain},
        "margin": {"l": 70, "r": 10, "t": 10, "b": 50},
        "legend": {"orientation": "h", "y": 1.12},
        "showlegend": True,
        "hovermode": "closest",
    }


def _points(result: Tradeoff) -> list[str]:
    x, y = result.asked.x, result.asked.y
    listed = spread(result.of(result.envelope), MOST_LISTED, result.envelope.knee)
    rest = [point for point in result.points if point.number not in {each.number for each in listed}]
    names = () if len(result.fronts) == 1 else ("front",)
    heads = ("point", *names, x.title, y.title, "price", "shapes", "materials", "arm file")

    def row(point: Point) -> list[str]:
        number = f"{point.number} (knee)" if point.number == result.envelope.knee else str(point.number)
        cells = [number, *([point.front] if names else []), shown(x, point.x, 5), shown(y, point.y, 5)]
        cells += [price_words(result, point), names_words(point.shapes), names_words(point.materials)]
        return [*cells, point_file(result, point)]

    first = len(names)
    made = [table(heads, [row(point) for point in listed], numbers=(first + 1, first + 2, first + 3))]
    if rest:
        summary = element("summary", text(f"{len(rest)} more points"))
        more = table(heads, [row(point) for point in rest], numbers=(first + 1, first + 2, first + 3))
        made.append(element("details", summary, more))
    return made


def _problem(result: Tradeoff) -> list[list[str]]:
    given = result.asked.given
    rows = [["problem file", PurePath(given.file).name], ["workspace", workspace_words(given.arm, given.workspace)]]
    rows += [[f"load case {k}", load_case_words(case)] for k, case in enumerate(given.load_cases, start=1)]
    rows += [["subject to" if k == 0 else "", limit.text] for k, limit in enumerate(given.limits)]
    for axis, name in ((result.asked.x, "x"), (result.asked.y, "y")):
        rows.append([name, f"{axis.title}; {'more' if axis.more_is_better else 'less'} is better"])
    knee = "the point farthest from the chord between the ends, both axes scaled from 0 to 1 as drawn"
    rows.append(["knee", f"{knee} (Das 1999, doi:10.1007/BF01195985)"])
    rows.append(["", knee_words(result, result.envelope)])
    return rows
