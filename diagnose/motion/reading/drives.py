"""Torques of the joints, of logged torques or of currents: constants, gear ratios, drives that were not logged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.reading.motion_settings import MotionSettings
from linkwright.core.diagnose.reading.read_column import ReadColumn
from linkwright.core.diagnose.reading.settings import ReadingSettings
from linkwright.core.diagnose.reading.table import Table
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError


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
    torques, currents = (
        {k: columns[f"{base}{k + 1}"] for k in range(arm.size) if f"{base}{k + 1}" in columns}
        for base in ("tau", "current")
    )
    from_current = len(torques) < len(currents)
    torque, warnings = _logged(currents if from_current else torques, table, arm)
    constants = motion.torque_constants
    if not from_current and (constants is not None or motion.torque_constants_free):
        warnings.append("torque_constants are not used: the log has torques.")
    elif from_current and constants is None and not motion.torque_constants_free:
        warnings.append(
            "There are no torque_constants in recording.yaml. They are made from the arm's weights, and are as "
            "wrong as its masses. Better write `torque_constants: [14.9, ...]` (N*m/A, one a joint)."
        )
    torque = torque * _by_joint(constants if from_current else None, "torque_constants", arm, held)
    torque = torque * _by_joint(motion.gear_ratios, "gear_ratios", arm, held)
    other = {} if from_current else {column.header: column.values for column in currents.values()}
    return Drives(torque, from_current, from_current and constants is None, other, tuple(warnings))


def _logged(logged: Mapping[int, ReadColumn], table: Table, arm: Arm) -> tuple[Array, list[str]]:
    """Torques or currents by joint (from 0) as one table (N, n), nan where a drive was not logged, and what is to be
    said of those. Raises `InputError`."""
    if not logged:
        message = "is missing: a motion log has drives' torques (tau1_Nm) or currents (current1_A)"
        raise InputError(table.file, "tau1_Nm", message)
    still = [k for k, column in logged.items() if np.nanmax(column.values) == np.nanmin(column.values)]
    names = ", ".join(logged[k].header for k in still)
    if len(still) == len(logged):
        verb = "change" if len(still) > 1 else "changes"
        raise InputError(table.file, names, f"never {verb}: the torques were not logged")
    warnings = [f"{names} never changes: those drives count as not logged."] if still else []
    lacking = [f"{k + 1}" for k in range(arm.size) if k not in logged]
    if lacking:
        warnings.append(f"There is no torque of joint{'s' if len(lacking) > 1 else ''} {', '.join(lacking)}.")
    nothing = np.full(len(table.row), np.nan)
    rows = [logged[k].values if k in logged and k not in still else nothing for k in range(arm.size)]
    return np.stack(rows, axis=1), warnings


def _by_joint(values: tuple[float, ...] | None, name: str, arm: Arm, held: ReadingSettings) -> Array:
    if values is None:
        return np.ones(arm.size)
    if len(values) != arm.size:
        message = f"has {len(values)} numbers, and {arm.name!r} has {arm.size} joints; one for each"
        raise InputError(held.file, name, message)
    return np.array(values)
