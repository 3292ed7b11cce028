"""A link's 6 x 6 stiffness as an arm file gives it: a table (CSV) from finite elements, or its rows in place."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import cast

import numpy as np

from linkwright.core.arm.chain.chain import Matrix
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.reading import Mapping, read_text

AXES = ("fx", "fy", "fz", "mx", "my", "mz")
"""Rows and columns: forces with displacements, moments with rotations, along the axes of the link's frame."""
_SYMMETRIC = 1e-4
"""By how much of the geometric mean of the diagonal's entries two opposite ones may differ: digits of a printout."""
_LEAST = 1e-12
_TO_M = np.array([1e-3, 1e-3, 1e-3, 1.0, 1.0, 1.0])
_TO_NMM = np.array([1.0, 1.0, 1.0, 1e3, 1e3, 1e3])
"""What a displacement in mm is in m, and a moment in N*m in N*mm; a force and a rotation stay."""


def read_stiffness(link: Mapping) -> Matrix | None:
    """The compliance of a link's far end (rows for m and rad, columns for N and N*m) from its stiffness in N, mm and
    rad; None where the link has none. Raises `InputError` where it is no stiffness."""
    if not link.has("stiffness"):
        return None
    raw = link.raw("stiffness")
    if isinstance(raw, str):
        path = Path(str(link.file)).parent / raw
        rows, file, key = _table(path), cast(object, path), ""
    else:
        rows, file, key = raw, link.file, link.path_of("stiffness")
    matrix = _numbers(rows, file, key)
    _check(matrix, file, key)
    compliance = _TO_M[:, None] * np.linalg.inv(matrix) * _TO_NMM[None, :]
    compliance = 0.5 * (compliance + compliance.T)
    return tuple(tuple(row) for row in compliance.tolist())


def stiffness_rows(compliance: Matrix) -> list[list[float]]:
    """The stiffness (N, mm, rad) of a compliance (m, rad by N, N*m), as an arm file has its rows."""
    matrix = np.linalg.inv(np.array(compliance) / _TO_M[:, None] / _TO_NMM[None, :])
    return [[float(f"{value:.12g}") for value in row] for row in (0.5 * (matrix + matrix.T)).tolist()]


def _table(path: Path) -> list[list[str]]:
    try:
        reader = csv.reader(io.StringIO(read_text(path), newline=""), skipinitialspace=True, strict=True)
        rows = [[cell.strip() for cell in row] for row in reader if any(cell.strip() for cell in row)]
    except csv.Error as error:
        raise InputError(path, "", f"is no table: {error}") from None
    names = [cell.lower() for cell in rows[0]] if rows else []
    if any(name in AXES for name in names):
        if tuple(name for name in names if name) != AXES:
            raise InputError(
                path, "line 1", f"needs the columns {', '.join(AXES)} in this order, not {', '.join(names)}"
            )
        rows = rows[1:]
    if rows and all(row[0].lower() == name for row, name in zip(rows, AXES, strict=False)):
        rows = [row[1:] for row in rows]
    return rows


def _numbers(rows: object, file: object, key: str) -> Array:
    entries = cast(list[object], rows) if isinstance(rows, list) else []
    wrong = len(entries) != 6 or any(not isinstance(row, list) or len(cast(list[object], row)) != 6 for row in entries)
    if wrong:
        message = f"needs 6 rows of 6 numbers ({', '.join(AXES)}; N, mm, rad), or a CSV of them"
        raise InputError(file, key, message)
    matrix = np.empty((6, 6))
    for i, row in enumerate(cast(list[list[object]], entries)):
        for j, value in enumerate(row):
            try:
                matrix[i, j] = float(str(value))
            except ValueError:
                matrix[i, j] = np.nan
            if not np.isfinite(matrix[i, j]):
                place = f"row {AXES[i]}, column {AXES[j]}"
                raise InputError(file, key, f"needs a number in {place} (N, mm, rad), not {shown(value)}")
    return matrix


def _check(matrix: Array, file: object, key: str) -> None:
    """Refuse what is no stiffness: one that differs from its transpose, or gives way by itself."""
    diagonal = np.diag(matrix)
    if (diagonal <= 0.0).any():
        name = AXES[int(np.argmin(diagonal))]
        raise InputError(file, key, f"is not positive: row {name}, column {name} must be above zero, as a stiffness is")
    scale = np.sqrt(np.outer(diagonal, diagonal))
    off = np.abs(matrix - matrix.T) / scale
    i, j = (int(k) for k in np.unravel_index(int(off.argmax()), off.shape))
    if off[i, j] > _SYMMETRIC:
        pair = f"row {AXES[i]}, column {AXES[j]} is {matrix[i, j]:g}, the other way round {matrix[j, i]:g}"
        raise InputError(file, key, f"is not symmetric: {pair}; a stiffness is, by Maxwell and Betti")
    if np.linalg.eigvalsh(0.5 * (matrix + matrix.T) / scale)[0] < _LEAST:
        raise InputError(file, key, "is not positive definite: some load would move the far end against itself")
