"""An arm in space as plotly draws it: its axis, the shape that its loads bend it to, the error at its tip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.chain.chain import LoadCase
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.materials.material import MissingProperty
from linkwright.core.sections.numeric import Array
from linkwright.report.page import figure_place, side_by_side
from linkwright.report.pictures.loads import bent_shape
from linkwright.report.pictures.svg import nice_below, text
from linkwright.results.document import Drawn
from linkwright.results.figures_in_words import mm
from linkwright.results.figures_in_words import pose as pose_words

_SHARE = 0.1
"""What of the arm's size the greatest displacement is drawn as."""
_FLATTEST = 0.05
"""The least share of the greatest extent that an axis has: a scene without depth is not drawn."""
_RIGID, _BENT, _ERROR, _REACH = "#7f8c98", "#0072b2", "#d55e00", "#9aa5ae"
_WORDS = "Drag to turn it. Orange is the tip's error, blue the shape under load (without play)."


@dataclass(frozen=True)
class Stand:
    """An arm to one tip at a pose (m): its axis, where its joints are, and where its loads bend the axis to; `error`
    is the worst that the tip errs there, where that was asked."""

    title: str
    axis: Array
    joints: Array
    bent: tuple[Array, Array] | None
    error: Array | None


def beside(drawn: str, evaluation: Evaluation) -> Drawn | str:
    """A picture of an arm with the arm at its worst pose beside it, to be turned; alone for an arm in a plane."""
    if evaluation.arm.flat:
        return drawn
    worst = evaluation.worst.poses[0]
    case = evaluation.load_cases[worst.load_case]
    stand = stand_of(evaluation.arm, case, worst.q, np.array(worst.vector, dtype=float))
    figures = {"in-space": in_space([stand], np.empty((0, 3)), None, flat=False)}
    turned = figure_place("in-space", f"{evaluation.arm.name} in space at {stand.title}", text(_WORDS))
    return Drawn(side_by_side(drawn, turned), figures)


def stand_of(model: Model, case: LoadCase, q: Sequence[float], error: Array | None) -> Stand:
    """Where an arm is at a pose under a load case, with the error of its tip there where that is known."""
    arm = model.on(case.tip or model.tip)
    frames = place(arm, list(q))
    here, axis, joints = np.zeros(3), [np.zeros(3)], []
    for joint, link in zip(frames.joints, frames.links, strict=True):
        start = here + np.array(joint.lead, dtype=float)
        here = start + np.array(link.vector, dtype=float)
        joints.append(start)
        axis += [start, here]
    axis.append(here + np.array(frames.tool, dtype=float))
    try:
        bent = bent_shape(arm, solve(arm, list(q), beams_of(arm, (case,)), case))
    except MissingProperty:
        bent = None
    words = pose_words(arm, q)
    title = words if error is None else f"{words}: {mm(float(np.linalg.norm(error)))}"
    return Stand(title, np.array(axis), np.array(joints), bent, error)


def in_space(stands: Sequence[Stand], reach: Array, scale: float | None, *, flat: bool) -> dict[str, Any]:
    """The figure of an arm at some poses, to one scale, and the points that its tip reaches (m), if any."""
    size = max(float(np.abs(reach).max(initial=0.0)), *(float(np.abs(item.axis).max()) for item in stands))
    moves = [item.bent[1] for item in stands if item.bent is not None]
    moves += [item.error[None, :] for item in stands if item.error is not None]
    greatest = max((float(np.linalg.norm(move, axis=1).max()) for move in moves), default=0.0)
    if scale is None:
        scale = max(1.0, nice_below(_SHARE * size / greatest)) if greatest > 0.0 else 1.0
    data: list[dict[str, Any]] = []
    if len(reach):
        data.append(_trace("reach", reach, "markers", marker={"size": 1.5, "color": _REACH, "opacity": 0.35}))
    for number, each in enumerate(stands):
        once = {"showlegend": number == 0, "text": each.title, "hoverinfo": "text"}
        line = {"color": _RIGID, "width": 8}
        data.append(_trace("arm", each.axis, "lines", line=line, legendgroup="arm", **once))
        dots = {"size": 5, "color": _RIGID}
        data.append(_trace("joints", each.joints, "markers", marker=dots, legendgroup="arm", **once))
        if each.bent is not None:
            bent, line = each.bent[0] + scale * each.bent[1], {"color": _BENT, "width": 5}
            data.append(_trace("bent", bent, "lines", line=line, legendgroup="bent", **once))
        if each.error is not None:
            tip, line = each.axis[-1], {"color": _ERROR, "width": 6}
            way = np.array([tip, tip + scale * each.error])
            data.append(_trace("worst error", way, "lines", line=line, legendgroup="worst error", **once))
    title = f"Displacements {scale:.6g} times as large" if moves else "No displacements: a mass is not known"
    layout = {
        "title": {"text": title},
        "scene": _scene(data, flat=flat),
        "showlegend": True,
        "legend": {"orientation": "h", "y": 0.0, "yanchor": "top"},
        "margin": {"l": 0, "r": 0, "t": 60, "b": 60},
    }
    return {"data": data, "layout": layout}


def _scene(data: Sequence[dict[str, Any]], *, flat: bool) -> dict[str, Any]:
    """Axes to one scale that hold all that is drawn, whatever its proportions; an arm in a plane is looked at from
    above."""
    middle, half = np.zeros(3), np.zeros(3)
    for k, name in enumerate("xyz"):
        values = np.concatenate([trace[name] for trace in data])
        middle[k], half[k] = 0.5 * (values.min() + values.max()), 0.5 * np.ptp(values)
    half = np.maximum(1.05 * half, _FLATTEST * half.max())
    axes: dict[str, dict[str, Any]] = {
        f"{name}axis": {"title": {"text": f"{name} in mm"}, "range": [middle[k] - half[k], middle[k] + half[k]]}
        for k, name in enumerate("xyz")
    }
    ratio = {name: half[k] / half.max() for k, name in enumerate("xyz")}
    camera = {"eye": {"x": 1.0, "y": -1.36, "z": 0.72}, "center": {"x": 0.0, "y": 0.0, "z": -0.12}}
    if flat:
        axes["zaxis"]["visible"] = False
        camera = {"eye": {"x": 0.0, "y": 0.0, "z": 1.4}, "up": {"x": 0.0, "y": 1.0, "z": 0.0}}
    return {"aspectmode": "manual", "aspectratio": ratio, "camera": camera, **axes}


def _trace(name: str, points: Array, mode: str, **more: Any) -> dict[str, Any]:
    x, y, z = (1e3 * points.T).tolist()
    return {"type": "scatter3d", "name": name, "mode": mode, "x": x, "y": y, "z": z, **more}
