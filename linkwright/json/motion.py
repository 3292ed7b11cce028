"""A diagnosis of motion logs as a plain mapping for `diagnosis.json`: torques in N*m, of slides forces in N."""

from __future__ import annotations

import math
from pathlib import PurePath
from types import MappingProxyType
from typing import Any

from linkwright.core.diagnose.motion.result import Event, MotionDiagnosis, MotionFinding, MotionUnknown, Rollout
from linkwright.results.motion.answer import answer, to_do

from .fields import fields, fields_if
from .parameters import parameter_json, rivals_json

OBSERVES = MappingProxyType({"observes": "motion", "rms_unit": "N*m"})
"""What says in a result that its figures are of torques."""
_WRITTEN = ("rms", "promised", "lacks")


def _unknown(unknown: MotionUnknown) -> dict[str, Any]:
    """What nothing in the library explains; `since_s` with its interval and the effect that acts otherwise from then on
    where it begins within a log."""
    change = unknown.change
    return {
        **fields(unknown, "joints", "depends_on", "amplitude", "shape", "decide"),
        "since_s": None if change is None else change.start.time,
        "since_ci95_s": None if change is None else list(change.start.interval),
        "until_s": None if change is None or change.end is None else change.end.time,
        "changed": None
        if change is None
        else {
            **fields(change, "effect", "at", "log", "share"),
            "parameters": {fitted.name: parameter_json(fitted) for fitted in change.parameters},
        },
    }


def _event(event: Event) -> dict[str, Any]:
    """When an event begins and ends (None: it lasts), where it acts, and how much."""
    change = event.change
    return {
        **fields(event, "kind", "links", "joints"),
        **fields(change, "effect", "at", "log", "share", "rms_by_joint=torque"),
        "start_s": change.start.time,
        "start_ci95_s": list(change.start.interval),
        "end_s": None if change.end is None else change.end.time,
        "end_ci95_s": None if change.end is None else list(change.end.interval),
        "parameters": {fitted.name: parameter_json(fitted) for fitted in change.parameters},
    }


def _finding(finding: MotionFinding) -> dict[str, Any]:
    sets = [[[effect, list(at)] for effect, at in alternative.effects] for alternative in finding.alternatives]
    # Each effect of each set once, those of the nearest set first; what belongs together stands in the detail.
    flat: list[list[Any]] = []
    for one in (one for item in sets for one in item):
        flat += [] if one in (*flat, [finding.effect, list(finding.at)]) else [one]
    return {
        **fields(finding, "effect", "at"),
        "recording": finding.recording or None,
        "alternatives": flat,
        "alternatives_detail": [
            {"effects": named, "worse_nats": alternative.worse}
            for named, alternative in zip(sets, finding.alternatives, strict=True)
        ],
        "parameters": {fitted.name: parameter_json(fitted) for fitted in finding.parameters},
        **fields(finding, "rms_explained", "rms_without_held_out", "evidence_nats=evidence", "p_value"),
        **fields(finding, "sentence=reading", "small"),
        **(
            {}
            if finding.apart is None
            else {"between_encoders_rms": fields(finding.apart, "nominal", "written", "without", "left", "unit")}
        ),
    }


def _rollout(diagnosis: MotionDiagnosis, rollout: Rollout) -> dict[str, Any]:
    """How far the simulated arm is off: coordinates in rad (m), speeds in rad/s (m/s)."""
    off = ("q", "q_end", "dq=velocity", "dq_end=velocity_end")
    states = ("before", "after", "held_out")
    return {
        **fields(rollout, "window_s=seconds", "windows", "beside_mjcf=beside"),
        "left_range": dict(zip(states, rollout.left, strict=True)),
        "per_joint": [
            {
                "joint": item.joint,
                "unit": "rad" if diagnosis.arm.joints[item.joint - 1].revolute else "m",
                **{state: fields(getattr(item, state), *off) for state in states},
            }
            for item in rollout.per_joint
        ],
        "lacks": rollout.lacks or None,
    }


def per_joint_json(diagnosis: MotionDiagnosis) -> list[dict[str, Any]]:
    """What is left of each joint's torque, N*m (N)."""
    rms = ("rms_before=before", "rms_after=after", "rms_after_held_out=held_out", "noise_floor=floor")
    return [
        {
            **fields(item, "joint", *rms, "share_of_torque=share", "depends_on", "p_unknown"),
            "unit": "N*m" if diagnosis.arm.joints[item.joint - 1].revolute else "N",
        }
        for item in diagnosis.per_joint
    ]


def _where(diagnosis: MotionDiagnosis) -> dict[str, Any]:
    """The joint of whose torque the model leaves most as given, and what is left depends on."""
    known = [item for item in diagnosis.per_joint if math.isfinite(item.before)]
    joint = max(known, key=lambda item: item.before, default=None)
    named = () if diagnosis.unknown is None else diagnosis.unknown.depends_on
    depends = dict.fromkeys((*named, *(name for item in diagnosis.per_joint for name in item.depends_on)))
    return {
        "joint": None if diagnosis.verdict == "none" or joint is None else joint.joint,
        "depends_on": list(depends),
        "direction": None,
        "since_s": None,
    }


def motion_json(diagnosis: MotionDiagnosis) -> dict[str, Any]:
    """What `diagnosis.json` holds of motion logs."""
    several = len(diagnosis.logs) > 1
    rejected = [
        {**({"log": PurePath(log.file).name} if several else {}), **fields(item, "row", "reason")}
        for log in diagnosis.logs
        for item in log.rejected
    ]
    of_log = ("name", "file", "samples", "rms_before", "rms_after", "rms_after_held_out=rms_held_out", "rejected")
    logs = [
        {**fields(log, *of_log, "rms_with_own"), "unit": log.unit or None, "date": log.date or None}
        for log in diagnosis.of_logs
    ]
    written = diagnosis.written
    return {
        "arm": diagnosis.arm.name,
        **OBSERVES,
        "logs": logs,
        "samples": sum(log.size for log in diagnosis.logs),
        "answer": answer(diagnosis),
        "to_do": list(to_do(diagnosis)),
        **fields(diagnosis, "sentence", "verdict", "noise_floor", "rms_before", "rms_after"),
        **fields(diagnosis, "rms_after_held_out=rms_held_out", "gate_p"),
        "per_joint": per_joint_json(diagnosis),
        "written_arm_rms": None if written is None else written.rms,
        "written_arm": fields_if(written, *_WRITTEN),
        **rivals_json(diagnosis.rivals, "rms=in_sample", "rms_held_out=held_out", by_joint=True),
        "missing": [_finding(finding) for finding in diagnosis.findings],
        "events": [_event(event) for event in diagnosis.events],
        **fields(diagnosis, "small_together", "differs_beyond=beyond"),
        "rms_with_own": None if diagnosis.rms_with_own is None else diagnosis.rms_with_own[0],
        "where": _where(diagnosis),
        "unknown": None if diagnosis.unknown is None else _unknown(diagnosis.unknown),
        "rollout": None if diagnosis.rollout is None else _rollout(diagnosis, diagnosis.rollout),
        "rejected_rows": [item["row"] for item in rejected],
        "rejected_rows_detail": rejected,
        **fields(diagnosis, "split", "cutoff_Hz", "notes", "seconds"),
        "rates_Hz": list(diagnosis.rates),
        "warnings": [warning for log in diagnosis.logs for warning in log.warnings],
    }
