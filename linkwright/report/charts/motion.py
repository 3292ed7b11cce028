"""Torques drawn: of each joint against time, and what is left of them against its angle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import PurePath
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.motion.result import MotionDiagnosis, Traces
from linkwright.core.sections.numeric import Array
from linkwright.report.page import figure_place, side_by_side
from linkwright.report.pictures.plots import Figure
from linkwright.report.pictures.residual_map import chosen_rows
from linkwright.report.pictures.svg import Plot, binned, course, dots, element, spanned, text
from linkwright.results.document import Drawn
from linkwright.results.motion.words import torque_unit

MOST_LINES = 14
"""Pictures against time at most."""
MOST_INSTANTS, MOST_DOTS = 1600, 600
"""Instants against time and dots of a state that are drawn of all joints together: a page stays below two megabytes,
whatever was logged."""
_WIDTH, _HEIGHT = 420.0, 170.0
_DIGITS = 4


def torque_against_time(diagnosis: MotionDiagnosis) -> Drawn:
    """The torques of each joint over a log: as measured, before and after; of several logs the first ones."""
    figures: dict[str, Figure] = {}
    places: list[str] = []
    count = diagnosis.arm.size
    shown = diagnosis.traces[: max(1, MOST_LINES // count)]
    most = MOST_INSTANTS // (count * max(1, len(shown)))
    for index, trace in enumerate(shown):
        if len(diagnosis.traces) > 1:
            places.append(element("h4", text(PurePath(trace.log).name)))
        for joint in range(1, count + 1):
            name = f"torque-{index + 1}-{joint}"
            figures[name] = _over_time(diagnosis.arm, trace, joint, most)
            words = f"Torque of joint {joint} against time: measured, by the model before, and after."
            places.append(element("h4", text(f"Joint {joint}")) + figure_place(name, words))
    left = len(diagnosis.traces) - len(shown)
    if left:
        places.append(element("p", text(f"{left} more logs are not drawn."), class_="lead"))
    return Drawn(element("div", *places, class_="torques"), figures)


def _over_time(arm: Arm, trace: Traces, joint: int, most: int) -> Figure:
    rows = chosen_rows(len(trace.time), most)
    time = trace.time[rows].round(3).tolist()
    # Not solid lines alone: on paper and to people who see no colours they are to be distinguished too.
    styles: tuple[tuple[str, Array, dict[str, Any]], ...] = (
        ("measured", trace.measured, {"color": "#1a7f37", "width": 1.2}),
        ("before", trace.before, {"color": "#8b95a3", "width": 1.2, "dash": "dot"}),
        ("after", trace.after, {"color": "#1f6feb", "width": 1.2, "dash": "dash"}),
    )
    lines = [
        {"type": "scatter", "mode": "lines", "name": name, "x": time, "y": _short(values[rows, joint - 1]), "line": how}
        for name, values, how in styles
    ]
    layout: Figure = {
        "xaxis": {"title": {"text": "time in s"}, "zeroline": False},
        "yaxis": {"title": {"text": torque_unit(arm, joint)}, "zeroline": True},
        "margin": {"l": 60, "r": 10, "t": 10, "b": 50},
        "legend": {"orientation": "h", "y": 1.02, "yanchor": "bottom"},
    }
    return {"data": lines, "layout": layout}


def _short(values: Array) -> list[float | None]:
    """Torques with as many digits as a picture shows; nothing where they are not known."""
    largest = float(np.nanmax(np.abs(values))) if np.isfinite(values).any() else 0.0
    digits = _DIGITS - math.ceil(math.log10(largest)) if largest > 0.0 else _DIGITS
    return [round(value, digits) if math.isfinite(value) else None for value in values.tolist()]


def left_against(diagnosis: MotionDiagnosis) -> str:
    """What the model leaves of each joint's torque against its coordinate, before and after."""
    after = bool(diagnosis.findings)
    joints = range(1, diagnosis.arm.size + 1)
    return side_by_side(*(_of_joint(diagnosis.arm, diagnosis.traces, joint, after=after) for joint in joints))


def _of_joint(arm: Arm, traces: Sequence[Traces], joint: int, *, after: bool) -> str:
    column, turns = joint - 1, arm.joints[joint - 1].revolute
    moves = np.concatenate([trace.moves[:, column] for trace in traces])
    if not moves.any():
        return element("p", text(f"Joint {joint} does not move."), class_="lead")

    def pooled(name: str) -> Array:
        return np.concatenate([getattr(trace, name)[:, column] for trace in traces])[moves]

    measured = pooled("measured")
    states = [(when, measured - pooled(when)) for when in (("before", "after") if after else ("before",))]
    x = np.degrees(pooled("q")) if turns else 1e3 * pooled("q")
    label, unit = f"joint {joint} in {'degrees' if turns else 'mm'}", torque_unit(arm, joint)
    plot = Plot(_WIDTH, _HEIGHT, spanned(x, 0.03), spanned(np.concatenate([values for _, values in states])))
    most = MOST_DOTS // arm.size
    known = np.flatnonzero(np.isfinite(x) & np.all([np.isfinite(values) for _, values in states], axis=0))
    rows = known[chosen_rows(len(known), most)] if len(known) else known
    drawn = [dots(plot.x(x[rows]), plot.y(values[rows]), when) for when, values in states]
    for when, values in states:
        if len(known):
            means = binned(x[known], values[known], 24)
            drawn.append(course(plot.x(means[0]), plot.y(means[1]), when))
    return element("figure", plot.drawn(f"What is left of the torque against {label}", (label, unit), *drawn))
