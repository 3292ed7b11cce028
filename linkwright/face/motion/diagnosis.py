"""Diagnosis of motion logs for programs: what a model lacks in the torques of a moving arm."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.result import MotionDiagnosis as MotionDiagnosisResult
from linkwright.core.diagnose.options import Options
from linkwright.face.arm import Arm, catalogue_of
from linkwright.face.progress import Progress
from linkwright.face.result import Field, Reported, drawn
from linkwright.json.fields import fields
from linkwright.json.motion import motion_json
from linkwright.json.parameters import parameter_row
from linkwright.output.diagnosis_folder import claim_diagnosis, with_written_motion, write_motion
from linkwright.output.files import REPORT
from linkwright.output.table_file import frame
from linkwright.results.motion.described import describe
from linkwright.results.motion.words import alternative_words, of_all_joints

from .log import Log, with_known_weights

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go


@dataclass(frozen=True, repr=False)
class MotionDiagnosis(Reported):
    """What motion logs say that an arm's model lacks in the drives' torques; `found` holds everything in SI.

    RMS figures are N*m (of slides N); without a joint they are of all joints together.
    """

    _command = "diagnose"
    _describe = staticmethod(describe)

    arm: Arm
    logs: tuple[Log, ...]
    found: MotionDiagnosisResult

    verdict = Field[str]("`none`, `named`, `alias_class`, `unknown` or `insufficient_data`.")
    sentence = Field[str]("The answer in plain words.")
    rms_before = Field[float]("RMS of what the model as given leaves, N*m.")
    rms_after = Field[float]("RMS of what is left with what was found, N*m.")
    rms_held_out = Field[float]("The same on motion that was not fitted, N*m.")
    noise_floor = Field[float]("RMS of what the whole library leaves, N*m.")

    @property
    def findings(self) -> pd.DataFrame:
        """A row for each parameter of each finding, in `unit`, with its 95 % interval, and what the finding adds to the
        torques (RMS of all joints together); `alternatives` names what the logs cannot tell from it."""
        rows: list[dict[str, Any]] = []
        for finding in self.found.findings:
            row = {
                **{name: getattr(finding, name) for name in ("effect", "at")},
                "rms_explained_Nm": of_all_joints(finding.rms_explained),
                "evidence_nats": finding.evidence,
                "p_value": finding.p_value,
                "alternatives": "; ".join(alternative_words(alternative) for alternative in finding.alternatives),
            }
            rows += [{**row, **parameter_row(fitted)} for fitted in finding.parameters] or [row]
        columns = ["effect", "at", "rms_explained_Nm", "evidence_nats", "p_value", "alternatives"]
        return frame(rows, [*columns, "parameter", "value", "low", "high", "unit"])

    @property
    def per_joint(self) -> pd.DataFrame:
        """A row for each joint: RMS before, after, held out and floor (N*m, of slides N), the share of its torque that
        is left, and what that depends on."""
        return frame([asdict(item) for item in self.found.per_joint])

    @property
    def rollout(self) -> pd.DataFrame | None:
        """A row for each joint: how far MuJoCo's arm is off under the logged torques (RMS over the windows, `_end` at
        their ends; rad and rad/s, of slides m and m/s), before, after and held out; None where it was not asked for."""
        if self.found.rollout is None:
            return None
        off = ("q", "q_end", "dq=velocity", "dq_end=velocity_end")
        return frame(
            [
                {"joint": item.joint}
                | {
                    f"{name}_{state}": value
                    for state in ("before", "after", "held_out")
                    for name, value in fields(getattr(item, state), *off).items()
                }
                for item in self.found.rollout.per_joint
            ]
        )

    @property
    def recordings(self) -> pd.DataFrame:
        """A row for each log: samples, RMS (N*m, all joints together) before, after and held out."""
        keys = ("name", "file", "unit", "date", "samples", "rms_before", "rms_after", "rms_held_out")
        return frame([fields(log, *keys) for log in self.found.of_logs], keys)

    @property
    def corrected(self) -> Arm:
        """The arm with the findings in it."""
        return Arm.of(self.found.corrected, catalogue=self.arm.catalogue)

    @property
    def residuals(self) -> pd.DataFrame:
        """Samples of each log, as far as they are drawn, with the torques left before and after (measured less
        modelled; N*m, of slides N), filtered alike."""
        import pandas as pd

        parts: list[pd.DataFrame] = []
        for trace in self.found.traces:
            columns: dict[str, Any] = {"log": trace.log, "t_s": trace.time}
            for when in ("before", "after"):
                left = trace.measured - getattr(trace, when)
                for number, joint in enumerate(self.found.arm.joints, start=1):
                    columns[f"{when}{number}_{'Nm' if joint.revolute else 'N'}"] = left[:, number - 1]
            parts.append(pd.DataFrame(columns))
        return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()

    def plot(self) -> go.Figure:
        """What is left of each joint's torque: before, after, held out, and the floor."""
        joints = self.found.per_joint
        bars = {
            name: [getattr(joint, field) for joint in joints]
            for name, field in (("before", "before"), ("after", "after"), ("held out", "held_out"), ("floor", "floor"))
        }
        return drawn([f"joint {joint.joint}" for joint in joints], bars, "", "RMS in N*m", mode="bar", type="log")

    @property
    def settings_read(self) -> list[Path]:
        """The settings that the logs were read with."""
        return list(dict.fromkeys(Path(log.found.settings) for log in self.logs if log.found.settings))

    def _saved(self, place: Path, first: Mapping[str, str]) -> Sequence[Path]:
        claim_diagnosis(place)
        return write_motion(place, self.found, self.to_json(), first[REPORT], catalogue_of(self.arm.catalogue))

    def _content(self) -> Mapping[str, Any]:
        return motion_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {self.found.sentence: self.findings, "Each joint": self.per_joint}


def diagnosed_motion(arm: Arm, logs: Sequence[Log], options: Options, tell: Progress) -> MotionDiagnosis:
    """Motion logs diagnosed, and what the written arm is worth on them."""
    diagnosis = diagnose_motion(with_known_weights(arm.model), [log.found for log in logs], options, tell)
    return MotionDiagnosis(arm, tuple(logs), with_written_motion(diagnosis, catalogue_of(arm.catalogue)))
