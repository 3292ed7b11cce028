"""The error over the workspace as a table that a controller can subtract."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.compensation import Table as TableResult
from linkwright.core.arm.compensation import default_grid, moves, table_at, table_over
from linkwright.core.arm.descriptions.exported import GEOMETRY
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.errors.unknown_mass import payloads_left_out
from linkwright.core.arm.files.poses import read_poses
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from linkwright.json.fields import fields_if, joint_columns
from linkwright.output.files import write_file
from linkwright.output.table_file import WAYS, frame, write_table
from linkwright.results.document import Description, Item, Paragraph, length, table
from linkwright.results.figures_in_words import coordinate, effect_title, figure, mm, with_unit

from .arm import Arm
from .evaluation import pose_of
from .plain_input import File, Quantity, in_si
from .progress import Progress, reporting
from .result import Result, figure_of

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

_MOST_ROWS = 1_000_000
_ROUNDING = 1e-9
_MUCH = 0.2
"""Of the largest error: a table that leaves more is warned of."""
_DIGITS = 9
_NOTE = (
    "The table holds what is certain. Backlash is taken on the loaded side. Direction, time and temperature are not "
    "included."
)


def describe(result: TableResult) -> Description:
    """What the table does."""
    arm, check = result.arm, result.check
    payloads = ", ".join(with_unit(value, "kg") for value in np.unique(result.payload).tolist())
    error = np.linalg.norm(result.error, axis=1)
    sizes = [
        ("at the table's poses, without it", _rms(error), float(error.max())),
        ("there, joint corrections added", _rms(result.left), float(result.left.max())),
    ]
    if check is not None:
        name = f"between them ({check.poses} poses checked), without it"
        sizes += [
            (name, check.rms_without, check.largest_without),
            ("there, interpolated displacement subtracted", check.rms_subtracted, check.largest_subtracted),
            ("there, interpolated joint corrections added", check.rms_corrected, check.largest_corrected),
        ]
    rows = [(name, length(rms, 3), length(largest, 3)) for name, rms, largest in sizes]
    items: list[Item] = []
    if result.axes is not None:
        steps = [
            f"joint {index + 1} from {low} to {high} every {step}"
            for index, axis in enumerate(result.axes)
            if len(axis) > 1
            for low, high, step in [[coordinate(arm, index, float(x)) for x in (axis[0], axis[-1], axis[1] - axis[0])]]
        ]
        items.append(Paragraph(f"grid: {', '.join(steps)}"))
    items.append(table(("error of the tip", "RMS", "largest"), rows))
    items += [Paragraph(f"{warning}.", "warning") for warning in _warnings(result)]
    items.append(Paragraph(_NOTE))
    left = dict.fromkeys(entry.effect for entry in arm.effects if EFFECTS[entry.effect].recording.of_instrument)
    if left:
        names = ", ".join(effect_title(effect) for effect in left)
        items.append(Paragraph(f"Not in it, because it belongs to the instrument: {names}."))
    what = f"{len(result.q)} poses, payload {payloads}"
    (stays, how), of = _ways(result)[0], float(error.max()) if check is None else check.largest_without
    stays = stays if stays > _ROUNDING * of else 0.0
    where = f"{'at' if check is None else 'between'} them, {how}"
    headline = f"{what}. It leaves at most {mm(stays, 3)} of {mm(of, 3)} {where}" if of > 0.0 else what
    brief = f"{what}: largest error {mm(float(error.max()), 3)}"
    return Description(f"{arm.name}: compensation table", headline, tuple(items), brief, f"{arm.name}: ")


def _ways(result: TableResult) -> list[tuple[float, str]]:
    """The largest error (m) that stays where the table is used, between the poses of a grid or at its poses, and how it
    is used; what leaves least first."""
    check, added = result.check, "joint corrections added"
    if check is None:
        return [(float(result.left.max()), added)]
    return sorted([(check.largest_corrected, added), (check.largest_subtracted, "displacements subtracted")])


def _warnings(result: TableResult) -> list[str]:
    """What makes the table worth less than it looks, and what to do, without full stops."""
    arm, check = result.arm, result.check
    error, warnings = np.linalg.norm(result.error, axis=1), list[str]()
    if check is not None and check.largest_without > 0.0:
        shares = [(stays / check.largest_without, how) for stays, how in _ways(result)]
        (least, best), (most, other) = shares
        said = f"of the largest error stays between the poses, {best if least > _MUCH else other}"
        if least > _MUCH:
            remedies = ". ".join(_remedies(result, least))
            warnings.append(
                f"{figure(100.0 * least, 2)} % {said}: the grid is coarse, or loads turn play over. {remedies}"
            )
        elif most > _MUCH:
            warnings.append(
                f"{figure(100.0 * most, 2)} % {said}. Use the table with {best}: {figure(100.0 * least, 2)} %"
            )
    if (poor := int((result.left > _MUCH * error.max()).sum())) and error.max() > 0.0:
        lead = f"at {poor} of the table's poses joint corrections leave more than {100.0 * _MUCH:.0f} %"
        warnings.append(f"{lead} of the largest error: the drives hardly move the tip that way there")
    missing = payloads_left_out(arm, np.unique(result.payload).tolist())
    return [*warnings, missing] if missing else warnings


def _remedies(result: TableResult, share: float) -> list[str]:
    """What makes a table over a grid leave less than that share, or does without one."""
    arm, varied = result.arm, [number for number, joint in enumerate(result.arm.joints, 1) if moves(joint)]
    assert result.axes is not None
    points = max(len(axis) for axis in result.axes)
    most = int((_MOST_ROWS / len(np.unique(result.payload))) ** (1.0 / len(varied)) + 1e-9)
    # Linear interpolation of a sine leaves 1 - cos(step / 2) of it; half of what is warned of is aimed at.
    due = math.ceil(1.0 + (points - 1) * math.acos(1.0 - min(share, 1.0)) / math.acos(1.0 - 0.5 * _MUCH))
    remedies = [f"--grid {min(due, most)} makes it finer" + ("" if due <= most else ", the most that it can be")]
    if points >= most:
        remedies = ["No grid can be finer over these ranges"]
    endless = [
        n for n in varied if arm.joints[n - 1].revolute and np.ptp(arm.joints[n - 1].range) > 2.0 * math.pi + 1e-6
    ]
    if endless:
        numbers = f"joint{'s' * (len(endless) > 1)} {', '.join(map(str, endless))}"
        remedies.append(f"range: [-180 deg, 180 deg] of {numbers} in the arm file leaves out turns that repeat")
    remedies.append("Narrower ranges, or --poses FILE, keep to where the arm works")
    if any(entry.effect in GEOMETRY for entry in arm.effects):
        remedies.append(
            "linkwright export ARM --into your URDF, or --to csv, has zeros, lengths and axes without a table"
        )
    return remedies


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values * values)))


@dataclass(frozen=True, repr=False)
class Compensation(Result):
    """By how much the tip is off at each pose of a table, and what to add to each joint against it; `found` in SI."""

    _command = "compensate"
    _describe = staticmethod(describe)

    arm: Arm
    found: TableResult

    @property
    def table(self) -> pd.DataFrame:
        """The table as `compensate --out` writes it: poses, payload, error, joint corrections, what is left."""
        result, arm = self.found, self.arm.model
        columns = {**joint_columns(arm, result.q), "payload_kg": result.payload}
        for axis, values in zip("xy" if arm.planar() else "xyz", result.error.T, strict=False):
            columns[f"d{axis}_mm"] = 1e3 * values
        columns |= {**joint_columns(arm, result.correction, "dq"), "left_mm": 1e3 * result.left}
        return frame({name: values.round(_DIGITS) + 0.0 for name, values in columns.items()})

    @property
    def _lengths_mm(self) -> Array:
        return 1e3 * np.linalg.norm(self.found.error, axis=1)

    @property
    def max_error_mm(self) -> float:
        """The greatest error at the table's poses, mm."""
        return float(self._lengths_mm.max())

    def plot(self) -> go.Figure:
        """The error of the tip at each pose, where the tip nominally is."""
        tip = 1e3 * tip_position(self.arm.model, self.found.q)
        planar = self.arm.model.planar()
        across, up = (tip[:, 0], tip[:, 1]) if planar else (np.hypot(tip[:, 0], tip[:, 1]), tip[:, 2])
        colours = {"colorscale": "Viridis", "colorbar": {"title": {"text": "mm"}}}
        marker = {"color": self._lengths_mm.tolist(), **colours}
        marks = {"type": "scatter", "mode": "markers", "x": across.tolist(), "y": up.tolist(), "marker": marker}
        return figure_of({"data": [marks]})

    def save(self, folder: File) -> Sequence[Path]:
        """Write the table where `folder` names a file (.csv, .parquet or .md), as `compensate --out` does; else
        as CSV into that folder."""
        place = Path(folder)
        target = place / "compensation.csv" if place.is_dir() else place
        if target.suffix.lower() in WAYS:
            write_table(self.table, target)
        else:
            write_file(target, self.table.to_csv(index=False, lineterminator="\n"))
        return [target]

    def _content(self) -> Mapping[str, Any]:
        result, table = self.found, self.table
        pairs = [(f"rms_{name}_mm", f"max_{name}_mm=largest_{name}") for name in ("without", "subtracted", "corrected")]
        return {
            "arm": result.arm.name,
            "grid": None if result.axes is None else [len(axis) for axis in result.axes],
            "rms_error_mm": _rms(self._lengths_mm),
            "max_error_mm": self.max_error_mm,
            "max_left_mm": float(1e3 * result.left.max()),
            "between": fields_if(result.check, "poses", *(item for pair in pairs for item in pair)),
            "warnings": _warnings(result),
            "columns": list(table.columns),
            "rows": table.to_numpy().tolist(),
        }

    def _tables(self) -> Mapping[str, pd.DataFrame]:
        return {"Table": self.table}


def payloads_of(arm: Arm, given: Quantity | Sequence[Quantity]) -> tuple[float, ...]:
    """The payloads of a table, kg; the arm's own where none is given. Raises `InputError`."""
    several = (given,) if isinstance(given, str | float | int) else given
    masses = tuple(in_si(item, "mass", "payload") for item in several) or (arm.model.payload.mass,)
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
        return read_poses(Path(given), arm.model)[0]
    return np.array([pose_of(arm.model, q) for q in given])


def compensated(
    arm: Arm, grid: int | None, poses: Array | None, payloads: tuple[float, ...], progress: Progress | None
) -> TableResult:
    """The table at poses, or over a grid. Raises `InputError`."""
    with reporting(progress) as tell:

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
