"""Materials as a table of comma-separated values: a row a material, cells with their units.

The columns are `name`, `title`, `family`, `isotropic`, one a property (`elastic_modulus`: `71 GPa`, at 20 degC),
`source`, one text for the whole row, and `unconfirmed` (`density: what was looked for; cost: ...`). Tables over
temperature, spreads and notes have no place in it.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from linkwright.core.catalogues.csv_table import marks_of, marks_text, read_rows, table_text
from linkwright.core.catalogues.materials_as_text import Entry
from linkwright.core.materials.material import Material, property_kinds
from linkwright.core.units.quantities import InputError, format_quantity, read_quantity


def columns() -> tuple[str, ...]:
    """Return the columns of the table, in order."""
    return ("name", "title", "family", "isotropic", *property_kinds(), "source", "unconfirmed")


def write_table(materials: Iterable[Material]) -> str:
    """Return the table of the materials, their values at 20 degC."""
    return table_text(columns(), (_row(material) for material in materials))


def _row(material: Material) -> dict[str, str]:
    kinds = property_kinds()
    return {
        "name": material.name,
        "title": material.title,
        "family": material.family,
        "isotropic": "yes" if material.isotropic else "no",
        **{name: format_quantity(material.need(name), kinds[name]) for name in kinds if name in material.properties},
        "source": "; ".join(" ".join(text.split()) for text in material.references.values()),
        "unconfirmed": marks_text({k: item.unconfirmed for k, item in material.properties.items() if item.unconfirmed}),
    }


def read_table(path: Path | str) -> tuple[Entry, ...]:
    """Return the materials of a table; columns may be missing or in another order. Raises `InputError`."""

    def entry(cells: dict[str, str], where: str) -> Entry:
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
        marks = marks_of(cells.get("unconfirmed", ""), property_kinds(), path, f"{where}: unconfirmed")
        content |= {"unconfirmed": marks} if marks else {}
        return Entry(cells["name"], content, {"table": cells.get("source", "") or f"table {Path(path).name}"})

    return read_rows(path, columns(), ["name"], entry)
