"""A recording's file as a table, whatever its format: text, workbook, parquet (LeRobot's too), data frame, bag."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import replace
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from linkwright.core.sections.numeric import Array
from linkwright.core.units.extras import not_installed
from linkwright.core.units.files import read_bytes
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.workbook import is_workbook, workbook_text

from .foreign.bags import bag_table, is_bag
from .foreign.lerobot import expanded, feature_names, on_one_clock
from .table import Layout, Table, file_text, text_table

if TYPE_CHECKING:
    from pandas import DataFrame

_LARGEST_PARQUET = 512 * 1024 * 1024


def read_table(path: Path, layout: Layout, *, rows: int = 0) -> Table:
    """The table that a CSV, .xlsx or parquet file or a bag holds; of a text the first `rows` lines alone, unless 0.
    Raises `InputError`, one line, for anything else."""
    if is_bag(path):
        return bag_table(path, layout.topics)
    if path.suffix.lower() in (".parquet", ".pq"):
        return _parquet(path)
    if is_workbook(path):
        text = workbook_text(path, layout.sheet, layout.decimal or ".")
        return text_table(path, replace(layout, separator=","), text)
    text, notes = file_text(path, layout.encoding)
    if rows:
        text = "".join(islice(io.StringIO(text), rows))
    table = text_table(path, layout, text)
    return replace(table, notes=(*notes, *table.notes)) if notes else table


def _parquet(path: Path) -> Table:
    content = read_bytes(path, _LARGEST_PARQUET)
    import pandas as pd

    try:
        frame = pd.read_parquet(io.BytesIO(content))
    except ImportError:
        message = f"{not_installed('parquet', 'pyarrow', 'parquet')}, or give a CSV file"
        raise InputError(path, "", message) from None
    except (OSError, ValueError, KeyError) as error:  # pyarrow's errors are heirs of ValueError or OSError
        raise InputError(path, "", f"is not a parquet file: {shown(str(error))}") from None
    return table_of(frame, str(path), feature_names(path))


def table_of(frame: DataFrame, path: str, names: Mapping[str, tuple[str, ...]] = MappingProxyType({})) -> Table:
    """The table that a data frame holds; `path` names it in messages, `names` the numbers of columns that hold lists of
    them. Raises `InputError`."""
    import pandas as pd

    columns: dict[str, tuple[str, ...] | Array] = {}
    for position, name in enumerate(" ".join(str(column).split()) for column in frame.columns):
        if name in columns:
            raise InputError(path, "", f"the column {shown(name)} occurs twice")
        series = frame.iloc[:, position]
        if pd.api.types.is_numeric_dtype(series) or pd.api.types.is_bool_dtype(series):
            columns[name] = series.to_numpy(dtype=float, na_value=np.nan)
        elif parts := expanded(name, series.tolist(), names, path):
            columns |= parts
        else:
            columns[name] = tuple("" if pd.isna(value) else str(value) for value in series.tolist())
    if not len(frame) or not columns:
        raise InputError(path, "", "has no rows")
    notes = on_one_clock(columns)
    return Table(path, MappingProxyType(columns), np.arange(1, len(frame) + 1), notes=tuple(notes))
