"""Actuators for and from spreadsheets: a row an actuator, quantities as text with their units."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from linkwright.core.arm.actuators import CONFIRMABLE
from linkwright.core.catalogues.csv_table import marks_of, marks_text, read_rows, table_text
from linkwright.core.catalogues.materials_as_text import Entry
from linkwright.core.units.quantities import InputError

_SEVERAL = ("stiffness", "zone_torques")
"""Keys that may have several values, those of zones of torque: `31 kN*m/rad; 50 kN*m/rad`."""
COLUMNS = (
    "name",
    "maker",
    "gear",
    "ratio",
    "rated_torque",
    "peak_torque",
    "stiffness",
    "zone_torques",
    "backlash",
    "mass",
    "tilting_stiffness",
    "cost",
    "source",
    "found_in",
    "unconfirmed",
)
_NEEDED = ("name", "maker", "gear", "rated_torque", "stiffness", "backlash", "mass")


def write_table(entries: Sequence[Entry]) -> str:
    """Actuators as a table of comma-separated values."""
    rows: list[dict[str, object]] = []
    for entry in entries:
        cells = {key: entry.content[key] for key in COLUMNS if key in entry.content}
        source = entry.references.get(str(cells.get("source", "")), "")
        said = cells.pop("unconfirmed", {})
        marks = dict.fromkeys(list[str](CONFIRMABLE), said) if isinstance(said, str) else said
        told = {"source": source, "unconfirmed": marks_text(marks)}
        rows.append({"name": entry.name, **{key: _cell(value) for key, value in cells.items()}, **told})
    return table_text(COLUMNS, rows)


def _cell(value: Any) -> object:
    if isinstance(value, list):
        return "; ".join(str(each) for each in value)  # type: ignore[reportUnknownVariableType]
    if isinstance(value, dict):
        return value.get("value", "")  # type: ignore[reportUnknownVariableType]
    return value


def read_table(path: Path | str) -> tuple[Entry, ...]:
    """The actuators of a table; columns may be missing or in another order. What a quantity must be is checked where
    they are put into a file. Raises `InputError`."""

    def entry(cells: dict[str, str], where: str) -> Entry:
        content: dict[str, Any] = {key: cells[key] for key in COLUMNS[1:] if key in cells}
        for key in _SEVERAL:
            several = [each.strip() for each in cells.get(key, "").split(";") if each.strip()]
            if len(several) > 1:
                content[key] = several
        if "ratio" in cells:
            try:
                content["ratio"] = float(cells["ratio"])
            except ValueError:
                raise InputError(path, f"{where}: ratio", f"needs a number, not '{cells['ratio']}'") from None
        content["source"] = "table"
        marks = marks_of(content.pop("unconfirmed", ""), CONFIRMABLE, path, f"{where}: unconfirmed")
        content |= {"unconfirmed": marks} if marks else {}
        return Entry(cells["name"], content, {"table": cells.get("source", "") or f"table {Path(path).name}"})

    return read_rows(path, COLUMNS, _NEEDED, entry)
