"""An arm in space, to be turned: its worst poses, the shape that its loads bend it to, and what its tip reaches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.chain.chain import LoadCase
from linkwright.core.arm.chain.kinematics import place, tip_position
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.evaluation import Evaluation as EvaluationResult
from linkwright.core.arm.worst.workspace import Workspace, joint_box, spread
from linkwright.core.materials.material import MissingProperty
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm, arm_of
from linkwright.face.design import Optimization
from linkwright.face.evaluation import Evaluation, pose_of
from linkwright.face.plain_input import File, Quantity
from linkwright.face.result import Result, figure_of
from linkwright.report.pictures.loads import bent_shape
from linkwright.report.pictures.svg import nice_below
from linkwright.results.figures_in_words import mm
from linkwright.results.figures_in_words import pose as pose_words

if TYPE_CHECKING:
    import plotly.graph_objects as go

_POSES = 3
_REACHED = 3000
_SHARE = 0.1
"""What of the arm's size the greatest displacement is drawn as."""
_FLATTEST = 0.05
"""The least share of the greatest extent that an axis has: a scene without depth is not drawn."""
_RIGID, _BENT, _ERROR, _REACH = "#7f8c98", "#0072b2", "#d55e00", "#9aa5ae"


@dataclass(frozen=True)
class _Stand:
    """An arm to one tip at a pose (m): its axis, where its joints are, and where its loads bend the axis to; `error`
    is the worst that the tip errs there, where that was asked."""

    title: str
    axis: Array
    joints: Array
    bent: tuple[Array, Array] | None
    error: Array | None


def show(
    of: Arm | File | Result, *, pose: Sequence[Quantity] | str | None = None, scale: float | None = None
) -> go.Figure:
    """An arm in space as a plotly figure that turns: what its tip reaches, the arm, and the shape that it is bent to.

    Of an evaluation or an optimisation the three worst poses are drawn with the error there (play included); of an arm,
    or of a result that found one, the pose in the middle of the joint ranges. The shape is to first order and without
    play; it is left out where a mass is not known. Displacements are enlarged, and the figure says by how much.

    Args:
        of: an arm, its file, or a result: of a diagnosis the corrected arm is drawn.
        pose: the pose to draw, numbers in degrees (mm for slides) in one text, or quantities.
        scale: by how much displacements are enlarged.

    Raises:
        InputError: a result without an arm, or a pose that does not fit the arm.

    >>> import linkwright as lw
    >>> link = lw.Link(length=0.4, section="IPE 80", material="steel-s355")
    >>> arm = lw.Arm(chain=[(lw.Joint(axis="y", range=["-90 deg", "90 deg"]), link)])
    >>> [trace.name for trace in lw.show(arm, pose="20").data]
    ['reach', 'arm', 'joints', 'bent']
    """
    model, evaluation = _arm_of(of)
    if evaluation is not None and pose is None:
        stands = [
            _stand(model, evaluation.load_cases[item.load_case], item.q, np.array(item.vector, dtype=float))
            for item in evaluation.worst.poses[:_POSES]
        ]
    else:
        q = np.mean(joint_box(model, Workspace()), axis=0) if pose is None else pose_of(model, pose)
        stands = [_stand(model, case, [float(value) for value in q], None) for case in model.cases]
    return figure_of(_drawn(stands, _reach(model), scale, flat=model.planar()))


def _arm_of(of: Arm | File | Result) -> tuple[Model, EvaluationResult | None]:
    """What is drawn, and what was found of its worst poses."""
    if isinstance(of, Optimization):
        rounded = of.found.rounded
        of = of.after if rounded is None else Evaluation(of.arm, rounded.evaluation)
    if isinstance(of, Evaluation):
        return of.found.arm, of.found
    if isinstance(of, Result):
        arm = getattr(of, "corrected", None) or getattr(of, "arm", None)
        if not isinstance(arm, Arm):
            raise InputError("", "show", f"takes an arm or a result that has one, and {type(of).__name__} has none")
        return arm.model, None
    return arm_of(of, tips="every").model, None


def _stand(model: Model, case: LoadCase, q: Sequence[float], error: Array | None) -> _Stand:
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
    return _Stand(title, np.array(axis), np.array(joints), bent, error)


def _reach(model: Model) -> Array:
    """Where the tips get, poses spread over the joint ranges."""
    q = spread(*joint_box(model, Workspace()), _REACHED)
    return np.vstack([tip_position(model.on(tip), q) for tip in [branch.name for branch in model.branches] or [""]])


def _drawn(stands: Sequence[_Stand], reach: Array, scale: float | None, *, flat: bool) -> dict[str, Any]:
    size = max(float(np.abs(reach).max()), *(float(np.abs(item.axis).max()) for item in stands))
    moves = [item.bent[1] for item in stands if item.bent is not None]
    moves += [item.error[None, :] for item in stands if item.error is not None]
    greatest = max((float(np.linalg.norm(move, axis=1).max()) for move in moves), default=0.0)
    if scale is None:
        scale = max(1.0, nice_below(_SHARE * size / greatest)) if greatest > 0.0 else 1.0
    data = [_trace("reach", reach, "markers", marker={"size": 1.5, "color": _REACH, "opacity": 0.35})]
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
    camera = {"eye": {"x": 1.25, "y": -1.7, "z": 0.9}, "center": {"x": 0.0, "y": 0.0, "z": -0.12}}
    if flat:
        axes["zaxis"]["visible"] = False
        camera = {"eye": {"x": 0.0, "y": 0.0, "z": 1.4}, "up": {"x": 0.0, "y": 1.0, "z": 0.0}}
    return {"aspectmode": "manual", "aspectratio": ratio, "camera": camera, **axes}


def _trace(name: str, points: Array, mode: str, **more: Any) -> dict[str, Any]:
    x, y, z = (1e3 * points.T).tolist()
    return {"type": "scatter3d", "name": name, "mode": mode, "x": x, "y": y, "z": z, **more}
