"""The joint coordinates that reach a point, all branches."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.chain.following import completed
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.chain.vectors import Rotation, about
from linkwright.core.arm.worst.inverse import InversePose
from linkwright.core.units.quantities import InputError
from linkwright.json.design import coordinates
from linkwright.json.fields import fields, in_joint_unit, in_mm, joint_columns
from linkwright.output.table_file import frame
from linkwright.results.document import Description, Item, Paragraph, Value, table
from linkwright.results.figures_in_words import MINUS, coordinate, figure

from .arm import Arm
from .plain_input import Quantity, in_si
from .result import Result, drawn

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_AT_LIMIT = 1e-6
"""A coordinate this near to an end of its range (rad, m) stands at it."""


@dataclass(frozen=True, repr=False)
class Inverse(Result):
    """The poses that put the tip at a point; `found` holds their coordinates in SI, those nearest mid-range first."""

    _command = "inverse"

    arm: Arm
    point: tuple[float, ...]
    found: tuple[InversePose, ...]

    @property
    def table(self) -> pd.DataFrame:
        """A row for each pose: coordinates, how far its tip is from the point, whether it stands alone."""
        model, poses = self.arm.model, np.array([pose.q for pose in self.found])
        columns: dict[str, Any] = joint_columns(model, completed(model, poses) + 0.0)
        columns["residual_mm"] = [1e3 * pose.residual for pose in self.found]
        return frame({**columns, "isolated": [pose.isolated for pose in self.found]})

    def plot(self) -> go.Figure:
        """The tip of each pose: all stand at the point."""
        tips = 1e3 * tip_position(self.arm.model, [pose.q for pose in self.found])
        return drawn(tips[:, 0].tolist(), {"": tips[:, 1].tolist()})

    @property
    def description(self) -> Description:
        """Each pose by its coordinates, and what is odd about it."""
        arm, poses = self.arm.model, self.found
        place = ", ".join(figure(1e3 * value) for value in self.point)
        count = "1 pose" if len(poses) == 1 else f"{len(poses)} poses"
        family = "" if all(pose.isolated for pose in poses) else ", samples of a family"
        headings = [
            f"joint {index + 1} ({coordinate(arm, index, low)} to {coordinate(arm, index, high)})"
            for index, (low, high) in enumerate(joint.range for joint in arm.joints)
        ]
        items: list[Item] = [table((*headings, ""), [_row(arm, pose) for pose in poses])]
        if not all(pose.isolated or pose.singular for pose in poses):
            items.append(Paragraph("samples of a family: the joints can move on while the tip stays"))
        if arm.branches:
            items.append(Paragraph(f"the tip is {arm.tip}'s; the other arms' joints stand in mid-range"))
        headline = f"{count} at ({place}) mm, within the joint ranges"
        return Description(arm.name, headline, tuple(items), f"{count} at ({place}) mm{family}", f"{arm.name}: ")

    def _content(self) -> Mapping[str, Any]:
        arm = self.arm.model
        poses = [
            {
                **coordinates(arm, pose.q),
                **fields(pose, "residual_mm", "isolated", "singular"),
                "joints_at_limit": _at_limit(arm, pose),
            }
            for pose in self.found
        ]
        tip = {"tip": arm.tip} if arm.branches else {}
        return {"arm": arm.name, **tip, "point_mm": in_mm(self.point), "poses": poses}

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Poses": self.table}


def _at_limit(arm: Model, pose: InversePose) -> list[int]:
    """The joints (from 1) on the way to the tip that stand at an end of their range, of those that cannot turn all the
    way round."""
    return [
        index + 1
        for index, (joint, value) in enumerate(zip(arm.joints, pose.q, strict=True))
        if index in arm.to_tip
        and not (joint.revolute and joint.range[1] - joint.range[0] >= math.tau - 1e-9)
        and min(abs(value - end) for end in joint.range) <= _AT_LIMIT
    ]


def _row(arm: Model, pose: InversePose) -> tuple[str | Value, ...]:
    odd = [*(["singular"] if pose.singular else []), *(f"joint {k} at its limit" for k in _at_limit(arm, pose))]
    shown = (Value(_coordinate(arm, index, value)) for index, value in enumerate(arm.whole_pose(pose.q)))
    return (*shown, ", ".join(odd))


def _coordinate(arm: Model, index: int, value: float) -> str:
    """Fine enough that the tip comes within a hundredth of a millimetre of the point: 0.001 degrees, 0.001 mm."""
    unit = "°" if arm.joints[index].revolute else " mm"
    return f"{round(in_joint_unit(arm, index, value), 3) + 0.0:.3f}{unit}".replace("-", MINUS)


def inclined(arm: Arm, inclination: Quantity) -> Rotation:
    """How the last link's frame is turned when it has this angle from the x axis."""
    if not arm.model.planar():
        raise InputError("", "inclination", f"is for planar arms; {arm.name} leaves the x-y plane")
    angle = in_si(inclination, "angle", "inclination")
    return about((0.0, 0.0, 1.0), math.cos(angle), math.sin(angle))
