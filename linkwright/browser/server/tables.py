"""The catalogues as tables, and their edits: those of the command line, in the same files."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import linkwright as lw
from catalogues import store
from catalogues.materials_as_text import find_entry
from catalogues.materials_editor import MATERIALS
from catalogues.stock_editor import STOCK, columns_of, row_of
from linkwright.commands.materials.edit import OWN
from linkwright.commands.materials.query import QUERY, value_of
from materials.catalogue import load_layer, user_catalogue_path
from sections.stock.tables import user_stock_path
from units.quantities import InputError
from units.reading import read_text

Row = dict[str, str]
"""A row's cells as text, `name` among them; `own` says whether it stands in the user's own file."""


class CatalogueTable(ABC):
    """A catalogue, the shipped one with the user's own over it. Edits go to the latter; all raise `InputError`."""

    title = ""

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
            found.append({"name": each.name, "own": is_own, "title": each.model.title, **figures})
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
            found.append({"name": size.name, "own": "yes" if size.name in own else "", "family": size.family, **cells})
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
