"""The error over the workspace as a table that a controller can subtract."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.compensation import Heard, default_grid, moves, table_at, table_over
from linkwright.core.arm.compensation import Table as Found
from linkwright.core.units.quantities import InputError
from linkwright.json.compensation import compensation_json, table_columns
from linkwright.output.files import write_file
from linkwright.output.table_file import WAYS, write_table

from .arm import Arm, arm_of
from .evaluation import pose_of
from .given import File, Quantity, in_si
from .progress import Progress, told
from .result import Result, figure_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_MOST_ROWS = 1_000_000


@dataclass(frozen=True, repr=False)
class Compensation(Result):
    """By how much the tip is off at each pose of a table, and what to add to each joint against it; `found` in SI."""

    _command = "compensate"

    arm: Arm
    found: Found

    @property
    def table(self) -> pd.DataFrame:
        """The table as `compensate --out` writes it: poses, payload, error, joint corrections, what is left."""
        import pandas as pd

        return pd.DataFrame(table_columns(self.found))

    @property
    def max_error_mm(self) -> float:
        """The greatest error at the table's poses, mm."""
        return float(1e3 * np.linalg.norm(self.found.error, axis=1).max())

    def plot(self) -> go.Figure:
        """The error of the tip at each pose, where the tip nominally is."""
        tip = 1e3 * tip_position(self.arm.model, self.found.q)
        across = tip[:, 0] if self.arm.model.planar() else np.hypot(tip[:, 0], tip[:, 1])
        length = 1e3 * np.linalg.norm(self.found.error, axis=1)
        marker = {"color": length.tolist(), "colorscale": "Viridis", "colorbar": {"title": {"text": "mm"}}}
        up = tip[:, 1] if self.arm.model.planar() else tip[:, 2]
        marks = {"type": "scatter", "mode": "markers", "x": across.tolist(), "y": up.tolist(), "marker": marker}
        return figure_of({"data": [marks]})

    def save(self, folder: File) -> None:
        """Write the table where `folder` names a file (.csv, .parquet, .md or .tex), as `compensate --out` does; else
        as CSV into that folder."""
        place = Path(folder)
        target = place / "compensation.csv" if place.is_dir() else place
        if target.suffix.lower() in WAYS:
            write_table(self.table, target)
        else:
            write_file(target, self.table.to_csv(index=False, lineterminator="\n"))

    def _content(self) -> Mapping[str, Any]:
        return compensation_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Table": self.table}


def compensate(
    arm: Arm | File,
    *,
    grid: int | None = None,
    poses: Sequence[Sequence[Quantity]] | None = None,
    payload: Quantity | Sequence[Quantity] = (),
    progress: Progress | None = None,
) -> Compensation:
    """The error over the workspace as a table: by how much the tip is off, and what to add to each joint against it.

    `grid` is how many coordinates of each joint, over its range; `poses` (N, n) are poses of one's own instead (text,
    or rad and m). `payload` (text, or kg; one or several) replaces the arm's own. `progress(text, share)` hears of the
    rows, by default a bar where somebody looks. Raises `InputError`, and `MissingProperty` where the arm lacks a
    figure.

    >>> import linkwright as lw
    >>> found = lw.compensate("examples/welding-arm/arm.yaml", grid=3)
    >>> found
    <Compensation: 27 poses, payload 0.7747 kg: largest error 0.194 mm>
    """
    given = arm_of(arm, tips="one")
    if grid is not None and poses is not None:
        raise InputError("", "poses", "goes without grid: the poses are given")
    if grid is not None and grid < 2:
        raise InputError("", "grid", f"needs at least 2, not {grid}")
    several = (payload,) if isinstance(payload, str | float | int) else payload
    masses = tuple(in_si(each, "mass", "payload") for each in several) or (given.model.payload.mass,)
    if min(masses) < 0.0:
        raise InputError("", "payload", "cannot be negative")
    if len(set(masses)) != len(masses):
        raise InputError("", "payload", "names the same mass twice")
    if poses is not None:
        at = np.array([pose_of(given.model, q) for q in poses])
        with told(progress) as tell:
            return Compensation(given, table_at(given.model, at, masses, _counted(tell)))
    moving = sum(moves(joint) for joint in given.model.joints)
    if not moving:
        raise InputError("", "arm", f"{given.name} has no joint that can move; give one a range")
    points = default_grid(moving, len(masses)) if grid is None else grid
    rows = points**moving * len(masses)
    if rows > _MOST_ROWS:
        raise InputError("", "grid", f"makes {rows} rows; take fewer, {_MOST_ROWS} at most")
    with told(progress) as tell:
        return Compensation(given, table_over(given.model, points, masses, _counted(tell)))


def _counted(tell: Progress) -> Heard:
    return lambda done, total: tell(f"computing the table, {done} of {total} rows", done / total)
