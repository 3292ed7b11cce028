"""Tables for and from spreadsheets, as text or a workbook: a row an entry, read or refused with its line."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import read_text
from linkwright.core.units.workbook import defused, fused, is_workbook, workbook_text

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
    known, marks = list(names), dict[str, str]()
    for part in (item for item in cell.split("; ") if item.strip()):
        name, colon, text = (item.strip() for item in part.partition(":"))
        if name not in known or not colon or not text:
            raise InputError(path, where, f"needs a figure's name and text, not '{part}'{nearest(name, known)}")
        marks[name] = text
    return marks


class WrongRows(InputError):
    """Some entries of a file are wrong: `faults` says what is of each, `good` are the others."""

    def __init__(self, good: Sequence[Any], faults: Sequence[InputError]) -> None:
        self.good, self.faults = tuple(good), tuple(faults)
        first = self.faults[0]
        more = f" (and {len(self.faults) - 1} more)" if len(self.faults) > 1 else ""
        super().__init__(first.file, first.key, f"{first.message}{more}")

    def __reduce__(self) -> tuple[object, ...]:
        """Keep the entries when the error crosses between processes."""
        return WrongRows, (self.good, self.faults)


@dataclass(frozen=True)
class Cells:
    """A table of texts.

    Attributes:
        headings: of its columns.
        rows: of each the words for its line and its texts by heading, without empty ones; None in their place where it
            has not as many cells as the heading.
    """

    headings: tuple[str, ...]
    rows: tuple[tuple[str, dict[str, str] | None], ...]


def read_cells(path: Path | str) -> Cells:
    """The cells of a table. Raises `InputError`."""
    text = workbook_text(path, None).lstrip("\n") if is_workbook(path) else read_text(path)
    reader = csv.DictReader(io.StringIO(text, newline=""), strict=True)
    results: list[tuple[str, dict[str, str] | None]] = []
    try:
        headings = tuple(reader.fieldnames or ())
        for row in reader:
            torn = None in row or None in row.values()
            cells = None if torn else {key: fused(text.strip()) for key, text in row.items() if text.strip()}
            results.append((f"line {reader.line_num}", cells))
    except csv.Error as error:
        raise InputError(path, f"line {reader.line_num}", f"is no table: {error}") from None
    return Cells(headings, tuple(results))


def read_rows(
    path: Path | str,
    columns: Sequence[str],
    needed: Sequence[str],
    entry: Callable[[dict[str, str], str], T],
    cells: Cells | None = None,
) -> tuple[T, ...]:
    """What `entry` makes of each row's cells by column, without the empty ones, and of the words for its line.

    Columns may be in any order and missing, but for those `needed`, which every row must fill. `cells` are those of the
    file, where they have been read. Raises `InputError`, and `WrongRows` once all rows have been looked at.
    """
    table = read_cells(path) if cells is None else cells
    for heading in table.headings:
        if heading not in columns:
            raise InputError(path, "", f"unknown column '{heading}'{nearest(heading, columns)}")
    for column in needed:
        if column not in table.headings:
            raise InputError(path, "", f"has no column '{column}'")
    rows: list[T] = []
    faults: list[InputError] = []
    for where, row in table.rows:
        try:
            rows.append(entry(_filled(row, needed, path, where), where))
        except InputError as error:
            faults.append(error)
    if faults:
        raise WrongRows(rows, faults)
    if not rows:
        raise InputError(path, "", "has no rows")
    return tuple(rows)


def _filled(row: dict[str, str] | None, needed: Sequence[str], path: Path | str, where: str) -> dict[str, str]:
    """A row that has what it needs. Raises `InputError`."""
    if row is None:
        raise InputError(path, where, "has not as many cells as the heading")
    for column in needed:
        if column not in row:
            raise InputError(path, where, f"has no {column}")
    return row
