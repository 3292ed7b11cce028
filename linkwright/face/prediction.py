"""What an arm file is worth on a recording that it was not learned from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.diagnose.predict import Prediction as Found
from linkwright.json.fields import joint_columns
from linkwright.json.prediction import prediction_json

from .arm import Arm
from .recording import Recording
from .result import Result, figure_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


@dataclass(frozen=True, repr=False)
class Prediction(Result):
    """How far an arm's model is from a recording, nothing but frame and tool fitted, and those only where free.

    Lengths in mm, RMS and mean of the length of the error vector; `found` holds everything in SI.
    """

    _command = "predict"

    arm: Arm
    recording: Recording
    found: Found

    @property
    def rms_mm(self) -> float:
        """The RMS length of the residual, mm."""
        return 1e3 * self.found.rms

    @property
    def mean_mm(self) -> float:
        """The mean length of the residual, mm."""
        return 1e3 * self.found.mean

    @property
    def max_mm(self) -> float:
        """The greatest length of the residual, mm."""
        return 1e3 * self.found.largest

    @property
    def nominal_rms_mm(self) -> float:
        """The RMS of the arm's nominal geometry alone, frame and tool fitted alike, mm."""
        return 1e3 * self.found.nominal_rms

    @property
    def rows(self) -> int:
        """How many readings there are."""
        return self.recording.found.size

    @property
    def outside(self) -> tuple[int, ...]:
        """The rows of the file whose joints leave the coordinates that the arm was learned from.

        Where nobody knows those, they are the joint ranges.
        """
        return self.found.outside

    @property
    def frame(self) -> str:
        """`known`, or `free`: fitted."""
        return self.found.recording.frame

    @property
    def tool(self) -> str:
        """`known`, or `free`: fitted."""
        return self.found.recording.tool

    @property
    def table(self) -> pd.DataFrame:
        """A row for each reading: coordinates, residual (measured less modelled, mm), whether outside."""
        import pandas as pd

        recording = self.found.recording
        columns: dict[str, Any] = {"row": recording.row, **joint_columns(self.arm.model, recording.q + 0.0)}
        for axis, values in zip(recording.component_names, self.found.residual.T, strict=True):
            columns[f"residual_{axis}_mm"] = 1e3 * values
        columns["residual_mm"] = 1e3 * np.linalg.norm(self.found.residual, axis=1)
        columns["outside"] = np.isin(recording.row, self.found.outside)
        return pd.DataFrame(columns)

    def plot(self) -> go.Figure:
        """The length of the residual row by row."""
        table = self.table
        marks = {"type": "scatter", "mode": "markers", "x": table["row"].tolist(), "y": table["residual_mm"].tolist()}
        axes = {"xaxis": {"title": {"text": "row"}}, "yaxis": {"title": {"text": "residual in mm"}}}
        return figure_of({"data": [marks], "layout": axes})

    def _content(self) -> Mapping[str, Any]:
        return prediction_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Readings": self.table}
