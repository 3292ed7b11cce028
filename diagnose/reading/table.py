"""A recording's file as a table of named columns, whatever its separator.

Text cells from CSV and Excel workbooks, values from parquet."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.recording import RejectedRow
from linkwright.core.sections.numeric import Array
from linkwright.core.units.files import read_bytes
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.reading import refusal

from .columns import looks_like_ours, otherwise_spelled

_SEPARATORS = (",", ";", "\t", "|")
_MARKS = ("#", "%")
_FEWEST_COLUMNS = 3
"""An arm with one joint has as many: q1, x and y."""
_MOST_TITLES = 30
_LOOKED_AT = 50
"""Rows that show how numbers are written."""
_UNIT_ALONE = re.compile(r"\s*[\[(]?(?:deg|°|rad|mm|m|s|ms|kg|N\*?m|A)[\])]?\s*", re.IGNORECASE)
_LINE = re.compile(r"[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+\Z")
"""A line with its end, whichever that is."""
_THOUSANDS = MappingProxyType(
    {
        ".": re.compile(r"[+-]?[0-9]{1,3}(?:,[0-9]{3})+\.[0-9]*"),
        ",": re.compile(r"[+-]?[0-9]{1,3}(?:\.[0-9]{3})+,[0-9]*"),
    }
)
_BINARY = MappingProxyType(
    {
        b"PK\x03\x04": "a zip file or an Excel workbook by another name (call it .xlsx)",
        b"\xd0\xcf\x11\xe0": "an old Excel workbook",
        b"\x1f\x8b": "compressed (gzip)",
        b"MATLAB": "a MATLAB file",
        b"\x89HDF": "an HDF5 or MATLAB file",
        b"\x93NUMPY": "a NumPy file",
        b"PAR1": "a parquet file by another name; call it .parquet",
        b"\xff\xfe": "UTF-16 text (`encoding: utf-16` in recording.yaml reads it)",
        b"\xfe\xff": "UTF-16 text (`encoding: utf-16` in recording.yaml reads it)",
    }
)
_SIDES = MappingProxyType(
    {
        **dict.fromkeys(("+", "p", "pos", "positive", "plus", "up", "forward", "fwd"), 1.0),
        **dict.fromkeys(("-", "\N{MINUS SIGN}", "n", "neg", "negative", "minus", "down", "backward", "bwd"), -1.0),
    }
)
_USUAL = ("utf-8", "utf8")


@dataclass(frozen=True)
class Layout:
    """How a text file is laid out. `skip_rows` lines stand before the header, lines that begin with `comment` count
    for nothing; without a `separator` the header tells it. An empty `decimal` or `encoding` is told by the file itself,
    and so are titles above the header. `names` are the columns' where the file has no header;
    `sheet` is the one of a workbook, `topics` those of a bag that count."""

    separator: str | None = None
    decimal: str = ""
    comment: str | None = None
    skip_rows: int = 0
    encoding: str = ""
    names: tuple[str, ...] = ()
    sheet: str = ""
    topics: tuple[str, ...] = ()


@dataclass(frozen=True)
class Table:
    """Columns by name, text or numbers; `row` is each row's number in the file: of text the line and of workbooks the
    row that an editor shows, of other files counted from 1.

    `ragged` names the rows that do not have a cell for each column; they are not among the others.
    """

    file: str
    columns: Mapping[str, tuple[str, ...] | Array]
    row: NDArray[np.int64]
    decimal: str = "."
    ragged: tuple[RejectedRow, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns in the order of the file."""
        return tuple(self.columns)

    def kept(self, keep: NDArray[np.bool_]) -> Table:
        """The rows that `keep` (N) marks."""
        chosen = np.flatnonzero(keep)
        columns = {
            name: cells[keep] if isinstance(cells, np.ndarray) else tuple(cells[k] for k in chosen)
            for name, cells in self.columns.items()
        }
        return replace(self, columns=MappingProxyType(columns), row=self.row[keep])

    def numbers(self, name: str) -> Array:
        """A column as numbers; nan where a cell holds none."""
        cells = self.columns[name]
        if isinstance(cells, np.ndarray):
            return cells
        return as_numbers(cells, self.decimal)

    def sides(self, name: str) -> Array:
        """A column as numbers, with signs and words for the two ways that a joint can come (`+`, `neg`) as 1 and -1."""
        sides = self.numbers(name)
        cells = self.columns[name]
        if isinstance(cells, np.ndarray):
            return sides
        words = (_SIDES.get(cell.strip().lower(), math.nan) for cell in cells)
        return np.where(np.isnan(sides), np.fromiter(words, dtype=float, count=len(cells)), sides)

    def text(self, name: str, index: int) -> str:
        """A cell as it stands in the file."""
        return str(self.columns[name][index]).strip()

    def fault(self, name: str, index: int) -> str | None:
        """What is wrong with a cell that should hold a number, None where it does."""
        text = self.text(name, index)
        value = as_number(text, self.decimal)
        if math.isfinite(value):
            return None
        if not text:
            return f"{name} is blank"
        if text.lower().lstrip("+-") in ("nan", "na", "n/a", "null", "none", "inf", "infinity", "-"):
            return f"{name} is {text}"
        return f"{name} is {shown(text, 30)}, not a number"


def as_number(cell: str, decimal: str = ".") -> float:
    """A cell's number, nan for anything else; 1.234,5 and 1,234.5 stand for one thousand and some."""
    cell = cell.replace("\N{MINUS SIGN}", "-")
    other = "." if decimal == "," else ","
    if other in cell:
        if _THOUSANDS[decimal].fullmatch(cell.strip()) is None:
            return math.nan
        cell = cell.replace(other, "")
    if decimal != ".":
        cell = cell.replace(decimal, ".")
    try:
        return float(cell) if "_" not in cell else math.nan
    except ValueError:
        return math.nan


def as_numbers(cells: Sequence[str], decimal: str = ".") -> Array:
    """The numbers of cells, nan where one holds none."""
    # Nearly all columns hold nothing but plain numbers.
    text = "".join(cells)
    if decimal == "." and not any(sign in text for sign in ",_\N{MINUS SIGN}"):
        with suppress(ValueError):
            return np.array(list(map(float, cells)))
    return np.array([as_number(cell, decimal) for cell in cells], dtype=float)


def file_text(path: Path, encoding: str) -> tuple[str, list[str]]:
    """The text of a file in an encoding, by default UTF-8 or what its bytes are; sentences where that is another.
    Raises `InputError`."""
    content = read_bytes(path)
    if not encoding:
        mark = next((item for item in (b"\xff\xfe", b"\xfe\xff") if content.startswith(item)), None)
        with suppress(UnicodeDecodeError):
            if mark is not None:
                return content.decode("utf-16"), [f"{path.name} is UTF-16 text."]
        _refuse_binary(path, content)
        try:
            return content.decode("utf-8-sig"), []
        except UnicodeDecodeError as error:
            warning = (
                f"{path.name} is not UTF-8 text (byte {error.start}) and was read as latin-1. `encoding:` says another."
            )
            return content.decode("latin-1"), [warning]
    if encoding.lower().replace("_", "-") in _USUAL:
        _refuse_binary(path, content)
        encoding = "utf-8-sig"
    try:
        return content.decode(encoding), []
    except LookupError:
        raise InputError(path, "encoding", f"there is no encoding {shown(encoding)}") from None
    except UnicodeDecodeError as error:
        raise InputError(path, "encoding", f"is not {encoding} text (byte {error.start})") from None
    except UnicodeError:
        raise InputError(path, "encoding", f"is not {encoding} text") from None


def text_table(path: Path, layout: Layout, text: str) -> Table:
    """The table that a text holds, laid out so. Raises `InputError`, one line, for anything else."""
    if "\0" in text:
        raise refusal(path, "", "is no plain text: it holds NUL bytes; is it UTF-16?", {"encoding": "utf-16"})
    notes: list[str] = []
    titles = 0 if layout.names else _titles(text, layout)
    layout = replace(layout, skip_rows=layout.skip_rows + titles)
    kept, first, named = _lines(path, text, layout)
    if not first:
        raise InputError(path, "", "is empty; it needs a header (time_s, q1_deg, .., x_mm, y_mm) and a row a reading")
    separator = layout.separator or named or _separator(first)
    rows, lines = _rows(path, kept, separator)
    decimal = layout.decimal or ("," if _decimal_commas(rows[1:]) else ".")
    if decimal == "," and not layout.decimal:
        notes.append("Numbers have decimal commas.")
    header, body, more = _headed(path, rows, layout, decimal)
    if titles:
        notes.insert(0, f"The header stands in line {lines[0]}. Lines above the header are not used.")
    lines = lines[len(rows) - len(body) :]
    header, body = _trimmed(header, body)
    good = [index for index, cells in enumerate(body) if len(cells) == len(header)]
    if not good:
        raise InputError(path, "", _no_row(header, body[0], lines[0], separator, layout))
    columns = {name: tuple(body[index][k] for index in good) for k, name in enumerate(header) if name}
    nameless = (f"Column {k} of {path.name} has no name and is not used." for k, n in enumerate(header, 1) if not n)
    return Table(
        str(path),
        MappingProxyType(columns),
        np.array(lines, dtype=np.int64)[good],
        decimal,
        tuple(_ragged(header, body, lines)),
        (*notes, *more, *nameless),
    )


def _rows(path: Path, lines: Iterator[tuple[int, str]], separator: str) -> tuple[list[list[str]], list[int]]:
    """The cells of each row, those that blanks part without any that is empty, and the line in which each begins."""
    numbers, rows, begins = list[int](), list[list[str]](), list[int]()

    def text() -> Iterator[str]:
        for number, line in lines:
            numbers.append(number)
            yield line

    reader = csv.reader(text(), delimiter=separator, skipinitialspace=True, strict=True)
    read = 0
    try:
        for cells in reader:
            rows.append([cell for cell in cells if cell] if separator == " " else cells)
            begins.append(numbers[read])
            read = reader.line_num  # a quoted cell may go over several lines
    except csv.Error as error:
        raise InputError(path, "", f"is no table: {error}") from None
    return rows, begins


def _headed(
    path: Path, rows: list[list[str]], layout: Layout, decimal: str
) -> tuple[list[str], list[list[str]], list[str]]:
    """The columns' names, the rows below them, and what is to be said of names."""
    header, body, notes = list(layout.names), rows, list[str]()
    if not layout.names:
        names, body = rows[0], rows[1:]
        if body and _of_two_lines(names, body[0]):
            notes.append("The header has a second line, with units.")
            units, body = [unit.strip(" []()") for unit in body[0]], body[1:]
            names = [f"{name} [{unit}]" if unit else name for name, unit in zip(names, units, strict=True)]
        header, more = _header(path, names, decimal)
        notes += more
    if not body:
        raise InputError(path, "", "has a header but no rows")
    return header, body, notes


def _trimmed(header: list[str], body: list[list[str]]) -> tuple[list[str], list[list[str]]]:
    """Both without what a separator at the end of every line adds to rows, or to the header."""
    if all(len(cells) == len(header) + 1 and not cells[-1].strip() for cells in body):
        body = [cells[:-1] for cells in body]
    if len(header) > 1 and not header[-1] and all(len(cells) == len(header) - 1 for cells in body):
        header = header[:-1]
    return header, body


def _ragged(header: Sequence[str], body: Sequence[Sequence[str]], lines: Sequence[int]) -> Iterator[RejectedRow]:
    """The rows that have not as many cells as the header."""
    for number, cells in zip(lines, body, strict=True):
        if len(cells) != len(header):
            yield RejectedRow(number, f"has {len(cells)} cells where the header has {len(header)}")


def _no_row(header: Sequence[str], first: Sequence[str], line: int, separator: str, layout: Layout) -> str:
    """That no row has as many cells as the header, and what may be the cause."""
    message = f"no row has the {len(header)} cells of the header; row {line} has {len(first)}"
    if separator == "," and len(first) >= 2 * len(header) - 1 > 1:
        return f"{message}; decimal commas cannot stand in a table parted by commas: part it by semicolons"
    if len(first) > len(header) and not layout.names:
        return f"{message}; where titles stand above the header, write `skip_rows: 1`, say, in recording.yaml"
    return message


def _refuse_binary(path: Path, content: bytes) -> None:
    for mark, kind in _BINARY.items():
        if content.startswith(mark):
            raise InputError(path, "", f"is {kind}; a recording is a table of text (save a sheet as CSV) or parquet")


def _titles(text: str, layout: Layout) -> int:
    """How many lines stand between those that are skipped and the header: that of our names, or the line (or two, see
    `_of_two_lines`) over the first numbers with as many cells, where what stands first has others or mostly blank ones.
    """
    lines = [line for line, _ in zip(io.StringIO(text), range(layout.skip_rows + _MOST_TITLES), strict=False)]
    lines = lines[layout.skip_rows :]
    above = [number for number, line in enumerate(lines) if line.strip() and not _passed_over(line, layout)]
    named = next((number for number in above if _names_columns(lines[number], layout)), None)
    if named is not None or len(above) < _FEWEST_COLUMNS:
        return 0 if named is None or named == above[0] else named
    for place in range(1, len(above) - 1):
        separator = layout.separator or _parting(lines[above[place]])
        first, before, header, below = (_cells(lines[above[k]], separator) for k in (0, place - 1, place, place + 1))
        if not len(header) == len(below) >= _FEWEST_COLUMNS or not _numeric(below) > 0.5 > _numeric(header):
            continue
        if len(first) != len(header) or 2 * _filled(first) <= _filled(header):
            return above[place - 1 if place > 1 and _of_two_lines(before, header) else place]
    return 0


def _names_columns(line: str, layout: Layout) -> bool:
    names = _cells(line, layout.separator or _parting(line))
    return sum(looks_like_ours(name) or otherwise_spelled(name) is not None for name in names) >= _FEWEST_COLUMNS


def _parting(line: str) -> str:
    """What parts a line most."""
    return max(_SEPARATORS, key=line.count)


def _cells(line: str, separator: str) -> list[str]:
    try:
        cells = next(csv.reader([line], delimiter=separator), [])
    except csv.Error:  # what cannot be read is refused with the rows
        cells = line.split(separator)
    return [" ".join(cell.split()) for cell in cells]


def _filled(cells: Sequence[str]) -> int:
    return sum(bool(cell) for cell in cells)


def _of_two_lines(names: Sequence[str], units: Sequence[str]) -> bool:
    """Whether a header goes on in a second line, that of the units: words alone, below names alone."""
    same = len(names) == len(units) and all(names) and 2 * _filled(units) > len(units)
    return same and _numeric(names) == _numeric(units) == 0.0 and any(map(_UNIT_ALONE.fullmatch, units))


def _numeric(cells: Sequence[str]) -> float:
    """The share of cells that hold a number, however it is written."""
    numbers = (any(math.isfinite(as_number(cell, sign)) for sign in ".,") for cell in cells)
    return sum(numbers) / max(len(cells), 1)


def _decimal_commas(rows: Sequence[Sequence[str]]) -> bool:
    """Whether more cells are numbers with a comma for a decimal point than with a point, or without either."""
    cells = [cell for row in rows[:_LOOKED_AT] for cell in row]
    by_point, by_comma = (sum(math.isfinite(as_number(cell, sign)) for cell in cells) for sign in ".,")
    return by_comma > by_point


def _passed_over(line: str, layout: Layout) -> bool:
    """Whether a line is a comment, or Excel's on the separator."""
    comment = bool(layout.comment) and line.lstrip().startswith(str(layout.comment))
    return comment or re.fullmatch(r'"?sep=(.)"?\s*', line) is not None


def _lines(path: Path, text: str, layout: Layout) -> tuple[Iterator[tuple[int, str]], str, str | None]:
    """The lines that count with their numbers (from 1), the first of them, and the separator where Excel names it
    (`sep=;`)."""
    lines = enumerate((item[0] for item in _LINE.finditer(text)), start=1)
    for done in range(layout.skip_rows):
        if next(lines, None) is None:
            raise InputError(path, "skip_rows", f"is {shown(layout.skip_rows)}, but the file has {done} lines")
    counting = (
        (number, line.lstrip(" "))
        for number, line in lines
        if line.strip() and not (layout.comment and line.lstrip().startswith(layout.comment))
    )
    separator = None
    for number, line in counting:
        if named := re.fullmatch(r'"?sep=(.)"?\s*', line):
            separator = named[1]
        else:
            return chain([(number, line)], counting), line, separator
    return counting, "", separator


def _separator(header: str) -> str:
    """What parts the columns of a header; blanks only where nothing else is there."""
    count = {item: len(next(csv.reader([header], delimiter=item))) for item in _SEPARATORS}
    best = max(count, key=lambda item: count[item])
    return best if count[best] > 1 or len(header.split()) < _FEWEST_COLUMNS else " "


def _header(path: Path, cells: Sequence[str], decimal: str) -> tuple[list[str], list[str]]:
    """The columns' names and what is to be said of them."""
    header = [" ".join(cell.split()) for cell in cells]
    if all(math.isfinite(as_number(cell, decimal)) for cell in header):
        would_do = "time_s, q1_deg, .., x_mm, y_mm"
        hint = f"the first line names the columns: {would_do}; or list `names` in recording.yaml"
        raise InputError(path, "", f"has no header; {hint}")
    if header[0][:1] in _MARKS:  # as NumPy writes its header
        header = header[1:] if header[0] in _MARKS else [header[0][1:].strip(), *header[1:]]
    notes: list[str] = []
    for place, name in enumerate(header):
        if name and name in header[:place]:
            if looks_like_ours(name):
                raise InputError(path, "", f"the column {shown(name)} occurs twice in the header; rename one")
            again = header[:place].count(name)
            number = next(k for k in range(again, len(header) + 1) if f"{name}.{k}" not in header)
            header[place] = f"{name}.{number}"
            notes.append(f"The column {shown(name)} occurs more than once. The further one is called {header[place]}.")
    return header, notes
