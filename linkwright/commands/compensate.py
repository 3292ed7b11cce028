"""`linkwright compensate`: the error over the workspace as a table that a controller can subtract."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from linkwright.as_json import program_version
from linkwright.writing import check_target, write_file, write_json
from materials.quantities import InputError, read_quantity

from .options import CatalogueFile, JsonFile, asked_of, catalogue_with

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from arm.chain import Arm
    from arm.compensation import Table

HELP = """The error over the workspace as a table: by how much the tip is off, and what to add to each joint against it.

Example: linkwright compensate arm.yaml --grid 9 --out table.csv
"""
_MOST_ROWS = 1_000_000
_DIGITS = 9


def compensate(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file; a corrected one, say.")],
    grid: Annotated[
        int | None, typer.Option("--grid", metavar="N", min=2, help="Coordinates of each joint, over its range.")
    ] = None,
    poses: Annotated[
        Path | None,
        typer.Option("--poses", metavar="FILE", help="Poses of one's own: CSV with q1_deg, q2_deg ... (slides: mm)."),
    ] = None,
    payload: Annotated[
        list[str] | None,
        typer.Option("--payload", metavar="MASS", help="Instead of the arm file's, e.g. '2 kg'; may be repeated."),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the table as CSV.")] = None,
    json: JsonFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from arm.compensation import default_grid, table_at, table_over
    from arm.files import read_arm
    from linkwright.screen.compensation import show_compensation
    from linkwright.screen.console import console, waiting

    for target in (out, json):
        check_target(target, arm, poses, catalogue)
    if grid is not None and poses is not None:
        raise InputError("", "--poses", "goes without --grid: the poses are the file's")
    read = read_arm(arm, catalogue_with(catalogue))
    masses = tuple(_mass(text) for text in payload or ()) or (read.payload.mass,)
    if len(set(masses)) != len(masses):
        raise InputError("", "--payload", "names the same mass twice")
    with asked_of(arm), waiting("computing the table"):
        if poses is not None:
            table = table_at(read, read_poses(poses, read), masses)
        else:
            points = default_grid(read.size, len(masses)) if grid is None else grid
            if points**read.size * len(masses) > _MOST_ROWS:
                message = f"makes {points**read.size * len(masses)} rows; take fewer, {_MOST_ROWS} at most"
                raise InputError("", "--grid", message)
            table = table_over(read, points, masses)
    columns = table_columns(table)
    if out is not None:
        import pandas as pd

        write_file(out, pd.DataFrame(columns).to_csv(index=False, lineterminator="\n"))
    write_json(json, _as_json(table, columns))
    screen = console()
    show_compensation(screen, table)
    for path in (out, json):
        if path is not None:
            screen.print(f"written: {path}", soft_wrap=True)


def _mass(text: str) -> float:
    mass = read_quantity(text, "mass", file="", key="--payload")
    if mass < 0.0:
        raise InputError("", "--payload", f"cannot be negative, not '{text}'")
    return mass


def read_poses(path: Path, arm: Arm) -> NDArray[np.float64]:
    """Poses (N, n) from a CSV file, rad and m. Raises `InputError`."""
    import numpy as np
    import pandas as pd

    try:
        content = pd.read_csv(path, skipinitialspace=True)
    except OSError as error:
        raise InputError(path, "", f"cannot be read: {error.strerror or error}") from None
    except (ValueError, UnicodeDecodeError) as error:
        raise InputError(path, "", f"is no table: {' '.join(str(error).split())}") from None
    if content.empty:
        raise InputError(path, "", "holds no poses")
    found: list[NDArray[np.float64]] = []
    for index, joint in enumerate(arm.joints):
        name = f"q{index + 1}_{'deg' if joint.revolute else 'mm'}"
        if name not in content.columns:
            raise InputError(path, name, f"is missing; the file has {', '.join(str(each) for each in content.columns)}")
        values = np.asarray(pd.to_numeric(content[name], errors="coerce"), dtype=np.float64)
        bad = np.flatnonzero(~np.isfinite(values))
        if len(bad):
            raise InputError(path, name, f"is not a number in row {int(bad[0]) + 1}")
        found.append(np.radians(values) if joint.revolute else 1e-3 * values)
    return np.stack(found, axis=1)


def table_columns(table: Table) -> dict[str, NDArray[np.float64]]:
    """The table's columns by name, in degrees and mm."""
    import numpy as np

    arm = table.arm
    factor = [180.0 / np.pi if joint.revolute else 1e3 for joint in arm.joints]
    unit = ["deg" if joint.revolute else "mm" for joint in arm.joints]
    columns = {f"q{k + 1}_{unit[k]}": factor[k] * table.q[:, k] for k in range(arm.size)}
    columns["payload_kg"] = table.payload
    for axis, values in zip("xy" if arm.planar() else "xyz", table.error.T, strict=False):
        columns[f"d{axis}_mm"] = 1e3 * values
    for k in range(arm.size):
        columns[f"dq{k + 1}_{unit[k]}"] = factor[k] * table.correction[:, k]
    columns["left_mm"] = 1e3 * table.left
    return {name: values.round(_DIGITS) + 0.0 for name, values in columns.items()}


def _as_json(table: Table, columns: dict[str, Any]) -> dict[str, Any]:
    import numpy as np

    length = 1e3 * np.linalg.norm(table.error, axis=1)
    check = table.check
    return {
        "made_by": f"linkwright compensate {program_version()}",
        "arm": table.arm.name,
        "grid": None if table.axes is None else [len(axis) for axis in table.axes],
        "rms_error_mm": float(np.sqrt(np.mean(length**2))),
        "max_error_mm": float(length.max()),
        "max_left_mm": float(1e3 * table.left.max()),
        "between": None
        if check is None
        else {
            "poses": check.poses,
            "rms_without_mm": 1e3 * check.rms_without,
            "max_without_mm": 1e3 * check.largest_without,
            "rms_subtracted_mm": 1e3 * check.rms_subtracted,
            "max_subtracted_mm": 1e3 * check.largest_subtracted,
            "rms_corrected_mm": 1e3 * check.rms_corrected,
            "max_corrected_mm": 1e3 * check.largest_corrected,
        },
        "columns": list(columns),
        "rows": np.stack(list(columns.values()), axis=1).tolist(),
    }
