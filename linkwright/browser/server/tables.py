"""The catalogues as tables, and their edits: those of the command line, in the same files."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from types import MappingProxyType

import linkwright as lw
from linkwright.commands.actuators.schema import ACTUATORS
from linkwright.commands.catalogues.own import value_of_text
from linkwright.commands.materials.edit import OWN
from linkwright.commands.materials.query import QUERY, value_of
from linkwright.core.arm.actuators import Actuator, read_actuators, shipped_actuators, user_actuators_path
from linkwright.core.catalogues import store
from linkwright.core.catalogues.materials import MATERIALS, find_entry
from linkwright.core.catalogues.stock_editor import STOCK, columns_of, row_of
from linkwright.core.materials.catalogue import load_layer, user_catalogue_path
from linkwright.core.sections.stock.tables import user_stock_path
from linkwright.core.units.prices import read_prices
from linkwright.core.units.quantities import InputError, format_quantity
from linkwright.core.units.reading import load_yaml, read_text

Row = dict[str, str]
"""A row's cells as text, `name` among them; `own` says whether it stands in the user's own file, `unconfirmed` what
nobody could find in its source."""


class CatalogueTable(ABC):
    """A catalogue, the shipped one with the user's own over it. Edits go to the latter; all raise `InputError`."""

    title = ""
    always: tuple[str, ...] = ("title",)
    """Columns that are there even where no entry has anything in them."""

    @property
    @abstractmethod
    def path(self) -> Path:
        """The user's own file."""

    @abstractmethod
    def columns(self, group: str) -> Sequence[str]:
        """The columns that can be edited."""

    def groups(self) -> Sequence[str]:
        """What the table is parted by, nothing by default."""
        return ()

    @abstractmethod
    def rows(self, group: str) -> list[Row]:
        """All entries of a group."""

    @abstractmethod
    def change(self, name: str, column: str, text: str, source: str) -> str:
        """Change a cell, an empty text takes the figure away; says what was done."""

    @abstractmethod
    def copy(self, name: str, new_name: str) -> str:
        """Put an entry into the user's own file under another name."""

    @abstractmethod
    def remove(self, name: str) -> str:
        """Take an entry out of the user's own file."""

    def doubts(self, name: str) -> list[str]:
        """What is hardly believable of an entry of the user's own."""
        del name
        return []

    def undo(self) -> str:
        """Take the last edit back."""
        return f"undone: {store.undo(self.path)}"


class MaterialsTable(CatalogueTable):
    """The materials."""

    title = "Materials"

    @property
    def path(self) -> Path:
        """The user's own catalogue."""
        return user_catalogue_path()

    def columns(self, group: str) -> Sequence[str]:
        """Every property."""
        del group
        return ("title", *QUERY.every)

    def rows(self, group: str) -> list[Row]:
        """A row for each material, its figures at 20 degC."""
        del group
        own = load_layer(self.path).materials if self.path.exists() else {}
        found: list[Row] = []
        for each in lw.materials.values():
            figures = {name: value_of(each.model, name).replace("–", "") for name in QUERY.every}
            is_own = "yes" if each.name in own else ""
            marks = {name: item.unconfirmed for name, item in each.model.properties.items() if item.unconfirmed}
            marks |= {"magnetic": each.model.magnetic_unconfirmed} if each.model.magnetic_unconfirmed else {}
            unconfirmed = "; ".join(f"{name.replace('_', ' ')}: {text}" for name, text in marks.items())
            row = {"name": each.name, "own": is_own, "title": each.model.title, **figures}
            found.append({**row, "unconfirmed": unconfirmed})
        return found

    def change(self, name: str, column: str, text: str, source: str) -> str:
        """Set or take away a property."""
        if not text.strip():
            return MATERIALS.remove_key(self.path, name, column)
        value = OWN.made(name, {column: text.strip()}, "").content[column]
        return MATERIALS.set_keys(self.path, name, {column: value}, source=source)

    def copy(self, name: str, new_name: str) -> str:
        """A material like another."""
        entry = find_entry(lw.materials.catalogue, name)
        return MATERIALS.add(self.path, [replace(entry, name=_named(new_name))])

    def remove(self, name: str) -> str:
        """The user's own."""
        return MATERIALS.remove(self.path, name)

    def doubts(self, name: str) -> list[str]:
        """What the command line questions."""
        return [each for each in OWN.doubts(self.path) if each.startswith(f"{name}:")]


class SectionsTable(CatalogueTable):
    """The stock sizes, by shape."""

    title = "Stock sizes"

    @property
    def path(self) -> Path:
        """The user's own tables."""
        return user_stock_path()

    def groups(self) -> Sequence[str]:
        """The shapes that there are sizes of."""
        return sorted({size.shape for size in lw.sections.values()})

    def columns(self, group: str) -> Sequence[str]:
        """The dimensions of a shape and the figures that a table may print."""
        return ("family", *columns_of(group))

    def rows(self, group: str) -> list[Row]:
        """A row for each size of a shape; dimensions in mm, printed figures in cm."""
        text = read_text(self.path) if self.path.exists() else ""
        own = {size.name for size in STOCK.check(text, self.path)} if text else set[str]()
        found: list[Row] = []
        for size in (each for each in lw.sections.values() if each.shape == group):
            row = row_of(size)
            cells = {column: f"{value:.12g}" for column, value in row.cells.items()}
            told = {"family": size.family, "unconfirmed": size.unconfirmed}
            found.append({"name": size.name, "own": "yes" if size.name in own else "", **told, **cells})
        return found

    def change(self, name: str, column: str, text: str, source: str) -> str:
        """Change a cell; a bare number is in the column's unit."""
        if not text.strip():
            return STOCK.remove_cell(self.path, name, column)
        unit = {"mm": "mm", "cm2": "cm^2", "cm4": "cm^4"}.get(column.rpartition("_")[2])
        told = f"{text.strip()} {unit}" if unit and _bare(text) else text.strip()
        return STOCK.change_cells(self.path, name, {column: told}, source=source)

    def copy(self, name: str, new_name: str) -> str:
        """A size like another."""
        return STOCK.add(self.path, [replace(row_of(lw.sections[name]), name=_named(new_name))])

    def remove(self, name: str) -> str:
        """The user's own."""
        return STOCK.remove(self.path, name)


class ActuatorsTable(CatalogueTable):
    """The actuators."""

    title = "Actuators"
    always = ("cost", "note")

    @property
    def path(self) -> Path:
        """The user's own file."""
        return user_actuators_path()

    def columns(self, group: str) -> Sequence[str]:
        """What an entry says, as a file has it."""
        del group
        return ("maker", "gear", "ratio", *_DRIVE, "note")

    def rows(self, group: str) -> list[Row]:
        """A row for each actuator."""
        del group
        keys = load_yaml(self.path) if self.path.exists() else None
        own = set[str]() if keys is None else {*read_actuators(keys), *read_prices(keys, "cost")}
        found: list[Row] = []
        for each in lw.actuators.values():
            ratio = "" if each.ratio is None else f"{each.ratio:.12g}"
            figures = {name: _drive_figure(each, name) for name in _DRIVE}
            row = {"maker": each.maker, "gear": each.gear, "ratio": ratio, **figures, "note": each.note}
            row["unconfirmed"] = "; ".join(f"{key.replace('_', ' ')}: {text}" for key, text in each.unconfirmed)
            found.append({"name": each.name, "own": "yes" if each.name in own else "", **row})
        return found

    def change(self, name: str, column: str, text: str, source: str) -> str:
        """Set or take away a figure; a price alone leaves a shipped entry where it is."""
        if column == "cost":
            return self._price(name, text.strip(), source)
        if not text.strip():
            return ACTUATORS.remove_key(self.path, name, column)
        return ACTUATORS.set_keys(self.path, name, {column: value_of_text(text.strip(), column)}, source=source)

    def _price(self, name: str, text: str, source: str) -> str:
        if not text:
            return ACTUATORS.remove_price(self.path, name)
        if not source:
            raise InputError("", "Source of your figures", "is empty; say where the price is from")
        price = {"value": text, "date": datetime.now(UTC).strftime("%Y-%m"), "source": source}
        return ACTUATORS.set_price(self.path, name, price, list(shipped_actuators()))

    def copy(self, name: str, new_name: str) -> str:
        """An actuator like another."""
        entry = ACTUATORS.entry(name, [self.path] if self.path.exists() else [])
        if entry is None:
            raise InputError("", "Entry", "is empty; choose the one to copy")
        return ACTUATORS.add(self.path, [replace(entry, name=_named(new_name))])

    def remove(self, name: str) -> str:
        """The user's own entry, or price."""
        own = read_actuators(load_yaml(self.path)) if self.path.exists() else {}
        if name in own or not self.path.exists():
            return ACTUATORS.remove(self.path, name)
        return ACTUATORS.remove_price(self.path, name)


_DRIVE: Mapping[str, str] = MappingProxyType(
    {
        "rated_torque": "torque",
        "peak_torque": "torque",
        "stiffness": "torsional_stiffness",
        "zone_torques": "torque",
        "backlash": "angle",
        "mass": "mass",
        "tilting_stiffness": "torsional_stiffness",
        "cost": "cost",
    }
)
"""The figures of an actuator and their kinds."""


def _drive_figure(each: Actuator, name: str) -> str:
    """A figure as a file has it; those of zones as a list."""
    kind = _DRIVE[name]
    if name in ("stiffness", "zone_torques"):
        zones = each.stiffnesses if name == "stiffness" else each.zone_torques
        written = [format_quantity(value, kind, digits=6) for value in zones]
        return f"[{', '.join(written)}]" if len(each.stiffnesses) > 1 else "".join(written)
    value: float | None = getattr(each, name)
    return "" if value is None else format_quantity(value, kind, "arcmin" if kind == "angle" else None, digits=6)


def _bare(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _named(name: str) -> str:
    if not name.strip():
        raise InputError("", "new name", "is empty; write how the copy shall be called")
    return name.strip()
