"""What an arm can do: the worst error over its workspace, where it is and why; the figures of any design."""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.chain.following import completed
from linkwright.core.arm.errors.at_pose import PoseError
from linkwright.core.arm.evaluation import Evaluation as EvaluationResult
from linkwright.core.arm.figures import FIGURES, Figure
from linkwright.core.arm.figures.error import MAX_ERROR
from linkwright.core.arm.figures.frequency import FIRST_FREQUENCY
from linkwright.core.arm.files.poses import read_poses
from linkwright.core.arm.motion.dynamics import OfDrive, loads_of
from linkwright.core.diagnose.motion.uses.trajectory import read_motion
from linkwright.core.optimize.robust.result import RobustFigure
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.plain_input import File, Quantity, in_si
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
_UNIT = re.compile(r"\d\s*[^\W\d]")
"""A unit behind a number."""
_OF_DRIVE = ("torque", "rms_torque", "speed", "power", "energy", "braked")


@dataclass(frozen=True)
class Row:
    """A figure beside those that can be limited: of the kind of one of them, with a separate title."""

    name: str
    title: str
    like: Figure


_BESIDE = (
    Row(UPPER, "upper bound of the worst error", MAX_ERROR),
    Row(LOWER, "lower bound of the worst error", MAX_ERROR),
    Row(ROBUST, "worst error over what is uncertain", MAX_ERROR),
    Row(DRIVES, "first frequency with rigid links", FIRST_FREQUENCY),
)


class Figured(ABC):
    """A result with a design: its figures, those that everybody asks for by their names."""

    @abstractmethod
    def _designs(self) -> Mapping[str, Values]:
        """The figures of the design by what its column is called, last; those that it is compared with before it."""

    @abstractmethod
    def _arm_and_figures(self) -> tuple[Model, Mapping[str, Figure]]:
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
        """A row for each figure that is known, by its name: its title, its value (one for each design where
        several are compared; nan where it is not known) and the unit of that row, empty for a pure number."""
        import pandas as pd

        designs = self._designs()
        arm, known = self._arm_and_figures()
        rows = [Row(item.name, item.title_for(arm), item) for item in known.values()]
        rows = [*rows[:1], *(item for item in _BESIDE if item.like is MAX_ERROR), *rows[1:], _BESIDE[-1]]
        shown = [row for row in rows if any(values.get(row.name) is not None for values in designs.values())]
        table = {"title": [row.title for row in shown]}
        columns = {which: [row.like.shown(values.get(row.name)) for row in shown] for which, values in designs.items()}
        frame = pd.DataFrame({**table, **columns, "unit": [row.like.unit for row in shown]})
        frame.index = pd.Index([row.name for row in shown], name="figure")
        return frame.astype(dict.fromkeys(columns, float))


def values_of(evaluation: EvaluationResult, beside: Values = _NONE, known: Mapping[str, Figure] = FIGURES) -> Values:
    """The figures (SI) of an evaluated design, those `beside` too."""
    drives = evaluation.frequency_of_drives
    values = {name: item.value(evaluation) for name, item in known.items()}
    return {**values, UPPER: evaluation.upper_bound, DRIVES: None if drives is None else drives.value, **beside}


@dataclass(frozen=True, repr=False)
class Evaluation(Figured, Reported):
    """An arm's worst position error over its workspace and load cases, and its figures.

    `found` holds everything in SI. Errors in mm, masses in kg; None where the arm's data cannot tell.
    """

    _command = "evaluate"

    arm: Arm
    found: EvaluationResult
    robust: RobustFigure | None = None
    """The error over what the problem calls uncertain, SI."""
    motion: tuple[OfDrive, ...] | None = None
    """What a motion asks of each drive, SI; None where none was given."""
    at: tuple[PoseError, ...] = ()
    """The tip's error at each pose that was asked for, under each load case, SI."""
    known: Mapping[str, Figure] = field(default_factory=lambda: FIGURES)
    """The figures, those of a problem's own (along a direction, say) among them."""

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
        result = self.found.by_effect
        titles = [effect_title(name) for name in result]
        errors = [1e3 * value for value in result.values()]
        return frame({"effect": list(result), "title": titles, "error_mm": errors})

    @property
    def at_poses(self) -> pd.DataFrame:
        """A row for each pose that was asked for and each load case: coordinates (deg, mm), load case (from 1), the
        tip's error with its components (mm) and its rotation with its components (mrad), in the base frame."""
        model, q = self.found.arm, np.array([error.q for error in self.at]).reshape(-1, self.found.arm.size)
        columns: dict[str, Any] = joint_columns(model, completed(model, q) + 0.0)
        columns["load_case"] = [error.load_case + 1 for error in self.at]
        columns["error_mm"] = [1e3 * error.error for error in self.at]
        columns |= _in_axes("error_{}_mm", [error.vector for error in self.at])
        columns["orientation_error_mrad"] = [1e3 * error.orientation for error in self.at]
        return frame(columns | _in_axes("rotation_{}_mrad", [error.rotation for error in self.at]))

    @property
    def at_poses_by_effect(self) -> pd.DataFrame:
        """What each effect has of the error at each pose that was asked for: row of `at_poses` (from 0), share of the
        error (they add up to 1), displacement (mm) and rotation (mrad)."""
        parts = [(row, part) for row, error in enumerate(self.at) for part in error.by_effect]
        columns: dict[str, Any] = {
            "row": [row for row, _ in parts],
            "effect": [part.effect for _, part in parts],
            "share": [part.share for _, part in parts],
        }
        columns |= _in_axes("error_{}_mm", [part.vector for _, part in parts])
        return frame(columns | _in_axes("rotation_{}_mrad", [part.rotation for _, part in parts]))

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
        return describe(self.found, self.robust, self.motion, self.at, self.known)

    def _designs(self) -> Mapping[str, Values]:
        robust = None if self.robust is None else self.robust.value
        return {"value": values_of(self.found, {ROBUST: robust}, self.known)}

    def _arm_and_figures(self) -> tuple[Model, Mapping[str, Figure]]:
        return self.found.arm, self.known

    def _content(self) -> Mapping[str, Any]:
        return evaluation_json(self.found, self.robust, self.motion, self.at, self.known)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        drives = {} if self.motion is None else {"Drives in motion": self.drives}
        asked = {"Asked poses": self.at_poses, "Asked poses by effect": self.at_poses_by_effect} if self.at else {}
        return {"Worst poses": self.worst_poses, "By effect": self.by_effect, **asked, **drives}


def _in_axes(heading: str, vectors: Sequence[Sequence[float]]) -> dict[str, list[float]]:
    """The components of vectors in SI as columns in mm or mrad."""
    return {heading.format(axis): [1e3 * vector[k] for vector in vectors] for k, axis in enumerate("xyz")}


def along(model: Model, file: Path | str) -> tuple[OfDrive, ...]:
    """What the motion in a file asks of an arm's drives. Raises `InputError`, `MissingProperty`."""
    return loads_of(read_motion(Path(file), model))


def poses_of(model: Model, pose: Sequence[Quantity] | Sequence[Sequence[Quantity]] | File) -> Array:
    """Poses (N, n) in rad and m: one as `pose_of` reads it, a list of such, or the table of poses (CSV: q1_deg, ...)
    in a file. Raises `InputError`."""
    if isinstance(pose, PathLike) or (isinstance(pose, str) and Path(pose).suffix.lower() == ".csv"):
        return read_poses(Path(pose), model)[0]
    if not isinstance(pose, str) and len(pose) and all(not isinstance(item, str) and np.ndim(item) for item in pose):
        return np.array([pose_of(model, cast("Sequence[Quantity]", item)) for item in pose])
    return np.array([pose_of(model, cast("Sequence[Quantity] | str", pose))])


def pose_of(model: Model, pose: Sequence[Quantity] | str) -> tuple[float, ...]:
    """Joint coordinates in SI, of quantities or of one text, apart by blanks or commas: numbers with their unit
    (`20 deg, -30 deg`) or in degrees (mm for slides). Raises `InputError`, also for another number of them than
    joints."""
    words = _words(pose, model.size) if isinstance(pose, str) else pose
    if len(words) != model.size:
        needed = f"{model.size} {'value is' if model.size == 1 else 'values are'} needed, one for each joint"
        raise InputError("", "pose", f"{needed}, and {len(words)} {'is' if len(words) == 1 else 'are'} given")
    kinds = ["angle" if joint.revolute else "length" for joint in model.joints]
    units = ["deg" if isinstance(pose, str) and joint.revolute else "mm" for joint in model.joints]
    return tuple(
        _number(word, unit)
        if isinstance(pose, str) and not _UNIT.search(str(word))
        else in_si(word, kind, f"pose[{k}]")
        for k, (word, kind, unit) in enumerate(zip(words, kinds, units, strict=True), 1)
    )


def _words(text: str, size: int) -> list[str]:
    """The numbers of a pose, with the units behind them."""
    parts = [word.strip() for word in re.split(r"[,\s]+(?=[-+.\d])", text.strip())]
    blanks = text.replace(",", " ").split()
    if len(blanks) != size or all(map(_has_unit, parts)):
        return parts
    return blanks


def _has_unit(word: str) -> bool:
    """Whether it is an angle or a length with its unit."""
    for kind in ("angle", "length"):
        with suppress(InputError):
            in_si(word, kind, "pose")
            return True
    return False


def _number(word: str | float, unit: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError("", "pose", f"'{word}' is not a number of degrees (or mm)")
    return math.radians(value) if unit == "deg" else 1e-3 * value
