"""A diagnosis as a plain mapping for `diagnosis.json`: millimetres, degrees and units as people write them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import PurePath
from typing import Any

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.answer.sentences import put_right
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.result import (
    Covered,
    Detectable,
    Diagnosis,
    Difference,
    Exchange,
    Finding,
    FittedOrigin,
    FittedPlacement,
    LackOfFit,
    Mislabelled,
    NextPose,
    OfRecording,
    RejectedForm,
    SetAside,
    SmallBeside,
    Unknown,
    WrittenArm,
)
from linkwright.json.parameters import rivals_json
from linkwright.results.diagnoses.answer import answer, to_do
from linkwright.results.diagnoses.evidence import unit_files

from .design import coordinates
from .fields import fields, fields_if, in_joint_unit, in_mm
from .parameters import in_unit, parameter_json, unit_of


def _finding(finding: Finding) -> dict[str, Any]:
    return {
        **fields(finding, "effect", "at", "rms_explained_mm", "p_value", "evidence_nats=evidence"),
        **fields(finding, "rms_without_mm", "rms_without_held_out_mm"),
        "alternatives": [[alternative.effect, list(alternative.at)] for alternative in finding.alternatives],
        "parameters": {fitted.name: parameter_json(fitted) for fitted in finding.parameters},
        "alternatives_detail": [
            fields(alternative, "effect", "at", "likeness", "worse") for alternative in finding.alternatives
        ],
        "sentence": finding.reading,
        "recording": finding.recording or None,
        "together": [[effect, list(at)] for effect, at in finding.together],
        "small": finding.small,
    }


_LACK_OF_FIT = ("against", "ratio", "freedom", "p_value", "times", "held_out_times", "held_out_p")


def _rejected(forms: Sequence[RejectedForm]) -> list[dict[str, Any]]:
    return [fields(form, "effect", "at", "share", "reason") for form in forms]


def _unknown(unknown: Unknown) -> dict[str, Any]:
    return {
        **fields(unknown, "depends_on", "amplitude_mm", "shape", "since_s=since", "decide", "held_out_share"),
        "rejected": _rejected(unknown.rejected),
        "forms": [fields(form, "name", "share", "share_held_out", "sentence") for form in unknown.forms],
    }


def _detectable(detectable: Detectable) -> dict[str, Any]:
    content = {
        **fields(detectable, "effect", "at", "rms_mm", "parameter", "visible"),
        "value": in_unit(detectable.value, detectable.kind),
        "unit": unit_of(detectable.kind),
    }
    return content if detectable.visible > 0.0 else {**content, "rms_mm": None, "value": None}


def minimum_detectable(diagnosis: Diagnosis) -> dict[str, float | None]:
    """The smallest RMS displacement (mm) of each effect that would have been found wherever the effect can be seen at
    all: the largest over its visible places. None where the recording shows it nowhere."""
    minima: dict[str, float | None] = {effect: None for effect, _ in diagnosis.invisible}
    for item in diagnosis.detectable:
        size = 1e3 * item.rms if item.visible > 0.0 else None
        known = minima.get(item.effect)
        minima[item.effect] = size if known is None else known if size is None else max(known, size)
    return minima


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


def _difference(difference: Difference, recordings: Sequence[OfRecording]) -> dict[str, Any]:
    values = {recording.name: parameter_json(item) for recording, item in zip(recordings, difference.each, strict=True)}
    return {
        **fields(difference, "effect", "at", "p_value"),
        "parameter": difference.each[0].parameter,
        "values": values,
    }


def _rejected_row(recording: Recording, each: RejectedRow) -> dict[str, Any]:
    """A row that was set aside; of several recordings with the one whose file it is in."""
    index, row = recording.place_of(each.row)
    name = recording.names[index]
    return {**({"recording": name} if name else {}), "row": row, "reason": each.reason}


def _set_aside(aside: SetAside) -> dict[str, Any]:
    alike = None if aside.alike is None else fields(aside.alike, "how", "p_value")
    return {**fields(aside, "rows", "rms_with_mm"), "alike": alike}


_WRITTEN = ("rms_mm", "promised_mm", "lacks")


def _recording(recording: OfRecording, arm_file: str | None) -> dict[str, Any]:
    rms = ("rms_before_mm", "rms_after_mm", "rms_held_out_mm", "rms_from_others_mm", "rms_own_mm")
    return {
        **fields(recording, "name", "file", "rows", "frame", "tool", "noise_floor_mm", *rms),
        "unit": recording.unit or None,
        "date": recording.date or None,
        **fields(recording, "rejected_rows=rejected"),
        "arm_file": arm_file,
        **_written(recording.written),
    }


def _origin(origin: FittedOrigin) -> dict[str, Any]:
    return {
        "joint": origin.joint,
        "xyz_mm": [in_mm(item) for item in origin.shift],
        "rpy_deg": [math.degrees(item) for item in origin.turn],
        "parameters": {fitted.name: parameter_json(fitted) for fitted in origin.parameters},
        "not_told_from": [[effect, list(at)] for effect, at in origin.swallowed],
    }


def _placements(placements: Sequence[FittedPlacement], of: str) -> list[dict[str, Any]]:
    """Free frames (the base in the measuring frame) or tools (the tip at the last link's end), one a recording."""
    held: list[dict[str, Any]] = []
    for item in placements:
        if item.of == of:
            lengths, angles = ([each for each in item.parameters if each.kind == k] for k in ("length", "angle"))
            turned = {"rpy_deg": [0.0] * (3 - len(angles)) + [math.degrees(each.value) for each in angles]}
            held.append(
                {
                    "recording": item.recording or None,
                    "xyz_mm": [in_mm(each.value) for each in lengths],
                    **(turned if angles else {}),
                    "parameters": {each.name: parameter_json(each) for each in item.parameters},
                }
            )
    return held


def _exchange(exchange: Exchange) -> dict[str, Any]:
    return {
        "instead_of": [[effect, list(at)] for effect, at, _ in exchange.instead_of],
        "effects": [[effect, list(at)] for effect, at, _ in exchange.effects],
        "worse": exchange.worse,
    }


def _lack_of_fit(fit: LackOfFit | None, small: SmallBeside | None) -> dict[str, Any]:
    """What the verdict rests on: where small causes explain what is left, the p-value with room for them."""
    tested = fit if small is None else small.lack_of_fit
    return {
        "lack_of_fit_p": None if tested is None else tested.p_value,
        "lack_of_fit": fields_if(fit, *_LACK_OF_FIT),
        "small_causes": None
        if small is None
        else {**fields(small, "moved_mm"), "lack_of_fit": fields(small.lack_of_fit, *_LACK_OF_FIT)},
    }


def _written(written: WrittenArm | None) -> dict[str, Any]:
    rms = None if written is None else in_mm(written.rms)
    return {"written_arm_rms_mm": rms, "written_arm": fields_if(written, *_WRITTEN)}


def _next_pose(arm: Arm, pose: NextPose) -> dict[str, Any]:
    return {**coordinates(arm, pose.q), "payload_kg": pose.payload_mass, **fields(pose, "side", "decides")}


def diagnosis_json(diagnosis: Diagnosis) -> dict[str, Any]:
    """What `diagnosis.json` holds."""
    arm, where, recording = diagnosis.arm, diagnosis.where, diagnosis.recording
    rms = ("rms_before_mm", "rms_after_mm", "rms_after_held_out_mm")
    files = unit_files(diagnosis.recordings) or (None,) * len(diagnosis.recordings)
    rejected = [_rejected_row(recording, row) for row in diagnosis.rejected_rows]
    return {
        "arm": arm.name,
        "recording": PurePath(recording.file).name,
        "recordings": [_recording(item, file) for item, file in zip(diagnosis.recordings, files, strict=True)],
        "differences": [_difference(difference, diagnosis.recordings) for difference in diagnosis.differences],
        "rows": recording.size,
        "answer": answer(diagnosis),
        "to_do": list(to_do(diagnosis)),
        **fields(diagnosis, "sentence", "verdict", "noise_floor_mm", "noise_source", *rms, "gate_p"),
        **_lack_of_fit(diagnosis.lack_of_fit, diagnosis.small),
        "scatter_over_floor": diagnosis.scatter,
        "labels": None if diagnosis.labels is None else _labels(diagnosis.labels),
        "describes_part": diagnosis.describes_part,
        **_written(diagnosis.written),
        **rivals_json(diagnosis.rivals, "rms_mm=in_sample", "rms_held_out_mm=held_out"),
        "missing": [_finding(finding) for finding in diagnosis.findings],
        **fields(diagnosis, "small_together_mm"),
        "exchanges": [_exchange(exchange) for exchange in diagnosis.exchanges],
        "origins": [_origin(origin) for origin in diagnosis.origins],
        "frame": _placements(diagnosis.placements, "frame"),
        "tool": _placements(diagnosis.placements, "tool"),
        "where": fields(where, "joint", "depends_on", "direction", "since_s=since", "joint_shares"),
        "dependences": [fields(dependence, "on", "p_value", "share") for dependence in where.dependences],
        "unknown": None if diagnosis.unknown is None else _unknown(diagnosis.unknown),
        "rejected_rows": [item["row"] for item in rejected],
        "rejected_rows_detail": rejected,
        "set_aside": None if diagnosis.set_aside is None else _set_aside(diagnosis.set_aside),
        "minimum_detectable_mm": minimum_detectable(diagnosis),
        "detectable": [_detectable(item) for item in diagnosis.detectable],
        "invisible": [{"effect": effect, "at": at} for effect, at in diagnosis.invisible],
        "next_poses": [joint_coordinates(arm, pose.q) for pose in diagnosis.next_poses],
        "next_poses_detail": [_next_pose(arm, pose) for pose in diagnosis.next_poses],
        "ladder": [
            fields(item, "label", "rms_mm", "mean_mm", "largest_mm", "held_out_mm") for item in diagnosis.ladder
        ],
        "rejected_forms": _rejected(diagnosis.rejected_forms),
        "splits": {name: in_mm(value) for name, value in diagnosis.splits.items()},
        "iso_figures": [covered_json(figure) for figure in diagnosis.figures],
        **fields(diagnosis, "next_poses_note", "next_poses_enough", "null_vectors", "notes", "seconds"),
        "warnings": recording.warnings,
    }
