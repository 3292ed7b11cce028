"""Tables for and from spreadsheets, as text or a workbook: a row an entry, read whole or refused with the line."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import read_text
from linkwright.core.units.spreadsheet import defused, fused
from linkwright.core.units.workbook import is_workbook, workbook_text

T = TypeVar("T")


def table_text(columns: Sequence[str], rows: Iterable[Mapping[str, object]]) -> str:
    """The rows as text, a column a key; what a row has not is an empty cell."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows({key: defused(cell) for key, cell in row.items()} for row in rows)
    return stream.getvalue()


def marks_text(marks: Mapping[str, str]) -> str:
    """What is said of each figure, such as that it could not be confirmed, in one cell: `mass: why; stiffness: why`."""
    return "; ".join(f"{name}: {text.replace('; ', ', ')}" for name, text in marks.items())


def marks_of(cell: str, names: Iterable[str], path: Path | str, where: str) -> dict[str, str]:
    """What such a cell says of the figures called `names`. Raises `InputError`."""
    known, found = list(names), dict[str, str]()
    for part in (each for each in cell.split("; ") if each.strip()):
        name, colon, text = (each.strip() for each in part.partition(":"))
        if name not in known or not colon or not text:
            raise InputError(path, where, f"needs a figure's name and text, not '{part}'{nearest(name, known)}")
        found[name] = text
    return found


def read_rows(
    path: Path | str, columns: Sequence[str], needed: Sequence[str], entry: Callable[[dict[str, str], str], T]
) -> tuple[T, ...]:
    """What `entry` makes of each row's cells by column, without the empty ones, and of the words for its line.

    Columns may be in any order and missing, but for those `needed`, which every row must fill. Raises `InputError`.
    """
    text = workbook_text(path) if is_workbook(path) else read_text(path)
    reader = csv.DictReader(io.StringIO(text, newline=""), strict=True)
    found: list[T] = []
    try:
        headings = list(reader.fieldnames or ())
        for heading in headings:
            if heading not in columns:
                raise InputError(path, "", f"unknown column '{heading}'{nearest(heading, columns)}")
        for column in needed:
            if column not in headings:
                raise InputError(path, "", f"has no column '{column}'")
        for row in reader:
            where = f"line {reader.line_num}"
            if None in row or None in row.values():
                raise InputError(path, where, "has not as many cells as the heading")
            cells = {key: fused(text.strip()) for key, text in row.items() if text.strip()}
            for column in needed:
                if column not in cells:
                    raise InputError(path, where, f"has no {column}")
            found.append(entry(cells, where))
    except csv.Error as error:
        raise InputError(path, f"line {reader.line_num}", f"is no table: {error}") from None
    if not found:
        raise InputError(path, "", "has no rows")
    return tuple(found)
