"""A diagnosis as a plain mapping for `diagnosis.json`: millimetres, degrees and units as people write them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import PurePath
from types import MappingProxyType
from typing import Any

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.answer.sentences import put_right
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.result import (
    Covered,
    Detectable,
    Diagnosis,
    Difference,
    Finding,
    FittedParameter,
    FoundOrigin,
    Mislabelled,
    OfRecording,
    RejectedForm,
    Unknown,
)
from linkwright.core.diagnose.several.recordings import Several
from linkwright.core.units.quantities import format_quantity, kind_of
from linkwright.results.diagnoses.answer import answer, to_do
from linkwright.results.diagnoses.evidence import unit_files

from .design import coordinates
from .fields import fields, fields_if, in_joint_unit, in_mm

_UNITS = MappingProxyType(
    {
        "length": "mm",
        "angle": "mrad",
        "temperature": "degC",
        "thermal_expansion": "um/(m*K)",
        "linear_stiffness": "N/mm",
        "linear_compliance": "um/N",
        "elastic_modulus": "GPa",
        "pressure": "MPa",
        "angle_per_temperature": "mrad/K",
        "length_per_temperature": "um/K",
        "angle_per_length": "mrad/m",
    }
)
"""Units that files for machines use, whatever the size of the figure; SI for all other kinds."""


def unit_of(kind: str) -> str:
    """The unit in which JSON gives a kind of quantity; empty for pure numbers."""
    return _UNITS.get(kind, kind_of(kind).si)


def in_unit(value: float, kind: str) -> float | None:
    """An SI value in the unit of `unit_of`; None where it is not known."""
    if not math.isfinite(value):
        return None
    return float(format_quantity(value, kind, unit_of(kind) or None).split()[0])


def parameter_json(fitted: FittedParameter) -> dict[str, Any]:
    """A fitted parameter with its unit and 95 % interval."""
    return {
        "value": in_unit(fitted.value, fitted.kind),
        "unit": unit_of(fitted.kind),
        "ci95": [in_unit(end, fitted.kind) for end in fitted.alone],
        **fields(fitted, "parameter", "at", "at_bound"),
        "may_hold": fitted.may_hold or None,
    }


def _finding(finding: Finding) -> dict[str, Any]:
    return {
        **fields(finding, "effect", "at", "rms_explained_mm", "p_value", "evidence_nats=evidence"),
        **fields(finding, "rms_without_mm", "rms_without_held_out_mm"),
        "alternatives": [[each.effect, list(each.at)] for each in finding.alternatives],
        "parameters": {fitted.name: parameter_json(fitted) for fitted in finding.parameters},
        "alternatives_detail": [fields(each, "effect", "at", "likeness", "worse") for each in finding.alternatives],
        "sentence": finding.reading,
        "recording": finding.recording or None,
        "together": [[effect, list(at)] for effect, at in finding.together],
    }


_LACK_OF_FIT = ("against", "ratio", "freedom", "p_value", "times", "held_out_times", "held_out_p")


def _rejected(forms: Sequence[RejectedForm]) -> list[dict[str, Any]]:
    return [fields(each, "effect", "at", "share", "reason") for each in forms]


def _unknown(unknown: Unknown) -> dict[str, Any]:
    return {
        **fields(unknown, "depends_on", "amplitude_mm", "shape", "since_s=since", "decide", "held_out_share"),
        "rejected": _rejected(unknown.rejected),
        "forms": [fields(each, "name", "share", "share_held_out", "sentence") for each in unknown.forms],
    }


def _detectable(each: Detectable) -> dict[str, Any]:
    found = {
        **fields(each, "effect", "at", "rms_mm", "parameter", "visible"),
        "value": in_unit(each.value, each.kind),
        "unit": unit_of(each.kind),
    }
    return found if each.visible > 0.0 else {**found, "rms_mm": None, "value": None}


def minimum_detectable(diagnosis: Diagnosis) -> dict[str, float | None]:
    """The smallest RMS displacement (mm) of each effect that would have been found wherever the effect can be seen at
    all: the largest over its visible places. None where the recording shows it nowhere."""
    found: dict[str, float | None] = {effect: None for effect, _ in diagnosis.invisible}
    for each in diagnosis.detectable:
        size = 1e3 * each.rms if each.visible > 0.0 else None
        known = found.get(each.effect)
        found[each.effect] = size if known is None else known if size is None else max(known, size)
    return found


def joint_coordinates(arm: Arm, q: Sequence[float]) -> list[float]:
    """Joint coordinates in degrees, mm for slides."""
    return [in_joint_unit(arm, index, value) + 0.0 for index, value in enumerate(q)]


def covered_json(covered: Covered) -> dict[str, Any]:
    """A figure of a standard; 1 m/N is 1000 mm/N, so one factor serves lengths and compliances."""
    unit = "mm/N" if covered.symbol == "C" else "mm"
    return {**fields(covered, "symbol", "name", "standard", "count"), "value": 1e3 * covered.value, "unit": unit}


def _labels(labels: Mislabelled) -> dict[str, Any]:
    named = [[effect, list(at)] for effect, at in labels.named]
    return {
        "sentence": f"{labels.said}: with that put right, {put_right(labels)}",
        "named": named,
        **fields(labels, "rms_mm"),
    }


def _difference(found: Difference, recordings: Sequence[OfRecording]) -> dict[str, Any]:
    values = {own.name: parameter_json(each) for own, each in zip(recordings, found.each, strict=True)}
    return {**fields(found, "effect", "at", "p_value"), "parameter": found.each[0].parameter, "values": values}


def _rejected_row(recording: Recording, each: RejectedRow) -> dict[str, Any]:
    """A row that was set aside; of several recordings with the one whose file it is in."""
    if not isinstance(recording, Several):
        return fields(each, "row", "reason")
    index, row = recording.place_of(each.row)
    return {"recording": recording.names[index], "row": row, "reason": each.reason}


_WRITTEN = ("rms_mm", "promised_mm", "lacks")


def _recording(each: OfRecording, arm_file: str | None) -> dict[str, Any]:
    rms = ("rms_before_mm", "rms_after_mm", "rms_held_out_mm", "rms_from_others_mm", "rms_own_mm")
    return {
        **fields(each, "name", "file", "rows", "frame", "tool", "noise_floor_mm", *rms),
        "unit": each.unit or None,
        "date": each.date or None,
        **fields(each, "rejected_rows=rejected"),
        "arm_file": arm_file,
        "written_arm_rms_mm": None if each.written is None else in_mm(each.written.rms),
        "written_arm": fields_if(each.written, *_WRITTEN),
    }


def _origin(found: FoundOrigin) -> dict[str, Any]:
    return {
        "joint": found.joint,
        "xyz_mm": [in_mm(each) for each in found.shift],
        "rpy_deg": [math.degrees(each) for each in found.turn],
        "parameters": {fitted.name: parameter_json(fitted) for fitted in found.parameters},
        "not_told_from": [[effect, list(at)] for effect, at in found.swallowed],
    }


def diagnosis_json(diagnosis: Diagnosis) -> dict[str, Any]:
    """What `diagnosis.json` holds."""
    arm, where, recording, small = diagnosis.arm, diagnosis.where, diagnosis.recording, diagnosis.small
    # What the verdict rests on: where small causes explain what is left, the p-value with room for them.
    fit = diagnosis.lack_of_fit if small is None else small.lack_of_fit
    rms = ("rms_before_mm", "rms_after_mm", "rms_after_held_out_mm")
    files = unit_files(diagnosis.recordings) or (None,) * len(diagnosis.recordings)
    rejected = [_rejected_row(recording, each) for each in diagnosis.rejected_rows]
    return {
        "arm": arm.name,
        "recording": PurePath(recording.file).name,
        "recordings": [_recording(each, file) for each, file in zip(diagnosis.recordings, files, strict=True)],
        "differences": [_difference(each, diagnosis.recordings) for each in diagnosis.differences],
        "rows": recording.size,
        "answer": answer(diagnosis),
        "to_do": list(to_do(diagnosis)),
        **fields(diagnosis, "sentence", "verdict", "noise_floor_mm", "noise_source", *rms, "gate_p"),
        "lack_of_fit_p": None if fit is None else fit.p_value,
        "lack_of_fit": fields_if(diagnosis.lack_of_fit, *_LACK_OF_FIT),
        "small_causes": None
        if small is None
        else {**fields(small, "moved_mm"), "lack_of_fit": fields(small.lack_of_fit, *_LACK_OF_FIT)},
        "scatter_over_floor": diagnosis.scatter,
        "labels": None if diagnosis.labels is None else _labels(diagnosis.labels),
        "describes_part": diagnosis.describes_part,
        "written_arm_rms_mm": None if diagnosis.written is None else in_mm(diagnosis.written.rms),
        "written_arm": fields_if(diagnosis.written, *_WRITTEN),
        "missing": [_finding(finding) for finding in diagnosis.findings],
        "origins": [_origin(each) for each in diagnosis.origins],
        "where": fields(where, "joint", "depends_on", "direction", "since_s=since", "joint_shares"),
        "dependences": [fields(each, "on", "p_value", "share") for each in where.dependences],
        "unknown": None if diagnosis.unknown is None else _unknown(diagnosis.unknown),
        "rejected_rows": [each["row"] for each in rejected],
        "rejected_rows_detail": rejected,
        "minimum_detectable_mm": minimum_detectable(diagnosis),
        "detectable": [_detectable(each) for each in diagnosis.detectable],
        "invisible": [{"effect": effect, "at": at} for effect, at in diagnosis.invisible],
        "next_poses": [joint_coordinates(arm, each.q) for each in diagnosis.next_poses],
        "next_poses_detail": [
            {**coordinates(arm, each.q), "payload_kg": each.payload_mass, **fields(each, "side", "decides")}
            for each in diagnosis.next_poses
        ],
        "ladder": [
            fields(each, "label", "rms_mm", "mean_mm", "largest_mm", "held_out_mm") for each in diagnosis.ladder
        ],
        "rejected_forms": _rejected(diagnosis.rejected_forms),
        "splits": {name: in_mm(value) for name, value in diagnosis.splits.items()},
        "iso_figures": [covered_json(each) for each in diagnosis.figures],
        **fields(diagnosis, "next_poses_note", "next_poses_enough", "null_vectors", "notes", "seconds"),
        "warnings": recording.warnings,
    }
