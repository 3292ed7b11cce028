"""The catalogue of actuators: its schema, its editor and its tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast

from linkwright.core.arm.actuators import CONFIRMABLE, read_actuators
from linkwright.core.catalogues.csv_table import marks_text, table_text
from linkwright.core.catalogues.keyed import Column, Entry, KeyedEditor, Schema
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import shipped_files


def _inherited(data: Mapping[str, Any], stem: str, content: Mapping[str, Any]) -> Mapping[str, Any]:
    """With what the file says of all: the maker, and where the figures were found or not."""
    del stem
    told = [key for key in ("maker", "unconfirmed", "found_in") if data.get(key) and key not in content]
    return {**{key: data[key] for key in told}, **content}


def _listed(text: str, path: Path | str, where: str) -> list[str]:
    """Several values: `14 N*m; 48 N*m`."""
    del path, where
    return [each.strip() for each in text.split(";") if each.strip()]


def _stiffness(text: str, path: Path | str, where: str) -> str | list[str]:
    """One value, or those of zones: `31 kN*m/rad; 50 kN*m/rad`."""
    found = _listed(text, path, where)
    return found if len(found) > 1 else text


def _cost(text: str, path: Path | str, where: str) -> str | dict[str, Any]:
    """A price with the lowest and highest to expect and its date: `800 EUR; 700 EUR; 950 EUR; 2026-01`."""
    parts = _listed(text, path, where)
    return {"value": parts[0], "spread": parts[1:3], "date": parts[3]} if len(parts) == 4 else text


def _number(text: str, path: Path | str, where: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(path, where, f"needs a number, not '{text}'") from None


ACTUATORS = KeyedEditor(
    Schema(
        what="actuator",
        under="actuators",
        read=read_actuators,
        shipped=lambda: shipped_files("linkwright.core.arm.actuators"),
        figures=lambda: CONFIRMABLE,
        own_sources=False,
        inherited=_inherited,
        columns=lambda: (
            *(Column(name, needed=True) for name in ("name", "maker", "gear")),
            Column("ratio", _number),
            Column("rated_torque", needed=True),
            Column("peak_torque"),
            Column("stiffness", _stiffness, needed=True),
            Column("zone_torques", _listed),
            *(Column(name, needed=True) for name in ("backlash", "mass")),
            Column("tilting_stiffness"),
            Column("cost", _cost),
            *(Column(name) for name in ("source", "found_in", "unconfirmed")),
        ),
    )
)


def write_table(entries: Sequence[Entry]) -> str:
    """Actuators as a table of comma-separated values."""
    columns = ACTUATORS.schema.heading
    rows: list[dict[str, object]] = []
    for entry in entries:
        cells = {key: _cell(entry.content[key]) for key in columns[:-1] if key in entry.content}
        marks = entry.content.get("unconfirmed", {})
        each = cast(dict[str, str], marks)
        said = each if isinstance(marks, dict) else dict.fromkeys(list[str](CONFIRMABLE), str(marks))
        source = entry.references.get(str(cells.get("source", "")), "")
        rows.append({"name": entry.name, **cells, "source": source, "unconfirmed": marks_text(said)})
    return table_text(columns, rows)


def _cell(value: Any) -> object:
    if isinstance(value, list):
        return "; ".join(map(str, cast(list[object], value)))
    if isinstance(value, dict):
        price = cast(dict[str, Any], value)
        return "; ".join(map(str, (price["value"], *price["spread"], price["date"])))
    return value
