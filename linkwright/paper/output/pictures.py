"""Figures 5 to 9 as one page that opens without a network: the truth, and the paper's curves beside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from linkwright.core.sections.numeric import Array
from linkwright.report.page import figure_place, side_by_side
from linkwright.report.pictures.svg import element, text
from linkwright.results.document import Description, Drawn, Paragraph, Picture, section

from .figures import Figure

Plot = dict[str, Any]
_TITLE = "The paper's figures 5 to 9 beside the truth"
_SUMMARY = (
    "The paper's curves are computed by the conventions that reproduce its tables: squared distances (mm², printed "
    "as mm) and two constants fitted to its figures. The truth is in mm, from the whole physics, fitted to nothing."
)
_NAMES = (
    ("corrected_clearance_mm", "clearance alone"),
    ("corrected_backlash_mm", "backlash alone"),
    ("corrected_with_deformation_mm", "with deformation"),
    ("corrected_mm", "worst error"),
    ("paper_clearance_mm2", "clearance alone"),
    ("paper_backlash_mm2", "backlash alone"),
    ("paper_with_deformation_mm2", "with deformation"),
    ("paper_mm2", "PE"),
)


def describe(figures: Sequence[Figure]) -> Description:
    """All figures, each with the truth and the paper's curves beside each other."""
    parts = [
        section(
            f"Figure {figure.number}: {figure.title}",
            Picture(partial(_beside, figure)),
            *map(Paragraph, figure.remarks),
            opened=True,
        )
        for figure in figures
    ]
    columns = sum(len(figure.columns) for figure in figures)
    return Description(_TITLE, _SUMMARY, tuple(parts), f"{len(figures)} figures, {columns} columns")


def _beside(figure: Figure) -> Drawn:
    makers: dict[str, Callable[[Figure], tuple[Plot, Plot]]] = {
        "5": _maps,
        "6": lambda figure: _curves(figure, "shoulder_deg", "angle of the shoulder in degrees"),
        "7": lambda figure: _curves(figure, "clearance_mm", "clearance of each joint in mm", logarithmic=True),
        "8": lambda figure: _curves(figure, "backlash_rad", "backlash to either side in rad"),
        "9": _lengths,
    }
    names = f"true-{figure.number}", f"paper-{figure.number}"
    places = (
        ("The truth, mm", f"{figure.title}, in truth"),
        ("By the paper's conventions, mm²", f"{figure.title}, by the paper's conventions"),
    )
    halves = (
        element("div", element("h3", text(head)), figure_place(name, label))
        for name, (head, label) in zip(names, places, strict=True)
    )
    return Drawn(side_by_side(*halves), dict(zip(names, makers[figure.number](figure), strict=True)))


def _maps(figure: Figure) -> tuple[Plot, Plot]:
    return _map(figure, "corrected_mm", "mm"), _map(figure, "paper_mm2", "mm²")


def _map(figure: Figure, column: str, unit: str) -> Plot:
    x, y = np.unique(figure.column("x_mm")), np.unique(figure.column("y_mm"))
    field = figure.column(column).reshape(len(y), len(x))
    heat = {
        "type": "heatmap",
        "x": x.tolist(),
        "y": y.tolist(),
        "z": field.tolist(),
        "zmin": 0.0,
        "zsmooth": "best",
        "connectgaps": False,
        "colorscale": "Viridis",
        "colorbar": {"title": {"text": unit}, "thickness": 12, "outlinewidth": 0},
        "hovertemplate": f"x %{{x:.0f}} mm<br>y %{{y:.0f}} mm<br>%{{z:.4g}} {unit}<extra></extra>",
    }
    layout = {
        "xaxis": {"title": {"text": "x in mm"}, "zeroline": False, "constrain": "domain"},
        "yaxis": {"title": {"text": "y in mm"}, "zeroline": False, "scaleanchor": "x"},
        "margin": {"l": 60, "r": 10, "t": 10, "b": 50},
        "showlegend": False,
    }
    return {"data": [heat], "layout": layout}


def _curves(figure: Figure, across: str, title: str, *, logarithmic: bool = False) -> tuple[Plot, Plot]:
    kind = "log" if logarithmic else "linear"

    def half(prefix: str, unit: str) -> Plot:
        data = [
            _line(figure, across, name, words)
            for name, words in _NAMES
            if name.startswith(prefix) and name in figure.columns
        ]
        # Curves that lie on each other are both seen where the later one is dashed.
        for later in data[1:]:
            later["line"] = {"dash": "dash", "width": 3}
        ticks = {"zeroline": False, "type": kind, "exponentformat": "none"}
        up = {"title": {"text": unit}, **ticks, **({"dtick": 1} if logarithmic else {})}
        layout = {
            "xaxis": {"title": {"text": title}, **ticks, **_spaced(figure.column(across), logarithmic=logarithmic)},
            "yaxis": up if logarithmic else {**up, "rangemode": "tozero"},
            "margin": {"l": 70, "r": 10, "t": 10, "b": 50},
            "legend": {"orientation": "h", "y": 1.12},
            "showlegend": len(data) > 1,
        }
        return {"data": data, "layout": layout}

    return half("corrected_", "worst error in mm"), half("paper_", "“PE” in mm²")


def _spaced(values: Array, *, logarithmic: bool) -> dict[str, object]:
    """Ticks of a logarithmic axis: at 1, 2 and 5 times powers of ten where it holds but two of those or fewer."""
    if not logarithmic:
        return {}
    return {"dtick": "D2" if values.max() < 100.0 * values.min() else 1}


def _line(figure: Figure, across: str, up: str, words: str) -> Plot:
    x, y = list(figure.columns[across]), list(figure.columns[up])
    return {"type": "scatter", "mode": "lines", "name": words, "x": x, "y": y}


def _lengths(figure: Figure) -> tuple[Plot, Plot]:
    truth, paper = _curves(figure, "reach_mm", "reach in mm", logarithmic=True)
    wide = list(figure.columns["corrected_mm"])
    for mark, words, dash in (
        ("linear_to_reach_mm", "linear bending ends", "dot"),
        ("yields_at_reach_mm", "a link yields", "solid"),
    ):
        at = figure.marks[mark]
        line = {"color": "#b7791f", "width": 2, "dash": dash}
        ends = {"x": [at, at], "y": [min(wide), max(wide)]}
        truth["data"].append({"type": "scatter", "mode": "lines", "name": words, "line": line, **ends})
    truth["layout"]["showlegend"] = True
    return truth, paper
