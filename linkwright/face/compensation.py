"""The error over the workspace as a table that a controller can subtract."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm as Model
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.compensation import Table as Found
from linkwright.core.arm.compensation import default_grid, moves, table_at, table_over
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import read_text
from linkwright.json.compensation import compensation_json, table_columns
from linkwright.output.files import write_file
from linkwright.output.table_file import WAYS, write_table

from .arm import Arm
from .evaluation import pose_of
from .given import File, Quantity, in_si
from .progress import Progress, told
from .result import Result, figure_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_MOST_ROWS = 1_000_000
_LARGEST = 1e9


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

    def save(self, folder: File) -> Sequence[Path]:
        """Write the table where `folder` names a file (.csv, .parquet, .md or .tex), as `compensate --out` does; else
        as CSV into that folder."""
        place = Path(folder)
        target = place / "compensation.csv" if place.is_dir() else place
        if target.suffix.lower() in WAYS:
            write_table(self.table, target)
        else:
            write_file(target, self.table.to_csv(index=False, lineterminator="\n"))
        return [target]

    def _content(self) -> Mapping[str, Any]:
        return compensation_json(self.found)

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Table": self.table}


def payloads_of(arm: Arm, given: Quantity | Sequence[Quantity]) -> tuple[float, ...]:
    """The payloads of a table, kg; the arm's own where none is given. Raises `InputError`."""
    several = (given,) if isinstance(given, str | float | int) else given
    masses = tuple(in_si(each, "mass", "payload") for each in several) or (arm.model.payload.mass,)
    if min(masses) < 0.0:
        raise InputError("", "payload", "cannot be negative")
    if len(set(masses)) != len(masses):
        raise InputError("", "payload", "names the same mass twice")
    return masses


def poses_of(arm: Arm, given: File | Sequence[Sequence[Quantity]], grid: int | None = None) -> Array:
    """The poses (N, n) of a table in place of a `grid`, rad and m. Raises `InputError`."""
    if grid is not None:
        raise InputError("", "poses", "goes without `grid`: the poses are given")
    if isinstance(given, str | Path):
        return read_poses(Path(given), arm.model)
    return np.array([pose_of(arm.model, q) for q in given])


def compensated(
    arm: Arm, grid: int | None, poses: Array | None, payloads: tuple[float, ...], progress: Progress | None
) -> Found:
    """The table at poses, or over a grid. Raises `InputError`."""
    with told(progress) as tell:

        def counted(done: int, total: int) -> None:
            tell(f"computing the table, {done} of {total} rows", done / total)

        if poses is not None:
            return table_at(arm.model, poses, payloads, counted)
        return table_over(arm.model, _points(arm, grid, len(payloads)), payloads, counted)


def _points(arm: Arm, grid: int | None, payloads: int) -> int:
    """How many coordinates of each joint. Raises `InputError`."""
    if grid is not None and grid < 2:
        raise InputError("", "grid", f"needs at least 2, not {grid}")
    moving = sum(moves(joint) for joint in arm.model.joints)
    if not moving:
        raise InputError("", "arm", f"{arm.name} has no joint that can move; give one a range")
    points = default_grid(moving, payloads) if grid is None else grid
    rows = points**moving * payloads
    if rows > _MOST_ROWS:
        raise InputError("", "grid", f"makes {rows} rows; take fewer, {_MOST_ROWS} at most")
    return points


def read_poses(path: Path, arm: Model) -> Array:
    """Poses (N, n) from a CSV file, rad and m. Raises `InputError`."""
    import pandas as pd

    from linkwright.core.diagnose.reading.table import as_numbers

    text = read_text(path)
    try:
        content = pd.read_csv(io.StringIO(text), skipinitialspace=True, dtype=str)
    except ValueError as error:
        raise InputError(path, "", f"is no table: {' '.join(str(error).split())}") from None
    if content.empty:
        raise InputError(path, "", "holds no poses")
    found: list[Array] = []
    for index, joint in enumerate(arm.joints):
        name = f"q{index + 1}_{'deg' if joint.revolute else 'mm'}"
        if name not in content.columns:
            raise InputError(path, name, f"is missing; the file has {', '.join(str(each) for each in content.columns)}")
        values = as_numbers([str(cell) for cell in content[name]])
        bad = np.flatnonzero(~(np.abs(values) < _LARGEST))
        if len(bad):
            raise InputError(path, name, f"is no coordinate of a joint in row {int(bad[0]) + 1}")
        found.append(np.radians(values) if joint.revolute else 1e-3 * values)
    return np.stack(found, axis=1)
