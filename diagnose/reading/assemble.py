"""The columns of a recording put together: what belongs together, what needs its fellows, what is not used."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

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
    given = _Given(columns, arm, len(table.row), warnings)
    one, each_joint, total = given.one, given.each_joint, given.total
    q = _stacked(columns, [f"q{k + 1}" for k in range(arm.size)])
    sides = given.sides()
    if sides is None and held.sides == "from_order":
        sides = sides_from_order(q, arm, rules=rules)
    spatial = given.spatial()
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
        **_of_sights(sights),
    )


def _of_sights(sights: Sights | None) -> dict[str, Any]:
    """What a recording holds of what was sighted."""
    if sights is None:
        return {"instrument": Instrument()}
    names = ("slots", "touches", "bar_at", "instrument")
    return {name: getattr(sights, name) for name in names}


@dataclass(frozen=True)
class _Given:
    """The columns of a recording of `total` rows of an arm; what is lacking of them is said in `warnings`."""

    columns: dict[str, ReadColumn]
    arm: Arm
    total: int
    warnings: list[str]

    def one(self, name: str) -> Array | None:
        """A column (N,); None where it is not there."""
        return self.columns[name].values if name in self.columns else None

    def each_joint(self, base: str) -> Array | None:
        """A column a joint (N, n); None where there are none, or too few to be of use. Speeds and accelerations that
        are lacking are none."""
        names = [f"{base}{k + 1}" for k in range(self.arm.size)]
        there = [name for name in names if name in self.columns]
        if not there:
            return None
        if len(there) == len(names):
            return _stacked(self.columns, names)
        lacking = self._lacking(base)
        if base in ("v", "a"):
            if lacking:
                self.warnings.append(f"There is no {', '.join(lacking)}: these joints are taken to stand still.")
            return _stacked(self.columns, names, np.zeros(self.total))
        needed = ", ".join(lacking or [name for name in names if name not in self.columns])
        self.warnings.append(f"{', '.join(there)}: not used, because {needed} would be needed as well.")
        return None

    def sides(self) -> Array | None:
        """The sides of approach (N, n), 0 where a joint has no column of them; None where there is no such column."""
        names = [f"dir{k + 1}" for k in range(self.arm.size)]
        if not any(name in self.columns for name in names):
            return None
        if lacking := self._lacking("dir"):
            self.warnings.append(f"There is no {', '.join(lacking)}: the side of approach is unknown there.")
        return _stacked(self.columns, names, np.zeros(self.total))

    def spatial(self) -> tuple[str, ...]:
        """The components of the tip; the height of an arm in the plane is none where it stays the same."""
        if "z" not in self.columns:
            return ("x", "y")
        if self.arm.planar() and not np.ptp(self.columns["z"].values):
            height = format_quantity(float(self.columns["z"].values[0]), "length", digits=6)
            header = self.columns["z"].header
            why = f"{header} is {height} throughout, and the arm does not leave its plane: it is not used."
            self.warnings.append(why)
            return ("x", "y")
        return ("x", "y", "z")

    def _lacking(self, base: str) -> list[str]:
        """The joints' columns of that name that are not there, of joints that carry the tip."""
        return [f"{base}{k + 1}" for k in self.arm.to_tip if f"{base}{k + 1}" not in self.columns]


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
