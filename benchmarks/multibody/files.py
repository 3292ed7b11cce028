"""A case as files: arm.yaml, recordings and their settings for the tool, and the truth apart."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.blind.generator.arms import arm_file
from benchmarks.blind.generator.files import written
from benchmarks.multibody.cases import Case, Placed
from benchmarks.multibody.instrument import MISLABELLED
from benchmarks.multibody.session import BETWEEN_REPEATS

UNITS = {
    "N*m": ("knee", "held_below"),
    "rad": ("total", "windup", "offset", "sine", "cosine", "tilt_u", "tilt_v", "about_x", "about_y", "about_z"),
    "rad/(N*m)": ("compliance", "windup_per_load"),
    "s": ("time_constant", "lag"),
    "m": ("radius", "length", "along", "across"),
    "kg": ("mass",),
    "m/(m*K)": ("expansion",),
    "rad/K": ("per_kelvin",),
}
"""Parameters by their unit; others are pure numbers."""
HOURLY = {**dict.fromkeys("xyz", "m/h"), "about_z": "rad/h"}


def true_parameters(placed: Placed) -> dict[str, dict[str, float | str]]:
    """Parameters as name_place: {value, unit}, in SI but for what drifts (by the hour)."""
    cause = placed.cause
    units = {name: (unit, 1.0) for unit, names in UNITS.items() for name in names}
    if cause.effect == "frame_drift":
        units |= {name: (unit, 3600.0) for name, unit in HOURLY.items()}
    place = f"_{cause.at[0]}" if cause.at else ""
    results: dict[str, dict[str, float | str]] = {}
    for name, value in cause.parameters.items():
        unit, factor = units.get(name, ("", 1.0))
        results[name + place] = {"value": float(value) * factor, "unit": unit}
    return results


def truth_of(case: Case) -> dict[str, Any]:
    """What is sealed."""
    unknown, session = case.wrong.unknown, case.scene.stage.session
    return {
        "case": case.name,
        "seed": list(case.seed),
        "half": case.half,
        "kind": case.kind,
        "arm": case.scene.stage.machine.arm.family,
        "design": session.design,
        "rows": session.visits * session.repeats,
        "duration_s": float(session.time[-1]),
        "frame": "free" if case.scene.frame_free else "known",
        "tool": "free" if case.scene.tool_free else "known",
        "mounts": len(case.mounts),
        "vice": case.scene.vice,
        "return_scatter_mrad": case.return_scatter * 1e3,
        "sag_mm": case.sag * 1e3,
        "sigma_mm": case.scene.tracker.sigma * 1e3,
        "noise_rms_mm": case.scene.noise * 1e3,
        "oracle_rms_mm": case.oracle * 1e3,
        "dose": case.wrong.dose,
        "effects": [
            {
                "effect": p.cause.effect,
                "at": list(p.cause.at),
                "snr": p.snr,
                "large": p.large,
                "parameters": true_parameters(p),
            }
            for p in case.wrong.causes
        ],
        "unknown": None
        if unknown is None
        else {
            "class": unknown.name,
            "joints": list(unknown.joints),
            "depends_on": sorted(unknown.depends_on),
            "since_s": unknown.since,
            "until_s": unknown.until,
            "snr_beyond_library": case.wrong.unknown_snr[0],
            "snr_beside_geometry": case.wrong.unknown_snr[1],
        },
        "mislabelled": case.wrong.mislabelled[0] or None,
        "file": _of_file(case),
    }


def _of_file(case: Case) -> dict[str, Any]:
    """What the arm file says of masses and stiffness, against which a stated size is possible or not."""
    arm = case.scene.stage.machine.arm
    return {
        "link_mass_kg": [k.line_mass * k.length for k in arm.links],
        "link_length_m": [k.length for k in arm.links],
        "payload_kg": float(case.scene.stage.session.payload.min()),
        "drive_compliance": [j.compliance for j in arm.joints],
    }


def table_of(case: Case) -> pd.DataFrame:
    """All rows, with their columns' units, and a column `mount`."""
    session, arm = case.scene.stage.session, case.scene.stage.machine.arm
    rows = np.repeat(np.arange(session.visits), session.repeats)
    again = np.tile(np.arange(session.repeats), session.visits)
    columns: dict[str, Any] = {"time_s": np.round(session.time[rows] + BETWEEN_REPEATS * again, 1)}
    columns |= {f"q{i + 1}_deg": np.round(session.q[i, rows] * 180.0 / math.pi, 3) for i in range(arm.count)}
    if session.design in ("full", "sides"):
        columns |= {f"dir{i + 1}": session.side[i, rows].astype(int) for i in range(arm.count)}
    columns["payload_kg"] = session.payload[rows]
    columns["temperature_degC"] = np.round(session.temperature[rows], 2)
    axes = "xy" if arm.planar else "xyz"
    columns |= {f"{axis}_mm": np.round(case.readings[k] * 1e3, 5) for k, axis in enumerate(axes)}
    columns["mount"] = np.array(session.mount)[rows]
    return pd.DataFrame(columns)


def write_case(case: Case, root: Path) -> str:
    """Writes the case's files under root/cases/<name> and its truth under root/truth; returns the truth's text."""
    table, (wrong, joint) = table_of(case), case.wrong.mislabelled
    if wrong:
        table = MISLABELLED[wrong](table, joint)
    settings = {"frame": "free" if case.scene.frame_free else "known"} | (
        {"tool": "free"} if case.scene.tool_free else {}
    )
    stems = ["recording"] if len(case.mounts) == 1 else [f"recording-{k + 1}" for k in range(len(case.mounts))]
    parts = [table[table["mount"] == mount].drop(columns="mount") for mount in range(len(case.mounts))]
    recordings = {stem: (part, settings) for stem, part in zip(stems, parts, strict=True)}
    arm = arm_file(case.scene.stage.machine.arm, case.scene.ranges)
    return written(root, case.name, arm, recordings, truth_of(case))
