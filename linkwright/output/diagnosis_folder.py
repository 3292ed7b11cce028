"""The output folder of a diagnosis: whose it is, and what goes into it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, cast

import numpy as np
import pandas as pd

from arm.writing import arm_to_yaml
from diagnose.result import Diagnosis
from materials.quantities import InputError

from .writing import DESIGN, REPORT, made_folder, refuse_strangers, write_file

DIAGNOSIS, RESIDUALS, COMPENSATION = "diagnosis.json", "residuals.csv", "compensation.csv"
FILES = (REPORT, DIAGNOSIS, DESIGN, RESIDUALS, COMPENSATION)
"""Everything that a diagnosis may write."""
_SIGNATURE = "linkwright diagnose"
_DIGITS = 9


def claim_diagnosis(folder: Path | None) -> None:
    """Make the output folder, or take an earlier diagnosis's again; anything else is refused. Raises `InputError`."""
    if folder is None:
        return
    there = made_folder(folder)
    refuse_strangers(folder, there, FILES)
    if there and not _ours(folder / DIAGNOSIS):
        message = f"holds files that are not of `linkwright diagnose` ({min(there)}); name a new or empty folder"
        raise InputError(folder, "", message)


def _ours(path: Path) -> bool:
    try:
        content: object = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    made_by = cast(dict[str, object], content).get("made_by") if isinstance(content, dict) else None
    return isinstance(made_by, str) and made_by.startswith(_SIGNATURE)


def write_diagnosis(folder: Path, diagnosis: Diagnosis, content: str, page: str) -> tuple[str, ...]:
    """Write the files, diagnosis.json first; gives their names. Raises `InputError`."""
    files = {
        DIAGNOSIS: content,
        REPORT: page,
        DESIGN: arm_to_yaml(diagnosis.corrected),
        RESIDUALS: residuals_csv(diagnosis),
    }
    compensation = compensation_csv(diagnosis)
    if compensation is not None:
        files[COMPENSATION] = compensation
    for name, text in files.items():
        write_file(folder / name, text)
    if compensation is None:
        # One of an earlier diagnosis would be taken for this one's.
        (folder / COMPENSATION).unlink(missing_ok=True)
    return tuple(files)


def _poses(diagnosis: Diagnosis) -> dict[str, Any]:
    """Row, joint coordinates and what was carried, by column."""
    recording = diagnosis.recording
    columns: dict[str, Any] = {"row": recording.row}
    for index, joint in enumerate(diagnosis.arm.joints):
        values = recording.q[:, index]
        name = f"q{index + 1}_{'deg' if joint.revolute else 'mm'}"
        columns[name] = (np.degrees(values) if joint.revolute else 1e3 * values).round(_DIGITS)
    if recording.payload_mass is not None:
        columns["payload_kg"] = recording.payload_mass
    if recording.time is not None:
        columns["time_s"] = recording.time
    return columns


def residuals_csv(diagnosis: Diagnosis) -> str:
    """Every reading with its residual before and after, mm (measured less modelled, in the base frame)."""
    columns = _poses(diagnosis)
    for when, residual in (("before", diagnosis.residual_before), ("after", diagnosis.residual_after)):
        for axis, values in zip("xyz", residual.T, strict=False):
            columns[f"{when}_{axis}_mm"] = (1e3 * values).round(_DIGITS)
        columns[f"{when}_mm"] = (1e3 * np.linalg.norm(residual, axis=1)).round(_DIGITS)
    return pd.DataFrame(columns).to_csv(index=False, lineterminator="\n")


def compensation_csv(diagnosis: Diagnosis) -> str | None:
    """The smooth model of what nothing explains at the poses recorded, mm; a controller subtracts it there.

    None unless the verdict is unknown and there is such a model. What was named besides is in the corrected arm, and
    `linkwright compensate` makes a table of that.
    """
    if diagnosis.verdict != "unknown" or diagnosis.unknown is None or diagnosis.unknown.predicted is None:
        return None
    columns = _poses(diagnosis)
    for axis, values in zip("xyz", diagnosis.unknown.predicted.T, strict=False):
        columns[f"d{axis}_mm"] = (1e3 * values).round(_DIGITS)
    return pd.DataFrame(columns).to_csv(index=False, lineterminator="\n")
