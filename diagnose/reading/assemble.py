"""The columns of a recording put together: what belongs together, what needs its fellows, what is not used."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import MappingProxyType

import numpy as np
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.recording import Recording, since_the_reading_before
from linkwright.core.diagnose.residual.visits import same_pose
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import format_quantity

from .read_column import ReadColumn
from .settings import ReadingSettings
from .sights import Sights
from .table import Table


def assembled(
    path: Path,
    columns: dict[str, ReadColumn],
    strangers: dict[str, Array],
    table: Table,
    arm: Arm,
    held: ReadingSettings,
    *,
    sights: Sights | None = None,
    rules: ResidualRules = RULES.residual,
) -> Recording:
    """The recording that the columns make; a kind of column that joints have in part is left out and said."""
    warnings: list[str] = []

    def one(name: str) -> Array | None:
        return columns[name].values if name in columns else None

    total = len(table.row)

    def each_joint(base: str) -> Array | None:
        names = [f"{base}{k + 1}" for k in range(arm.size)]
        there = [name for name in names if name in columns]
        if not there:
            return None
        if len(there) < len(names):
            lacking = ", ".join(f"{base}{k + 1}" for k in arm.to_tip if f"{base}{k + 1}" not in columns)
            if base in ("v", "a") and not lacking:
                return _stacked(columns, names, np.zeros(total))
            lacking = lacking or ", ".join(name for name in names if name not in columns)
            if base in ("v", "a"):
                warnings.append(f"There is no {lacking}: these joints are taken to stand still.")
                return _stacked(columns, names, np.zeros(total))
            warnings.append(f"{', '.join(there)}: not used, because {lacking} would be needed as well.")
            return None
        return _stacked(columns, names)

    sides, q = None, _stacked(columns, [f"q{k + 1}" for k in range(arm.size)])
    directions = [f"dir{k + 1}" for k in range(arm.size)]
    lacking = [name for name in directions if name not in columns]
    if len(lacking) < arm.size:
        sides = _stacked(columns, directions, np.zeros(total))
        lacking = [f"dir{k + 1}" for k in arm.to_tip if f"dir{k + 1}" in lacking]
        if lacking:
            warnings.append(f"There is no {', '.join(lacking)}: the side of approach is unknown there.")
    elif held.sides == "from_order":
        sides = sides_from_order(q, arm, rules=rules)
    spatial = ("x", "y", "z") if "z" in columns else ("x", "y")
    if "z" in columns and arm.planar() and not np.ptp(columns["z"].values):
        height = format_quantity(float(columns["z"].values[0]), "length", digits=6)
        header = columns["z"].header
        warnings.append(f"{header} is {height} throughout, and the arm does not leave its plane: it is not used.")
        spatial = ("x", "y")
    torque = each_joint("tau")
    if torque is not None and arm.branches:
        warnings.append("Torques are not used: what they say of weights is worked out for arms without branches alone.")
        torque = None
    orientation = _orientation(columns)
    camera = sights is not None and "camera" in sights.instrument.kinds
    if camera and orientation is None:
        warnings.append(
            "There are no orientations (qw, qx, qy, qz). Only the target's place in the camera's frame counts. Causes "
            "that turn the tool more than they shift it hardly show."
        )
    if sights is not None and orientation is not None and not camera:
        warnings.append("Orientations are not used: they go with the whole place of the tip.")
        orientation = None
    return Recording(
        file=str(path),
        q=q,
        tip=_stacked(columns, spatial) if sights is None else sights.tip,
        row=table.row,
        orientation=orientation,
        time=one("time"),
        sides=sides,
        payload_mass=one("payload"),
        temperature=one("temperature"),
        link_temperature=_link_temperature(columns, arm, total, warnings),
        velocity=each_joint("v"),
        acceleration=each_joint("a"),
        commanded=each_joint("c"),
        last_moves=since_the_reading_before(q),
        joint_side=each_joint("j"),
        torque=torque,
        force=_in_space(columns, ("fx", "fy", "fz"), total),
        base_target=_in_space(columns, ("basex", "basey", "basez"), total),
        sigma=held.sigma,
        frame=held.frame,
        tool=held.tool,
        seat=held.seat if sights is None or (camera and orientation is not None) else "unused",
        sigma_axes=held.sigma_axes,
        sigma_angle=held.sigma_angle,
        warnings=tuple(warnings),
        other=MappingProxyType(strangers),
        settings=held.file,
        unit=held.unit,
        avoid=held.avoid,
        branch=arm.tip,
        date=held.date,
        slots=None if sights is None else sights.slots,
        touches=None if sights is None else sights.touches,
        bar_at=None if sights is None else sights.bar_at,
        instrument=Instrument() if sights is None else sights.instrument,
    )


def _stacked(columns: dict[str, ReadColumn], names: Sequence[str], instead: Array | None = None) -> Array:
    """Columns side by side (N, k); those that are not there have the values `instead`, where there may be such."""
    return np.stack([columns[x].values if instead is None or x in columns else instead for x in names], axis=1)


def sides_from_order(q: Array, arm: Arm, *, rules: ResidualRules = RULES.residual) -> Array:
    """The side from which each joint came (N, n), +1 or -1, if it went straight from the row before; a joint that stays
    keeps its side, and before its first move it has none (0)."""
    moves = np.diff(q, axis=0, prepend=q[:1])
    sides = np.where(np.abs(moves) > same_pose(arm, rules), np.sign(moves), 0.0)
    for row in range(1, len(sides)):
        sides[row] = np.where(sides[row] == 0.0, sides[row - 1], sides[row])
    return sides


def _in_space(columns: dict[str, ReadColumn], names: Sequence[str], total: int) -> Array | None:
    """Three components; the third is 0 where a recording in the plane leaves it out."""
    if names[0] not in columns:
        return None
    return _stacked(columns, names, np.zeros(total))


def _orientation(columns: dict[str, ReadColumn]) -> Array | None:
    """Rotation matrices (N, 3, 3), nan where a row has none; angles turn about the fixed x, y and z, in this order."""
    names = ("qx", "qy", "qz", "qw") if "qw" in columns else ("rx", "ry", "rz")
    if names[0] not in columns:
        return None
    values = _stacked(columns, names)
    good = np.isfinite(values).all(axis=1) & (("rx" in names) | (np.abs(values).max(axis=1) > 0.0))
    matrices = np.full((len(values), 3, 3), np.nan)
    if good.any():
        turns = Rotation.from_quat(values[good]) if "qw" in columns else Rotation.from_euler("xyz", values[good])
        matrices[good] = turns.as_matrix()
    return matrices


def _link_temperature(columns: dict[str, ReadColumn], arm: Arm, total: int, warnings: list[str]) -> Array | None:
    names = [f"temperature_link{k + 1}" for k in range(arm.size)]
    lacking = [name for name in names if name not in columns]
    if len(lacking) == arm.size:
        return None
    if lacking:
        instead = "temperature" if "temperature" in columns else "the arm file's temperature"
        warnings.append(f"There is no {', '.join(lacking)}: {instead} counts for those links.")
    rest = columns["temperature"].values if "temperature" in columns else np.full(total, arm.temperature)
    return _stacked(columns, names, rest)
