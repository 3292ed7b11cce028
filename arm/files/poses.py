"""Poses as a table (CSV): the joint coordinates, and how much each pose counts."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import read_text

WEIGHT = "weight"
_LARGEST = 1e9
_ANGLES = MappingProxyType({"deg": math.pi / 180.0, "rad": 1.0})
_LENGTHS = MappingProxyType({"mm": 1e-3, "m": 1.0})


def read_poses(path: Path, arm: Arm) -> tuple[Array, Array | None]:
    """Poses (N, n) from columns `q1_deg` (or `q1_rad`; `q1_mm`, `q1_m` of a slide) in rad and m, and their weights (N)
    from a column `weight`; None where there is none. Raises `InputError`."""
    content = pose_columns(path)
    poses = poses_of(content, path, arm)
    if WEIGHT not in content:
        return poses, None
    weights = numbers(content[WEIGHT])
    bad = np.flatnonzero(~((weights > 0.0) & (weights < _LARGEST)))
    if len(bad):
        raise InputError(path, WEIGHT, f"is no number above zero in row {int(bad[0]) + 1}")
    return poses, weights


def pose_columns(path: Path) -> dict[str, list[str | None]]:
    """The columns of a table of poses, by name. Raises `InputError`."""
    reader = csv.DictReader(io.StringIO(read_text(path), newline=""), skipinitialspace=True, strict=True)
    try:
        rows = list(reader)
        torn = next((number for number, row in enumerate(rows, start=2) if None in row or None in row.values()), None)
    except csv.Error as error:
        raise InputError(path, f"line {reader.line_num}", f"is no table: {error}") from None
    if torn is not None:
        raise InputError(path, f"line {torn}", "is no table: it has not as many cells as the heading")
    if not rows:
        raise InputError(path, "", "holds no poses")
    return {name.strip(): [row.get(name) for row in rows] for name in reader.fieldnames or ()}


def poses_of(content: Mapping[str, list[str | None]], path: Path, arm: Arm) -> Array:
    """The joint coordinates (N, n) that columns hold, rad and m. Raises `InputError`."""
    poses: list[Array] = []
    for number, joint in enumerate(arm.joints, start=1):
        units = _ANGLES if joint.revolute else _LENGTHS
        name = next((f"q{number}_{unit}" for unit in units if f"q{number}_{unit}" in content), None)
        if name is None:
            raise InputError(path, f"q{number}_{next(iter(units))}", f"is missing; the file has {', '.join(content)}")
        values = numbers(content[name])
        bad = np.flatnonzero(~(np.abs(values) < _LARGEST))
        if len(bad):
            raise InputError(path, name, f"is no coordinate of a joint in row {int(bad[0]) + 1}")
        poses.append(units[name.rpartition("_")[2]] * values)
    return np.stack(poses, axis=1)


def numbers(cells: list[str | None]) -> Array:
    """The numbers of cells, NaN where one holds none."""
    values: list[float] = []
    for cell in cells:
        try:
            values.append(float(cell or "nan"))
        except ValueError:
            values.append(math.nan)
    return np.array(values)
