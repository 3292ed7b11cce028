"""Stock sizes as a table of comma-separated values.

The columns are `name`, `family`, `shape`, `source`, one a dimension (`height_mm`, or `height_in`), the printed figures
(`area_cm2`, `second_moment_y_cm4`, `second_moment_z_cm4`, or in inches `area_in2` and so on) and where any row says so
`found_in` and `unconfirmed`; a cell is empty where a shape has no such dimension.

A table with the headings of the AISC Shapes Database is read in inches as it is printed (v15.0 and v16.0, Readme): `d`
is the depth, `bf` and `tf` are of the flange, `tw` is the web's thickness, `kdes` reaches from the outer face of the
flange to the toe of the fillet, for design.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from types import MappingProxyType

from linkwright.core.catalogues.csv_table import Cells, read_cells, read_rows, table_text
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


_NAMES = ("AISC_Manual_Label", "AISC_name")
_COLUMNS = MappingProxyType(
    {
        "height_in": "d",
        "width_in": "bf",
        "flange_thickness_in": "tf",
        "web_thickness_in": "tw",
        "area_in2": "A",
        "second_moment_y_in4": "Ix",
        "second_moment_z_in4": "Iy",
    }
)
_SHAPES = MappingProxyType({"W": "i_section", "M": "i_section", "HP": "i_section"})
"""What is read, by the `Type` or the beginning of the name; flanges of other rolled shapes slope."""


def is_aisc(table: Cells) -> bool:
    """Whether a table has AISC's headings."""
    return not set(_NAMES).isdisjoint(table.headings)


def from_aisc(table: Cells, path: Path | str) -> Cells:
    """Such a table with the columns of stock sizes. The fillet's radius is `kdes - tf`; what is of a kind that is not
    read has that for its shape, and other columns are left out."""
    named = next(name for name in _NAMES if name in table.headings)
    source = f"{Path(path).name}, by the headings of the AISC Shapes Database"
    rows = tuple((where, row and _row(row, named, source)) for where, row in table.rows)
    read = [column for column, heading in _COLUMNS.items() if heading in table.headings]
    return Cells(("name", "family", "shape", "source", *read, "root_radius_in"), rows)


def _row(row: dict[str, str], named: str, source: str) -> dict[str, str]:
    name = row.get(named, "")
    kind = row.get("Type") or re.sub(r"\d.*", "", name, flags=re.DOTALL)
    figures = {column: row[heading] for column, heading in _COLUMNS.items() if heading in row}
    if "kdes" in row and "tf" in row:
        figures["root_radius_in"] = _less(row["kdes"], row["tf"])
    head = {"name": name, "family": kind, "shape": _SHAPES.get(kind, kind), "source": source}
    return {**{column: text for column, text in head.items() if text}, **figures}


def _less(one: str, other: str) -> str:
    """The difference of two printed numbers; of what is none, the words for it."""
    try:
        return f"{float(one) - float(other):.12g}"
    except ValueError:
        return f"{one} - {other}"
