"""A motion log as a file: the columns that it is read by, and the settings beside it."""

from __future__ import annotations

import io

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.sections.numeric import Array
from linkwright.core.units.temperature import ZERO_CELSIUS

from .log import DISTANCE, MotionLog

_DIGITS = 7
"""Significant digits that are written: encoders and torque sensors have fewer."""


def log_columns(log: MotionLog, arm: Arm) -> dict[str, Array]:
    """The columns of a log by the names that they are read by: `t_s`, `q1_rad`, `dq1_radps`, `tau1_Nm` ..., of slides
    `q1_m`, `dq1_mps`, `tau1_N`; torques that nobody knows but for their constants are currents, `current1_A`, or
    voltages, `voltage1_V`."""
    columns = {"t_s": log.time}
    joints = list(enumerate(arm.joints, start=1))

    def each(name: str, values: Array | None, turning: str, sliding: str) -> None:
        if values is not None:
            for (number, joint), column in zip(joints, values.T, strict=True):
                columns[f"{name}{number}_{turning if joint.revolute else sliding}"] = column

    each("q", log.q, "rad", "m")
    each("dq", log.velocity, "radps", "mps")
    if not log.torque_constants_free:
        each("tau", log.torque, "Nm", "N")
    elif log.drive is not DISTANCE:
        each(log.drive.base, log.torque, log.drive.unit, log.drive.unit)
    each("c", log.commanded, "rad", "m")
    each("j", log.joint_side, "rad", "m")
    if log.temperature is not None:
        columns["temperature_degC"] = log.temperature - ZERO_CELSIUS
    if log.payload_mass is not None:
        columns["payload_kg"] = log.payload_mass
    return columns


def log_text(log: MotionLog, arm: Arm) -> str:
    """A log as CSV."""
    return table_text(log_columns(log, arm))


def table_text(columns: dict[str, Array]) -> str:
    """Columns (N,) by name as CSV; what is not known is blank."""
    stream = io.StringIO()
    stream.write(",".join(columns) + "\n")
    for row in np.column_stack(list(columns.values())):
        stream.write(",".join("" if np.isnan(value) else f"{value + 0.0:.{_DIGITS}g}" for value in row) + "\n")
    return stream.getvalue()


def settings_text(log: MotionLog) -> str:
    """The recording.yaml of a log."""
    lines = ["observes: motion"]
    if log.torque_constants_free:
        lines.append("torque_constants: free")
    if log.torque_constants_free and log.drive is DISTANCE:
        lines.append("servo: {gain: free}")
    if log.beyond_drive:
        lines.append("encoders: joint")
    if log.cutoff is not None:
        lines.append(f"filter: {{cutoff: {log.cutoff:g} Hz}}")
    if log.date:
        lines.append(f"date: {log.date}")
    return "\n".join(lines) + "\n"
