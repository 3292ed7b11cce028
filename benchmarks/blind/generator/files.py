"""A case as files: arm.yaml, recording.csv, recording.yaml for the tool, and the truth apart."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import yaml

from benchmarks.blind.generator.arms import arm_file
from benchmarks.blind.generator.cases import Alias, Case
from benchmarks.blind.generator.concealed import Effect

UNITS = (
    ("backlash", "held_below", "N*m"),
    ("joint_compliance", "compliance", "rad/(N*m)"),
    ("servo_droop", "compliance", "rad/(N*m)"),
    ("base_compliance", "compliance", "rad/(N*m)"),
    ("creep", "compliance", "rad/(N*m)"),
    ("creep", "time", "s"),
    ("joint_hardening", "compliance", "rad/(N*m)"),
    ("joint_hardening", "knee", "N*m"),
    ("backlash", "total", "rad"),
    ("friction_windup", "coulomb", "rad"),
    ("friction_windup", "proportional", "rad/(N*m)"),
    ("clearance", "radius", "m"),
    ("encoder_offset", "offset", "rad"),
    ("link_length", "length", "m"),
    ("link_mass", "mass", "kg"),
    ("payload", "mass", "kg"),
    ("thermal_expansion", "expansion", "m/(m*K)"),
    ("gearbox_thermal", "rate", "rad/K"),
    ("link_bending", "flexibility", "1/(N*m^2)"),
    ("counterbalance", "spring", "N*m"),
    ("latency", "delay", "s"),
)


def true_parameters(effect: Effect) -> dict[str, dict[str, float | str]]:
    """Parameters as name_place: {value, unit}; SI. EI and the modulus' ratio are given beside their flexibilities."""
    units = {(e, k): u for e, k, u in UNITS}
    values = dict(effect.parameters)
    if effect.effect == "link_bending":
        values["bending_stiffness"] = 1.0 / values["flexibility"]
    if effect.effect == "link_modulus":
        values["ratio"] = 1.0 / (1.0 + values["softness"]) - 1.0
    suffixes = [f"_{i}" for i in effect.at] or [""]
    return {
        f"{name}{suffix}": {"value": float(value), "unit": units.get((effect.effect, name), "")}
        for name, value in values.items()
        for suffix in suffixes
    }


def _pairs(alias: tuple[Alias, ...]) -> list[list[Any]]:
    return [[effect, list(at)] for effect, at, _ in alias]


def truth_of(case: Case) -> dict[str, Any]:
    """What is sealed."""
    axes = 2 if case.arm.planar else 3
    since = next((e.parameters["since"] for e in case.effects if "since" in e.parameters), None)
    return {
        "case": case.name,
        "seed": list(case.seed),
        "kind": case.kind,
        "arm": case.arm.family,
        "stiffness": case.arm.name.split()[-1],
        "design": case.design.name,
        "rows": int(case.design.time.size),
        "frame": "free" if case.design.frame_free else "known",
        "effects": [
            {"effect": e.effect, "at": list(e.at), "parameters": true_parameters(e)}
            | ({"aliases": _pairs(case.alias[k])} if case.alias else {})
            for k, e in enumerate(case.effects)
        ],
        "dose": case.dose,
        "projected_snr": case.projected_snr,
        "effect_snr": list(case.effect_snr),
        "snr_beyond_library": case.beyond_library,
        "sigma_mm": case.tracker.sigma * 1e3,
        "noise_rms_mm": case.tracker.sigma * 1e3 * math.sqrt(axes),
        "since_s": since,
        "aliases": [pair for alias in case.alias for pair in _pairs(alias)],
        "alias_correlations": [r for alias in case.alias for _, _, r in alias],
        "aliases_given_geometry": [pair for alias in case.alias_given_geometry for pair in _pairs(alias)],
        "visible": case.visible,
        "nonlinearity_sigma": case.nonlinearity,
        "hostility": list(case.hostility),
        "tracker": {
            "correlation": case.tracker.correlation,
            "degrees_of_freedom": case.tracker.degrees_of_freedom,
            "drift_mm": case.tracker.drift * 1e3,
            "declared_factor": case.tracker.declared_factor,
        },
        "outlier_rows": [k + 1 for k in case.outliers],
    }


def recording_table(case: Case) -> pd.DataFrame:
    """The recording's columns in their units."""
    design, arm = case.design, case.arm
    columns: dict[str, Any] = {}
    if "time_s" in design.columns:
        columns["time_s"] = np.round(design.time, 1)
    for i, joint in enumerate(arm.joints, 1):
        unit, name = (1e3, "mm") if joint.prismatic else (180.0 / math.pi, "deg")
        columns[f"q{i}_{name}"] = np.round(design.q[i - 1] * unit, 3)
    if "dir" in design.columns:
        columns |= {f"dir{i}": design.side[i - 1].astype(int) for i in range(1, arm.count + 1)}
    if "payload_kg" in design.columns:
        columns["payload_kg"] = design.payload
    if "force" in design.columns:
        columns |= {f"f{axis}_N": design.force[k] for k, axis in enumerate("xyz"[: 2 if arm.planar else 3])}
    if "temperature_degC" in design.columns:
        columns["temperature_degC"] = np.round(design.temperature, 2)
    if "speed" in design.columns:
        turning = [i for i in range(arm.count) if not arm.joints[i].prismatic]
        columns |= {f"v{i + 1}_deg_s": np.round(np.degrees(design.speed[i]), 3) for i in turning}
    axes = "xyz"[: case.readings.shape[0]]
    columns |= {f"{axis}_mm": np.round(case.readings[k] * 1e3, 5) for k, axis in enumerate(axes)}
    return pd.DataFrame(columns)


def recording_settings(case: Case) -> dict[str, str]:
    """recording.yaml: the frame, and the sigma where it is declared (always without repeats)."""
    settings = {"frame": "free" if case.design.frame_free else "known"}
    declared = not case.design.repeats or case.tracker.declared_factor != 1.0 or case.seed[-1] % 3 == 0
    if declared:
        settings["sigma"] = f"{case.tracker.sigma * 1e6 * case.tracker.declared_factor:.3g} um"
    return settings


def write_case(case: Case, root: Path) -> str:
    """Writes the case's files under root/cases/<name> and its truth under root/truth; returns the truth's text."""
    recordings = {"recording": (recording_table(case), recording_settings(case))}
    return written(root, case.name, arm_file(case.arm, case.ranges), recordings, truth_of(case))


def written(
    root: Path, name: str, arm: str, recordings: Mapping[str, tuple[pd.DataFrame, dict[str, str]]], truth: object
) -> str:
    """Writes an arm file, recordings with their settings by their stems, and the truth apart; returns its text."""
    folder = root / "cases" / name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "arm.yaml").write_text(arm, encoding="utf-8")
    for stem, (table, settings) in recordings.items():
        table.to_csv(folder / f"{stem}.csv", index=False, lineterminator="\n")
        (folder / f"{stem}.yaml").write_text(yaml.safe_dump(settings, sort_keys=True), encoding="utf-8")
    text = json.dumps(truth, indent=1, sort_keys=True) + "\n"
    (root / "truth").mkdir(exist_ok=True)
    (root / "truth" / f"{name}.json").write_text(text, encoding="utf-8", newline="\n")
    return text
