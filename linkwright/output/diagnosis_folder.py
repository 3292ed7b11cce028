"""The output folder of a diagnosis: whose it is, what goes into it, and what its arm files are worth."""

from __future__ import annotations

import io
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.loads.unknown_weight import unit_weights
from linkwright.core.arm.files.read import arm_from
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.diagnose.answer.sentences import name_of
from linkwright.core.diagnose.judge.predict import residual_under
from linkwright.core.diagnose.motion.predict import predict_motion
from linkwright.core.diagnose.motion.result import MotionDiagnosis
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.result import Diagnosis, OfRecording, WrittenArm
from linkwright.core.diagnose.several.recordings import Several
from linkwright.core.materials.catalogue import Catalogue
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping as Reader
from linkwright.core.units.reading import load_json, parse_yaml, read_text
from linkwright.json.fields import joint_columns
from linkwright.output.arm_file import arm_file
from linkwright.output.files import DESIGN, REPORT, ReadBack, claim_folder, made_by, write_each
from linkwright.output.table_file import frame
from linkwright.results.diagnoses.evidence import unit_files

if TYPE_CHECKING:
    import pandas as pd

DIAGNOSIS, RESIDUALS, COMPENSATION = "diagnosis.json", "residuals.csv", "compensation.csv"
FILES = (REPORT, DIAGNOSIS, DESIGN, RESIDUALS, COMPENSATION)
"""Everything that a diagnosis may write."""
_DIGITS = 9


def claim_diagnosis(folder: Path) -> None:
    """Make the output folder, or take an earlier diagnosis's again; anything else is refused. Raises `InputError`."""
    claim_folder(folder, "diagnose", (*FILES, *_arm_files(folder)), DIAGNOSIS)


def write_diagnosis(folder: Path, diagnosis: Diagnosis, content: str, page: str, catalogue: Catalogue) -> list[Path]:
    """Write the files, diagnosis.json first; gives which, the report first. `catalogue` is that by which the arm was
    read. Raises `InputError`, and `NotAsWritten` at the end."""
    compensation, units = compensated(diagnosis), unit_files(diagnosis.recordings)
    files: dict[str, str | ReadBack] = {
        DIAGNOSIS: content,
        REPORT: page,
        DESIGN: arm_file(diagnosis.corrected, catalogue),
        RESIDUALS: _csv(residuals(diagnosis)),
        **({} if compensation is None else {COMPENSATION: _csv(compensation)}),
    }
    for one, name in zip(diagnosis.recordings, units, strict=False):
        files[name] = arm_file(one.corrected if one.corrected is not None else diagnosis.corrected, catalogue)
    earlier = {*_arm_files(folder), COMPENSATION} - files.keys()
    return _written(folder, files, (*FILES, *units), earlier)


def write_motion(folder: Path, diagnosis: MotionDiagnosis, content: str, page: str, catalogue: Catalogue) -> list[Path]:
    """The same of motion logs. Raises `InputError`, and `NotAsWritten` at the end."""
    files = {DIAGNOSIS: content, REPORT: page, DESIGN: arm_file(diagnosis.corrected, catalogue)}
    return _written(folder, files, FILES, {*_arm_files(folder), *FILES} - files.keys())


def _written(
    folder: Path, files: Mapping[str, str | ReadBack], order: Sequence[str], earlier: Collection[str]
) -> list[Path]:
    """Write files; gives which, in an order of their names. What an earlier diagnosis left would be taken for this
    one's: it goes."""
    try:
        write_each({folder / name: text for name, text in files.items()})
    finally:
        for name in earlier:
            (folder / name).unlink(missing_ok=True)
    return [folder / name for name in order if name in files]


def _arm_files(folder: Path) -> dict[str, str]:
    """The files of several arms' own in a diagnosis's folder, with what the recording of each is called."""
    if made_by(folder / DIAGNOSIS) != "diagnose":
        return {}
    content: Any = load_json(folder / DIAGNOSIS)
    recordings = content.get("recordings")
    pairs = [(one.get("arm_file"), one.get("name")) for one in recordings or () if isinstance(one, dict)]
    return {name: str(called) for name, called in pairs if isinstance(name, str) and Path(name).name == name}


def _poses(diagnosis: Diagnosis) -> dict[str, Any]:
    """Row, joint coordinates and what was carried, by column."""
    recording = diagnosis.recording
    columns: dict[str, Any] = {"row": recording.row}
    if isinstance(recording, Several):
        places = [recording.place_of(row) for row in recording.row.tolist()]
        columns = {"recording": [recording.names[index] for index, _ in places], "row": [row for _, row in places]}
    for name, values in joint_columns(diagnosis.arm, recording.q).items():
        columns[name] = values.round(_DIGITS)
    if recording.payload_mass is not None:
        columns["payload_kg"] = recording.payload_mass
    if recording.time is not None:
        columns["time_s"] = recording.time
    return columns


def residuals(diagnosis: Diagnosis) -> pd.DataFrame:
    """Every reading with its residual before and after, mm (measured less modelled, in the base frame)."""
    columns = _poses(diagnosis)
    for when, residual in (("before", diagnosis.residual_before), ("after", diagnosis.residual_after)):
        for axis, values in zip(diagnosis.recording.component_names, residual.T, strict=True):
            columns[f"{when}_{axis}_mm"] = (1e3 * values).round(_DIGITS)
        columns[f"{when}_mm"] = (1e3 * np.linalg.norm(residual, axis=1)).round(_DIGITS)
    return frame(columns)


def compensated(diagnosis: Diagnosis) -> pd.DataFrame | None:
    """The smooth model of what nothing explains at the poses recorded, mm; a controller subtracts it there.

    None unless the verdict is unknown and there is such a model. What was named besides is in the corrected arm, and
    `linkwright compensate` makes a table of that.
    """
    if diagnosis.verdict != "unknown" or diagnosis.unknown is None or diagnosis.unknown.predicted is None:
        return None
    axes = zip("xyz", diagnosis.unknown.predicted.T, strict=False)
    columns = {f"d{axis}_mm": (1e3 * values).round(_DIGITS) for axis, values in axes}
    return frame({**_poses(diagnosis), **columns})


def _csv(table: pd.DataFrame) -> str:
    return table.to_csv(index=False, lineterminator="\n")


def learned_from(file: Path, arm: Arm) -> tuple[tuple[float, float], ...] | None:
    """The least and greatest coordinates (rad, m) of each joint in the diagnosis that an arm file stems from, by the
    residuals beside it; None for an arm file of no diagnosis."""
    import pandas as pd

    files = _arm_files(file.parent)
    if made_by(file.with_name(DIAGNOSIS)) != "diagnose" or (file.name != DESIGN and file.name not in files):
        return None
    try:
        poses = pd.read_csv(io.StringIO(read_text(file.with_name(RESIDUALS))))
    except (InputError, ValueError):
        return None
    if file.name in files and "recording" in poses.columns:
        poses = poses[poses["recording"].astype(str) == files[file.name]]
    times: list[tuple[float, float]] = []
    for name, joint in zip(joint_columns(arm, np.zeros((1, arm.size))), arm.joints, strict=True):
        if name not in poses.columns:
            return None
        values = np.asarray(pd.to_numeric(poses[name], errors="coerce"), dtype=float)
        if not np.isfinite(values).all() or not len(values):
            return None
        values = np.radians(values) if joint.revolute else 1e-3 * values
        times.append((float(values.min()), float(values.max())))
    return tuple(times)


def with_written_motion(result: MotionDiagnosis, catalogue: Catalogue) -> MotionDiagnosis:
    """The diagnosis of motion logs with what its `arm.yaml` is worth on the same motion, as `linkwright predict` says
    it; RMS of all joints and logs together."""
    back = _read_back(result.corrected, catalogue)
    predictions = [predict_motion(back, log) for log in result.logs]
    squares = np.nan_to_num([np.square(prediction.rms) for prediction in predictions])
    counts = np.array([prediction.samples for prediction in predictions], dtype=float)
    whole = counts.sum(axis=0)
    if not whole.any():
        return result
    each_joint = (squares * counts).sum(axis=0)[whole > 0.0] / whole[whole > 0.0]
    return replace(result, written=WrittenArm(float(np.sqrt(each_joint.mean())), result.rms_after, ()))


def with_written(result: Diagnosis, catalogue: Catalogue) -> Diagnosis:
    """The diagnosis with what its `arm.yaml` is worth on its recording, as `linkwright predict` says it: frame and
    tool as the recording declares them, nothing else fitted; of several arms, what each one's file is worth too."""
    rms = _written_rms(result.corrected, result.recording, catalogue)
    result = replace(result, written=WrittenArm(rms, result.rms_promised, _lacks(result, result.corrected)))
    parts = zip(result.recordings, result.recording.parts(), strict=False)  # of a recording alone there are none
    return replace(result, recordings=tuple(_with_written_part(result, one, part, catalogue) for one, part in parts))


def _with_written_part(
    diagnosis: Diagnosis, one: OfRecording, recording: Recording, catalogue: Catalogue
) -> OfRecording:
    """A recording with what the file of its arm is worth on it."""
    if one.corrected is None:
        return one
    rms = _written_rms(one.corrected, recording, catalogue)
    return replace(one, written=WrittenArm(rms, one.rms_promised, _lacks(diagnosis, one.corrected, one.name)))


def _written_rms(arm: Arm, recording: Recording, catalogue: Catalogue) -> float:
    """The RMS (m) that an arm leaves of a recording once it has been written and read back."""
    return rms_length(residual_under(_read_back(arm, catalogue), recording))


def _read_back(arm: Arm, catalogue: Catalogue) -> Arm:
    """An arm once it has been written and read back."""
    text = Reader(parse_yaml(arm_to_yaml(arm), file=DESIGN), file=DESIGN)
    return arm_from(text, catalogue, tip=arm.tip)


def _lacks(diagnosis: Diagnosis, corrected: Arm, name: str = "") -> tuple[str, ...]:
    """What an arm's file cannot carry of what was found in all recordings and in one that is its `own`, in words."""
    held = {(entry.effect, tuple(entry.at)) for entry in corrected.effects}
    regained = diagnosis.arm.leave_out - corrected.leave_out
    lost = [
        name_of(finding.effect, finding.at, finding.recording)
        for finding in diagnosis.findings
        if not (name and finding.recording not in ("", name))
        and (
            (finding.recording and not name)
            or ((finding.effect, finding.at) not in held and finding.effect not in regained)
        )
    ]
    weightless = [
        str(number)
        for number, link in enumerate(corrected.links, start=1)
        if link.section is None and link.mass is None
    ]
    if weightless and not unit_weights(corrected):
        lost.append(f"the weight of link{'s' if len(weightless) > 1 else ''} {', '.join(weightless)}, which is unknown")
    if diagnosis.unknown is not None:
        lost.append("what nothing in the library explains")
    return tuple(lost)
