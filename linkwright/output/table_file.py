"""A table as a file of the kind that its name says: CSV, parquet or Markdown."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from linkwright.core.units.extras import not_installed
from linkwright.core.units.quantities import InputError
from linkwright.core.units.workbook import defused

from .files import write_file

if TYPE_CHECKING:
    import pandas as pd

_DIGITS = 6
"""Of numbers in tables that people read."""
_MARKDOWN = str.maketrans({"|": r"\|", "\n": " ", "<": "&lt;"})


def frame(rows: Any, columns: Sequence[str] | None = None) -> pd.DataFrame:
    """A table for programs, of rows or of columns by name; pandas is loaded by the first."""
    import pandas as pd

    return pd.DataFrame(rows, columns=None if columns is None else list(columns))


def write_table(table: pd.DataFrame, file: Path | str) -> None:
    """Write a table, its columns' names with their units as its head: .csv, .parquet (.pq) or .md.
    Raises `InputError` for another ending, for parquet without pyarrow, and where the file cannot be written.

    >>> import pathlib, tempfile
    >>> import linkwright as lw
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "drives.md"
    >>> table = lw.actuators.table[["name", "mass_kg"]]
    >>> lw.write_table(table[table["name"] == "CSG-14-100-2UH"], file)
    >>> print(file.read_text(), end="")
    | name | mass_kg |
    | --- | ---: |
    | CSG-14-100-2UH | 0.52 |
    """
    file = Path(file)
    way = WAYS.get(file.suffix.lower())
    if way is None:
        raise InputError(file, "", f"is of no kind that a table can be written as: {', '.join(WAYS)}")
    write_file(file, way(table))


def check_table(file: Path | None) -> None:
    """Refuse, before any work is done, parquet where pyarrow is not installed. Raises `InputError`."""
    if file is not None and WAYS.get(file.suffix.lower()) is _parquet and find_spec("pyarrow") is None:
        raise InputError(file, "", not_installed("parquet", "pyarrow", "parquet"))


def _csv(table: pd.DataFrame) -> str:
    words = table.select_dtypes(exclude="number")
    return str(table.assign(**words.map(defused)).to_csv(index=False, lineterminator="\n"))


def _parquet(table: pd.DataFrame) -> bytes:
    stream = io.BytesIO()
    try:
        table.to_parquet(stream, index=False)
    except ImportError:
        raise InputError("", "", not_installed("parquet", "pyarrow", "parquet")) from None
    return stream.getvalue()


def _cell(value: Any) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    return f"{value:.{_DIGITS}g}" if isinstance(value, float) else str(value)


def _markdown(table: pd.DataFrame) -> str:
    every = [list(table.columns), *table.itertuples(index=False, name=None)]
    head, *rows = [[_cell(item).translate(_MARKDOWN) for item in row] for row in every]
    marks = ["---:" if kind.kind in "iuf" else "---" for kind in table.dtypes]
    return "".join(f"| {' | '.join(row)} |\n" for row in (head, marks, *rows))


WAYS: Mapping[str, Callable[[Any], str | bytes]] = MappingProxyType(
    {".csv": _csv, ".parquet": _parquet, ".pq": _parquet, ".md": _markdown}
)
"""How a table is written, by the ending of the file."""
