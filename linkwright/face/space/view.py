"""An arm in space, to be turned: its worst poses, the shape that its loads bend it to, and what its tip reaches."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.evaluation import Evaluation as EvaluationResult
from linkwright.core.arm.worst.workspace import Workspace, joint_box, spread
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm, arm_of
from linkwright.face.design import Optimization
from linkwright.face.evaluation import Evaluation, pose_of
from linkwright.face.plain_input import File, Quantity
from linkwright.face.result import Result, figure_of
from linkwright.report.charts.space import in_space, stand_of

if TYPE_CHECKING:
    import plotly.graph_objects as go

_POSES = 3
_REACHED = 3000


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
            stand_of(model, evaluation.load_cases[item.load_case], item.q, np.array(item.vector, dtype=float))
            for item in evaluation.worst.poses[:_POSES]
        ]
    else:
        q = np.mean(joint_box(model, Workspace()), axis=0) if pose is None else pose_of(model, pose)
        stands = [stand_of(model, case, [float(value) for value in q], None) for case in model.cases]
    return figure_of(in_space(stands, _reach(model), scale, flat=model.planar()))


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


def _reach(model: Model) -> Array:
    """Where the tips get, poses spread over the joint ranges."""
    q = spread(*joint_box(model, Workspace()), _REACHED)
    return np.vstack([tip_position(model.on(tip), q) for tip in [branch.name for branch in model.branches] or [""]])
