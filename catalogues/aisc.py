"""Tables with the headings of the AISC Shapes Database, in inches as they are printed.

Source: AISC Shapes Database v15.0 and v16.0, Readme: `d` is the depth, `bf` and `tf` are of the flange, `tw` is the
web's thickness, `kdes` reaches from the outer face of the flange to the toe of the fillet, for design.
"""

from __future__ import annotations

import re
from pathlib import Path
from types import MappingProxyType

from linkwright.core.catalogues.csv_table import Cells

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
