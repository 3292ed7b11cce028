"""Actuators for the command line: the catalogue's schema and tables, and the edits of a file of one's own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, cast

import typer

import linkwright as lw
from linkwright.commands.catalogues.own import Names, OwnCatalogue, TableFile, value_of_text
from linkwright.core.arm.actuators import CONFIRMABLE, read_actuators, shipped_actuators, user_actuators_path
from linkwright.core.catalogues.csv_table import marks_text, table_text
from linkwright.core.catalogues.keyed import Column, Entry, KeyedEditor, Schema
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import load_yaml, shipped_files


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


ActuatorFile = Annotated[
    Path | None, typer.Option("--catalogue", metavar="FILE", help="Actuators that add to the shipped ones.")
]
_HELPS = MappingProxyType(
    {
        "add": """Add an actuator to your file.

Example: linkwright actuators add 'TURNER 1' maker=Somebody gear=planetary rated_torque='20 N*m' stiffness='5 kN*m/rad' backlash='3 arcmin' mass='2 kg' --source 'Data sheet 7'
""",  # noqa: E501 - an example is one line
        "edit": """Change keys of an actuator, or the file in $EDITOR; a shipped actuator is copied to yours.

Example: linkwright actuators edit RV-20E mass='4.9 kg' --source 'weighed, 3 March'
""",
        "price": """Give an actuator a price in your file; the rest of it stays where it is.

Example: linkwright actuators price RV-20E '900 EUR' --source 'Offer 12'
""",
        "import": """Put actuators from a .yaml, .csv or .xlsx file into yours; all of it or nothing.

Example: linkwright actuators import supplier.yaml
""",
        "check": "Check files of actuators; without a file the shipped ones and yours.",
    }
)


def _made(name: str, given: dict[str, str], source: str) -> Entry:
    if not source:
        raise InputError("", "--source", "is missing: say where the figures are from")
    content = {key: value_of_text(value, key) for key, value in given.items()}
    return Entry(name, {**content, "source": "own"}, {"own": source})


def _found(catalogue: Path | None) -> Callable[[str], Entry | None]:
    files = [path for path in (user_actuators_path(), catalogue) if path is not None and path.exists()]
    return lambda name: ACTUATORS.entry(name, files)


OWN = OwnCatalogue(
    group="actuators",
    editor=ACTUATORS,
    own=lambda: user_actuators_path(),
    entry="actuator",
    called="file",
    key="actuator",
    count=lambda path: len(read_actuators(load_yaml(path))),
    shipped=lambda: [("shipped actuators", len(shipped_actuators()))],
    examples=("'TURNER 1'", "'TURNER 2'"),
    helps=_HELPS,
    such_as="mass='2 kg'",
    made=_made,
    found=_found,
    known=lambda path: lw.actuators.with_file(path),
    priced=lambda: list(shipped_actuators()),
    read={".yaml": ACTUATORS.entries, ".csv": ACTUATORS.read_table, ".xlsx": ACTUATORS.read_table},
)


def export_actuators(
    names: Names = None, out: TableFile = Path("actuators.yaml"), catalogue: ActuatorFile = None
) -> None:
    """Write actuators to a .yaml or .csv file, or for reports to .tex, .md or .parquet; all without a name.

    Example: linkwright actuators export RV-20E --out drives.yaml
    """
    known = OWN.known(catalogue)
    found = [known[name].name for name in names or known]
    OWN.write(out, found, catalogue, {".yaml": ACTUATORS.text, ".csv": write_table})
