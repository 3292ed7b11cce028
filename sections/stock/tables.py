"""Standard sizes by name (`IPE 80`, `CHS 60.3x3.2`), each row checked against its dimensions when it is read.

A file of tables, shipped ones in ``sections/stock`` and the user's alike:

```yaml
format_version: 1
tables:
  - family: CHS
    shape: tube
    source: "EN 10210-2:2006, ..."
    columns: [name, diameter_mm, thickness_mm, area_cm2, second_moment_y_cm4]
    rows:
      - [CHS 60.3x3.2, 60.3, 3.2, 5.74, 23.5]
```

A table can say where its figures were found beside their source, in text that anybody can look up, and what was looked
for in vain, for all its rows or some:

```yaml
    found_in: "owner/repository, path/table.json"
    unconfirmed: "in no text that could be searched"        # or {CHS 60.3x3.2: "..."}
```

A column that ends in ``_mm`` or ``_in`` is a dimension of the shape. `area_cm2`, `second_moment_y_cm4` and
`second_moment_z_cm4` (`_in2`, `_in4`) are what the source prints; a table without them has computed figures only.

Rounding: a printed figure carries at least three significant digits (zeros at the end do not count beyond them),
and may differ from the recomputed one by 0.6 units of its last digit: half for its rounding, the rest for that
of the source's intermediate steps. Sizes in millimetres are nominal ones, and exact. Those in inches are rounded in
print too, and may each be off by half a unit of their last digit; what that makes of a figure it may differ by as
well. A row beyond that is refused.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

import numpy as np

from linkwright.core.sections.build import build
from linkwright.core.sections.section import Section, SectionError
from linkwright.core.sections.shapes import SHAPES
from linkwright.core.units.files import UserFile
from linkwright.core.units.names import meant, nearest
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.reading import parse_bundled_yaml, parse_yaml
from linkwright.core.units.reading import read_text as file_text

FORMAT_VERSION = 1
"""The version of the table format that this code reads."""

USER_STOCK = UserFile("LINKWRIGHT_SECTIONS", "sections.yaml")
"""The user's tables."""

_LARGEST = 1e9
"""No figure of a table is larger."""

INCH = 0.0254
"""m."""

LENGTHS = MappingProxyType({"_mm": 1e-3, "_in": INCH})
"""How columns of dimensions end, and what one of their units is in SI."""

PRINTED = MappingProxyType(
    {
        "area_cm2": ("area", 1e4),
        "second_moment_y_cm4": ("second_moment_y", 1e8),
        "second_moment_z_cm4": ("second_moment_z", 1e8),
        "area_in2": ("area", INCH**-2),
        "second_moment_y_in4": ("second_moment_y", INCH**-4),
        "second_moment_z_in4": ("second_moment_z", INCH**-4),
    }
)
"""Columns of printed figures: the property that each is compared with, and how many of its units make one in SI."""

ROUNDING = 0.6
"""How far a printed figure may be from the recomputed one, in units of its last digit."""

LEAST_DIGITS = 3
"""Significant digits that a printed figure carries at least."""


@dataclass(frozen=True)
class StockSize:
    """A standard size.

    Attributes:
        name: as in its table, `IPE 80`.
        family: `IPE`.
        shape: name of the shape.
        dimensions: by name, m.
        cells: what its row holds beside the name, by column (`height_mm`, `area_cm2`), in the column's unit.
        source: the standard.
        file: where the row stands.
        found_in: the text that anybody can look up in which the row was found, empty where nobody looked.
        unconfirmed: what was looked for in vain where nobody could find the size in its source, else empty.
    """

    name: str
    family: str
    shape: str
    dimensions: Mapping[str, float]
    cells: Mapping[str, float]
    source: str
    file: str
    found_in: str = ""
    unconfirmed: str = ""

    @cached_property
    def printed(self) -> Mapping[str, float]:
        """What the source prints, by column (`area_cm2`, `area_in2`); empty where A and I are computed only."""
        return MappingProxyType({column: value for column, value in self.cells.items() if column in PRINTED})

    @cached_property
    def section(self) -> Section:
        """The section of this size."""
        return build(self.shape, self.dimensions)


@dataclass(frozen=True)
class Stock:
    """Standard sizes; of two with the same name the later one counts.

    Attributes:
        sizes: in the order of their tables, each name once.
    """

    sizes: tuple[StockSize, ...]

    def __iter__(self) -> Iterator[StockSize]:
        """Iterate over the sizes."""
        return iter(self.sizes)

    def __len__(self) -> int:
        """Count the sizes."""
        return len(self.sizes)

    @cached_property
    def _by_key(self) -> Mapping[str, StockSize]:
        return MappingProxyType({plain_name(size.name): size for size in self.sizes})

    @property
    def families(self) -> tuple[str, ...]:
        """The families, in order."""
        return tuple(dict.fromkeys(size.family for size in self.sizes))

    def of_family(self, family: str) -> tuple[StockSize, ...]:
        """The sizes of a family, whatever its case and spaces; raises InputError for one that there is not."""
        wanted = plain_name(family)
        results = tuple(size for size in self.sizes if plain_name(size.family) == wanted)
        if not results:
            raise InputError("", "family", f"there is no family {family!r}; known: {', '.join(self.families)}")
        return results

    def find(self, name: str, *, file: object = "", key: str = "section") -> StockSize:
        """The size of this name, whatever its case and spaces; raises InputError for file and key with the nearest."""
        result = self._by_key.get(plain_name(name))
        if result is None:
            raise InputError(file, key, f"there is no stock size {name!r}{self._nearest(name)}")
        return result

    def _nearest(self, name: str) -> str:
        near = meant(plain_name(name), self._by_key)
        if near is None:
            return f"; families: {', '.join(self.families)}"
        return f"; did you mean '{self._by_key[near].name}'?"


def plain_name(name: str) -> str:
    """A size's name reduced to what counts: ``IPE 80`` and ``ipe80``, ``SHS 50 x 3,0`` and ``SHS 50x50x3``."""
    text = re.sub(r"[\s_-]+", "", name.casefold()).replace("×", "x").replace("*", "x").replace(",", ".")
    text = text.replace("aluminium", "alu").replace("aluminum", "alu")
    text = re.sub(r"\d+(?:\.\d+)?", lambda number: f"{float(number[0]):g}", text)
    text = re.sub(r"^he(\d+)([abm])$", r"he\2\1", text)
    return re.sub(r"^((?:hf)?shs)([\d.]+)x\2x", r"\1\2x", text)


def load_stock(paths: Sequence[Path | str] = (), *, user: bool = True) -> Stock:
    """The shipped sizes, over them the user's own (where the file exists and ``user`` is true), over that ``paths``.

    A file named by the environment variable or in ``paths`` must exist. Raises InputError, one line.
    """
    entries = [read_file(path) for path in USER_STOCK.over(paths, user=user)]
    return _stock([shipped_sizes(), *entries]) if entries else _shipped_stock()


@lru_cache(maxsize=1)
def _shipped_stock() -> Stock:
    return _stock([shipped_sizes()])


def _stock(layers: Sequence[Sequence[StockSize]]) -> Stock:
    sizes: dict[str, StockSize] = {}
    for layer in layers:
        for size in layer:
            sizes[plain_name(size.name)] = size
    return Stock(tuple(sizes.values()))


@lru_cache(maxsize=1)
def shipped_sizes() -> tuple[StockSize, ...]:
    """The sizes that come with the program, read from its package data and checked."""
    folder = files("linkwright.core.sections").joinpath("stock")
    sizes: list[StockSize] = []
    for item in sorted(folder.iterdir(), key=lambda entry: entry.name):
        if item.name.endswith(".yaml"):
            content = parse_bundled_yaml(item.read_text(encoding="utf-8"))
            sizes.extend(_read_content(content, f"stock/{item.name}"))
    return tuple(sizes)


def read_file(path: Path | str) -> tuple[StockSize, ...]:
    """The checked sizes of a file; raises InputError, one line that names the file."""
    return read_text(file_text(path), str(path))


def read_text(text: str, file: str) -> tuple[StockSize, ...]:
    """The checked sizes that a file's text holds; raises InputError, one line that names the file."""
    try:
        content: Any = parse_yaml(text, file=file)
    except InputError as error:
        raise InputError(file, "", f"is not YAML: {error.message}") from None
    return _read_content(content, file)


def _read_content(content: Any, file: str) -> tuple[StockSize, ...]:
    if not isinstance(content, dict) or not isinstance(content.get("tables"), list):
        raise _wrong(file, "needs format_version and tables, a list")
    version = content.get("format_version")
    if isinstance(version, bool) or version != FORMAT_VERSION:
        raise _wrong(file, f"format_version {shown(version)} is not known here; this program reads {FORMAT_VERSION}")
    sizes: list[StockSize] = []
    for number, table in enumerate(cast(list[Any], content["tables"]), start=1):
        sizes.extend(_read_table(table, f"{file}: tables[{number}]"))
    seen: set[str] = set()
    for size in sizes:
        if plain_name(size.name) in seen:
            raise _wrong(file, f"{size.name} stands there twice")
        seen.add(plain_name(size.name))
    return tuple(sizes)


def _wrong(where: str, message: str) -> InputError:
    return InputError(where, "", message)


def _head(table: Any, where: str) -> tuple[str, str, str, list[str], list[Any]]:
    """The family, shape, source, columns and rows of a table."""
    needed, more = ("family", "shape", "source", "columns", "rows"), ("found_in", "unconfirmed")
    if not isinstance(table, dict) or not set(needed) <= set(table) <= {*needed, *more}:
        raise _wrong(where, f"needs {', '.join(needed)}, may have {' and '.join(more)}, and nothing else")
    family, shape, source, columns, rows = (table[key] for key in needed)
    if not all(isinstance(value, str) and value.strip() for value in (family, shape, source)):
        raise _wrong(where, "family, shape and source are text")
    kind = SHAPES.get(shape)
    if kind is None:
        raise _wrong(where, f"there is no shape {shown(shape)}{nearest(shape, SHAPES)}")
    known = {"name", *columns_of(shape)}
    listed = isinstance(columns, list) and all(isinstance(column, str) for column in columns)
    if not listed or "name" not in columns or len(set(columns)) != len(columns):
        raise _wrong(where, "columns is a list without repeats, one of which is name")
    for column in columns:
        if column not in known:
            raise _wrong(where, f"a {shape} has no column {shown(column)}{nearest(str(column), sorted(known))}")
    if not isinstance(rows, list) or not rows:
        raise _wrong(where, "rows is a list of at least one row")
    return family, shape, source, columns, cast(list[Any], rows)


def _read_table(table: Any, where: str) -> list[StockSize]:
    family, shape, source, columns, rows = _head(table, where)
    sizes = [_read_row(row, columns, family, shape, source, where) for row in rows]
    dimensions = {name: np.array([size.dimensions[name] for size in sizes]) for name in sizes[0].dimensions}
    _check_buildable(sizes, shape, dimensions, where)
    _check_printed(sizes, shape, dimensions, where)
    return _provenance(sizes, table, where)


def _provenance(sizes: list[StockSize], table: Mapping[str, Any], where: str) -> list[StockSize]:
    """The sizes with what their table says of where they were found, and of those that nobody could find."""
    found_in = table.get("found_in", "")
    marks = table.get("unconfirmed", "")
    if not isinstance(found_in, str):
        raise _wrong(where, "found_in is text")
    if isinstance(marks, str):
        marks = dict.fromkeys((size.name for size in sizes), marks)
    if not isinstance(marks, dict) or not all(isinstance(text, str) for text in cast(dict[Any, Any], marks).values()):
        raise _wrong(where, "unconfirmed is text, or a size's name and text for each")
    marks = cast(dict[str, str], marks)
    for name in set(marks) - {size.name for size in sizes}:
        raise _wrong(where, f"unconfirmed: {shown(name)} is not in the table")
    return [replace(size, found_in=found_in, unconfirmed=marks.get(size.name, "")) for size in sizes]


def _read_row(row: Any, columns: list[str], family: str, shape: str, source: str, where: str) -> StockSize:
    if not isinstance(row, list) or len(row) != len(columns):
        raise _wrong(where, f"a row has {len(columns)} entries, unlike {shown(row)}")
    entries = dict(zip(columns, row, strict=True))
    name = entries.pop("name")
    if not isinstance(name, str) or not name.strip():
        raise _wrong(where, f"{shown(name)} cannot be a size's name")
    for column, value in entries.items():
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not number or not 0.0 < value <= _LARGEST:
            raise _wrong(where, f"{name}: {column} must be a positive number, not {shown(value)}")
    dimensions: dict[str, float] = {}
    for column, value in entries.items():
        if (result := dimension_of(column)) is not None:
            if result in dimensions:
                raise _wrong(where, f"{result} stands there in mm and in inches")
            dimensions[result] = float(f"{value * LENGTHS[column[-3:]]:.12g}")
    cells = MappingProxyType(entries)
    return StockSize(name, family, shape, MappingProxyType(dimensions), cells, source, where.split(": tables")[0])


def dimension_of(column: str) -> str | None:
    """The dimension that a column holds; None for a printed figure."""
    return column[:-3] if column[-3:] in LENGTHS else None


def columns_of(shape: str) -> tuple[str, ...]:
    """The columns that a table of a shape can have beside `name`: each dimension in mm, each in inches, then the
    printed figures."""
    named = [dimension.name for dimension in SHAPES[shape].dimensions if dimension.kind != "points"]
    return (*(f"{name}{ending}" for ending in LENGTHS for name in named), *PRINTED)


_Columns = Mapping[str, np.ndarray[Any, np.dtype[np.float64]]]
"""The dimensions of all rows by name: one pass through the formulas for the whole table."""


def _check_buildable(sizes: list[StockSize], shape: str, columns: _Columns, where: str) -> None:
    try:
        build(shape, columns)
    except SectionError:
        for size in sizes:
            try:
                build(shape, size.dimensions)
            except SectionError as error:
                raise _wrong(where, f"{size.name}: {error}") from None


def _check_printed(sizes: list[StockSize], shape: str, columns: _Columns, where: str) -> None:
    """Refuse a row whose printed figures are not those of its dimensions."""
    if not sizes[0].printed:
        return
    with np.errstate(all="ignore"):  # what is no number is refused below, row by row
        kind = SHAPES[shape]
        properties = kind(**columns).properties(0.3)
        rounded = [kind(**varied).properties(0.3) for varied in _within_rounding(sizes, columns)]
    for column, (name, factor) in PRINTED.items():
        if column not in sizes[0].printed:
            continue
        computed = np.broadcast_to(getattr(properties, name) * factor, len(sizes))
        slack = sum((np.abs(getattr(item, name) * factor - computed) for item in rounded), np.zeros(len(sizes)))
        for size, value, by_sizes in zip(sizes, computed, slack, strict=True):
            allowed = ROUNDING * last_unit(size.printed[column]) + float(by_sizes)
            if not abs(size.printed[column] - float(value)) <= allowed:
                given = f"{float(value):.4g}" if math.isfinite(value) else "none"
                raise _wrong(where, f"{size.name}: {column} is {size.printed[column]:g}, its dimensions give {given}")


def _within_rounding(sizes: list[StockSize], columns: _Columns) -> Iterator[_Columns]:
    """The dimensions with one of those in inches, which are rounded in print, half a unit of its last digit up."""
    for column in sizes[0].cells:
        if column.endswith("_in"):
            half = np.array([0.5 * INCH * last_unit(size.cells[column]) for size in sizes])
            name = column.removesuffix("_in")
            yield {**columns, name: columns[name] + half}


def last_unit(printed: float) -> float:
    """One unit of the last digit that a printed figure carries."""
    mantissa = (repr(printed) if isinstance(printed, float) else str(printed)).partition("e")[0]
    whole, _, decimals = mantissa.partition(".")
    digits = whole + decimals.rstrip("0")
    carried = len(digits.lstrip("0").rstrip("0"))
    power = math.floor(math.log10(abs(printed)))
    return 10.0 ** (power + 1 - max(carried, LEAST_DIGITS))
