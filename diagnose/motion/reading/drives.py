"""Torques of the joints, of logged torques or of currents: constants, gear ratios, drives that were not logged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.reading.read_column import ReadColumn
from linkwright.core.diagnose.reading.settings import ReadingSettings
from linkwright.core.diagnose.reading.table import Table
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .settings import MotionSettings


@dataclass(frozen=True)
class Drives:
    """Torques of the joints (N, n), N*m (N), nan where a drive was not logged; whether they are currents times
    constants, and whether these are to be found (`free`: torques are currents then, A). `other` are currents logged
    beside torques, `warnings` what is to be said."""

    torque: Array
    from_current: bool
    free: bool
    other: Mapping[str, Array]
    warnings: tuple[str, ...]


def drives_of(
    columns: Mapping[str, ReadColumn], arm: Arm, motion: MotionSettings, table: Table, held: ReadingSettings
) -> Drives:
    """The torques that a log's columns hold. Raises `InputError` where there are none, or none that ever change."""
    bases: dict[str, list[int]] = {"tau": [], "current": []}
    for k in range(arm.size):
        for base, joints in bases.items():
            if f"{base}{k + 1}" in columns:
                joints.append(k)
    if not bases["tau"] and not bases["current"]:
        message = "is missing: a motion log has drives' torques (tau1_Nm) or currents (current1_A)"
        raise InputError(table.file, "tau1_Nm", message)
    base = "tau" if len(bases["tau"]) >= len(bases["current"]) else "current"
    logged = {k: columns[f"{base}{k + 1}"] for k in bases[base]}
    other = {columns[f"current{k + 1}"].header: columns[f"current{k + 1}"].values for k in bases["current"]}
    warnings: list[str] = []
    still = [k for k, column in logged.items() if np.nanmax(column.values) == np.nanmin(column.values)]
    if len(still) == len(logged):
        names = ", ".join(column.header for column in logged.values())
        verb = "change" if len(still) > 1 else "changes"
        raise InputError(table.file, names, f"never {verb}: the torques were not logged")
    if still:
        names = ", ".join(logged[k].header for k in still)
        warnings.append(f"{names} never changes: those drives count as not logged.")
    lacking = [f"{k + 1}" for k in range(arm.size) if k not in logged]
    if lacking:
        warnings.append(f"There is no torque of joint{'s' if len(lacking) > 1 else ''} {', '.join(lacking)}.")
    torque = np.full((len(table.row), arm.size), np.nan)
    for k, column in logged.items():
        if k not in still:
            torque[:, k] = column.values
    constants, free = motion.torque_constants, False
    if base == "current":
        free = constants is None
        if free and not motion.torque_constants_free:
            warnings.append(
                "There are no torque_constants in recording.yaml. They are made from the arm's weights, and are as "
                "wrong as its masses. Better write `torque_constants: [14.9, ...]` (N*m/A, one a joint)."
            )
        if constants is not None:
            torque = torque * _by_joint(constants, "torque_constants", arm, held)
    elif constants is not None or motion.torque_constants_free:
        warnings.append("torque_constants are not used: the log has torques.")
    if motion.gear_ratios is not None:
        torque = torque * _by_joint(motion.gear_ratios, "gear_ratios", arm, held)
    return Drives(torque, base == "current", free, {} if base == "current" else other, tuple(warnings))


def _by_joint(values: tuple[float, ...], name: str, arm: Arm, held: ReadingSettings) -> Array:
    if len(values) != arm.size:
        message = f"has {len(values)} numbers, and {arm.name!r} has {arm.size} joints; one for each"
        raise InputError(held.file, name, message)
    return np.array(values)
