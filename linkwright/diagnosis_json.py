"""A diagnosis as a plain mapping for `diagnosis.json`: millimetres, degrees and units as people write them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import PurePath
from types import MappingProxyType
from typing import Any

from arm.chain import Arm
from diagnose.result import (
    Covered,
    Detectable,
    Diagnosis,
    Finding,
    FittedParameter,
    NextPose,
    RejectedForm,
    Unknown,
)
from materials.quantities import format_quantity, kind_of

from .as_json import coordinates, program_version

_UNITS = MappingProxyType({
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
})
"""Units that files for machines use, whatever the size of the figure; SI for all other kinds."""


def unit_of(kind: str) -> str:
    """The unit in which JSON gives a kind of quantity; empty for pure numbers."""
    return _UNITS.get(kind, kind_of(kind).si)


def in_unit(value: float, kind: str) -> float | None:
    """An SI value in the unit of `unit_of`; None where it is not known."""
    if not math.isfinite(value):
        return None
    return float(format_quantity(value, kind, unit_of(kind) or None).split()[0])


def _mm(metres: float | None) -> float | None:
    return None if metres is None or not math.isfinite(metres) else 1e3 * metres


def parameter_json(fitted: FittedParameter) -> dict[str, Any]:
    """A fitted parameter with its unit and 95 % interval."""
    return {
        "value": in_unit(fitted.value, fitted.kind),
        "unit": unit_of(fitted.kind),
        "ci95": [in_unit(end, fitted.kind) for end in fitted.interval],
        "parameter": fitted.parameter,
        "at": list(fitted.at),
        "at_bound": fitted.at_bound,
    }


def _finding(finding: Finding) -> dict[str, Any]:
    return {
        "effect": finding.effect,
        "at": list(finding.at),
        "alternatives": [[each.effect, list(each.at)] for each in finding.alternatives],
        "parameters": {fitted.name: parameter_json(fitted) for fitted in finding.parameters},
        "rms_explained_mm": _mm(finding.rms_explained),
        "p_value": finding.p_value,
        "rms_without_mm": _mm(finding.rms_without),
        "rms_without_held_out_mm": _mm(finding.rms_without_held_out),
        "alternatives_detail": [
            {"effect": each.effect, "at": list(each.at), "likeness": each.likeness, "worse": each.worse}
            for each in finding.alternatives
        ],
        "sentence": finding.reading,
    }


def _rejected(form: RejectedForm) -> dict[str, Any]:
    return {"effect": form.effect, "at": list(form.at), "share": form.share, "reason": form.reason}


def _unknown(unknown: Unknown) -> dict[str, Any]:
    return {
        "depends_on": list(unknown.depends_on),
        "amplitude_mm": _mm(unknown.amplitude),
        "shape": unknown.shape,
        "rejected": [_rejected(form) for form in unknown.rejected],
        "since_s": unknown.since,
        "forms": [
            {
                "name": form.name,
                "share": form.share,
                "share_held_out": form.share_held_out,
                "sentence": form.sentence,
            }
            for form in unknown.forms
        ],
        "decide": unknown.decide,
        "held_out_share": unknown.held_out_share,
    }


def _detectable(each: Detectable) -> dict[str, Any]:
    return {
        "effect": each.effect,
        "at": list(each.at),
        "rms_mm": _mm(each.rms) if each.visible > 0.0 else None,
        "parameter": each.parameter,
        "value": in_unit(each.value, each.kind) if each.visible > 0.0 else None,
        "unit": unit_of(each.kind),
        "visible": each.visible,
    }


def minimum_detectable(diagnosis: Diagnosis) -> dict[str, float | None]:
    """The smallest RMS displacement (mm) of each effect that would have been found wherever the effect can be seen at
    all: the largest over its visible places. None where the recording shows it nowhere."""
    found: dict[str, float | None] = {effect: None for effect, _ in diagnosis.invisible}
    for each in diagnosis.detectable:
        size = _mm(each.rms) if each.visible > 0.0 else None
        known = found.get(each.effect)
        found[each.effect] = size if known is None else known if size is None else max(known, size)
    return found


def joint_coordinates(arm: Arm, q: Sequence[float]) -> list[float]:
    """Joint coordinates in degrees, mm for slides."""
    return [
        (math.degrees(x) if joint.revolute else 1e3 * x) + 0.0 for x, joint in zip(q, arm.joints, strict=True)
    ]


def _next_pose(arm: Arm, each: NextPose) -> dict[str, Any]:
    return {
        **coordinates(arm, each.q),
        "payload_kg": each.payload_mass,
        "side": each.side,
        "decides": each.decides,
    }


def covered_json(covered: Covered) -> dict[str, Any]:
    """A figure of a standard; 1 m/N is 1000 mm/N, so one factor serves lengths and compliances."""
    return {
        "symbol": covered.symbol,
        "name": covered.name,
        "standard": covered.standard,
        "value": 1e3 * covered.value,
        "unit": "mm/N" if covered.symbol == "C" else "mm",
        "count": covered.count,
    }


def diagnosis_json(diagnosis: Diagnosis) -> dict[str, Any]:
    """What `diagnosis.json` holds."""
    arm, where = diagnosis.arm, diagnosis.where
    return {
        "made_by": f"linkwright diagnose {program_version()}",
        "arm": arm.name,
        "recording": PurePath(diagnosis.recording.file).name,
        "rows": diagnosis.recording.size,
        "sentence": diagnosis.sentence,
        "verdict": diagnosis.verdict,
        "noise_floor_mm": _mm(diagnosis.noise_floor),
        "noise_source": diagnosis.noise_source,
        "rms_before_mm": _mm(diagnosis.rms_before),
        "rms_after_mm": _mm(diagnosis.rms_after),
        "rms_after_held_out_mm": _mm(diagnosis.rms_after_held_out),
        "gate_p": diagnosis.gate_p,
        "missing": [_finding(finding) for finding in diagnosis.findings],
        "where": {
            "joint": where.joint,
            "depends_on": list(where.depends_on),
            "direction": where.direction,
            "since_s": where.since,
            "joint_shares": list(where.joint_shares),
        },
        "dependences": [
            {"on": each.on, "p_value": each.p_value, "share": each.share} for each in where.dependences
        ],
        "unknown": None if diagnosis.unknown is None else _unknown(diagnosis.unknown),
        "rejected_rows": [each.row for each in diagnosis.rejected_rows],
        "rejected_rows_detail": [{"row": each.row, "reason": each.reason} for each in diagnosis.rejected_rows],
        "minimum_detectable_mm": minimum_detectable(diagnosis),
        "detectable": [_detectable(each) for each in diagnosis.detectable],
        "invisible": [{"effect": effect, "at": list(at)} for effect, at in diagnosis.invisible],
        "next_poses": [joint_coordinates(arm, each.q) for each in diagnosis.next_poses],
        "next_poses_detail": [_next_pose(arm, each) for each in diagnosis.next_poses],
        "next_poses_note": diagnosis.next_poses_note,
        "ladder": [
            {
                "label": rung.label,
                "rms_mm": _mm(rung.rms),
                "mean_mm": _mm(rung.mean),
                "largest_mm": _mm(rung.largest),
                "held_out_mm": _mm(rung.held_out),
            }
            for rung in diagnosis.ladder
        ],
        "rejected_forms": [_rejected(form) for form in diagnosis.rejected_forms],
        "null_vectors": list(diagnosis.null_vectors),
        "splits": {name: _mm(value) for name, value in diagnosis.splits.items()},
        "iso_figures": [covered_json(each) for each in diagnosis.figures],
        "notes": list(diagnosis.notes),
        "warnings": list(diagnosis.recording.warnings),
        "seconds": diagnosis.seconds,
    }
