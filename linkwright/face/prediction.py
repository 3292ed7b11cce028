"""Validation of an arm file on a recording that it was not identified from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from linkwright.core.arm.errors.unknown_mass import payloads_left_out
from linkwright.core.diagnose.judge.predict import Leaving
from linkwright.core.diagnose.judge.predict import Prediction as PredictionResult
from linkwright.core.units.lists import rows_text
from linkwright.json.fields import fields, in_joint_unit, joint_columns, joint_unit
from linkwright.output.table_file import frame
from linkwright.results.document import Description, Item, Lines, Paragraph, length, table
from linkwright.results.figures_in_words import mm

from .arm import Arm
from .recording import Recording
from .result import Field, Result, drawn

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


def describe(result: PredictionResult) -> Description:
    """How far the model is off, beside the geometry alone."""
    recording = result.recording
    fitted = " and ".join(name for name in ("frame", "tool") if getattr(recording, name) == "free")
    how = f"{fitted} fitted" if fitted else "frame and tool as declared"
    rows = [
        ("the arm file's model", length(result.rms, 3), length(result.mean, 3), length(result.largest, 3)),
        ("its geometry alone", length(result.nominal_rms, 3), "", ""),
    ]
    payloads = () if recording.payload_mass is None else np.unique(recording.payload_mass).tolist()
    items: list[Item] = [table(("residual", "RMS", "mean", "largest"), rows)]
    if result.left:
        lead = "Beyond what the arm was learned from nothing promises that its findings hold."
        items.append(Lines((*(_leaving(result, item) for item in result.left), lead)))
    if (missing := payloads_left_out(result.arm, payloads)) is not None:
        items.append(Paragraph(f"Warning: {missing}."))
    name = PurePath(recording.file).name
    headline = f"{mm(result.rms, 3)} RMS over {recording.size} readings, {how}"
    return Description(f"{result.arm.name} on {name}", headline, tuple(items), headline, f"{result.arm.name}: ")


def _leaving(result: PredictionResult, leaving: Leaving) -> str:
    """Where a joint leaves the coordinates that the arm was learned from, as a warning."""
    low, high = _span(result, leaving)
    what = "the coordinates that were learned" if leaving.learned else "its range"
    span = f"{low:.4g} to {high:.4g} {joint_unit(result.arm, leaving.joint - 1)}"
    return f"Warning: joint {leaving.joint} leaves {what} ({span}) in {rows_text(leaving.rows)}."


def _span(result: PredictionResult, leaving: Leaving) -> list[float]:
    return [in_joint_unit(result.arm, leaving.joint - 1, end) for end in leaving.span]


@dataclass(frozen=True, repr=False)
class Prediction(Result):
    """How far an arm's model is from a recording, nothing but frame and tool fitted, and those only where free.

    Lengths in mm, RMS and mean of the length of the error vector; `found` holds everything in SI.
    """

    _command = "predict"
    _describe = staticmethod(describe)

    arm: Arm
    recording: Recording
    found: PredictionResult

    rms_mm = Field[float]("The RMS length of the residual, mm.")
    mean_mm = Field[float]("The mean length of the residual, mm.")
    max_mm = Field[float]("The greatest length of the residual, mm.", "largest")
    nominal_rms_mm = Field[float]("The RMS of the arm's nominal geometry alone, frame and tool fitted alike, mm.")
    rows = Field[int]("How many readings there are.", "recording.size")
    outside = Field[tuple[int, ...]](
        "The rows of the file whose joints leave the coordinates that the arm was learned from. Where nobody knows "
        "those, they are the joint ranges."
    )
    frame = Field[Literal["known", "free"]]("`known`, or `free`: fitted.", "recording.frame")
    tool = Field[Literal["known", "free"]]("`known`, or `free`: fitted.", "recording.tool")

    @property
    def table(self) -> pd.DataFrame:
        """A row for each reading: coordinates, residual (measured less modelled, mm), whether outside."""
        recording = self.found.recording
        columns: dict[str, Any] = {"row": recording.row, **joint_columns(self.arm.model, recording.q + 0.0)}
        for axis, values in zip(recording.component_names, self.found.residual.T, strict=True):
            columns[f"residual_{axis}_mm"] = 1e3 * values
        columns["residual_mm"] = 1e3 * np.linalg.norm(self.found.residual, axis=1)
        return frame({**columns, "outside": np.isin(recording.row, self.found.outside)})

    def plot(self) -> go.Figure:
        """The length of the residual row by row."""
        table = self.table
        return drawn(table["row"].tolist(), {"": table["residual_mm"].tolist()}, "row", "residual in mm")

    def _content(self) -> Mapping[str, Any]:
        result, recording = self.found, self.found.recording
        left = [
            {
                **fields(item, "joint", "rows", "learned"),
                f"span_{joint_unit(result.arm, item.joint - 1)}": _span(result, item),
            }
            for item in result.left
        ]
        return {
            "arm": result.arm.name,
            "recording": PurePath(recording.file).name,
            "rows": recording.size,
            **fields(result, "rms_mm", "mean_mm", "max_mm=largest", "nominal_rms_mm", "outside"),
            **fields(recording, "frame", "tool"),
            "outside_by_joint": left,
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Readings": self.table}
