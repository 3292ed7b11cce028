"""Validation of an arm file on a motion log that it was not identified from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from linkwright.core.diagnose.motion.predict import MotionPrediction as MotionPredictionResult
from linkwright.core.diagnose.motion.predict import predict_motion
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.result import Result, drawn
from linkwright.json.motion import OBSERVES
from linkwright.output.table_file import frame
from linkwright.results.document import Description, Lines, count, share, table
from linkwright.results.figures_in_words import with_unit
from linkwright.results.motion.words import of_all_joints, torque, torque_unit

from .log import Log

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


@dataclass(frozen=True, repr=False)
class MotionPrediction(Result):
    """What an arm's model leaves of the drives' torques in a motion log, nothing fitted; `found` holds everything in
    SI."""

    _command = "predict"

    arm: Arm
    log: Log
    found: MotionPredictionResult

    @property
    def rms(self) -> float:
        """RMS of all joints together: the root of the mean of their squares, N*m."""
        return of_all_joints(self.found.rms)

    @property
    def per_joint(self) -> pd.DataFrame:
        """A row for each joint: RMS of measured less modelled torque where it moves (N*m, of slides N), that as a
        share of the torque, the samples that count."""
        return frame(self._content()["per_joint"])

    @property
    def description(self) -> Description:
        """How far the model is off, joint by joint."""
        model, result = self.arm.model, self.found
        rows = [
            (count(number), torque(rms, torque_unit(model, number)), share(part), count(samples))
            for number, (rms, part, samples) in enumerate(
                zip(result.rms, result.share, result.samples, strict=True), start=1
            )
        ]
        headings = ("joint", "RMS of what is left", "of its torque", "samples")
        headline = f"{torque(self.rms).text} RMS of all joints together, nothing fitted"
        how = "Torque and model are as they were sampled" if result.cutoff is None else ""
        how = how or f"Torque and model are low-passed at {with_unit(result.cutoff, 'Hz', 3)}"
        items = (table(headings, rows), Lines((f"{how}, where the joint moves.", *self.log.warnings)))
        name = PurePath(self.log.found.file).name
        return Description(f"{model.name} on {name}", headline, items, headline, f"{model.name}: ")

    def plot(self) -> go.Figure:
        """RMS of what is left of each joint's torque."""
        names = [f"joint {number}" for number in range(1, len(self.found.rms) + 1)]
        return drawn(names, {"": list(self.found.rms)}, "", "RMS in N*m", mode="bar")

    def _content(self) -> Mapping[str, Any]:
        model, result = self.arm.model, self.found
        return {
            "arm": model.name,
            "log": PurePath(self.log.found.file).name,
            **OBSERVES,
            "rms": self.rms,
            "per_joint": [
                {
                    "joint": number,
                    "rms": rms,
                    "share_of_torque": part,
                    "samples": samples,
                    "unit": "N*m" if model.joints[number - 1].revolute else "N",
                }
                for number, (rms, part, samples) in enumerate(
                    zip(result.rms, result.share, result.samples, strict=True), start=1
                )
            ],
            "cutoff_Hz": result.cutoff,
            "samples": self.log.found.size,
            "warnings": list(self.log.warnings),
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Each joint": self.per_joint}


def predicted_motion(arm: Arm, log: Log) -> MotionPrediction:
    """What an arm's model leaves of a motion log. Raises `InputError` for currents and voltages without torque
    constants."""
    if log.found.torque_constants_free:
        drive = log.found.drive
        message = (
            f"is missing; {drive.words} are torques by it, N m/{drive.unit}: `torque_constants: [14.9, ...]` in "
            "recording.yaml"
        )
        raise InputError(log.found.settings or log.found.file, "torque_constants", message)
    return MotionPrediction(arm, log, predict_motion(arm.model, log.found))
