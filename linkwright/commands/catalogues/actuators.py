"""`linkwright actuators`: the gears that joints can name, and a file of one's own."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

import linkwright as lw
from linkwright.commands.catalogues.user_catalogue import Names, TableFile, UserCatalogue, value_of_text
from linkwright.commands.options import Commands, JsonFile, answer
from linkwright.core.arm.actuators import CONFIRMABLE, USER_ACTUATORS, read_actuators, shipped_actuators
from linkwright.core.catalogues.csv_table import marks_text, table_text
from linkwright.core.catalogues.keyed import Column, Entry, KeyedEditor, Schema
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import load_yaml, shipped_files
from linkwright.json.fields import fields
from linkwright.output.files import check_target
from linkwright.results.figures_in_words import figure, with_unit
from linkwright.screen.console import table

if TYPE_CHECKING:
    from linkwright.core.arm.actuators import Actuator


def _inherited(data: Mapping[str, Any], stem: str, content: Mapping[str, Any]) -> Mapping[str, Any]:
    """With what the file says of all: the maker, and where the figures were found or not."""
    del stem
    keys = [key for key in ("maker", "unconfirmed", "found_in") if data.get(key) and key not in content]
    return {**{key: data[key] for key in keys}, **content}


def _listed(text: str, path: Path | str, where: str) -> list[str]:
    """Several values: `14 N*m; 48 N*m`."""
    del path, where
    return [item.strip() for item in text.split(";") if item.strip()]


def _stiffness(text: str, path: Path | str, where: str) -> str | list[str]:
    """One value, or those of zones: `31 kN*m/rad; 50 kN*m/rad`."""
    stiffness = _listed(text, path, where)
    return stiffness if len(stiffness) > 1 else text


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
        has_sources=False,
        inherited=_inherited,
        columns=lambda: (
            *(Column(name, needed=True) for name in ("name", "maker", "gear")),
            Column("ratio", _number),
            Column("rated_torque"),
            Column("peak_torque"),
            Column("stiffness", _stiffness),
            Column("zone_torques", _listed),
            *(Column(name) for name in ("backlash", "mass", "tilting_stiffness")),
            Column("cost", _cost),
            *(Column(name) for name in ("note", "source", "found_in", "unconfirmed")),
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
        marks_by_name = cast(dict[str, str], marks)
        marks_here = marks_by_name if isinstance(marks, dict) else dict.fromkeys(list[str](CONFIRMABLE), str(marks))
        source = entry.references.get(str(cells.get("source", "")), "")
        rows.append({"name": entry.name, **cells, "source": source, "unconfirmed": marks_text(marks_here)})
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
        "import": """Put actuators from a .yaml, .csv or .xlsx file into yours; each wrong row is named.

Example: linkwright actuators import supplier.yaml
""",
        "check": "Check files of actuators. Without a file the shipped ones and yours.",
    }
)


def _made(name: str, values: dict[str, str], source: str) -> Entry:
    if not source:
        raise InputError("", "--source", "is missing: say where the figures are from")
    content = {key: value_of_text(value, key) for key, value in values.items()}
    return Entry(name, {**content, "source": "own"}, {"own": source})


def _finder(catalogue: Path | None) -> Callable[[str], Entry | None]:
    files = [path for path in (USER_ACTUATORS.path(), catalogue) if path is not None and path.exists()]
    return lambda name: ACTUATORS.entry(name, files)


CATALOGUE = UserCatalogue(
    group="actuators",
    editor=ACTUATORS,
    user_file=USER_ACTUATORS.path,
    entry="actuator",
    called="file",
    key="actuator",
    count=lambda path: len(read_actuators(load_yaml(path))),
    shipped=lambda: [("shipped actuators", len(shipped_actuators()))],
    example="'TURNER 1'",
    helps=_HELPS,
    such_as="mass='2 kg'",
    made=_made,
    finder=_finder,
    known=lambda path: lw.actuators.with_file(path),
    read={".yaml": ACTUATORS.entries, ".csv": ACTUATORS.read_table, ".xlsx": ACTUATORS.read_table},
)


def export_actuators(
    names: Names = None, out: TableFile = Path("actuators.yaml"), catalogue: ActuatorFile = None
) -> None:
    """Write actuators to a .yaml or .csv file, or for reports to .md or .parquet; all without a name.

    Example: linkwright actuators export RV-20E --out drives.yaml
    """
    known = CATALOGUE.known(catalogue)
    chosen_names = [known[name].name for name in names or known]
    CATALOGUE.write(out, chosen_names, catalogue, {".yaml": ACTUATORS.text, ".csv": write_table})


def list_actuators(
    least_torque: Annotated[
        str | None, typer.Option("--least-torque", metavar="TORQUE", help="Only those rated for it, e.g. '100 N*m'.")
    ] = None,
    json: JsonFile = None,
    catalogue: ActuatorFile = None,
) -> None:
    """Every actuator: what it holds, how stiff it is, what it loses, weighs and costs.

    Example: linkwright actuators list --least-torque '100 N*m'
    """
    from linkwright.core.units.quantities import read_quantity

    check_target(json, catalogue)
    least = 0.0 if least_torque is None else read_quantity(least_torque, "torque", file="", key="--least-torque")
    actuators = [item for item in lw.actuators.with_file(catalogue).values() if (item.rated_torque or 0.0) >= least]
    content = {"actuators": [_as_json(actuator) for actuator in actuators]}
    if not actuators:
        answer(json, "actuators", content, "no actuator is rated for that")
        return
    units = ("rated N·m", "peak N·m", "stiffness kN·m/rad", "backlash arcmin", "mass kg", "cost EUR")
    shown = table("actuator", "gear", *units, numbers=(2, 3, 4, 5, 6, 7))
    shown.columns[0].no_wrap = True
    for each in actuators:
        figures = {
            "rated_torque": each.rated_torque,
            "peak_torque": each.peak_torque,
            "stiffness": None if each.stiffness is None else each.stiffness / 1e3,
            "backlash": _arcmin(each.backlash),
            "mass": each.mass,
            "cost": each.cost,
        }
        marked = (figure(value, 5) + _mark(each, name) for name, value in figures.items())
        shown.add_row(each.name, each.gear, *marked)
    makers = ", ".join(dict.fromkeys(actuator.maker for actuator in actuators))
    note = f"{makers}: figures of the makers' catalogues; stiffness: of the softest zone; a dash: not known"
    doubtful = any(actuator.unconfirmed for actuator in actuators)
    more = "?: could not be found in its source; `actuators show NAME` says more" if doubtful else ""
    answer(json, "actuators", content, shown, note, more)


def show_actuator(
    name: Annotated[str, typer.Argument(metavar="NAME", help="The actuator's name.")],
    json: JsonFile = None,
    catalogue: ActuatorFile = None,
) -> None:
    """One actuator: every figure, and where it is from.

    Example: linkwright actuators show RV-20E
    """
    check_target(json, catalogue)
    actuator = lw.actuators.with_file(catalogue)[name]
    shown = table("what", "value", numbers=(1,))
    if actuator.ratio is not None:
        shown.add_row("ratio", figure(actuator.ratio, 5))
    shown.add_row("rated torque", with_unit(actuator.rated_torque, "N·m", 5) + _mark(actuator, "rated_torque"))
    shown.add_row("peak torque", with_unit(actuator.peak_torque, "N·m", 5) + _mark(actuator, "peak_torque"))
    for label, stiffness in zip(_zones(actuator), actuator.stiffnesses, strict=True):
        shown.add_row(f"stiffness{label}", with_unit(stiffness / 1e3, "kN·m/rad", 5) + _mark(actuator, "stiffness"))
    if not actuator.stiffnesses:
        shown.add_row("stiffness", "not known")
    elif actuator.rated_torque is not None:
        wound = 1e3 * actuator.wind_up(actuator.rated_torque)
        shown.add_row("gives under its rated torque", with_unit(wound, "mrad", 3))
    shown.add_row(
        "backlash (total lost motion)", with_unit(_arcmin(actuator.backlash), "arcmin", 3) + _mark(actuator, "backlash")
    )
    weighed = "mass" if actuator.gear == "servo" else "mass, without motor"
    shown.add_row(weighed, with_unit(actuator.mass, "kg", 5) + _mark(actuator, "mass"))
    tilting = "not known"
    if actuator.tilting_stiffness is not None:
        tilting = with_unit(actuator.tilting_stiffness / 1e3, "kN·m/rad", 5) + _mark(actuator, "tilting_stiffness")
    shown.add_row("tilting stiffness of its bearing", tilting)
    shown.add_row("cost", _cost_words(actuator))
    note = f"{actuator.note}; " if actuator.note else ""
    lines = [f"{note}{actuator.source}; from {actuator.file}", actuator.found_in and f"found in: {actuator.found_in}"]
    lines += [f"? {key.replace('_', ' ')}, not confirmed: {text}" for key, text in actuator.unconfirmed]
    title = f"{actuator.name}: {actuator.maker}, {actuator.gear}"
    answer(json, "actuators", _as_json(actuator), shown, *lines, title=title)


def _mark(actuator: Actuator, name: str) -> str:
    return " ?" if actuator.is_unconfirmed(name) else ""


def _arcmin(radians: float | None) -> float | None:
    return None if radians is None else math.degrees(radians) * 60.0


def _zones(actuator: Actuator) -> list[str]:
    """Which torques each stiffness is for, in words."""
    if not actuator.zone_torques:
        return [""] * len(actuator.stiffnesses)
    ends = [figure(end, 5) for end in actuator.zone_torques]
    between = [f", {low} to {high} N·m" for low, high in itertools.pairwise(ends)]
    return [f", up to {ends[0]} N·m", *between, f", beyond {ends[-1]} N·m"]


def _cost_words(actuator: Actuator) -> str:
    if actuator.cost is None or actuator.cost_spread is None:
        return "not known"
    low, high = (figure(value) for value in actuator.cost_spread)
    spread = "" if low == high else f"{low} to {high}, "
    return f"{figure(actuator.cost)} EUR ({spread}{actuator.cost_date})"


def _as_json(actuator: Actuator) -> dict[str, Any]:
    figures = ("rated_torque_Nm", "peak_torque_Nm", "stiffness_Nm_per_rad", "stiffness_zones_Nm_per_rad=stiffnesses")
    figures += ("zone_torques_Nm", "backlash_arcmin", "tilting_stiffness_Nm_per_rad", "mass_kg")
    cost = ("cost_EUR", "cost_spread_EUR", "cost_date", "source", "note")
    result = {"found_in": actuator.found_in or None, "unconfirmed": dict(actuator.unconfirmed) or None}
    return {**fields(actuator, "name", "maker", "gear", "ratio", *figures, *cost), **result, **fields(actuator, "file")}


def group() -> Commands:
    """The commands of the group."""
    return {"list": list_actuators, "show": show_actuator, **CATALOGUE.commands(export_actuators)}
