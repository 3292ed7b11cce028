"""Edits of a file of stock sizes: each is checked as the whole file would be on load, and lands whole or not at all.

Checked means recomputed: a row whose printed A or I is not that of its dimensions does not land (`sections.stock`).
Comments, order and layout around an edit stay (`materials.yaml_text`); locking, atomic replacement and undo are in
`materials.store`. The shipped tables are never written: changing one of their sizes copies it into the file, where it
hides the shipped one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

from materials.edit import edit_yaml, land_yaml
from materials.quantities import InputError, read_quantity
from materials.reading import nearest
from materials.reading import read_text as text_of
from materials.yaml_text import YamlText
from sections import SHAPES, SectionError, StockSize
from sections.stock import FORMAT_VERSION, PRINTED, plain_name, read_text, shipped_sizes

NEW_FILE = f"format_version: {FORMAT_VERSION}\ntables: []\n"
"""What a file of stock sizes begins as."""

_UNITS = MappingProxyType({"mm": ("length", 1e3), "cm2": ("area", 1e4), "cm4": ("second_moment_of_area", 1e8)})


@dataclass(frozen=True)
class Row:
    """A stock size as a file writes it.

    Attributes:
        name: `CHS 60.3x3.2`.
        family: of its table.
        shape: of its table.
        source: of its table.
        cells: numbers by column: dimensions in mm (`diameter_mm`), printed figures (`area_cm2`).
    """

    name: str
    family: str
    shape: str
    source: str
    cells: Mapping[str, float]

    @property
    def entry(self) -> list[Any]:
        """The row's entries, its name first."""
        return [self.name, *self.cells.values()]


def row_of(size: StockSize) -> Row:
    """The row that a size was read from."""
    cells = {f"{name}_mm": neat(1e3 * value) for name, value in size.dimensions.items()}
    return Row(size.name, size.family, size.shape, size.source, {**cells, **size.printed})


def neat(value: float) -> float:
    """A number without the noise of a change of units, whole ones as integers."""
    rounded = float(f"{value:.12g}")
    return int(rounded) if rounded.is_integer() else rounded


def columns_of(shape: str) -> tuple[str, ...]:
    """The columns that a table of this shape can have beside `name`. Raises `InputError` for no such shape."""
    if shape not in SHAPES:
        raise InputError("", "shape", f"there is no shape '{shape}'{nearest(shape, list(SHAPES))}")
    dimensions = [each.name for each in SHAPES[shape].dimensions if each.kind != "points"]
    return (*(f"{name}_mm" for name in dimensions), *PRINTED)


def column_of(shape: str, key: str) -> str:
    """The column of a dimension or printed figure: `thickness` or `thickness_mm`, `area` or `area_cm2`."""
    columns = columns_of(shape)
    plain = {column.rpartition("_")[0]: column for column in columns}
    if key in columns:
        return key
    if key not in plain:
        raise InputError("", key, f"is nothing that a {shape} has{nearest(key, list(plain))}")
    return plain[key]


def cell(shape: str, key: str, text: str) -> tuple[str, float]:
    """The column and the number that `key` and a value with its unit (`60.3 mm`, `5.74 cm^2`) mean.

    Raises `InputError`.
    """
    column = column_of(shape, key)
    kind, factor = _UNITS[column.rpartition("_")[2]]
    return column, neat(factor * read_quantity(text, kind, file="", key=key))


# ---- edits


def add(path: Path | str, rows: Sequence[Row], *, replaced: bool = False) -> str:
    """Add sizes to the file at `path`, all of them or none; the file is made where it is not there.

    Raises `InputError` where a name is taken (unless `replaced`) or a row is not sound.
    """

    def change(document: YamlText) -> str:
        names = [plain_name(row.name) for row in rows]
        fresh: list[Row] = []
        for row in rows:
            if names.count(plain_name(row.name)) > 1:
                raise InputError(path, row.name, "comes twice")
            taken = _find(document, row.name)
            if taken is None:
                fresh.append(row)
            elif replaced:
                _put(document, row, taken)
            else:
                raise InputError(path, row.name, "is there already; edit it, use another name, or replace it")
        _put_new(document, fresh)
        return f"added {', '.join(row.name for row in rows)}"

    return _edit(path, change)


def change_cells(path: Path | str, name: str, changes: Mapping[str, str], *, source: str = "") -> str:
    """Change dimensions, printed figures, `family` or `source` of one size; returns what was done.

    A shipped size is copied into the file first. Raises `InputError`.
    """

    def change(document: YamlText) -> str:
        row, at = _row(document, path, name)
        texts = {key: value for key, value in changes.items() if key in ("family", "source")}
        if "shape" in changes:
            raise InputError(path, "shape", "cannot be changed: a size of another shape is another size; add it")
        cells = dict(cell(row.shape, key, value) for key, value in changes.items() if key not in texts)
        new = replace(row, cells={**row.cells, **cells}, **({"source": source} if source else {}), **texts)
        _put(document, new, at)
        told = {**changes, **({"source": source} if source else {})}
        done = ", ".join(f"{key} = {value}" for key, value in told.items())
        return f"set {done} of {name}" + (", copied from the shipped tables" if at is None else "")

    return _edit(path, change)


def remove_cell(path: Path | str, name: str, key: str) -> str:
    """Take one optional dimension or printed figure of a size away. Raises `InputError`."""

    def change(document: YamlText) -> str:
        row, at = _row(document, path, name)
        column = column_of(row.shape, key)
        if column not in row.cells:
            raise InputError(path, key, f"{name} has none")
        _put(document, replace(row, cells={key: value for key, value in row.cells.items() if key != column}), at)
        return f"removed {key} of {name}"

    return _edit(path, change)


def remove(path: Path | str, name: str) -> str:
    """Take a size out of the file; returns what was done. Raises `InputError` where the file has it not."""

    def change(document: YamlText) -> str:
        _take_out(document, _required(document, path, name))
        return f"removed {name}"

    return _edit(path, change)


def rename(path: Path | str, name: str, new_name: str) -> str:
    """Give a size of the file another name. Raises `InputError` where it is taken or cannot be a name."""

    def change(document: YamlText) -> str:
        table, row = _required(document, path, name)
        taken = _find(document, new_name)
        if taken is not None and taken != (table, row):
            raise InputError(path, new_name, "is there already")
        column = cast(list[str], document.get(["tables", table, "columns"])).index("name")
        document.set(["tables", table, "rows", row, column], new_name)
        return f"renamed {name} to {new_name}"

    return _edit(path, change)


def draft(path: Path | str, name: str) -> tuple[str | None, str]:
    """The file's text (None where there is no file) and the text to hand to an editor, which has the size in any case.

    Raises `InputError`.
    """
    before = text_of(path) if Path(path).exists() else None
    document = YamlText(before if before is not None and before.strip() else NEW_FILE, file=path)
    check(document.text, path)
    row, at = _row(document, path, name)
    if at is None:
        _put(document, row, None)
    return before, document.text


def land(path: Path | str, before: str | None, text: str) -> str:
    """Put an edited text in place of the file, checked; returns what was done. Raises `InputError`."""
    return land_yaml(path, before, text, check=lambda changed: check(changed, path))


def check(text: str, path: Path | str) -> tuple[StockSize, ...]:
    """The sizes of a text that is to stand in a file, each recomputed. Raises `InputError`."""
    try:
        return read_text(text, str(path))
    except SectionError as error:
        raise InputError("", "", error.message) from None


def rows_text(rows: Iterable[Row]) -> str:
    """The rows as the text of a file of their own."""
    document = YamlText(NEW_FILE, file="")
    document.append(["tables"], *_tables(rows))
    return document.text


def _edit(path: Path | str, change: Callable[[YamlText], str]) -> str:
    def sound_first(document: YamlText) -> str:
        check(document.text, path)
        return change(document)

    return edit_yaml(path, sound_first, new_file=NEW_FILE, check=lambda text: check(text, path))


def _find(document: YamlText, name: str) -> tuple[int, int] | None:
    """The numbers of the table and of the row of a size."""
    for number, table in enumerate(cast(list[dict[str, Any]], document.get(["tables"]))):
        column = table["columns"].index("name")
        for index, row in enumerate(table["rows"]):
            if plain_name(row[column]) == plain_name(name):
                return number, index
    return None


def _row(document: YamlText, path: Path | str, name: str) -> tuple[Row, tuple[int, int] | None]:
    """A size of the file and where it stands, or one of the shipped tables and None."""
    at = _find(document, name)
    if at is not None:
        table = cast(dict[str, Any], document.get(["tables", at[0]]))
        cells = dict(zip(table["columns"], table["rows"][at[1]], strict=True))
        return Row(cells.pop("name"), table["family"], table["shape"], table["source"], cells), at
    shipped = next((size for size in shipped_sizes() if plain_name(size.name) == plain_name(name)), None)
    if shipped is None:
        raise _missing(document, path, name)
    return row_of(shipped), None


def _required(document: YamlText, path: Path | str, name: str) -> tuple[int, int]:
    at = _find(document, name)
    if at is not None:
        return at
    raise _missing(document, path, name)


def _missing(document: YamlText, path: Path | str, name: str) -> InputError:
    if any(plain_name(size.name) == plain_name(name) for size in shipped_sizes()):
        return InputError(path, name, "is not in this file but shipped with the program, and stays there")
    tables = cast(list[dict[str, Any]], document.get(["tables"]))
    known = [row[table["columns"].index("name")] for table in tables for row in table["rows"]]
    return InputError(path, name, f"there is no such size in this file{nearest(name, known)}")


def _put(document: YamlText, row: Row, at: tuple[int, int] | None) -> None:
    """Write a row where it stands, or else into a table that it fits in, a new one if need be."""
    if at is not None and _fits(document, at[0], row):
        _put_cells(document, at, row)
        return
    if at is not None and len(cast(list[Any], document.get(["tables", at[0], "rows"]))) == 1:
        _put_table(document, at[0], row)
        return
    if at is not None:
        _take_out(document, at)
    _put_new(document, [row])


def _put_new(document: YamlText, rows: Iterable[Row]) -> None:
    """Write rows that stand nowhere yet: at the end of the tables that they fit in, else in new tables."""
    count = len(cast(list[Any], document.get(["tables"])))
    known: dict[int, list[list[Any]]] = {}
    rest: list[Row] = []
    for row in rows:
        number = next((number for number in range(count) if _fits(document, number, row)), None)
        if number is None:
            rest.append(row)
        else:
            columns = cast(list[str], document.get(["tables", number, "columns"]))
            known.setdefault(number, []).append([_cells(row)[column] for column in columns])
    for number, entries in known.items():
        document.append(["tables", number, "rows"], *entries)
    document.append(["tables"], *_tables(rest))


def _tables(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """The rows as tables, those of one head together."""
    tables: dict[tuple[Any, ...], dict[str, Any]] = {}
    for row in rows:
        head = {"family": row.family, "shape": row.shape, "source": row.source, "columns": ["name", *row.cells]}
        key = (row.family, row.shape, row.source, tuple(row.cells))
        tables.setdefault(key, {**head, "rows": []})["rows"].append(row.entry)
    return list(tables.values())


def _put_cells(document: YamlText, at: tuple[int, int], row: Row) -> None:
    place = ["tables", at[0], "rows", at[1]]
    for index, column in enumerate(cast(list[str], document.get(["tables", at[0], "columns"]))):
        if document.get([*place, index]) != _cells(row)[column]:
            document.set([*place, index], _cells(row)[column])


def _put_table(document: YamlText, number: int, row: Row) -> None:
    """Make the one row of a table another one, with its head."""
    place = ["tables", number]
    for key, value in (("family", row.family), ("shape", row.shape), ("source", row.source)):
        if document.get([*place, key]) != value:
            document.set([*place, key], value)
    if set(cast(list[str], document.get([*place, "columns"]))) != set(_cells(row)):
        document.set([*place, "columns"], ["name", *row.cells])
        document.set([*place, "rows", 0], row.entry)
    else:
        _put_cells(document, (number, 0), row)


def _take_out(document: YamlText, at: tuple[int, int]) -> None:
    table, row = at
    alone = len(cast(list[Any], document.get(["tables", table, "rows"]))) == 1
    document.remove(["tables", table] if alone else ["tables", table, "rows", row])


def _fits(document: YamlText, number: int, row: Row) -> bool:
    table = cast(dict[str, Any], document.get(["tables", number]))
    head = (table["family"], table["shape"], table["source"], set(table["columns"]))
    return head == (row.family, row.shape, row.source, set(_cells(row)))


def _cells(row: Row) -> dict[str, Any]:
    return {"name": row.name, **row.cells}

