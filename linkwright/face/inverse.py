"""The joint coordinates that reach a point, all branches."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.following import completed
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.chain.vectors import Rotation, about
from linkwright.core.arm.worst.inverse import InversePose
from linkwright.core.arm.worst.inverse import inverse as found_poses
from linkwright.core.units.quantities import InputError
from linkwright.json.fields import joint_columns
from linkwright.json.inverse import inverse_json

from .arm import Arm, arm_of
from .given import File, Quantity, in_si
from .result import Result, figure_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


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
        import pandas as pd

        model, poses = self.arm.model, np.array([pose.q for pose in self.found])
        columns: dict[str, Any] = joint_columns(model, completed(model, poses) + 0.0)
        columns["residual_mm"] = [1e3 * pose.residual for pose in self.found]
        columns["isolated"] = [pose.isolated for pose in self.found]
        return pd.DataFrame(columns)

    def plot(self) -> go.Figure:
        """The tip of each pose: all stand at the point."""
        tips = 1e3 * tip_position(self.arm.model, [pose.q for pose in self.found])
        marks = {"type": "scatter", "mode": "markers", "x": tips[:, 0].tolist(), "y": tips[:, 1].tolist()}
        return figure_of({"data": [marks]})

    def _line(self) -> str:
        count = len(self.found)
        family = "" if all(pose.isolated for pose in self.found) else ", samples of a family"
        point = ", ".join(f"{1e3 * x:.6g}" for x in self.point)
        return f"{count} pose{'s' if count > 1 else ''} at ({point}) mm{family}"

    def _content(self) -> Mapping[str, Any]:
        return inverse_json(self.arm.model, self.point, self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Poses": self.table}


def inverse(
    arm: Arm | File,
    x: Quantity,
    y: Quantity,
    z: Quantity | None = None,
    *,
    inclination: Quantity | None = None,
    most: int = 16,
) -> Inverse:
    """The joint coordinates within the joint ranges that put the tip at a point of the base frame, all branches.

    Lengths as text or in m; z is 0 where left out. `inclination` (text, or rad) asks a planar arm's last link to stand
    at this angle from the x axis. An arm with more joints than is asked for has a continuum of poses: samples of it are
    given, `most` at most. Of several arms on one torso it is the tip that the arm was read for (`read_arm(..., tip=)`);
    the joints of the others stand in the middle of their ranges. Raises `InputError`, and `NoAnswer` with what is
    missing where none reaches it.

    >>> import linkwright as lw
    >>> arm = lw.Arm(
    ...     chain=[
    ...         (lw.Joint(), lw.Link(length="400 mm", rigid=True, mass="1 kg")),
    ...         (lw.Joint(), lw.Link(length="300 mm", rigid=True, mass="1 kg")),
    ...     ]
    ... )
    >>> lw.inverse(arm, "400 mm", "300 mm")
    <Inverse: 2 poses at (400, 300) mm>
    """
    named = (("x", x), ("y", y)) if z is None else (("x", x), ("y", y), ("z", z))
    point = tuple(in_si(value, "length", name) for name, value in named)
    given = arm_of(arm, tips="one")
    turned = None if inclination is None else _inclined(given, inclination)
    return Inverse(given, point, found_poses(given.model, point, turned, most=most))


def _inclined(arm: Arm, inclination: Quantity) -> Rotation:
    """How the last link's frame is turned when it has this angle from the x axis."""
    if not arm.model.planar():
        raise InputError("", "inclination", f"is for planar arms; {arm.name} leaves the x-y plane")
    angle = in_si(inclination, "angle", "inclination")
    return about((0.0, 0.0, 1.0), math.cos(angle), math.sin(angle))
