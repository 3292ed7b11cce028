"""Figures that plotly draws, as plain mappings: the error map over the workspace, and the exchange."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.error_map import ErrorMap, error_map
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.errors.unknown_mass import unknown_taken_out
from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.arm.figures import Figure as Goal
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.optimize.result import Iteration
from linkwright.results.design import poses_that_differ
from linkwright.results.figures_in_words import figure, mm, pose

MOST_MARKS = 5
Figure = dict[str, Any]
LIKE = "like"
"""A figure that is another one in other colours holds that one's name by this key, and no data of its own."""


def field_of(evaluation: Evaluation) -> ErrorMap:
    """The worst error at each place of the tip."""
    arm, cases = unknown_taken_out(evaluation.arm, evaluation.load_cases), evaluation.load_cases
    search = WorstSearch(error_model(arm, cases), evaluation.workspace)
    return error_map(search, beam_values(beams_of(arm, cases)))


def colour_range(maps: Sequence[ErrorMap], evaluations: Sequence[Evaluation]) -> tuple[float, float]:
    """Least and greatest error (mm) on all maps, so that they share one scale."""
    least = min((float(np.nanmin(item.worst)) for item in maps if np.isfinite(item.worst).any()), default=0.0)
    return 1e3 * least, 1e3 * max(evaluation.max_error for evaluation in evaluations)


def shared_spans(maps: Sequence[ErrorMap]) -> tuple[list[float], list[float]]:
    """The spans (mm) of both axes that hold every map, with a little air."""
    spans: list[list[float]] = []
    for edges in ([item.horizontal for item in maps], [item.vertical for item in maps]):
        low, high = 1e3 * min(float(x[0]) for x in edges), 1e3 * max(float(x[-1]) for x in edges)
        spans.append([low - 0.06 * (high - low), high + 0.06 * (high - low)])
    return spans[0], spans[1]


def error_map_figure(
    field: ErrorMap,
    evaluation: Evaluation,
    colours: tuple[float, float],
    spans: tuple[list[float], list[float]],
) -> Figure:
    """The worst error at each place of the tip, in mm, with the worst poses marked; `spans` are those of the axes."""
    names = ("x", "y") if field.planar else ("distance from the base's z axis", "z")
    rows = [[None if np.isnan(value) else round(1e3 * float(value), 7) for value in row] for row in field.worst]
    heat = {
        "type": "heatmap",
        "x": _rounded(field.horizontal),
        "y": _rounded(field.vertical),
        "z": rows,
        "zmin": colours[0],
        "zmax": colours[1],
        "colorscale": "Viridis",
        "colorbar": {"title": {"text": "mm"}, "thickness": 12, "outlinewidth": 0},
        "hovertemplate": f"{names[0]} %{{x}} mm<br>{names[1]} %{{y}} mm<br>error %{{z:.5g}} mm<extra></extra>",
    }
    layout: Figure = {
        "xaxis": {"title": {"text": f"{names[0]} in mm"}, "zeroline": False, "constrain": "domain", "range": spans[0]},
        "yaxis": {"title": {"text": f"{names[1]} in mm"}, "zeroline": False, "scaleanchor": "x", "range": spans[1]},
        "margin": {"l": 60, "r": 10, "t": 10, "b": 50},
        "showlegend": False,
    }
    alone = colour_range([field], [evaluation])
    if alone != colours:
        layout.update(with_scales(colours, alone, ("zmin", "zmax")))
    return {"data": [heat, _marks(field, evaluation)], "layout": layout}


def separate_colours(name: str, least: float, greatest: float) -> Figure:
    """The figure called `name` with colours from `least` to `greatest`: what its second button shows, for paper."""
    return {LIKE: name, "from": least, "to": greatest}


def with_scales(common: tuple[float, float], alone: tuple[float, float], ends: tuple[str, str]) -> Figure:
    """What a layout holds with the buttons: `ends` are what plotly calls the ends of the colours."""
    margin = {"l": 60, "r": 10, "t": 44, "b": 50}
    return {"updatemenus": [_scales(common, alone, ends)], "margin": margin}


def _scales(common: tuple[float, float], alone: tuple[float, float], ends: tuple[str, str]) -> Figure:
    """Two buttons: the colours of all maps, or those of this one."""
    buttons = [
        {"label": words, "method": "restyle", "args": [dict(zip(ends, colours, strict=True)), [0]]}
        for words, colours in (("common scale", common), ("own scale", alone))
    ]
    place = {"x": 0.0, "xanchor": "left", "y": 1.02, "yanchor": "bottom", "pad": {"t": 0, "b": 4}}
    look = {"font": {"color": "#1d2530"}, "bgcolor": "#f5f7f9"}  # a chosen button stays light on a dark page too
    return {"type": "buttons", "direction": "right", "showactive": True, "buttons": buttons, **place, **look}


def _rounded(values: Any) -> list[float]:
    return [round(1e3 * float(value), 4) for value in values]


def _marks(field: ErrorMap, evaluation: Evaluation) -> Figure:
    poses = poses_that_differ(evaluation)[:MOST_MARKS]
    tips = 1e3 * tip_position(evaluation.arm, [item.q for item in poses])
    across = tips[:, 0] if field.planar else np.hypot(tips[:, 0], tips[:, 1])
    up = tips[:, 1] if field.planar else tips[:, 2]
    return {
        "type": "scatter",
        "mode": "markers+text",
        "x": [round(float(value), 4) for value in across],
        "y": [round(float(value), 4) for value in up],
        "text": _numbers(across, up),
        "textposition": "top center",
        "hovertext": [f"worst pose {k}: {pose(evaluation.arm, x.q)}, {mm(x.error, 5)}" for k, x in enumerate(poses, 1)],
        "hoverinfo": "text",
        "cliponaxis": False,
        "marker": {"symbol": "circle-open", "size": 11, "color": "#e5383b", "line": {"width": 2.5}},
        "textfont": {"color": "#e5383b", "size": 13},
    }


def _numbers(across: Any, up: Any) -> list[str]:
    """The numbers of the marks; those that would stand on an earlier one are left blank."""
    near = 0.06 * max(float(np.ptp(across)), float(np.ptp(up)), 0.1 * float(np.hypot(across, up).max()))
    shown: list[str] = []
    for number, (x, y) in enumerate(zip(across, up, strict=True)):
        taken = any(shown[k] and np.hypot(across[k] - x, up[k] - y) < near for k in range(number))
        shown.append("" if taken else str(number + 1))
    return shown


def error_map_words(field: ErrorMap, evaluation: Evaluation) -> str:
    """The map in a sentence, for those who cannot see it."""
    tip = 1e3 * tip_position(evaluation.arm, [evaluation.worst.poses[0].q])[0]
    place = ", ".join(figure(float(round(value, 3))) for value in (tip[:2] if field.planar else tip))
    return f"Error over the workspace. The worst, {mm(evaluation.max_error)}, is where the tip is at ({place}) mm."


def exchange_figure(iterations: Sequence[Iteration], objective: Goal) -> Figure:
    """The objective round by round; for errors also the worst found afterwards: where both meet, the exchange ends."""
    factor, unit = objective.factor, objective.unit
    numbers = [iteration.number for iteration in iterations]
    series = [("over the poses so far", [factor * iteration.objective for iteration in iterations])]
    if objective.name == "max_error":
        upper = [factor * iteration.objective * (1.0 + max(iteration.worst_violation, 0.0)) for iteration in iterations]
        series.insert(0, ("worst pose found afterwards", upper))
    data = [
        {"type": "scatter", "mode": "lines+markers", "name": name, "x": numbers, "y": values} for name, values in series
    ]
    layout = {
        "xaxis": {"title": {"text": "iteration"}, "dtick": max(1, len(numbers) // 10), "zeroline": False},
        "yaxis": {"title": {"text": f"{objective.name.replace('_', ' ')} in {unit}"}, "zeroline": False},
        "margin": {"l": 70, "r": 10, "t": 10, "b": 50},
        "legend": {"orientation": "h", "y": -0.22},
        "showlegend": len(series) > 1,
    }
    return {"data": data, "layout": layout}
