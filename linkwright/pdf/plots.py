"""The figures that scripts draw on a page, drawn for paper: maps with a colour bar, and lines with marks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from linkwright.core.sections.numeric import Array
from linkwright.report.pictures.plots import Figure
from linkwright.report.pictures.svg import element, label
from linkwright.report.pictures.svg_plot import Plot, course, dots, round_ticks, spanned
from linkwright.results.figures_in_words import figure as in_words

_SIDE = 270.0
_BAR = 14.0
_SHADES = 64
_CLASSES = ("before", "after")


def plotted(figure: Figure, about: str) -> str:
    """A figure of lines, or of a map with marks on it, as SVG; `about` says in words what it shows."""
    layout, traces = figure["layout"], figure["data"]
    names = (str(layout["xaxis"]["title"]["text"]), str(layout["yaxis"]["title"]["text"]))
    if traces[0]["type"] == "heatmap":
        return _map(traces[0], traces[1:], (layout["xaxis"]["range"], layout["yaxis"]["range"]), names, about)
    return _lines(traces, names, about)


def _map(heat: Figure, marks: Sequence[Figure], spans: tuple[Any, Any], names: tuple[str, str], about: str) -> str:
    across, up = (float(spans[0][0]), float(spans[0][1])), (float(spans[1][0]), float(spans[1][1]))
    scale = _SIDE / max(across[1] - across[0], up[1] - up[0], 1e-12)
    plot = Plot((across[1] - across[0]) * scale, (up[1] - up[0]) * scale, across, up, top=20.0, right=70.0)
    least, greatest = float(heat["zmin"]), float(heat["zmax"])
    x, y = np.array(heat["x"], dtype=float), np.array(heat["y"], dtype=float)
    parts = _cells(plot, x, y, heat["z"], (least, greatest))
    for trace in marks:
        at = plot.x(np.array(trace["x"], dtype=float)), plot.y(np.array(trace["y"], dtype=float))
        for a, b, words in zip(at[0].tolist(), at[1].tolist(), trace["text"], strict=True):
            parts.append(element("circle", cx=a, cy=b, r=5.0, class_="mark", stroke_width=2.0))
            parts.append(label(a, b - 8.0, 12.0, str(words)))
    parts += _colour_bar(plot, (least, greatest), str(heat["colorbar"]["title"]["text"]))
    return plot.drawn(about, names, *parts)


def _cells(
    plot: Plot, x: Array, y: Array, rows: Sequence[Sequence[float | None]], ends: tuple[float, float]
) -> list[str]:
    """Rectangles, those of one shade beside each other as one."""
    colours, parts = _shades(), list[str]()
    left, foot = plot.x(_edges(x)), plot.y(_edges(y))
    for k, row in enumerate(rows):
        shades = [None if value is None else _shade(value, ends) for value in row]
        begin = 0
        for end in range(1, len(shades) + 1):
            if end < len(shades) and shades[end] == shades[begin]:
                continue
            shade = shades[begin]
            if shade is not None:
                place = {"x": float(left[begin]), "y": float(foot[k + 1])}
                # A hair too large, so that no seams show between neighbours.
                size = {"width": float(left[end] - left[begin]) + 0.15, "height": float(foot[k] - foot[k + 1]) + 0.15}
                parts.append(element("rect", **place, **size, fill=colours[shade]))
            begin = end
    return parts


def _edges(centres: Array) -> Array:
    if len(centres) < 2:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    middle = 0.5 * (centres[1:] + centres[:-1])
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])


def _shade(value: float, ends: tuple[float, float]) -> int:
    share = (value - ends[0]) / (ends[1] - ends[0]) if ends[1] > ends[0] else 0.0
    return min(max(int(share * _SHADES), 0), _SHADES - 1)


def _shades() -> list[str]:
    from plotly.colors import sample_colorscale

    shades = sample_colorscale("Viridis", [k / (_SHADES - 1) for k in range(_SHADES)])
    return [str(shade) for shade in shades]


def _colour_bar(plot: Plot, ends: tuple[float, float], unit: str) -> list[str]:
    x, step = plot.left + plot.width + 10.0, plot.height / _SHADES
    foot = plot.top + plot.height
    parts = [
        element("rect", x=x, y=foot - (k + 1) * step, width=_BAR, height=step + 0.15, fill=colour)
        for k, colour in enumerate(_shades())
    ]
    parts.append(label(x, plot.top - 6.0, 11.0, unit, "start"))
    for value in round_ticks(*ends):
        share = (value - ends[0]) / (ends[1] - ends[0]) if ends[1] > ends[0] else 0.0
        parts.append(label(x + _BAR + 4.0, foot - share * plot.height + 4.0, 11.0, in_words(value, 4), "start"))
    return parts


def _lines(traces: Sequence[Figure], names: tuple[str, str], about: str) -> str:
    def known(values: Sequence[float | None]) -> Array:
        return np.array([math.nan if value is None else float(value) for value in values])

    x, y = (np.concatenate([known(trace[axis]) for trace in traces]) for axis in ("x", "y"))
    low, high = spanned(y)
    room = 0.1 * (high - low) * (len(traces) if len(traces) > 1 else 0)  # the names stand above the lines
    plot = Plot(_SIDE, 0.6 * _SIDE, spanned(x), (low, high + room), left=70.0)
    parts: list[str] = []
    for number, trace in enumerate(traces):
        a, b = known(trace["x"]), known(trace["y"])
        there = np.isfinite(a) & np.isfinite(b)
        at, class_ = (plot.x(a[there]), plot.y(b[there])), _CLASSES[number % 2]
        parts += [course(*at, class_), dots(*at, class_)]
        if len(traces) > 1:
            top = plot.top + 14.0 + 16.0 * number
            parts.append(
                element(
                    "rect", x=plot.left + plot.width - 8.0, y=top - 8.0, width=8.0, height=8.0, class_=f"fill {class_}"
                )
            )
            parts.append(label(plot.left + plot.width - 14.0, top, 11.0, str(trace.get("name", "")), "end"))
    whole = all(float(value).is_integer() for value in x)
    ticks = [value for value in round_ticks(*plot.across) if float(value).is_integer()] if whole else None
    return plot.drawn(about, names, *parts, ticks=ticks)
