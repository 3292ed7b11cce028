"""Diagnosis for programs: what a recording says that a model lacks, and what changed between two recordings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from linkwright.core.diagnose.reading.branches import refuse_unmeasured_origins
from linkwright.core.diagnose.result import Diagnosis as DiagnosisResult
from linkwright.core.diagnose.several.recordings import together
from linkwright.core.units.quantities import InputError
from linkwright.json.diagnosis import diagnosis_json
from linkwright.json.fields import fields
from linkwright.json.parameters import parameter_row
from linkwright.output.diagnosis_folder import claim_diagnosis, residuals, write_diagnosis
from linkwright.output.files import REPORT
from linkwright.output.table_file import frame
from linkwright.redesigning import redesign_json
from linkwright.report.pictures.plots import LIKE
from linkwright.report.pictures.residual_map import residual_maps
from linkwright.results.diagnoses.described import describe
from linkwright.results.diagnoses.words import name_words
from linkwright.results.document import Description

from .arm import Arm, catalogue_of
from .design import Redesign
from .motion.log import Log
from .plain_input import File
from .readings import paired
from .recording import Recording, read_recording
from .result import Field, Reported, figure_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

    _Given = Recording | Log | File | pd.DataFrame


@dataclass(frozen=True, repr=False)
class Diagnosis(Reported):
    """What a recording says that an arm's model lacks; `found` holds everything in SI.

    `redesign` is a design problem solved with it, where one was asked for; it is saved with the rest.
    """

    _command = "diagnose"

    arm: Arm
    recording: Recording
    found: DiagnosisResult
    redesign: Redesign | None = None

    verdict = Field[str]("`none`, `named`, `alias_class`, `unknown` or `insufficient_data`.")
    sentence = Field[str]("The answer in plain words.")

    @property
    def findings(self) -> pd.DataFrame:
        """A row for each fitted parameter of each finding, in `unit`, with its 95 % interval; lengths in mm.

        `at` numbers joints or links from 1; `alternatives` names what the data cannot tell from it.
        """
        rows: list[dict[str, Any]] = []
        for finding in self.found.findings:
            row = {
                "effect": finding.effect,
                "at": finding.at,
                "rms_explained_mm": 1e3 * finding.rms_explained,
                "p_value": finding.p_value,
                "alternatives": "; ".join(name_words(alternative) for alternative in finding.alternatives),
            }
            rows += [{**row, **parameter_row(fitted)} for fitted in finding.parameters] or [row]
        columns = ["effect", "at", "rms_explained_mm", "p_value", "alternatives"]
        return frame(rows, [*columns, "parameter", "value", "low", "high", "unit"])

    @property
    def recordings(self) -> pd.DataFrame:
        """A row for each of several recordings: readings, noise floor and RMS (mm) before, after, held out, by what the
        other recordings say, and with sizes of its own."""
        shown = ("noise_floor", "rms_before", "rms_after", "rms_held_out", "rms_from_others", "rms_own")
        keys = ("recording=name", "file", "rows", *(f"{name}_mm" for name in shown))
        rows = [fields(recording, *keys) for recording in self.found.recordings]
        return frame(rows, [key.partition("=")[0] for key in keys])

    @property
    def differences(self) -> pd.DataFrame:
        """A row for each recording of each parameter that is not the same in all, in `unit`, with its 95 % interval."""
        rows = [
            {
                "effect": difference.effect,
                "at": difference.at,
                "p_value": difference.p_value,
                "recording": recording.name,
                **parameter_row(fitted),
            }
            for difference in self.found.differences
            for recording, fitted in zip(self.found.recordings, difference.each, strict=True)
        ]
        columns = ["effect", "at", "p_value", "recording", "parameter", "value", "low", "high", "unit"]
        return frame(rows, columns)

    @property
    def corrected(self) -> Arm:
        """The arm with the findings in it; it knows the angles that it was learned from."""
        q = self.found.recording.q
        spans = tuple((float(low), float(high)) for low, high in zip(q.min(axis=0), q.max(axis=0), strict=True))
        return Arm.of(self.found.corrected, catalogue=self.arm.catalogue, learned=spans)

    @property
    def residuals(self) -> pd.DataFrame:
        """Every reading with its residual before and after (mm, measured less modelled, in the base frame)."""
        return residuals(self.found)

    def plot(self) -> go.Figure:
        """The length of the residual at each reading, with the findings taken off."""
        figures = residual_maps(self.found).figures
        return figure_of([figure for figure in figures.values() if LIKE not in figure][-1])

    @property
    def description(self) -> Description:
        """With the design problem that was solved with it."""
        return describe(self.found, None if self.redesign is None else self.redesign.found)

    @property
    def settings_read(self) -> list[Path]:
        """The files beside those that were named: settings of the recordings, the arm of the problem."""
        arm = None if self.redesign is None else self.redesign.problem.arm_file
        return [*settings_of(self.recording), *([] if arm is None else [arm])]

    def _saved(self, place: Path, first: Mapping[str, str]) -> Sequence[Path]:
        claim_diagnosis(place)
        return write_diagnosis(place, self.found, self.to_json(), first[REPORT], catalogue_of(self.arm.catalogue))

    def _content(self) -> Mapping[str, Any]:
        content: dict[str, Any] = diagnosis_json(self.found)
        content["redesign"] = None if self.redesign is None else redesign_json(self.redesign.found)
        return content

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {self.found.sentence: self.findings}


def recordings_of(
    given: _Given | Sequence[_Given],
    arm: Arm,
    settings: File | Sequence[File] | None = None,
    *,
    units: bool = False,
) -> Recording:
    """A recording as given, or read; several as one that knows which reading is from which."""
    several = list(cast("Sequence[_Given]", given)) if isinstance(given, list | tuple) else [cast("_Given", given)]
    if not several:
        raise InputError("", "recording", "is an empty list; name one recording or more")
    if units and len(several) < 2:
        raise InputError("", "units", "compares several arms; name a recording of each")
    read = each_with_settings(several, arm, settings)
    files = [Path(one.found.file).absolute() for one in read if one.found.file and Path(one.found.file).exists()]
    twice = next((file for k, file in enumerate(files) if file in files[:k]), None)
    if twice is not None:
        raise InputError(twice, "", "is named twice; each recording counts once")
    tips = {part.branch for one in read for part in one.found.singles}
    refuse_unmeasured_origins(arm.model, tips, arm.model.name)
    widths = {one.found.q.shape[1] for one in read}
    if len(widths) > 1:
        raise InputError("", "recording", f"are of arms with {' and '.join(map(str, sorted(widths)))} joints")
    return read[0] if len(read) == 1 else Recording(arm, together([one.found for one in read], arm.model, units=units))


def each_with_settings(given: Sequence[_Given], arm: Arm, settings: File | Sequence[File] | None) -> list[Recording]:
    """Recordings as given, or read: with settings for all, or with those of each. Raises `InputError`."""
    return [recording_of(one, arm, held) for one, held in paired(given, settings)]


def settings_of(recording: Recording) -> list[Path]:
    """The settings files that a recording, or each of several, was read with."""
    return list(dict.fromkeys(Path(part.settings) for part in recording.found.singles if part.settings))


def recording_of(given: _Given, arm: Arm, settings: File | None = None) -> Recording:
    """A recording as given, or read."""
    if isinstance(given, list | tuple):
        raise InputError("", "recording", "is one recording here, not a list; lw.diagnose takes several")
    if isinstance(given, Log):
        raise InputError("", "recording", "is a motion log, which holds nothing of the tip")
    return given if isinstance(given, Recording) else read_recording(given, arm, settings=settings)
