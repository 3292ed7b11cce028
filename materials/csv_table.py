"""Materials as a table of comma-separated values, for spreadsheets: a row a material, cells with their units.

The columns are `name`, `title`, `family`, `isotropic`, one a property (`elastic_modulus`: `71 GPa`, at 20 degC) and
`source`, one text for the whole row. Tables over temperature, spreads and notes have no place in it.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from materials.material import Material, property_kinds
from materials.quantities import InputError, format_quantity, read_quantity
from materials.reading import nearest, read_text
from materials.written import Entry

_ABOUT = ("name", "title", "family", "isotropic")


def columns() -> tuple[str, ...]:
    """Return the columns of the table, in order."""
    return (*_ABOUT, *property_kinds(), "source")


def write_table(materials: Iterable[Material]) -> str:
    """Return the table of the materials, their values at 20 degC."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, columns(), lineterminator="\n")
    writer.writeheader()
    for material in materials:
        row = {"name": material.name, "title": material.title, "family": material.family}
        row["isotropic"] = "yes" if material.isotropic else "no"
        for name, kind in property_kinds().items():
            if name in material.properties:
                row[name] = format_quantity(material.need(name), kind)
        row["source"] = "; ".join(" ".join(text.split()) for text in material.references.values())
        writer.writerow(row)
    return stream.getvalue()


def read_table(path: Path | str) -> tuple[Entry, ...]:
    """Return the materials of a table; columns may be missing or in another order. Raises `InputError`."""
    reader = csv.DictReader(io.StringIO(read_text(path), newline=""), strict=True)
    try:
        headings = list(reader.fieldnames or ())
        for heading in headings:
            if heading not in columns():
                raise InputError(path, "", f"unknown column '{heading}'{nearest(heading, columns())}")
        if "name" not in headings:
            raise InputError(path, "", "has no column 'name'")
        entries = [_entry(row, path, reader.line_num) for row in reader]
    except csv.Error as error:
        raise InputError(path, f"line {reader.line_num}", f"is no table: {error}") from None
    if not entries:
        raise InputError(path, "", "has no rows")
    return tuple(entries)


def _entry(row: dict[Any, Any], path: Path | str, line: int) -> Entry:
    where = f"line {line}"
    if None in row or None in row.values():
        raise InputError(path, where, "has not as many cells as the heading")
    cells = {str(key): str(value).strip() for key, value in row.items() if str(value).strip()}
    name = cells.get("name", "")
    if not name:
        raise InputError(path, where, "has no name")
    content: dict[str, Any] = {key: cells[key] for key in ("title", "family") if key in cells}
    if "isotropic" in cells:
        if cells["isotropic"] not in ("yes", "no"):
            raise InputError(path, f"{where}: isotropic", "needs yes or no")
        content["isotropic"] = cells["isotropic"] == "yes"
    content["source"] = "table"
    for key, kind in property_kinds().items():
        if key in cells:
            value = read_quantity(cells[key], kind, file=path, key=f"{where}: {key}")
            content[key] = value if kind == "dimensionless" else cells[key]
    return Entry(name, content, {"table": cells.get("source", "") or f"table {Path(path).name}"})
