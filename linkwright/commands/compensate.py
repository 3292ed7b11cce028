"""`linkwright compensate`: the error over the workspace as a table that a controller can subtract."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import linkwright as lw
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import read_text
from linkwright.output.files import check_target, write_result

from .options import CatalogueFile, JsonFile, MarkdownFile, Tip, as_options, asked_of, not_lost, tell

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from linkwright.core.arm.chain.chain import Arm

HELP = """The error over the workspace as a table: by how much the tip is off, and what to add to each joint against it.

Example: linkwright compensate arm.yaml --grid 9 --out table.csv
"""


_LARGEST = 1e9


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
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="Write the table: .csv, .parquet, .md or .tex.")
    ] = None,
    tip: Tip = None,
    json: JsonFile = None,
    markdown: MarkdownFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from linkwright.output.table_file import check_table
    from linkwright.results.compensation import describe
    from linkwright.screen.progress import waiting

    for target in (out, json, markdown):
        check_target(target, arm, poses, catalogue)
    check_table(out)
    if grid is not None and poses is not None:
        raise InputError("", "--poses", "goes without --grid: the poses are the file's")
    with asked_of(arm), as_options(), waiting("computing the table") as told:
        given = lw.read_arm(arm, catalogue=catalogue, tip=tip)
        at = None if poses is None else read_poses(poses, given.model).tolist()
        found = lw.compensate(given, grid=grid, poses=at, payload=payload or (), progress=told)
    described = describe(found.found)
    with not_lost(described), waiting("writing"):
        if out is not None:
            found.save(out)
        if json is not None:
            write_result(json, found.to_json())
    tell(described, markdown, out, json)


def read_poses(path: Path, arm: Arm) -> NDArray[np.float64]:
    """Poses (N, n) from a CSV file, rad and m. Raises `InputError`."""
    import numpy as np
    import pandas as pd

    from linkwright.core.diagnose.reading.table import as_number

    text = read_text(path)
    try:
        content = pd.read_csv(io.StringIO(text), skipinitialspace=True, dtype=str)
    except ValueError as error:
        raise InputError(path, "", f"is no table: {' '.join(str(error).split())}") from None
    if content.empty:
        raise InputError(path, "", "holds no poses")
    found: list[NDArray[np.float64]] = []
    for index, joint in enumerate(arm.joints):
        name = f"q{index + 1}_{'deg' if joint.revolute else 'mm'}"
        if name not in content.columns:
            raise InputError(path, name, f"is missing; the file has {', '.join(str(each) for each in content.columns)}")
        values = np.array([as_number(str(cell)) for cell in content[name]])
        bad = np.flatnonzero(~(np.abs(values) < _LARGEST))
        if len(bad):
            raise InputError(path, name, f"is no coordinate of a joint in row {int(bad[0]) + 1}")
        found.append(np.radians(values) if joint.revolute else 1e-3 * values)
    return np.stack(found, axis=1)
