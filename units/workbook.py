"""A sheet of an Excel workbook (.xlsx) as comma-separated text, and cells that no spreadsheet takes for a formula."""

from __future__ import annotations

import csv
import datetime
import io
import lzma
import re
import struct
import warnings
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import ParseError

from linkwright.core.units.files import read_bytes
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, shown
from linkwright.core.units.reading import refusal

if TYPE_CHECKING:
    from openpyxl.workbook.workbook import Workbook

WORKBOOKS = (".xlsx", ".xlsm")
_LARGEST = 512 * 1024 * 1024
"""Bytes that a workbook may hold when unpacked: a small file can unpack to more than a machine's memory."""
_MOST_CELLS = 10_000_000
_COMMA, _POINT = re.compile(r"[+-]?\d+,(?:\d{1,2}|\d{4,})"), re.compile(r"[+-]?\d+\.\d+")
"""Numbers with a decimal comma (three digits behind it may be thousands) and with a point."""
_NUMBER = re.compile(r"[+-]?\d+(?:[.,]\d+)?(?:e[+-]?\d+)?", re.IGNORECASE)
_BROKEN = (
    zipfile.BadZipFile,
    zlib.error,
    lzma.LZMAError,
    struct.error,
    RuntimeError,  # a packing that is not known, or a password
    ParseError,
    KeyError,
    ValueError,
    IndexError,
    TypeError,
    AttributeError,
    EOFError,
    OSError,
)
"""What openpyxl raises for a file that is no sound workbook, `InvalidFileException` (not a ValueError) aside."""


def is_workbook(path: Path | str) -> bool:
    """Whether a file is a workbook by its name."""
    return Path(path).suffix.lower() in WORKBOOKS


def workbook_text(path: Path | str, sheet: str | None = "", decimal: str = ".") -> str:
    """The cells of a sheet as comma-separated text, a line each row (an empty one for a blank row), without the blank
    rows and columns after the last that is filled.

    `sheet` names it; it may be missing where one sheet alone has rows of numbers (or is filled at all), and is None
    where nobody could name it: a table without settings. Numbers are written with `decimal`, to the last digit; dates
    as ISO 8601; a formula counts as what was last computed of it. Raises `InputError`, one line.
    """
    content = read_bytes(path)
    from openpyxl.utils.exceptions import InvalidFileException

    try:
        with zipfile.ZipFile(io.BytesIO(content)) as packed:
            unpacked = sum(item.file_size for item in packed.infolist())
        if unpacked > _LARGEST:
            raise InputError(path, "", f"unpacks to more than {_LARGEST // 1024**2} MB")
        with warnings.catch_warnings():  # what a library grumbles of a file is no line of ours
            warnings.simplefilter("ignore")
            return _text_of(path, content, sheet, decimal)
    except InputError:
        raise
    except (*_BROKEN, InvalidFileException) as error:
        raise InputError(path, "", f"is no Excel workbook that can be read: {shown(str(error))}") from None


def _text_of(path: Path | str, content: bytes, sheet: str | None, decimal: str) -> str:
    from openpyxl import load_workbook

    book: Workbook = load_workbook(io.BytesIO(content), read_only=True, data_only=True)
    names = [str(worksheet.title) for worksheet in book.worksheets]
    if sheet and sheet not in names:
        raise InputError(path, "sheet", f"there is no sheet {shown(sheet)}{nearest(sheet, names)}")
    tables = {name: list(_rows(path, book[name])) for name in ([sheet] if sheet else names)}
    rows = tables[_sheet_of(path, tables, ask=sheet is not None)]
    stream = io.StringIO(newline="")
    if decimal == "." and _commas_in_text(rows):
        decimal = ","
    width = max(len(row) for row in rows)
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerows([_cell(cell, decimal) for cell in row] + [""] * (width - len(row)) if row else [] for row in rows)
    return stream.getvalue()


def _sheet_of(path: Path | str, tables: dict[str, list[list[Any]]], *, ask: bool) -> str:
    """The sheet to read: the only one with rows of numbers, or that is filled at all. Raises `InputError`, which says
    how to name one where a setting can (`ask`)."""
    filled = [name for name, rows in tables.items() if rows]
    filled = [name for name in filled if _has_numbers(tables[name])] or filled
    if not filled:
        raise InputError(path, "", "has no filled cell")
    if len(filled) == 1:
        return filled[0]
    message = f"has {len(filled)} sheets ({', '.join(shown(name, 30) for name in filled[:5])})"
    if not ask:
        raise InputError(path, "", f"{message}; leave only the one to be read")
    raise refusal(path, "", message, *({"sheet": name} for name in filled[:5]))


def _rows(path: Path | str, sheet: Any) -> Iterator[list[Any]]:
    """The rows to the last that holds anything, each to its last filled cell."""
    sheet.reset_dimensions()  # what a file says of its size need not be true
    seen = blank = 0
    for row in sheet.iter_rows(values_only=True):
        seen += len(row)
        if seen > _MOST_CELLS:
            raise InputError(path, "", f"has more than {_MOST_CELLS} cells")
        cells = list(row)
        while cells and cells[-1] in (None, ""):
            cells.pop()
        if cells:
            yield from ([] for _ in range(blank))
            yield cells
        blank = 0 if cells else blank + 1


def _commas_in_text(rows: list[list[Any]]) -> bool:
    """Whether cells of text are numbers with decimal commas, so that those of numbers are written alike."""
    texts = [cell.strip() for row in rows for cell in row if isinstance(cell, str)]
    return any(map(_COMMA.fullmatch, texts)) and not any(map(_POINT.fullmatch, texts))


def _has_numbers(rows: list[list[Any]]) -> bool:
    """Whether a row holds two numbers or more, written as text or not."""
    return any(sum(bool(_NUMBER.fullmatch(str(cell).strip())) for cell in row) > 1 for row in rows)


def _cell(value: Any, decimal: str) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, int | float):
        return repr(value).replace(".", decimal)
    if isinstance(value, datetime.datetime | datetime.date | datetime.time):
        return value.isoformat()
    return " ".join(str(value).split())


_FORMULA = re.compile(r"'*\s*[=+\-@\t\r]")
_FIGURE = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?: ?[A-Za-z%°µ][A-Za-z0-9%°µ/*^() ]*)?")


def defused(cell: Any) -> Any:
    """The cell with an apostrophe before a text that a spreadsheet would compute (`=1+1`, `@cmd`); numbers, quantities
    (`-40 degC`) and all else as they are.

    Source: OWASP, CSV Injection (https://owasp.org/www-community/attacks/CSV_Injection).
    """
    if not isinstance(cell, str) or not _FORMULA.match(cell) or _FIGURE.fullmatch(cell):
        return cell
    return f"'{cell}"


def fused(cell: str) -> str:
    """What `defused` was given: the text without the apostrophe that it put before."""
    return cell[1:] if cell.startswith("'") and defused(cell[1:]) == cell else cell
