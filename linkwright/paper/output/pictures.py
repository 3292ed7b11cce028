"""Figures 5 to 9 as drawings: the truth, and the paper's curves beside it, on a page and as files fit for print."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from types import MappingProxyType

import numpy as np

from linkwright.report.page import side_by_side
from linkwright.report.pictures.contour import regions
from linkwright.report.pictures.svg import Plot, course, element, label, line, path, round_ticks, text, width_of
from linkwright.results.document import Description, Paragraph, Picture, section
from linkwright.results.figures_in_words import figure as number

from .figures import Figure

_TITLE = "The paper's figures 5 to 9 beside the truth"
_SUMMARY = (
    "The paper's curves are computed by the conventions that reproduce its tables: squared distances (mm², printed "
    "as mm) and two constants fitted to its figures. The truth is in mm, from the whole physics, fitted to nothing."
)
_HALVES = (
    ("corrected_", "The truth, mm", "worst error in mm"),
    ("paper_", "By the paper's conventions, mm²", "PE in mm²"),
)
_CURVES = MappingProxyType(
    {
        "clearance": "clearance alone",
        "backlash": "backlash alone",
        "with_deformation": "with deformation",
        "": "worst error",
    }
)
_ACROSS = MappingProxyType(
    {
        "6": ("shoulder_deg", "angle of the shoulder in degrees"),
        "7": ("clearance_mm", "clearance of each joint in mm"),
        "8": ("backlash_rad", "backlash to either side in rad"),
        "9": ("reach_mm", "reach in mm"),
    }
)
_MARKS = (("linear_to_reach_mm", "linear bending ends", "2 4"), ("yields_at_reach_mm", "a link yields", None))
_LOGARITHMIC = ("7", "9")
_SIZE, _HEAD = 280.0, 30.0
_PRINTED_WIDTH = 180.0
"""Of a figure on paper, mm: two columns of a journal."""
_VIRIDIS = (
    "#440154",
    "#482878",
    "#3e4989",
    "#31688e",
    "#26828e",
    "#1f9e89",
    "#35b779",
    "#6ece58",
    "#b5de2b",
    "#fde725",
)
"""Ten colours of even steps in lightness (S. van der Walt, N. Smith, matplotlib 1.5, 2015, CC0)."""
_LOOK = (
    "svg{background:#fff;font-family:Helvetica,Arial,'Liberation Sans',sans-serif}text{fill:#1d2530}"
    ".axis{stroke:#d9dee5}.frame,.course{fill:none}.frame{stroke:#5b6675}.course{stroke-width:2;stroke-linejoin:round}"
    ".course.before{stroke:#8b95a3}.course.after{stroke:#1f6feb}.error-line{stroke:#c00}"
)
"""The styles of a figure that stands by itself, on white."""


def describe(figures: Sequence[Figure]) -> Description:
    """All figures, each with the truth and the paper's curves beside each other."""
    parts = [
        section(
            f"Figure {figure.number}: {figure.title}",
            Picture(partial(_beside, figure)),
            *(Paragraph(remark, "lead") for remark in figure.remarks),
            opened=True,
        )
        for figure in figures
    ]
    return Description(_TITLE, _SUMMARY, tuple(parts), f"{len(figures)} figures beside the truth", without="")


def figure_svg(figure: Figure) -> str:
    """The figure as an SVG file of 180 mm, both halves beside each other; words stay words."""
    drawn, left, height = list[str](), 0.0, 0.0
    for half, (_, heading, _) in enumerate(_HALVES):
        picture = _half(figure, half)
        wide, high = (float(size) for size in picture.split('viewBox="', 1)[1].split('"', 1)[0].split()[2:])
        drawn.append(label(left + wide / 2, 16.0, 13.0, heading))
        drawn.append(
            picture.replace("<svg ", f'<svg x="{left:g}" y="{_HEAD:g}" width="{wide:g}" height="{high:g}" ', 1)
        )
        left, height = left + wide, max(height, high + _HEAD)
    size = {"width": f"{_PRINTED_WIDTH:g}mm", "height": f"{_PRINTED_WIDTH * height / left:.4g}mm"}
    head = {"xmlns": "http://www.w3.org/2000/svg", "view_box": f"0 0 {left:g} {height:g}", "role": "img"}
    return element("svg", element("style", _LOOK), *drawn, **head, aria_label=figure.title, **size) + "\n"


def figure_page(figure: Figure) -> str:
    """A page of the figure's size that holds nothing else, to be printed."""
    drawn = figure_svg(figure)
    width, height = (drawn.split(f' {name}="', 1)[1].split('"', 1)[0] for name in ("width", "height"))
    styles = f"@page{{size:{width} {height};margin:0}}body{{margin:0}}svg{{display:block}}"
    return f'<!DOCTYPE html><html><head><meta charset="utf-8"><style>{styles}</style></head><body>{drawn}</body></html>'


def _beside(figure: Figure) -> str:
    halves = (
        element("figure", element("h3", text(heading)), _half(figure, half))
        for half, (_, heading, _) in enumerate(_HALVES)
    )
    return side_by_side(*halves)


def _half(figure: Figure, half: int) -> str:
    return _map(figure, half) if figure.number == "5" else _curves(figure, half)


def _map(figure: Figure, half: int) -> str:
    """Regions of the plane by how large the error is there, each level's over those below it."""
    prefix, heading, _ = _HALVES[half]
    (values,) = (figure.column(name) for name in figure.columns if name.startswith(prefix))
    x, y = figure.column("x_mm"), figure.column("y_mm")
    spokes = int(np.isclose(np.hypot(x, y), np.hypot(x[-1], y[-1])).sum())
    reach = 1.04 * float(np.hypot(x, y).max())
    plot = Plot(_SIZE, _SIZE, (-reach, reach), (-reach, reach), left=58.0, right=74.0)
    levels = round_ticks(0.0, float(values.max()), 12)
    parts: list[str] = []
    for at, level in enumerate(levels):
        rings = regions(x, y, values, spokes, level)
        drawn = ([*zip(plot.x(ring[:, 0]).tolist(), plot.y(ring[:, 1]).tolist(), strict=True)] for ring in rings)
        parts.append(path(drawn, "").replace("<path ", f'<path fill="{_colour(at, levels)}" ', 1))
        parts += _key(plot, at, levels)
    unit = heading.rpartition(", ")[2]
    parts.append(label(plot.left + plot.width + 14.0, plot.top + 2.0, 12.0, unit, "start"))
    return plot.drawn(f"{figure.title}: {heading}", ("x in mm", "y in mm"), *parts)


def _colour(at: int, levels: Sequence[float]) -> str:
    place = at / max(len(levels) - 1, 1) * (len(_VIRIDIS) - 1)
    low, share = int(place), place - int(place)
    ends = [_VIRIDIS[min(low + step, len(_VIRIDIS) - 1)] for step in (0, 1)]
    mixed = [
        round((1.0 - share) * int(ends[0][k : k + 2], 16) + share * int(ends[1][k : k + 2], 16)) for k in (1, 3, 5)
    ]
    return "#" + "".join(f"{part:02x}" for part in mixed)


def _key(plot: Plot, at: int, levels: Sequence[float]) -> list[str]:
    """A level's colour beside the map, from its value upwards."""
    high = (plot.height - 12.0) / len(levels)
    foot, left = plot.top + plot.height - at * high, plot.left + plot.width + 14.0
    field = element("rect", x=left, y=foot - high, width=12.0, height=high, fill=_colour(at, levels))
    every = 2 if len(levels) > 8 else 1
    return [field, label(left + 17.0, foot + 4.0, 12.0, number(levels[at], 3), "start")] if at % every == 0 else [field]


def _curves(figure: Figure, half: int) -> str:
    prefix, heading, up_words = _HALVES[half]
    column, across_words = _ACROSS[figure.number]
    log = figure.number in _LOGARITHMIC
    x = figure.column(column)
    lines = {name.removeprefix(prefix): figure.column(name) for name in figure.columns if name.startswith(prefix)}
    every = np.concatenate(list(lines.values()))
    up = (float(every.min()) / 1.5, float(every.max()) * 1.5) if log else (0.0, 1.06 * float(every.max()))
    plot = Plot(
        _SIZE, 0.75 * _SIZE, (float(x.min()), float(x.max())), up, left=70.0, top=28.0, right=20.0, logs=(log, log)
    )
    parts: list[str] = []
    legend: list[tuple[str, str]] = []
    for at, (name, values) in enumerate(lines.items()):
        # Curves that lie on each other are both seen where the later one is dashed.
        look = ("after", "6 5") if at else ("before" if len(lines) > 1 else "after", None)
        legend.append((_dashed(course(plot.x(x), plot.y(values), look[0]), look[1]), _CURVES[name.rpartition("_")[0]]))
    if figure.number == "9" and not half:
        for mark, words, dash in _MARKS:
            at_x = float(plot.x(np.array(figure.marks[mark])))
            ends = ((at_x, plot.top), (at_x, plot.top + plot.height))
            legend.append((_dashed(line(*ends, "error-line", 1.6), dash), words))
    left = plot.left - 40.0
    for drawn, words in legend:
        parts.append(drawn)
        if len(legend) > 1:
            parts += _named(drawn, left, words)
            left += 34.0 + width_of(words, 11.0)
    return plot.drawn(f"{figure.title}: {heading}", (across_words, up_words), *parts)


def _dashed(drawn: str, dash: str | None) -> str:
    return drawn if dash is None else drawn.replace(" ", f' stroke-dasharray="{dash}" ', 1)


def _named(drawn: str, left: float, words: str) -> list[str]:
    """An entry of the legend: a piece of the line as it is drawn, and what it is."""
    kept = [part for part in drawn.split('"') if "after" in part or "before" in part or "error-line" in part]
    dash = drawn.split('stroke-dasharray="')[1].split('"')[0] if "dasharray" in drawn else None
    sample = element("path", d=f"M{left:g},14h22", class_=kept[-1], stroke_dasharray=dash, stroke_width=2)
    return [sample, label(left + 26.0, 18.0, 11.0, words, "start")]
