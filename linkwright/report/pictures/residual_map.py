"""Where over the workspace the model is off: an arrow at each reading, before and after; and readings to hover over."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.several.recordings import nominal_tips as tips_of
from linkwright.core.sections.numeric import Array
from linkwright.report.page import figure_place, only_on_paper, separate_place, side_by_side
from linkwright.report.pictures.svg import Plot, arrows, spanned
from linkwright.results.diagnoses.words import row_words
from linkwright.results.document import Drawn
from linkwright.results.figures_in_words import figure, mm, pose

from .plots import Figure, separate_colours, with_scales
from .svg import element, label, line, nice_below, text

MOST_ARROWS = 250
MOST_HOVERED = 3000
_WIDTH = 440.0
_ARROW = 0.14
"""The longest arrow, as a share of the picture's width."""


def states(diagnosis: Diagnosis) -> tuple[tuple[str, Array], ...]:
    """The residuals to show: before, and after where anything was found."""
    before = ("before", diagnosis.residual_before)
    explained = bool(diagnosis.findings) or diagnosis.unknown is not None
    return (before, ("after", diagnosis.residual_after)) if explained else (before,)


def nominal_tips(diagnosis: Diagnosis) -> Array:
    """Where the tip nominally is at each reading (N, D), mm: measured positions may stand in a separate frame."""
    width = diagnosis.recording.tip.shape[1] if diagnosis.shown is None else diagnosis.shown.shape[2]
    return 1e3 * tips_of(diagnosis.arm, diagnosis.recording)[:, :width]


def chosen_rows(count: int, most: int) -> NDArray[np.int64]:
    """So many rows at most, evenly spaced."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


def arrow_maps(diagnosis: Diagnosis) -> str:
    """The arrows, to one scale: in the plane x and y, in space from above and from the side."""
    tip = nominal_tips(diagnosis)
    views = [(0, 1, "")] if tip.shape[1] == 2 else [(0, 1, ", seen along z"), (0, 2, ", seen along y")]
    rows = chosen_rows(len(tip), MOST_ARROWS)
    largest = 1e3 * float(np.linalg.norm(diagnosis.residual_before, axis=1).max())
    shown: list[str] = []
    several = len(states(diagnosis)) > 1
    displaced = [(when, diagnosis.in_space(residual), rms_length(residual)) for when, residual in states(diagnosis)]
    for *view, seen in views:
        plot = _plot(tip, (view[0], view[1]))
        scale = (plot.across[1] - plot.across[0]) / plot.width
        exaggeration = nice_below(_ARROW * _WIDTH * scale / largest) if largest > 0.0 else 1.0
        maps = [
            _map(
                plot, tip, 1e3 * moved, 1e3 * rms, rows, (view[0], view[1]), (when, seen), exaggeration, several=several
            )
            for when, moved, rms in displaced
        ]
        shown.append(side_by_side(*maps))
    some = "" if len(rows) == len(tip) else f"{len(rows)} of {len(tip)} readings, evenly spaced. "
    words = f"{some}Arrows run from where the model has the tip to where it was measured, drawn much longer."
    if diagnosis.shown is not None:
        words += " Across what was measured they tell nothing."
    if diagnosis.unknown is not None:
        words += " After is what remains beside the findings and the form that describes the unexplained part best."
    return "".join(shown) + element("p", text(words), class_="lead")


def _plot(tip: Array, view: tuple[int, int]) -> Plot:
    across, up = spanned(tip[:, view[0]], 0.12), spanned(tip[:, view[1]], 0.12)
    # Both axes to one scale, and no picture flatter than half or higher than its width.
    width = across[1] - across[0]
    height = min(max(up[1] - up[0], 0.5 * width), 3.0 * width)
    if height > width:
        middle = 0.5 * (across[0] + across[1])
        across = (middle - 0.5 * height, middle + 0.5 * height)
        width = height
    middle = 0.5 * (up[0] + up[1])
    height = max(height, up[1] - up[0])
    return Plot(_WIDTH, _WIDTH * height / width, across, (middle - 0.5 * height, middle + 0.5 * height))


def _map(
    plot: Plot,
    tip: Array,
    residual: Array,
    rms: float,
    rows: NDArray[np.int64],
    view: tuple[int, int],
    named: tuple[str, str],
    exaggeration: float,
    *,
    several: bool,
) -> str:
    when, seen = named
    names = "xyz"
    page = np.stack([plot.x(tip[rows, view[0]]), plot.y(tip[rows, view[1]])], axis=1)
    scale = plot.width / (plot.across[1] - plot.across[0])
    moved = exaggeration * scale * residual[rows][:, list(view)] * np.array([1.0, -1.0])
    size = nice_below(_ARROW * _WIDTH / (exaggeration * scale))
    length = size * exaggeration * scale
    corner = (plot.left + 10.0, plot.top + plot.height - 10.0)
    key = line(corner, (corner[0] + length, corner[1]), "rule", 2.0)
    key += label(corner[0], corner[1] - 6.0, 12.0, f"{figure(size)} mm of error", "start")
    about = f"Residuals {when} over the workspace, {names[view[0]]} and {names[view[1]]}"
    axes = (f"{names[view[0]]} in mm", f"{names[view[1]]} in mm")
    drawn = plot.drawn(about, axes, arrows(page, page + moved, when), key)
    title = when.capitalize() if several else "As measured"
    heading = element("h3", text(title + seen))
    words = f"RMS {figure(rms, 3)} mm; arrows {figure(exaggeration)} times their size"
    return element("figure", heading, drawn, element("figcaption", text(words)))


def residual_maps(diagnosis: Diagnosis) -> Drawn:
    """The arrows, and every reading to hover over, with its row, pose and residual."""
    rows = chosen_rows(diagnosis.recording.size, MOST_HOVERED)
    lengths = [1e3 * np.linalg.norm(residual, axis=1) for _, residual in states(diagnosis)]
    greatest = max(float(length.max()) for length in lengths)
    figures: dict[str, Figure] = {}
    places: list[str] = []
    on_paper: list[str] = []
    for (when, _), length in zip(states(diagnosis), lengths, strict=True):
        name = f"readings-{when}"
        figures[name] = _hovered(diagnosis, length, rows, greatest)
        which = f" {when}" if len(lengths) > 1 else ""
        words = f"Length of the residual at each reading{which}. The largest is {mm(1e-3 * float(length.max()), 3)}."
        heading = element("h3", text(when.capitalize() if which else "Each reading"))
        places.append(element("div", heading, figure_place(name, words, text(words))))
        if 0.0 < float(length.max()) < greatest:
            figures[f"{name}-own"] = separate_colours(name, 0.0, float(length.max()))
            on_paper.append(separate_place(name, when, words))
    return Drawn(arrow_maps(diagnosis) + side_by_side(*places) + only_on_paper(on_paper), figures)


def _hovered(diagnosis: Diagnosis, length: Array, rows: NDArray[np.int64], greatest: float) -> Figure:
    recording, arm = diagnosis.recording, diagnosis.arm
    tip = nominal_tips(diagnosis)[rows]
    planar = tip.shape[1] == 2
    across = tip[:, 0] if planar else np.hypot(tip[:, 0], tip[:, 1])
    up = tip[:, 1] if planar else tip[:, 2]
    names = ("x", "y") if planar else ("distance from the base's z axis", "z")

    def words(row: int) -> str:
        at = f"{row_words(recording, int(recording.row[row]))}: {pose(arm, recording.q[row].tolist())}"
        return f"{at}<br>{figure(float(length[row]), 3)} mm"

    texts = [words(row) for row in rows.tolist()]
    marks = {
        "type": "scatter",
        "mode": "markers",
        "x": across.round(3).tolist(),
        "y": up.round(3).tolist(),
        "hovertext": texts,
        "hoverinfo": "text",
        "marker": {
            "size": 8,
            "color": length[rows].round(6).tolist(),
            "cmin": 0.0,
            "cmax": greatest,
            "colorscale": "Viridis",
            "colorbar": {"title": {"text": "mm"}, "thickness": 12, "outlinewidth": 0},
        },
    }
    layout: Figure = {
        "xaxis": {"title": {"text": f"{names[0]} in mm"}, "zeroline": False, "constrain": "domain"},
        "yaxis": {"title": {"text": f"{names[1]} in mm"}, "zeroline": False, "scaleanchor": "x"},
        "margin": {"l": 60, "r": 10, "t": 44 if len(states(diagnosis)) > 1 else 10, "b": 50},
        "showlegend": False,
    }
    longest = float(length.max())
    if 0.0 < longest < greatest:
        layout.update(with_scales((0.0, greatest), (0.0, longest), ("marker.cmin", "marker.cmax")))
    return {"data": [marks], "layout": layout}
