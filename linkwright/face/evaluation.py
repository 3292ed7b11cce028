"""What an arm can do: the worst error over its workspace, where it is and why."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.chain.following import completed
from linkwright.core.arm.evaluation import Evaluation as Found
from linkwright.core.optimize.limits import FIGURES, Figure
from linkwright.core.optimize.robust.result import RobustFigure
from linkwright.core.units.quantities import InputError
from linkwright.json.design import evaluation_json
from linkwright.json.fields import joint_columns
from linkwright.output.table_file import frame
from linkwright.report.pictures.plots import colour_range, error_map_figure, field_of, shared_spans
from linkwright.results.document import Description
from linkwright.results.evaluation import describe
from linkwright.results.figures_in_words import effect_title

from .arm import Arm
from .figures import ROBUST, Figured, Values, values_of
from .given import Quantity, in_si
from .result import Field, Reported, figure_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


@dataclass(frozen=True, repr=False)
class Evaluation(Figured, Reported):
    """An arm's worst position error over its workspace and load cases, and its figures.

    `found` holds everything in SI. Errors in mm, masses in kg; None where the arm's data cannot tell.
    """

    _command = "evaluate"

    arm: Arm
    found: Found
    robust: RobustFigure | None = None
    """The error over what the problem calls uncertain, SI."""

    min_safety_factor = Field[float | None](
        "The least factor of safety against yielding over links and poses.", "strength.least_safety_factor"
    )
    warnings = Field[tuple[str, ...]]("Sentences on what should not be relied on.")
    notes = Field[tuple[str, ...]]("What is taken for granted because the files say nothing of it.")
    rigid_links_mm = Field[float | None](
        "The worst error were the links rigid and weightless, mm: what no better link takes away.", "rigid_links_error"
    )

    @property
    def worst_poses(self) -> pd.DataFrame:
        """The worst poses, worst first: coordinates (deg, mm), load case (from 1), error and its components (mm)."""
        model, poses = self.found.arm, self.found.worst.poses
        columns: dict[str, Any] = joint_columns(model, completed(model, np.array([pose.q for pose in poses])) + 0.0)
        columns["load_case"] = [pose.load_case + 1 for pose in poses]
        columns["error_mm"] = [1e3 * pose.error for pose in poses]
        for axis, name in enumerate("xyz"):
            columns[f"error_{name}_mm"] = [1e3 * pose.vector[axis] for pose in poses]
        return frame(columns)

    @property
    def by_effect(self) -> pd.DataFrame:
        """What each effect alone adds at the worst pose, mm."""
        found = self.found.by_effect
        titles = [effect_title(name) for name in found]
        errors = [1e3 * value for value in found.values()]
        return frame({"effect": list(found), "title": titles, "error_mm": errors})

    def plot(self) -> go.Figure:
        """The worst error at each place of the tip, the worst poses marked."""
        field = field_of(self.found)
        colours, spans = colour_range([field], [self.found]), shared_spans([field])
        return figure_of(error_map_figure(field, self.found, colours, spans))

    @property
    def description(self) -> Description:
        """With what the problem calls uncertain."""
        return describe(self.found, self.robust)

    def _designs(self) -> Mapping[str, Values]:
        robust = None if self.robust is None else self.robust.value
        return {"value": values_of(self.found, {ROBUST: robust})}

    def _figured(self) -> tuple[Model, Mapping[str, Figure]]:
        return self.found.arm, FIGURES

    def _content(self) -> Mapping[str, Any]:
        return evaluation_json(self.found, self.robust)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Worst poses": self.worst_poses, "By effect": self.by_effect}


def pose_of(model: Model, pose: Sequence[Quantity] | str) -> tuple[float, ...]:
    """Joint coordinates in SI, of quantities or of numbers in degrees (mm for slides) in one text, apart by blanks or
    commas. Raises `InputError`, also for another number of them than joints."""
    words = pose.replace(",", " ").split() if isinstance(pose, str) else pose
    if len(words) != model.size:
        raise InputError("", "pose", f"needs {model.size} numbers, one for each joint, not {len(words)}")
    if isinstance(pose, str):
        pairs = zip(map(_number, map(str, words)), model.joints, strict=True)
        return tuple(math.radians(value) if joint.revolute else 1e-3 * value for value, joint in pairs)
    kinds = ["angle" if joint.revolute else "length" for joint in model.joints]
    return tuple(in_si(value, kind, f"pose[{k}]") for k, (value, kind) in enumerate(zip(pose, kinds, strict=True), 1))


def _number(word: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError("", "pose", f"'{word}' is not a number of degrees (or mm)")
    return value
