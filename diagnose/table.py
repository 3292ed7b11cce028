"""A recording's file as a table of named columns, whatever its separator: text cells from CSV, values from parquet."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from materials.quantities import InputError, shown
from materials.reading import read_text

from .recording import RejectedRow

Array = NDArray[np.float64]

_SEPARATORS = (",", ";", "\t", "|")
_LARGEST_PARQUET = 512 * 1024 * 1024


@dataclass(frozen=True)
class Layout:
    """How a text file is laid out. `skip_rows` lines stand before the header, lines that begin with `comment` count
    for nothing; without a `separator` the header tells it."""

    separator: str | None = None
    decimal: str = "."
    comment: str | None = None
    skip_rows: int = 0
    encoding: str = "utf-8"


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
        return np.array([as_number(cell, self.decimal) for cell in cells], dtype=float)

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
    """A cell's number, nan for anything else."""
    if decimal != ".":
        cell = cell.replace(decimal, ".")
    try:
        return float(cell) if "_" not in cell else math.nan
    except ValueError:
        return math.nan


def read_table(path: Path, layout: Layout) -> Table:
    """The table that a CSV or parquet file holds. Raises `InputError`, one line, for anything else."""
    if path.suffix.lower() in (".parquet", ".pq"):
        return _parquet(path)
    return _csv(path, layout)


def _text(path: Path, encoding: str) -> str:
    if encoding.lower().replace("_", "-") in ("utf-8", "utf8"):
        try:
            return read_text(path)
        except InputError as error:
            if "not UTF-8" not in error.message:
                raise
            raise InputError(path, "", f"{error.message}; write `encoding: latin-1`, say, in recording.yaml") from None
    try:
        return path.read_bytes().decode(encoding)
    except LookupError:
        raise InputError(path, "encoding", f"there is no encoding {shown(encoding)}") from None
    except UnicodeDecodeError as error:
        raise InputError(path, "encoding", f"is not {encoding} text (byte {error.start})") from None
    except OSError as error:
        raise InputError(path, "", f"cannot be read: {error.strerror or error}") from None


def _csv(path: Path, layout: Layout) -> Table:
    text = _text(path, layout.encoding)
    if "\0" in text:
        raise InputError(path, "", "is no text table: it holds NUL bytes")
    lines = io.StringIO(text, newline="")
    for _ in range(layout.skip_rows):
        lines.readline()
    kept = io.StringIO(newline="")
    for line in lines:
        if line.strip() and not (layout.comment and line.lstrip().startswith(layout.comment)):
            kept.write(line)
    kept.seek(0)
    first = kept.readline()
    kept.seek(0)
    if not first:
        raise InputError(path, "", "is empty; it needs a header (time_s, q1_deg, .., x_mm, y_mm) and a row a reading")
    separator = layout.separator or max(_SEPARATORS, key=lambda each: len(next(csv.reader([first], delimiter=each))))
    try:
        rows = list(csv.reader(kept, delimiter=separator, skipinitialspace=True, strict=True))
    except csv.Error as error:
        raise InputError(path, "", f"is no table: {error}") from None
    header = _header(path, rows[0], layout.decimal)
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
        raise InputError(path, "", f"no row has the {len(header)} cells of the header; row 1 has {len(body[0])}")
    columns = {name: tuple(body[index][k] for index in good) for k, name in enumerate(header) if name}
    return Table(
        str(path),
        MappingProxyType(columns),
        np.array(good, dtype=np.int64) + 1,
        layout.decimal,
        ragged,
        tuple(f"Column {k} of {path.name} has no name and is not used." for k, n in enumerate(header, 1) if not n),
    )


def _header(path: Path, cells: Sequence[str], decimal: str) -> list[str]:
    header = [" ".join(cell.split()) for cell in cells]
    if all(math.isfinite(as_number(cell, decimal)) for cell in header):
        raise InputError(path, "", "has no header; the first line names the columns: time_s, q1_deg, .., x_mm, y_mm")
    for name in header:
        if name and header.count(name) > 1:
            raise InputError(path, "", f"the column {shown(name)} occurs twice in the header")
    return header


def _parquet(path: Path) -> Table:
    if not path.is_file():
        raise InputError(path, "", "is a directory, not a file" if path.is_dir() else "there is no such file")
    if path.stat().st_size > _LARGEST_PARQUET:
        raise InputError(path, "", f"is larger than {_LARGEST_PARQUET // 1024**2} MB")
    import pandas as pd

    try:
        frame = pd.read_parquet(path)
    except ImportError:
        message = "parquet needs pyarrow, which is not installed: pip install 'linkwright[parquet]', or give a CSV file"
        raise InputError(path, "", message) from None
    except (OSError, ValueError, KeyError) as error:  # pyarrow's own errors are heirs of ValueError or OSError
        raise InputError(path, "", f"is not a parquet file: {shown(str(error))}") from None
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
    return Table(str(path), MappingProxyType(columns), np.arange(1, len(frame) + 1))
