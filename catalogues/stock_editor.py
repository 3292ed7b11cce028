"""Edits of a file of stock sizes (`catalogues.editor`), each of which stands as a row of a table.

Checked means recomputed: a row whose printed A or I is not that of its dimensions does not land
(`sections.stock.tables`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

from linkwright.core.catalogues.editor import Editor, Place
from linkwright.core.catalogues.yaml_edit import YamlText
from linkwright.core.sections import SHAPES, StockSize
from linkwright.core.sections.stock import tables
from linkwright.core.sections.stock.tables import (
    FORMAT_VERSION,
    INCH,
    dimension_of,
    plain_name,
    read_text,
    shipped_sizes,
)
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, read_quantity

NEW_FILE = f"format_version: {FORMAT_VERSION}\ntables: []\n"
"""What a file of stock sizes begins as."""

_UNITS = MappingProxyType(
    {
        "mm": ("length", 1e3),
        "in": ("length", 1.0 / INCH),
        "cm2": ("area", 1e4),
        "in2": ("area", INCH**-2),
        "cm4": ("second_moment_of_area", 1e8),
        "in4": ("second_moment_of_area", INCH**-4),
    }
)
"""How columns end: the kind of quantity, and how many of its units make one in SI."""


@dataclass(frozen=True)
class Row:
    """A stock size as a file writes it.

    Attributes:
        name: `CHS 60.3x3.2`.
        family: of its table.
        shape: of its table.
        source: of its table.
        cells: numbers by column: dimensions (`diameter_mm`, `diameter_in`), printed figures (`area_cm2`, `area_in2`).
        found_in: the text in which it was found, empty where none is given.
        unconfirmed: what was looked for in vain where nobody could find it in its source, else empty.
    """

    name: str
    family: str
    shape: str
    source: str
    cells: Mapping[str, float]
    found_in: str = ""
    unconfirmed: str = ""

    @property
    def entry(self) -> list[Any]:
        """The row's entries, its name first."""
        return [self.name, *self.cells.values()]


def row_of(size: StockSize) -> Row:
    """The row that a size was read from."""
    dimensions = {column: neat(value) for column, value in size.cells.items() if dimension_of(column)}
    marks = ("" if size.unconfirmed else size.found_in, size.unconfirmed)
    return Row(size.name, size.family, size.shape, size.source, {**dimensions, **size.printed}, *marks)


def neat(value: float) -> float:
    """A number without the noise of a change of units, whole ones as integers."""
    rounded = float(f"{value:.12g}")
    return int(rounded) if rounded.is_integer() else rounded


def columns_of(shape: str) -> tuple[str, ...]:
    """The columns that a table of this shape can have beside `name`. Raises `InputError` for no such shape."""
    if shape not in SHAPES:
        raise InputError("", "shape", f"there is no shape '{shape}'{nearest(shape, SHAPES)}")
    return tables.columns_of(shape)


def column_of(shape: str, key: str, cells: Iterable[str] = ()) -> str:
    """The column of a dimension or printed figure: `thickness` or `thickness_mm`, `area` or `area_cm2`; of the `cells`
    of a row where these have it, else a metric one."""
    columns = columns_of(shape)
    plain = {column.rpartition("_")[0]: column for column in (*reversed(columns), *cells)}
    if key in columns:
        return key
    if key not in plain:
        raise InputError("", key, f"is nothing that a {shape} has{nearest(key, list(plain))}")
    return plain[key]


def cell(shape: str, key: str, text: str, cells: Iterable[str] = ()) -> tuple[str, float]:
    """The column and the number that `key` and a value with its unit (`60.3 mm`, `5.74 cm^2`) mean in a row that has
    these `cells`.

    Raises `InputError`.
    """
    column = column_of(shape, key, cells)
    kind, factor = _UNITS[column.rpartition("_")[2]]
    return column, neat(factor * read_quantity(text, kind, file="", key=key))


class StockEditor(Editor[Row]):
    """Edits of a file of stock sizes."""

    what = "size"
    new_file = NEW_FILE

    def check(self, text: str, path: Path | str) -> tuple[StockSize, ...]:
        """The sizes of a text that is to stand in a file, each recomputed."""
        return read_text(text, str(path))

    def document(self, text: str | None, path: Path | str) -> YamlText:
        """A sound one, whose tables can be walked."""
        document = super().document(text, path)
        self.check(document.text, path)
        return document

    def plain(self, name: str) -> str:
        """Without case and blanks."""
        return plain_name(name)

    def names(self, document: YamlText) -> list[str]:
        """The sizes of all tables."""
        return [row[_name_column(table)] for table in _tables_of(document) for row in table["rows"]]

    def find(self, document: YamlText, name: str) -> Place | None:
        """Its row."""
        for number, table in enumerate(_tables_of(document)):
            for index, row in enumerate(table["rows"]):
                if plain_name(row[_name_column(table)]) == plain_name(name):
                    return ["tables", number, "rows", index]
        return None

    def shipped(self, name: str) -> Row | None:
        """The row that a shipped size was read from."""
        matches = (size for size in shipped_sizes() if plain_name(size.name) == plain_name(name))
        return next((row_of(size) for size in matches), None)

    def put(self, document: YamlText, entries: Sequence[Row]) -> None:
        """Each where one of its name stands, the others at the end of the tables that they fit in, or in new ones."""
        fresh = [row for row in entries if not self._put_over(document, row)]
        count = len(_tables_of(document))
        known: dict[int, list[list[Any]]] = {}
        rest: list[Row] = []
        for row in fresh:
            number = next((number for number in range(count) if _fits(document, number, row)), None)
            if number is None:
                rest.append(row)
            else:
                columns = _tables_of(document)[number]["columns"]
                known.setdefault(number, []).append([_cells(row)[column] for column in columns])
        for number, rows in known.items():
            document.append(["tables", number, "rows"], *rows)
        document.append(["tables"], *_tables(rest))

    def _put_over(self, document: YamlText, row: Row) -> bool:
        """Write a row where one of its name stands; tells whether it did, or the row has still to find its table."""
        place = self.find(document, row.name)
        if place is None:
            return False
        head, cells = place[:2], _cells(row)
        table = document.get(head)
        if not _fits(document, cast(int, place[1]), row):
            if len(table["rows"]) > 1:
                self.take_out(document, place)
                return False
            for key, value in (("family", row.family), ("shape", row.shape), ("source", row.source), *_marks_of(row)):
                if value and table.get(key) != value:
                    document.set([*head, key], value)
                elif not value and key in table:
                    document.remove([*head, key])
            if set(table["columns"]) != set(cells):
                document.set([*head, "columns"], list(cells))
                document.set(place, row.entry)
                return True
        for index, column in enumerate(document.get([*head, "columns"])):
            if document.get([*place, index]) != cells[column]:
                document.set([*place, index], cells[column])
        return True

    def take_out(self, document: YamlText, place: Place) -> None:
        """With its table where it is alone there, else with what the table says of it by name."""
        if len(document.get(place[:3])) == 1:
            document.remove(place[:2])
            return
        table = document.get(place[:2])
        name, marks = document.get(place)[_name_column(table)], table.get("unconfirmed")
        if isinstance(marks, dict) and name in marks:
            last = len(cast(dict[str, str], marks)) == 1
            document.remove([*place[:2], "unconfirmed", *([] if last else [name])])
        document.remove(place)

    def change_cells(self, path: Path | str, name: str, changes: Mapping[str, str], *, source: str = "") -> str:
        """Change dimensions, printed figures, `family` or `source` of one size."""

        def change(document: YamlText) -> str:
            copied = self.copy_shipped(document, path, name)
            row = self._row(document, path, name)
            texts = {key: value for key, value in changes.items() if key in ("family", "source")}
            if "shape" in changes:
                raise InputError(path, "shape", "cannot be changed: a size of another shape is another size; add it")
            cells = dict(cell(row.shape, key, value, row.cells) for key, value in changes.items() if key not in texts)
            given = {"source": source} if source else {}
            renewed = replace(row, found_in="", unconfirmed="" if {*given, *texts} & {"source"} else row.unconfirmed)
            self.put(document, [replace(renewed, cells={**row.cells, **cells}, **given, **texts)])
            done = ", ".join(f"{key} = {value}" for key, value in {**changes, **given}.items())
            return f"set {done} of {name}" + (", copied from the shipped tables" if copied else "")

        return self.edit(path, change)

    def remove_cell(self, path: Path | str, name: str, key: str) -> str:
        """Take one optional dimension or printed figure of a size away."""

        def change(document: YamlText) -> str:
            self.copy_shipped(document, path, name)
            row = self._row(document, path, name)
            column = column_of(row.shape, key, row.cells)
            if column not in row.cells:
                raise InputError(path, key, f"{name} has none")
            self.put(document, [replace(row, cells={k: value for k, value in row.cells.items() if k != column})])
            return f"removed {key} of {name}"

        return self.edit(path, change)

    def _row(self, document: YamlText, path: Path | str, name: str) -> Row:
        place = self.required(document, path, name)
        table = document.get(place[:2])
        cells = dict(zip(table["columns"], document.get(place), strict=True))
        return Row(
            cells.pop("name"), table["family"], table["shape"], table["source"], cells, *_provenance(table, name)
        )


STOCK = StockEditor()


def rows_text(rows: Iterable[Row]) -> str:
    """The rows as the text of a separate file."""
    document = YamlText(NEW_FILE, file="")
    document.append(["tables"], *_tables(rows))
    return document.text


def _tables_of(document: YamlText) -> list[dict[str, Any]]:
    return cast(list[dict[str, Any]], document.get(["tables"]))


def _name_column(table: Mapping[str, Any]) -> int:
    return table["columns"].index("name")


def _tables(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """The rows as tables, those of one head together."""
    tables: dict[tuple[Any, ...], dict[str, Any]] = {}
    for row in rows:
        head = {"family": row.family, "shape": row.shape, "source": row.source, "columns": ["name", *row.cells]}
        marks = {key: value for key, value in _marks_of(row) if value}
        key = (row.family, row.shape, row.source, tuple(row.cells), *marks.items())
        tables.setdefault(key, {**head, **marks, "rows": []})["rows"].append(row.entry)
    return list(tables.values())


def _fits(document: YamlText, number: int, row: Row) -> bool:
    table = _tables_of(document)[number]
    head = (table["family"], table["shape"], table["source"], set(table["columns"]), *_provenance(table, row.name))
    return head == (row.family, row.shape, row.source, set(_cells(row)), row.found_in, row.unconfirmed)


def _marks_of(row: Row) -> tuple[tuple[str, str], ...]:
    return (("found_in", row.found_in), ("unconfirmed", row.unconfirmed))


def _provenance(table: Mapping[str, Any], name: str) -> tuple[str, str]:
    """What a table says of the size of a name: where it was found, or what was looked for in vain."""
    marks: str | dict[str, str] = table.get("unconfirmed", "")
    unconfirmed = marks if isinstance(marks, str) else marks.get(name, "")
    return "" if unconfirmed else table.get("found_in", ""), unconfirmed


def _cells(row: Row) -> dict[str, Any]:
    return {"name": row.name, **row.cells}
