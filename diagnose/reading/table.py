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
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.recording import RejectedRow
from linkwright.core.sections.numeric import Array
from linkwright.core.units.files import read_bytes
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.workbook import is_workbook, workbook_text

from .columns import looks_like_ours, otherwise_spelled

if TYPE_CHECKING:
    from pandas import DataFrame


_SEPARATORS = (",", ";", "\t", "|")
_MARKS = ("#", "%")
_FEWEST_COLUMNS = 3
"""An arm with one joint has as many: q1, x and y."""
_MOST_TITLES = 30
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
_LARGEST_PARQUET = 512 * 1024 * 1024


@dataclass(frozen=True)
class Layout:
    """How a text file is laid out. `skip_rows` lines stand before the header, lines that begin with `comment` count
    for nothing; without a `separator` the header tells it. `names` are the columns' where the file has no header;
    `sheet` is the one of a workbook."""

    separator: str | None = None
    decimal: str = "."
    comment: str | None = None
    skip_rows: int = 0
    encoding: str = "utf-8"
    names: tuple[str, ...] = ()
    sheet: str = ""


@dataclass(frozen=True)
class Table:
    """Columns by name, text or numbers; `row` is each row's number in the file, the first reading being row 1.

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

    def numbers(self, name: str) -> Array:
        """A column as numbers; nan where a cell holds none."""
        cells = self.columns[name]
        if isinstance(cells, np.ndarray):
            return cells
        return as_numbers(cells, self.decimal)

    def sides(self, name: str) -> Array:
        """A column as numbers, with signs and words for the two ways that a joint can come (`+`, `neg`) as 1 and -1."""
        found = self.numbers(name)
        cells = self.columns[name]
        if isinstance(cells, np.ndarray):
            return found
        words = (_SIDES.get(cell.strip().lower(), math.nan) for cell in cells)
        return np.where(np.isnan(found), np.fromiter(words, dtype=float, count=len(cells)), found)

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


def read_table(path: Path, layout: Layout) -> Table:
    """The table that a CSV, .xlsx or parquet file holds. Raises `InputError`, one line, for anything else."""
    if path.suffix.lower() in (".parquet", ".pq"):
        return _parquet(path)
    if is_workbook(path):
        return _csv(path, replace(layout, separator=","), workbook_text(path, layout.sheet, layout.decimal))
    return _csv(path, layout, _text(path, layout.encoding))


def _text(path: Path, encoding: str) -> str:
    content = read_bytes(path)
    if encoding.lower().replace("_", "-") in _USUAL:
        _refuse_binary(path, content)
        try:
            return content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            would_do = "write `encoding: latin-1`, say, in recording.yaml"
            raise InputError(path, "", f"is not UTF-8 text (byte {error.start}); {would_do}") from None
    try:
        return content.decode(encoding)
    except LookupError:
        raise InputError(path, "encoding", f"there is no encoding {shown(encoding)}") from None
    except UnicodeDecodeError as error:
        raise InputError(path, "encoding", f"is not {encoding} text (byte {error.start})") from None
    except UnicodeError:
        raise InputError(path, "encoding", f"is not {encoding} text") from None


def _csv(path: Path, layout: Layout, text: str) -> Table:
    if "\0" in text:
        raise InputError(path, "", "is no plain text: it holds NUL bytes; is it UTF-16 (`encoding: utf-16`)?")
    kept, first, named = _lines(path, text, layout)
    if not first:
        raise InputError(path, "", "is empty; it needs a header (time_s, q1_deg, .., x_mm, y_mm) and a row a reading")
    if not layout.names:
        _refuse_title(path, text, layout)
    separator = layout.separator or named or _separator(first)
    try:
        rows = [
            [cell for cell in cells if cell] if separator == " " else cells
            for cells in csv.reader(kept, delimiter=separator, skipinitialspace=True, strict=True)
        ]
    except csv.Error as error:
        raise InputError(path, "", f"is no table: {error}") from None
    if layout.names:
        header, notes, body = list(layout.names), [], rows
    else:
        header, notes = _header(path, rows[0], layout.decimal)
        body = rows[1:]
    if not body:
        raise InputError(path, "", "has a header but no rows")
    if all(len(cells) == len(header) + 1 and not cells[-1].strip() for cells in body):
        body = [cells[:-1] for cells in body]  # a separator at the end of every line
    if len(header) > 1 and not header[-1] and all(len(cells) == len(header) - 1 for cells in body):
        header = header[:-1]
    good = [index for index, cells in enumerate(body) if len(cells) == len(header)]
    ragged = tuple(
        RejectedRow(index + 1, f"has {len(cells)} cells where the header has {len(header)}")
        for index, cells in enumerate(body)
        if len(cells) != len(header)
    )
    if not good:
        message = f"no row has the {len(header)} cells of the header; row 1 has {len(body[0])}"
        if separator == "," and len(body[0]) >= 2 * len(header) - 1 > 1:
            message += "; decimal commas cannot stand in a table parted by commas: part it by semicolons"
        elif len(body[0]) > len(header) and not layout.names:
            message += "; where a title stands above the header, write `skip_rows: 1`, say, in recording.yaml"
        raise InputError(path, "", message)
    columns = {name: tuple(body[index][k] for index in good) for k, name in enumerate(header) if name}
    return Table(
        str(path),
        MappingProxyType(columns),
        np.array(good, dtype=np.int64) + 1,
        layout.decimal,
        ragged,
        (
            *notes,
            *(f"Column {k} of {path.name} has no name and is not used." for k, n in enumerate(header, 1) if not n),
        ),
    )


def _refuse_binary(path: Path, content: bytes) -> None:
    for mark, kind in _BINARY.items():
        if content.startswith(mark):
            raise InputError(path, "", f"is {kind}; a recording is a table of text (save a sheet as CSV) or parquet")


def _refuse_title(path: Path, text: str, layout: Layout) -> None:
    """Refuse a file whose header stands below its first lines, with how many to skip."""
    above: list[str] = []
    for number, line in zip(range(layout.skip_rows + _MOST_TITLES), io.StringIO(text), strict=False):
        cells = max((line.split(each) for each in ([layout.separator] if layout.separator else _SEPARATORS)), key=len)
        names = [" ".join(cell.strip().strip('"').split()) for cell in cells]
        if sum(looks_like_ours(name) or otherwise_spelled(name) is not None for name in names) < _FEWEST_COLUMNS:
            above.append(line)
            continue
        if any(each.strip() and not _passed_over(each, layout) for each in above[layout.skip_rows :]):
            message = f"the header stands in line {number + 1}; write `skip_rows: {number}` in recording.yaml"
            raise InputError(path, "", message)
        return


def _passed_over(line: str, layout: Layout) -> bool:
    """Whether a line is a comment, or Excel's on the separator."""
    comment = bool(layout.comment) and line.lstrip().startswith(str(layout.comment))
    return comment or re.fullmatch(r'"?sep=(.)"?\s*', line) is not None


def _lines(path: Path, text: str, layout: Layout) -> tuple[Iterator[str], str, str | None]:
    """The lines that count, the first of them, and the separator where Excel names it (`sep=;`)."""
    lines = (each[0] for each in _LINE.finditer(text))
    for done in range(layout.skip_rows):
        if next(lines, None) is None:
            raise InputError(path, "skip_rows", f"is {shown(layout.skip_rows)}, but the file has {done} lines")
    counting = (
        line.lstrip(" ")
        for line in lines
        if line.strip() and not (layout.comment and line.lstrip().startswith(layout.comment))
    )
    separator = None
    for line in counting:
        if named := re.fullmatch(r'"?sep=(.)"?\s*', line):
            separator = named[1]
        else:
            return chain([line], counting), line, separator
    return counting, "", separator


def _separator(header: str) -> str:
    """What parts the columns of a header; blanks only where nothing else is there."""
    count = {each: len(next(csv.reader([header], delimiter=each))) for each in _SEPARATORS}
    best = max(count, key=lambda each: count[each])
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
            notes.append(f"The column {shown(name)} occurs more than once; here the further one is {header[place]}.")
    return header, notes


def _parquet(path: Path) -> Table:
    content = read_bytes(path, _LARGEST_PARQUET)
    import pandas as pd

    try:
        frame = pd.read_parquet(io.BytesIO(content))
    except ImportError:
        message = "parquet needs pyarrow, which is not installed: pip install 'linkwright[parquet]', or give a CSV file"
        raise InputError(path, "", message) from None
    except (OSError, ValueError, KeyError) as error:  # pyarrow's own errors are heirs of ValueError or OSError
        raise InputError(path, "", f"is not a parquet file: {shown(str(error))}") from None
    return table_of(frame, str(path))


def table_of(frame: DataFrame, path: str) -> Table:
    """The table that a data frame holds; `path` names it in messages. Raises `InputError`."""
    import pandas as pd

    columns: dict[str, tuple[str, ...] | Array] = {}
    for position, name in enumerate(" ".join(str(each).split()) for each in frame.columns):
        if name in columns:
            raise InputError(path, "", f"the column {shown(name)} occurs twice")
        series = frame.iloc[:, position]
        if pd.api.types.is_numeric_dtype(series) or pd.api.types.is_bool_dtype(series):
            columns[name] = series.to_numpy(dtype=float, na_value=np.nan)
        else:
            columns[name] = tuple("" if pd.isna(value) else str(value) for value in series.tolist())
    if not len(frame) or not columns:
        raise InputError(path, "", "has no rows")
    return Table(path, MappingProxyType(columns), np.arange(1, len(frame) + 1))
