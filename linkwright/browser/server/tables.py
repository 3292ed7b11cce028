"""The catalogues as tables, and their edits: those of the command line, in the same files."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from types import MappingProxyType
from typing import Any

import linkwright as lw
from linkwright.commands.catalogues import actuators, materials, sections
from linkwright.commands.catalogues.materials import QUERY, value_of
from linkwright.commands.catalogues.user_catalogue import UserCatalogue, value_of_text
from linkwright.core.arm.actuators import Actuator, read_actuators, shipped_actuators
from linkwright.core.catalogues.stock_editor import STOCK, columns_of, row_of
from linkwright.core.materials.catalogue import load_layer
from linkwright.core.units.prices import read_prices
from linkwright.core.units.quantities import InputError, format_quantity
from linkwright.core.units.reading import load_yaml, read_text

Row = dict[str, str]
"""A row's cells as text, `name` among them; `own` says whether it stands in the user's file, `unconfirmed` what
nobody could find in its source."""


class CatalogueTable(ABC):
    """A catalogue, the shipped one with the user's over it. Edits go to the latter; all raise `InputError`."""

    title = ""
    always: tuple[str, ...] = ("title",)
    """Columns that are there even where no entry has anything in them."""
    kind: UserCatalogue
    """How the command line edits it."""

    @property
    def path(self) -> Path:
        """The user's file."""
        return self.kind.user_file()

    @property
    def there(self) -> Path | None:
        """That file, where there is one."""
        return self.path if self.path.exists() else None

    @abstractmethod
    def columns(self, group: str) -> Sequence[str]:
        """The columns that can be edited."""

    def groups(self) -> Sequence[str]:
        """What the table is parted by, nothing by default."""
        return ()

    def rows(self, group: str) -> list[Row]:
        """All entries of a group, as a file has their figures."""
        user_names = self.names() if self.there else frozenset[str]()
        cells = {name: self.cells(item, group) for name, item in self.kind.known(None).items()}
        return [
            {"name": name, "own": "yes" if name in user_names else "", **row}
            for name, row in cells.items()
            if row is not None
        ]

    @abstractmethod
    def names(self) -> frozenset[str]:
        """The names in the user's file, which is there."""

    @abstractmethod
    def cells(self, entry: Any, group: str) -> Row | None:
        """The cells of an entry; None where it is of another group."""

    def change(self, name: str, column: str, text: str, source: str) -> str:
        """Change a cell, an empty text takes the figure away; says what was done."""
        editor: Any = self.kind.editor
        if not text:
            return editor.remove_key(self.path, name, column)
        return editor.set_keys(self.path, name, {column: value_of_text(text, column)}, source=source)

    def copy(self, name: str, new_name: str) -> str:
        """Put an entry into the user's file under another name."""
        if not name:
            raise InputError("", "Entry", "is empty; choose the one to copy")
        if not new_name.strip():
            raise InputError("", "new name", "is empty; write how the copy shall be called")
        return self.kind.editor.add(self.path, [replace(self.kind.finder(None)(name), name=new_name.strip())])

    def remove(self, name: str) -> str:
        """Take an entry out of the user's file."""
        return self.kind.editor.remove(self.path, name)

    def doubts(self, name: str) -> list[str]:
        """What is hardly believable of an entry of the user's, as the command line questions it."""
        return [doubt for doubt in self.kind.doubts(self.path) if doubt.startswith(f"{name}:")]


class MaterialsTable(CatalogueTable):
    """The materials, their figures at 20 degC."""

    title = "Materials"
    kind = materials.CATALOGUE

    def columns(self, group: str) -> Sequence[str]:
        """Every property."""
        del group
        return ("title", *QUERY.every)

    def names(self) -> frozenset[str]:
        """Those of the user's catalogue."""
        return frozenset(load_layer(self.path).materials)

    def cells(self, entry: Any, group: str) -> Row | None:
        """Every property."""
        del group
        model = entry.model
        marks = {name: item.unconfirmed for name, item in model.properties.items()}
        marks["magnetic"] = model.magnetic_unconfirmed
        figures = {name: value_of(model, name).replace("–", "") for name in QUERY.every}
        return {"title": model.title, **figures, "unconfirmed": _marks(marks)}


class SectionsTable(CatalogueTable):
    """The stock sizes, by shape; dimensions in mm, printed figures in cm."""

    title = "Stock sizes"
    kind = sections.CATALOGUE

    def groups(self) -> Sequence[str]:
        """The shapes that there are sizes of."""
        return sorted({size.shape for size in lw.sections.values()})

    def columns(self, group: str) -> Sequence[str]:
        """The dimensions of a shape and the figures that a table may print."""
        return ("family", *columns_of(group))

    def names(self) -> frozenset[str]:
        """Those of the user's tables."""
        return frozenset(size.name for size in STOCK.check(read_text(self.path), self.path))

    def cells(self, entry: Any, group: str) -> Row | None:
        """A size's dimensions and figures."""
        if entry.shape != group:
            return None
        cells = {column: f"{value:.12g}" for column, value in row_of(entry).cells.items()}
        return {"family": entry.family, "unconfirmed": entry.unconfirmed, **cells}

    def change(self, name: str, column: str, text: str, source: str) -> str:
        """Change a cell; a bare number is in the column's unit."""
        if not text:
            return STOCK.remove_cell(self.path, name, column)
        unit = {"mm": "mm", "cm2": "cm^2", "cm4": "cm^4"}.get(column.rpartition("_")[2])
        text_with_unit = f"{text} {unit}" if unit and _bare(text) else text
        return STOCK.change_cells(self.path, name, {column: text_with_unit}, source=source)


class ActuatorsTable(CatalogueTable):
    """The actuators, as a file has what they say."""

    title = "Actuators"
    always = ("cost", "note")
    kind = actuators.CATALOGUE

    def columns(self, group: str) -> Sequence[str]:
        """What an entry says."""
        del group
        return ("maker", "gear", "ratio", *_DRIVE, "note")

    def names(self) -> frozenset[str]:
        """Those of the user's file, prices of shipped ones among them."""
        keys = load_yaml(self.path)
        return frozenset({*read_actuators(keys), *read_prices(keys, "cost")})

    def cells(self, entry: Any, group: str) -> Row | None:
        """What an entry says."""
        del group
        ratio = "" if entry.ratio is None else f"{entry.ratio:.12g}"
        figures = {name: _drive_figure(entry, name) for name in _DRIVE}
        row = {"maker": entry.maker, "gear": entry.gear, "ratio": ratio, **figures, "note": entry.note}
        return {**row, "unconfirmed": _marks(dict(entry.unconfirmed))}

    def change(self, name: str, column: str, text: str, source: str) -> str:
        """Set or take away a figure; a price alone leaves a shipped entry where it is."""
        if column != "cost":
            return super().change(name, column, text, source)
        if not text:
            return self.kind.editor.remove_price(self.path, name)
        if not source:
            raise InputError("", "Source of your figures", "is empty; say where the price is from")
        price = {"value": text, "date": datetime.now(UTC).strftime("%Y-%m"), "source": source}
        return self.kind.editor.set_price(self.path, name, price, list(shipped_actuators()))

    def remove(self, name: str) -> str:
        """The user's entry, or price."""
        if self.there and name not in read_actuators(load_yaml(self.path)):
            return self.kind.editor.remove_price(self.path, name)
        return super().remove(name)


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


def _drive_figure(actuator: Actuator, name: str) -> str:
    """A figure as a file has it; those of zones as a list."""
    kind = _DRIVE[name]
    if name in ("stiffness", "zone_torques"):
        zones = actuator.stiffnesses if name == "stiffness" else actuator.zone_torques
        written = [format_quantity(value, kind, digits=6) for value in zones]
        return f"[{', '.join(written)}]" if len(actuator.stiffnesses) > 1 else "".join(written)
    value: float | None = getattr(actuator, name)
    return "" if value is None else format_quantity(value, kind, "arcmin" if kind == "angle" else None, digits=6)


def _marks(marks: Mapping[str, str]) -> str:
    """What could not be found, figure by figure."""
    return "; ".join(f"{name.replace('_', ' ')}: {text}" for name, text in marks.items() if text)


def _bare(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
