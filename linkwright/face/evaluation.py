"""What an arm can do: the worst error over its workspace, where it is and why; the figures of any design."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.chain.following import completed
from linkwright.core.arm.evaluation import Evaluation as Found
from linkwright.core.arm.figures import FIGURES, Figure
from linkwright.core.arm.figures.error import MAX_ERROR
from linkwright.core.arm.figures.frequency import FIRST_FREQUENCY
from linkwright.core.arm.motion.loads import OfDrive, loads_of
from linkwright.core.diagnose.motion.uses.trajectory import read_motion
from linkwright.core.optimize.robust.result import RobustFigure
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.plain_input import Quantity, in_si
from linkwright.face.result import Field, Reported, figure_of
from linkwright.json.design import evaluation_json
from linkwright.json.fields import joint_columns
from linkwright.output.table_file import frame
from linkwright.report.pictures.plots import colour_range, error_map_figure, field_of, shared_spans
from linkwright.results.document import Description
from linkwright.results.evaluation import describe
from linkwright.results.figures_in_words import effect_title

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


UPPER, LOWER, ROBUST, DRIVES = "upper_bound", "lower_bound", "robust_error", "first_frequency_of_drives"
Values = Mapping[str, float | None]
"""Figures (SI) by name; None where one is not known."""
_NONE: Values = MappingProxyType({})
_OF_DRIVE = ("torque", "rms_torque", "speed", "power", "energy", "braked")


@dataclass(frozen=True)
class Row:
    """A figure beside those that can be limited: of the kind of one of them, with a title of its own."""

    name: str
    title: str
    like: Figure


_BESIDE = (
    Row(UPPER, "upper bound of the worst error", MAX_ERROR),
    Row(LOWER, "lower bound of the worst error", MAX_ERROR),
    Row(ROBUST, "worst error over what is uncertain", MAX_ERROR),
    Row(DRIVES, "first frequency of the drives alone", FIRST_FREQUENCY),
)


class Figured(ABC):
    """A result with a design: its figures, those that everybody asks for by their names."""

    @abstractmethod
    def _designs(self) -> Mapping[str, Values]:
        """The figures of the design by what its column is called, last; those that it is compared with before it."""

    @abstractmethod
    def _figured(self) -> tuple[Model, Mapping[str, Figure]]:
        """The design's arm, and the figures that are known."""

    def _value(self, name: str, factor: float = 1.0) -> float | None:
        value = [*self._designs().values()][-1].get(name)
        return None if value is None else factor * value

    @property
    def max_error_mm(self) -> float:
        """The worst position error over the workspace and all load cases, mm."""
        error = self._value(MAX_ERROR.name, 1e3)
        assert error is not None
        return error

    @property
    def upper_bound_mm(self) -> float | None:
        """The bound to first order and the most by which samples were longer beyond it, mm; None where unknown."""
        return self._value(UPPER, 1e3)

    @property
    def lower_bound_mm(self) -> float | None:
        """What no allowed design's worst error goes below (see `found.bound_of`), mm; None where something else was
        minimised, or nothing is known."""
        return self._value(LOWER, 1e3)

    @property
    def mass_kg(self) -> float | None:
        """The links' mass, kg; None where some link's is unknown."""
        return self._value("mass")

    @property
    def figures(self) -> pd.DataFrame:
        """A row for each figure that the screen prints, by its name: its title, its value (one for each design where
        several are compared; nan where it is not known) and the unit of that row, empty for a pure number."""
        import pandas as pd

        designs = self._designs()
        arm, known = self._figured()
        rows = [Row(item.name, item.title_for(arm), item) for item in known.values()]
        rows = [*rows[:1], *(item for item in _BESIDE if item.like is MAX_ERROR), *rows[1:], _BESIDE[-1]]
        told = [row for row in rows if any(values.get(row.name) is not None for values in designs.values())]
        table = {"title": [row.title for row in told]}
        columns = {which: [row.like.shown(values.get(row.name)) for row in told] for which, values in designs.items()}
        frame = pd.DataFrame({**table, **columns, "unit": [row.like.unit for row in told]})
        frame.index = pd.Index([row.name for row in told], name="figure")
        return frame.astype(dict.fromkeys(columns, float))


def values_of(evaluation: Found, beside: Values = _NONE, known: Mapping[str, Figure] = FIGURES) -> Values:
    """The figures (SI) of an evaluated design, those `beside` too."""
    drives = evaluation.frequency_of_drives
    values = {name: item.value(evaluation) if item.told(evaluation) else None for name, item in known.items()}
    return {**values, UPPER: evaluation.upper_bound, DRIVES: None if drives is None else drives.value, **beside}


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
    motion: tuple[OfDrive, ...] | None = None
    """What a motion asks of each drive, SI; None where none was given."""

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

    @property
    def drives(self) -> pd.DataFrame:
        """What the motion asks of each drive: greatest and RMS torque (N*m; N), greatest speed (rad/s; m/s) and power
        (W), energy put in and braked off (J); without a row where no motion was given."""
        loads = self.motion or ()
        columns = [[getattr(load, name) for load in loads] for name in _OF_DRIVE]
        return frame({"joint": list(range(1, len(loads) + 1)), **dict(zip(_OF_DRIVE, columns, strict=True))})

    def plot(self) -> go.Figure:
        """The worst error at each place of the tip, the worst poses marked."""
        field = field_of(self.found)
        colours, spans = colour_range([field], [self.found]), shared_spans([field])
        return figure_of(error_map_figure(field, self.found, colours, spans))

    @property
    def description(self) -> Description:
        """With what the problem calls uncertain."""
        return describe(self.found, self.robust, self.motion)

    def _designs(self) -> Mapping[str, Values]:
        robust = None if self.robust is None else self.robust.value
        return {"value": values_of(self.found, {ROBUST: robust})}

    def _figured(self) -> tuple[Model, Mapping[str, Figure]]:
        return self.found.arm, FIGURES

    def _content(self) -> Mapping[str, Any]:
        return evaluation_json(self.found, self.robust, self.motion)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        drives = {} if self.motion is None else {"Drives in motion": self.drives}
        return {"Worst poses": self.worst_poses, "By effect": self.by_effect, **drives}


def along(model: Model, file: Path | str) -> tuple[OfDrive, ...]:
    """What the motion in a file asks of an arm's drives. Raises `InputError`, `MissingProperty`."""
    return loads_of(read_motion(Path(file), model))


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
