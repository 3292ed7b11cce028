"""`linkwright sections import` and `export`: files of stock tables, and CSV for spreadsheets.

The columns of the CSV are `name`, `family`, `shape`, `source`, one a dimension (`height_mm`) and the printed figures
(`area_cm2`, `second_moment_y_cm4`, `second_moment_z_cm4`); a cell is empty where a shape has no such dimension.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from linkwright.writing import check_target, write_file
from materials.quantities import InputError
from materials.reading import nearest, read_text
from sections import SHAPES, SectionError, StockSize
from sections.stock import PRINTED

from . import sections_rows
from .groups import Commands
from .materials_edit import say
from .sections_edit import OwnFile, own
from .sections_rows import Row
from .sections_stock import StockFile, stock_with

IMPORT_HELP = """Put stock sizes from a .yaml or .csv file into your tables; all of it or nothing.

Example: linkwright sections import supplier.csv
"""
EXPORT_HELP = """Write stock sizes to a .yaml or .csv file; all of them without a name or a family.

Example: linkwright sections export --family IPE --out ipe.csv
"""
_HEAD = ("name", "family", "shape", "source")


def import_sections(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A .yaml or .csv file.")],
    replace: Annotated[bool, typer.Option("--replace", help="Take the place of those of the same name.")] = False,
    catalogue: OwnFile = None,
) -> None:
    """Run `sections import`."""
    ending = file.suffix.lower()
    if ending in (".yaml", ".yml"):
        rows = [sections_rows.row_of(size) for size in sections_rows.check(read_text(file), file)]
    elif ending == ".csv":
        rows = read_table(file)
    else:
        raise InputError(file, "", "is of no known kind; known: .yaml, .csv")
    path = own(catalogue)
    done = sections_rows.add(path, rows, replaced=replace)
    say(done if len(rows) <= 5 else f"added {len(rows)} sizes", path)


def export_sections(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME...]", help="Which; all without a name.")] = None,
    family: Annotated[list[str] | None, typer.Option("--family", help="This family too; may be repeated.")] = None,
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="A .yaml or .csv file.")] = Path("sections.yaml"),
    catalogue: StockFile = None,
) -> None:
    """Run `sections export`."""
    check_target(out, catalogue)
    stock = stock_with(catalogue)
    found: list[StockSize] = []
    try:
        found += [stock.find(name) for name in names or ()]
        found += [size for each in family or () for size in stock.of_family(each)]
    except SectionError as error:
        raise InputError("", error.key, error.message) from None
    if not names and not family:
        found = list(stock)
    rows = [sections_rows.row_of(size) for size in {size.name: size for size in found}.values()]
    ending = out.suffix.lower()
    if ending not in (".yaml", ".yml", ".csv"):
        raise InputError(out, "", "is of no known kind; known: .yaml, .csv")
    write_file(out, write_table(rows) if ending == ".csv" else sections_rows.rows_text(rows))
    typer.echo(f"wrote {len(rows)} size{'' if len(rows) == 1 else 's'} to {out}")


def write_table(rows: Sequence[Row]) -> str:
    """The rows as comma-separated values, with the columns that any of them has."""
    used = {column for row in rows for column in row.cells}
    stream = io.StringIO()
    writer = csv.DictWriter(stream, [*_HEAD, *(c for c in _all_columns() if c in used)], lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({**{name: getattr(row, name) for name in _HEAD}, **row.cells})
    return stream.getvalue()


def read_table(path: Path) -> list[Row]:
    """The rows of a table of comma-separated values; columns may be in any order. Raises `InputError`."""
    reader = csv.DictReader(io.StringIO(read_text(path), newline=""), strict=True)
    known = [*_HEAD, *_all_columns()]
    try:
        headings = list(reader.fieldnames or ())
        for heading in headings:
            if heading not in known:
                raise InputError(path, "", f"unknown column '{heading}'{nearest(heading, known)}")
        for column in _HEAD:
            if column not in headings:
                raise InputError(path, "", f"has no column '{column}'")
        rows = [_row(row, path, reader.line_num) for row in reader]
    except csv.Error as error:
        raise InputError(path, f"line {reader.line_num}", f"is no table: {error}") from None
    if not rows:
        raise InputError(path, "", "has no rows")
    return rows


def _row(row: dict[Any, Any], path: Path, line: int) -> Row:
    where = f"line {line}"
    if None in row or None in row.values():
        raise InputError(path, where, "has not as many cells as the heading")
    texts = {str(key): str(value).strip() for key, value in row.items() if str(value).strip()}
    for column in _HEAD:
        if column not in texts:
            raise InputError(path, where, f"has no {column}")
    name, family, shape, source = (texts.pop(column) for column in _HEAD)
    if shape not in SHAPES:
        raise InputError(path, f"{where}: shape", f"there is no shape '{shape}'{nearest(shape, list(SHAPES))}")
    cells: dict[str, float] = {}
    for column, text in texts.items():
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError(path, f"{where}: {column}", f"needs a number, not '{text}'")
        cells[sections_rows.column_of(shape, column)] = sections_rows.neat(value)
    return Row(name, family, shape, source, {c: cells[c] for c in sections_rows.columns_of(shape) if c in cells})


def _all_columns() -> list[str]:
    """Every dimension that any shape has, then the printed figures."""
    dimensions = (f"{each.name}_mm" for kind in SHAPES.values() for each in kind.dimensions if each.kind != "points")
    return [*dict.fromkeys(dimensions), *PRINTED]


def commands() -> Commands:
    """These commands by name."""
    return {"import": (import_sections, IMPORT_HELP), "export": (export_sections, EXPORT_HELP)}
