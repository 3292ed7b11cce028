"""Torques of the joints, of torques, currents or voltages: constants, gear ratios, drives that were not logged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.motion.log import CURRENT, DISTANCE, TORQUE, VOLTAGE, Signal
from linkwright.core.diagnose.reading.motion_settings import MotionSettings, Servo
from linkwright.core.diagnose.reading.read_column import ReadColumn
from linkwright.core.diagnose.reading.settings import ReadingSettings
from linkwright.core.diagnose.reading.table import Table
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

Logged = Mapping[int, tuple[str, Array]]
"""A header and its values (N,) by joint (from 0)."""


@dataclass(frozen=True)
class Drives:
    """Torques of the joints (N, n), N*m (N), nan where a drive was not logged; the `signal` that they stem from, and
    whether its constants are to be found (`free`: torques are the signal then). `loop` (n,) V/rad is what servos make
    of their distance to the goal, None where nobody says; `other` are currents and voltages logged beside, `warnings`
    what is to be said."""

    torque: Array
    signal: Signal
    free: bool
    loop: tuple[float, ...] | None
    other: Mapping[str, Array]
    warnings: tuple[str, ...]


def drives_of(
    columns: Mapping[str, ReadColumn], arm: Arm, motion: MotionSettings, table: Table, held: ReadingSettings
) -> Drives:
    """The torques that a log's columns hold. Raises `InputError` where there are none, or none that ever change."""
    by_signal: list[tuple[Signal, Logged]] = [
        (each, _columns(columns, each, arm)) for each in (TORQUE, CURRENT, VOLTAGE)
    ]
    signal, logged = max(by_signal, key=lambda item: len(item[1]))
    said: list[str] = []
    loop = None
    if motion.servo is not None and logged:
        said.append(f"servo is not used: the log has {signal.words}.")
    elif motion.servo is not None:
        signal, logged, loop = _of_goals(columns, arm, motion.servo, table, held)
    torque, warnings = _logged(logged, table, arm)
    warnings = [*said, *warnings]
    constants = motion.torque_constants
    if signal is TORQUE and (constants is not None or motion.torque_constants_free):
        warnings.append("torque_constants are not used: the log has torques.")
    elif signal is not TORQUE and constants is None and not motion.torque_constants_free:
        warnings.append(
            "There are no torque_constants in recording.yaml. They are made from the arm's weights, and are as "
            f"wrong as its masses. Better write `torque_constants: [14.9, ...]` (N*m/{signal.unit}, one a joint)."
        )
    torque = torque * _by_joint(None if signal is TORQUE else constants, "torque_constants", arm, held)
    torque = torque * _by_joint(motion.gear_ratios, "gear_ratios", arm, held)
    other = {header: values for each, of in by_signal if each is not signal for header, values in of.values()}
    return Drives(torque, signal, signal is not TORQUE and constants is None, loop, other, tuple(warnings))


def _columns(columns: Mapping[str, ReadColumn], signal: Signal, arm: Arm) -> Logged:
    names = {k: f"{signal.base}{k + 1}" for k in range(arm.size)}
    return {k: (columns[name].header, columns[name].values) for k, name in names.items() if name in columns}


def _of_goals(
    columns: Mapping[str, ReadColumn], arm: Arm, servo: Servo, table: Table, held: ReadingSettings
) -> tuple[Signal, Logged, tuple[float, ...] | None]:
    """What servos make of how far their goals are ahead: voltages, and V/rad, or the distances themselves where nobody
    knows their gain. Raises `InputError`."""
    goals = _columns(columns, DISTANCE, arm)
    if not goals:
        message = (
            "needs the goals of the joints, and the log has none: c1_rad, or map them in recording.yaml (`columns:`)"
        )
        raise InputError(held.file or table.file, "servo", message)
    ahead = {k: (header, values - columns[f"q{k + 1}"].values) for k, (header, values) in goals.items()}
    if servo.gain is None or servo.supply is None:
        return DISTANCE, ahead, None
    gain = servo.gain * arm.size if len(servo.gain) == 1 else servo.gain
    loop = servo.supply * _by_joint(gain, "servo.gain", arm, held)
    most = servo.limit * servo.supply
    return VOLTAGE, {k: (name, np.clip(loop[k] * far, -most, most)) for k, (name, far) in ahead.items()}, tuple(loop)


def _logged(logged: Logged, table: Table, arm: Arm) -> tuple[Array, list[str]]:
    """What was logged by joint as one table (N, n), nan where a drive was not logged, and what is to be said of those.
    Raises `InputError`."""
    if not logged:
        message = (
            "is missing: a motion log has drives' torques (tau1_Nm), currents (current1_A) or voltages (voltage1_V), "
            "or goals (c1_rad) with `servo` in recording.yaml"
        )
        raise InputError(table.file, "tau1_Nm", message)
    still = [k for k, (_, values) in logged.items() if np.nanmax(values) == np.nanmin(values)]
    names = ", ".join(logged[k][0] for k in still)
    if len(still) == len(logged):
        verb = "change" if len(still) > 1 else "changes"
        raise InputError(table.file, names, f"never {verb}: the torques were not logged")
    warnings = [f"{names} never changes: those drives count as not logged."] if still else []
    lacking = [f"{k + 1}" for k in range(arm.size) if k not in logged]
    if lacking:
        warnings.append(f"There is no torque of joint{'s' if len(lacking) > 1 else ''} {', '.join(lacking)}.")
    nothing = np.full(len(table.row), np.nan)
    rows = [logged[k][1] if k in logged and k not in still else nothing for k in range(arm.size)]
    return np.stack(rows, axis=1), warnings


def _by_joint(values: tuple[float, ...] | None, name: str, arm: Arm, held: ReadingSettings) -> Array:
    if values is None:
        return np.ones(arm.size)
    if len(values) != arm.size:
        message = f"has {len(values)} numbers, and {arm.name!r} has {arm.size} joints; one for each"
        raise InputError(held.file, name, message)
    return np.array(values)
