"""A case as files: arm.yaml, recording-1.csv and so on with their settings, test.csv, and the truth apart."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.blind.generator.files import written
from benchmarks.motion.generator.arms import Arm, arm_file
from benchmarks.motion.generator.cases import Case
from benchmarks.motion.generator.logger import Logged
from benchmarks.motion.generator.moved import Cause
from benchmarks.motion.generator.signals import CUTOFF

OF_JOINT = {
    "torque": ("N*m", "N"),
    "coefficient": ("N*m*s/rad", "N*s/m"),
    "inertia": ("kg*m^2", "kg"),
    "stiffness": ("N*m/rad", "N/m"),
    "sine": ("N*m", "N"),
    "cosine": ("N*m", "N"),
    "compliance": ("rad/(N*m)", "m/N"),
    "speed": ("rad/s", "m/s"),
    "distance": ("rad", "m"),
    "offset": ("rad", "m"),
}
OTHER = {
    "mass": "kg", "centre_x": "m", "centre_y": "m", "centre_z": "m", "x": "m", "y": "m", "z": "m",
    "time": "s", "about_x": "rad", "about_y": "rad", "order": "", "share": "", "excess": "",
    "forward": "", "backward": "",
}  # fmt: skip


def _unit(cause: Cause, name: str, arm: Arm) -> str:
    """A parameter's unit."""
    slide = bool(cause.at) and arm.axes[cause.joint].slide
    if cause.effect == "friction_quadratic":
        return "N*s^2/m^2" if slide else "N*m*s^2/rad^2"
    return OF_JOINT[name][slide] if name in OF_JOINT else OTHER[name]


def true_parameters(cause: Cause, arm: Arm) -> dict[str, dict[str, float | str]]:
    """Parameters as name_place: {value, unit}; SI."""
    suffixes = [f"_{i}" for i in cause.at] or [""]
    return {
        f"{name}{suffix}": {"value": float(value), "unit": _unit(cause, name, arm)}
        for name, value in {**cause.sizes, **cause.shapes}.items()
        for suffix in suffixes
    }


def truth_of(case: Case) -> dict[str, Any]:
    """What is sealed."""
    logger, unknown = case.logger, case.unknown
    return {
        "case": case.name,
        "seed": list(case.seed),
        "half": case.half,
        "kind": case.kind,
        "arm": case.arm.family,
        "joints": case.arm.count,
        "logs": len(case.logs) - 1,
        "duration_s": [float(log.time[-1]) for log in case.logs],
        "rows": sum(len(log.time) for log in case.logs[:-1]),
        "logger": asdict(logger),
        "torque_rms": case.torque_rms.tolist(),
        "noise_rms": case.noise_rms.tolist(),
        "oracle_rms": case.oracle_rms.tolist(),
        "cutoff_hz": CUTOFF,
        "effects": [
            {
                "effect": cause.effect,
                "at": list(cause.at),
                "share": cause.share,
                "large": cause.large,
                "parameters": true_parameters(cause, case.arm),
            }
            for cause in case.causes
        ],
        "unknown": None
        if unknown is None
        else {
            "class": unknown.name,
            "joints": list(unknown.joints),
            "share_beyond_library": case.beyond,
        },
    }


def table_of(log: Logged, arm: Arm, digits: int, currents: bool) -> pd.DataFrame:
    """The log's columns in their units."""
    columns: dict[str, Any] = {"t_s": np.round(log.time, 5)}
    for j, axis in enumerate(arm.axes):
        columns[f"q{j + 1}_{'m' if axis.slide else 'rad'}"] = np.round(log.q[:, j], digits + axis.slide)
    if log.velocity is not None:
        for j, axis in enumerate(arm.axes):
            columns[f"dq{j + 1}_{'mps' if axis.slide else 'radps'}"] = np.round(log.velocity[:, j], 5)
    for j, axis in enumerate(arm.axes):
        name = f"current{j + 1}_A" if currents else f"tau{j + 1}_{'N' if axis.slide else 'Nm'}"
        columns[name] = [float(f"{x:.6g}") for x in log.torque[:, j]]
    return pd.DataFrame(columns)


def declared(arm: Arm) -> list[dict[str, object]]:
    """The arm file's effects: what it says of its drives."""
    effects = (("friction_coulomb", "torque"), ("friction_viscous", "coefficient"), ("armature", "inertia"))
    return [
        {"effect": effect, "at": j + 1, size: f"{arm.drives[row, j]:.6g} {OF_JOINT[size][axis.slide]}"}
        for j, axis in enumerate(arm.axes)
        for row, (effect, size) in enumerate(effects)
        if arm.drives[row, j]
    ]


def write_case(case: Case, root: Path) -> str:
    """Writes the case's files under root/cases/<name> and its truth under root/truth; returns the truth's text."""
    settings: dict[str, Any] = {"observes": "motion"}
    currents = case.logger.constants is not None
    if case.logger.constants is not None:
        settings["torque_constants"] = list(case.logger.constants)
    stems = [f"recording-{k + 1}" for k in range(len(case.logs) - 1)]
    tables = [table_of(log, case.arm, case.logger.digits, currents) for log in case.logs]
    recordings = {stem: (table, settings) for stem, table in zip(stems, tables[:-1], strict=True)}
    recordings["test"] = (tables[-1], settings | {"filter": {"cutoff": f"{CUTOFF:g} Hz"}})
    return written(root, case.name, arm_file(case.arm, declared(case.arm)), recordings, truth_of(case))
