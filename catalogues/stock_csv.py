"""Stock sizes as a table of comma-separated values.

The columns are `name`, `family`, `shape`, `source`, one a dimension (`height_mm`, or `height_in`), the printed figures
(`area_cm2`, `second_moment_y_cm4`, `second_moment_z_cm4`, or in inches `area_in2` and so on) and where any row says so
`found_in` and `unconfirmed`; a cell is empty where a shape has no such dimension.

A table with the headings of the AISC Shapes Database is read as it is printed (`catalogues.aisc`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from linkwright.core.catalogues.aisc import from_aisc, is_aisc
from linkwright.core.catalogues.csv_table import read_cells, read_rows, table_text
from linkwright.core.catalogues.stock_editor import Row, column_of, columns_of, neat
from linkwright.core.sections import SHAPES
from linkwright.core.sections.stock.tables import PRINTED
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError

_HEAD = ("name", "family", "shape", "source")
_MARKS = ("found_in", "unconfirmed")


def _figures() -> list[str]:
    """Every dimension that any shape has, then the printed figures."""
    columns = dict.fromkeys(column for shape in SHAPES for column in columns_of(shape))
    return [*(column for column in columns if column not in PRINTED), *PRINTED]


def write_table(rows: Sequence[Row]) -> str:
    """The rows as comma-separated values, with the columns that any of them has."""
    used = {column for row in rows for column in row.cells}
    marks = [name for name in _MARKS if any(getattr(row, name) for row in rows)]
    cells = ({**{name: getattr(row, name) for name in (*_HEAD, *marks)}, **row.cells} for row in rows)
    return table_text([*_HEAD, *(column for column in _figures() if column in used), *marks], cells)


def read_table(path: Path | str) -> tuple[Row, ...]:
    """The rows of a table of comma-separated values; columns may be in any order.

    Raises `InputError`, and `WrongRows` once all rows have been looked at.
    """
    cells = read_cells(path)
    if is_aisc(cells):
        cells = from_aisc(cells, path)

    def row(texts: dict[str, str], where: str) -> Row:
        name, family, shape, source = (texts[column] for column in _HEAD)
        if shape not in SHAPES:
            raise InputError(path, f"{where}: shape", f"there is no shape '{shape}'{nearest(shape, SHAPES)}")
        marks = [texts.get(name, "") for name in _MARKS]
        dimensions: dict[str, float] = {}
        for column, text in texts.items():
            if column not in (*_HEAD, *_MARKS):
                dimensions[column_of(shape, column)] = neat(_number(text, path, f"{where}: {column}"))
        return Row(
            name, family, shape, source, {c: dimensions[c] for c in columns_of(shape) if c in dimensions}, *marks
        )

    return read_rows(path, [*_HEAD, *_figures(), *_MARKS], _HEAD, row, cells)


def _number(text: str, path: Path | str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(path, where, f"needs a number, not '{text}'")
    return value
