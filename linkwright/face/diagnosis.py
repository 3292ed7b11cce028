"""Diagnosis for programs: what a recording says that a model leaves out, and what changed between two recordings."""

from __future__ import annotations

import io
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.compare.compare import Comparison as FoundComparison
from linkwright.core.diagnose.compare.compare import compare
from linkwright.core.diagnose.diagnosis import diagnose as diagnosed
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.reading.branches import refuse_unmeasured_origins
from linkwright.core.diagnose.recording import Recording as FoundRecording
from linkwright.core.diagnose.result import Diagnosis as Found
from linkwright.core.diagnose.result import FittedParameter
from linkwright.core.diagnose.several.recordings import Several, together
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError
from linkwright.json.diagnosis import diagnosis_json, in_unit, unit_of
from linkwright.output.diagnosis_folder import claim_diagnosis, residuals_csv, write_diagnosis, written_files
from linkwright.report.described import page_of
from linkwright.report.origin import origin_of, signed
from linkwright.report.pictures.plots import LIKE
from linkwright.report.pictures.residual_map import residual_maps
from linkwright.results.diagnoses.comparison import comparison_json, comparison_sentence
from linkwright.results.diagnoses.described import describe
from linkwright.results.diagnoses.words import name_words
from linkwright.results.document import Description
from linkwright.results.redesign import redesign_json

from .arm import Arm, catalogue_of
from .design import Redesign
from .given import File
from .progress import Progress
from .recording import Recording, read_recording
from .result import Reported, Result, figure_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

    _Given = Recording | File | pd.DataFrame


@dataclass(frozen=True, repr=False)
class Diagnosis(Reported):
    """What a recording says that an arm's model leaves out; `found` holds everything in SI.

    `redesign` is a design problem solved with it, where one was asked for; it is saved with the rest.
    """

    _command = "diagnose"

    arm: Arm
    recording: Recording
    found: Found
    redesign: Redesign | None = None

    @property
    def verdict(self) -> str:
        """`none`, `named`, `alias_class`, `unknown` or `insufficient_data`."""
        return self.found.verdict

    @property
    def sentence(self) -> str:
        """The answer in plain words."""
        return self.found.sentence

    @property
    def findings(self) -> pd.DataFrame:
        """A row for each fitted parameter of each finding, in `unit`, with its 95 % interval; lengths in mm.

        `at` numbers joints or links from 1; `alternatives` names what the data cannot tell from it.
        """
        import pandas as pd

        rows: list[dict[str, Any]] = []
        for finding in self.found.findings:
            told = {
                "effect": finding.effect,
                "at": finding.at,
                "rms_explained_mm": 1e3 * finding.rms_explained,
                "p_value": finding.p_value,
                "alternatives": "; ".join(name_words(each) for each in finding.alternatives),
            }
            rows += [{**told, **_parameter(fitted)} for fitted in finding.parameters] or [told]
        columns = ["effect", "at", "rms_explained_mm", "p_value", "alternatives"]
        return pd.DataFrame(rows, columns=[*columns, "parameter", "value", "low", "high", "unit"])

    @property
    def recordings(self) -> pd.DataFrame:
        """A row for each of several recordings: readings, noise floor and RMS (mm) before, after, held out, by what the
        other recordings say, and with sizes of its own."""
        import pandas as pd

        shown = ("noise_floor", "rms_before", "rms_after", "rms_held_out", "rms_from_others", "rms_own")
        rows = [
            {"recording": each.name, "file": each.file, "rows": each.rows}
            | {f"{name}_mm": None if (v := getattr(each, name)) is None else 1e3 * v for name in shown}
            for each in self.found.recordings
        ]
        return pd.DataFrame(rows, columns=["recording", "file", "rows", *(f"{name}_mm" for name in shown)])

    @property
    def differences(self) -> pd.DataFrame:
        """A row for each recording of each parameter that is not the same in all, in `unit`, with its 95 % interval."""
        import pandas as pd

        rows = [
            {"effect": each.effect, "at": each.at, "p_value": each.p_value, "recording": own.name, **_parameter(fitted)}
            for each in self.found.differences
            for own, fitted in zip(self.found.recordings, each.each, strict=True)
        ]
        columns = ["effect", "at", "p_value", "recording", "parameter", "value", "low", "high", "unit"]
        return pd.DataFrame(rows, columns=columns)

    @property
    def corrected(self) -> Arm:
        """The arm with the findings in it; it knows the angles that it was learned from."""
        q = self.found.recording.q
        spans = tuple((float(low), float(high)) for low, high in zip(q.min(axis=0), q.max(axis=0), strict=True))
        return Arm.of(self.found.corrected, catalogue=self.arm.catalogue, learned=spans)

    @property
    def residuals(self) -> pd.DataFrame:
        """Every reading with its residual before and after (mm, measured less modelled, in the base frame)."""
        import pandas as pd

        return pd.read_csv(io.StringIO(residuals_csv(self.found)))

    def plot(self) -> go.Figure:
        """The length of the residual at each reading, with what was found taken off."""
        figures = residual_maps(self.found).figures
        return figure_of([each for each in figures.values() if LIKE not in each][-1])

    @property
    def description(self) -> Description:
        """With the design problem that was solved with it."""
        return describe(self.found, None if self.redesign is None else self.redesign.found)

    @property
    def settings_read(self) -> list[Path]:
        """The files beside those that were named: settings of the recordings, the arm of the problem."""
        arm = None if self.redesign is None else self.redesign.problem.arm_file
        return [*settings_of(self.recording), *([] if arm is None else [arm])]

    def save(
        self, folder: File, *, made_from: Iterable[File] = (), author: str = "", comment: str = ""
    ) -> Sequence[Path]:
        """Write what `diagnose --out` writes, the report with its origin as other results have it; gives which files.
        Raises `InputError` for a folder that holds anything else."""
        place = Path(folder)
        claim_diagnosis(place)
        origin = origin_of(map(Path, made_from), author=author, comment=comment)
        page = signed(page_of(self.description), origin)
        write_diagnosis(place, self.found, self.to_json(), page, catalogue_of(self.arm.catalogue))
        return written_files(place, self.found)

    def _content(self) -> Mapping[str, Any]:
        content: dict[str, Any] = diagnosis_json(self.found)
        content["redesign"] = None if self.redesign is None else redesign_json(self.redesign.found)
        return content

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {self.found.sentence: self.findings}


def _parameter(fitted: FittedParameter) -> dict[str, Any]:
    low, high = (in_unit(end, fitted.kind) for end in fitted.alone)
    unit = unit_of(fitted.kind)
    return {
        "parameter": fitted.name,
        "value": in_unit(fitted.value, fitted.kind),
        "low": low,
        "high": high,
        "unit": unit,
    }


def recordings_of(
    given: Recording | File | pd.DataFrame | Sequence[Recording | File | pd.DataFrame],
    arm: Arm,
    settings: File | Sequence[File] | None = None,
    *,
    units: bool = False,
) -> Recording:
    """A recording as given, or read; several as one that knows which reading is from which."""
    several = list(cast("Sequence[_Given]", given)) if isinstance(given, list | tuple) else [cast("_Given", given)]
    own = list(settings) if isinstance(settings, list | tuple) else [cast("File | None", settings)]
    if not several:
        raise InputError("", "recording", "is an empty list; name one recording or more")
    if units and len(several) < 2:
        raise InputError("", "units", "compares several arms; name a recording of each")
    if len(own) not in (1, len(several)):
        said = f"there are {len(own)} for {len(several)} recordings; give one for all, or one each"
        raise InputError("", "settings", said)
    each = own * len(several) if len(own) == 1 else own
    read = [recording_of(one, arm, held) for one, held in zip(several, each, strict=True)]
    files = [Path(one.found.file).absolute() for one in read if one.found.file and Path(one.found.file).exists()]
    twice = next((file for k, file in enumerate(files) if file in files[:k]), None)
    if twice is not None:
        raise InputError(twice, "", "is named twice; each recording counts once")
    tips = {part.branch for one in read for part in _parts(one)}
    refuse_unmeasured_origins(arm.model, tips, arm.model.name)
    widths = {one.found.q.shape[1] for one in read}
    if len(widths) > 1:
        raise InputError("", "recording", f"are of arms with {' and '.join(map(str, sorted(widths)))} joints")
    return read[0] if len(read) == 1 else Recording(arm, together([one.found for one in read], arm.model, units=units))


def settings_of(recording: Recording) -> list[Path]:
    """The settings files that a recording, or each of several, was read with."""
    return list(dict.fromkeys(Path(each.settings) for each in _parts(recording) if each.settings))


def _parts(recording: Recording) -> Sequence[FoundRecording]:
    """The recordings that one is made of: itself, or each of several."""
    return recording.found.each if isinstance(recording.found, Several) else (recording.found,)


def recording_of(given: Recording | File | pd.DataFrame, arm: Arm, settings: File | None = None) -> Recording:
    """A recording as given, or read."""
    if isinstance(given, list | tuple):
        raise InputError("", "recording", "is one recording here, not a list; lw.diagnose takes several")
    return given if isinstance(given, Recording) else read_recording(given, arm, settings=settings)


def known_effects(names: Collection[str], key: str = "without") -> frozenset[str]:
    """Names of effects; raises `InputError` with the nearest for one that is not known."""
    for name in names:
        if name not in EFFECTS:
            raise InputError("", key, f"there is no effect '{name}'{nearest(name, list(EFFECTS))}")
    return frozenset(names)


@dataclass(frozen=True, repr=False)
class Comparison(Result):
    """What changed between two recordings of one arm; `found` holds everything in SI."""

    _command = "compare"

    arm: Arm
    found: FoundComparison

    @property
    def sentence(self) -> str:
        """What changed, plainly."""
        return comparison_sentence(self.found)

    @property
    def changes(self) -> pd.DataFrame:
        """A row for each parameter of the common model in both recordings, in `unit`; `changed` where beyond doubt."""
        import pandas as pd

        columns = ["effect", "at", "parameter", "before", "after", "difference", "low", "high", "unit", "changed"]
        rows: list[tuple[Any, ...]] = []
        for each in self.found.changes:
            kind = each.first.kind
            figures = (each.first.value, each.second.value, each.difference, *each.interval)
            shown = [in_unit(value, kind) for value in figures]
            rows.append((each.effect, each.first.at, each.first.parameter, *shown, unit_of(kind), each.changed))
        return pd.DataFrame(rows, columns=columns)

    def plot(self) -> go.Figure:
        """The RMS mismatch of both recordings, before anything is explained and after, mm."""
        pair = (self.found.first, self.found.second)
        bars = [
            {"type": "bar", "name": name, "x": ["before", "after"], "y": [1e3 * value for value in values]}
            for name, values in (
                ("mismatch", [each.rms_before for each in pair]),
                ("not explained", list(self.found.unexplained)),
            )
        ]
        return figure_of({"data": bars, "layout": {"yaxis": {"title": {"text": "RMS in mm"}}}})

    def _content(self) -> Mapping[str, Any]:
        return comparison_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Changes": self.changes}


def compared(arm: Arm, both: Sequence[Recording], options: Options, tell: Progress) -> Comparison:
    """Both recordings diagnosed, then fitted with one common model. Raises `InputError` for those of two tips."""
    tips = [each.found.branch for each in both]
    if tips[0] != tips[1]:
        said = f"are of different tips ({' and '.join(tips)}); compare two recordings of one, diagnose takes both"
        raise InputError("", "recordings", said)
    diagnoses: list[Found] = []
    for number, read in enumerate(both):

        def half(text: str, share: float, done: int = number) -> None:
            tell(text, 0.5 * (done + share))

        diagnoses.append(diagnosed(arm.model, read.found, options, half))
    return Comparison(arm, compare(arm.model.on(tips[0]), *diagnoses))
