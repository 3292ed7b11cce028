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
from linkwright.core.units.quantities import InputError
from linkwright.json.fields import joint_columns
from linkwright.json.inverse import inverse_json
from linkwright.results.document import Description
from linkwright.results.inverse import describe

from .arm import Arm
from .given import Quantity, in_si
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

    @property
    def description(self) -> Description:
        """Each pose by its coordinates."""
        return describe(self.arm.model, self.point, self.found)

    def _content(self) -> Mapping[str, Any]:
        return inverse_json(self.arm.model, self.point, self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Poses": self.table}


def inclined(arm: Arm, inclination: Quantity) -> Rotation:
    """How the last link's frame is turned when it has this angle from the x axis."""
    if not arm.model.planar():
        raise InputError("", "inclination", f"is for planar arms; {arm.name} leaves the x-y plane")
    angle = in_si(inclination, "angle", "inclination")
    return about((0.0, 0.0, 1.0), math.cos(angle), math.sin(angle))
