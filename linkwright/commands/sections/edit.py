"""`linkwright sections` on stock tables of one's own: `add`, `edit`, `import`, `export` and the like."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

import linkwright as lw
from linkwright.commands.catalogues.own import Changes, Name, OwnCatalogue, OwnFile, Source, changes_of, say
from linkwright.commands.groups import Commands
from linkwright.core.catalogues.stock_csv import read_table, write_table
from linkwright.core.catalogues.stock_editor import STOCK, Row, cell, columns_of, row_of, rows_text
from linkwright.core.sections.stock.tables import shipped_sizes, user_stock_path
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import read_text
from linkwright.output.files import check_target
from linkwright.output.table_file import rows_of

from .stock import StockFile

ADD_HELP = """Add a stock size to your tables; printed figures, where given, must be those of its dimensions.

Example: linkwright sections add 'TUBE 60x4' shape=tube diameter='60 mm' thickness='4 mm' --source 'Offer 12'
"""
EDIT_HELP = """Change keys of a stock size, or the file in $EDITOR; a shipped size is copied to yours.

Example: linkwright sections edit 'TUBE 60x4' thickness '5 mm'
"""
IMPORT_HELP = """Put stock sizes from a .yaml, .csv or .xlsx file into your tables; all of it or nothing.

Example: linkwright sections import supplier.csv
"""
EXPORT_HELP = """Write stock sizes to a .yaml or .csv file, or to .tex, .md, .parquet; all without a name or family.

Example: linkwright sections export --family IPE --out ipe.csv
"""
CHECK_HELP = "Recompute A and I of every row of stock tables; without a file those of the shipped ones and yours."


def _made(name: str, given: dict[str, str], source: str) -> Row:
    if "shape" not in given:
        raise InputError("", "shape", "is missing; write shape=tube, say")
    if not source:
        raise InputError("", "--source", "is missing: say where the size is from")
    shape = given.pop("shape")
    columns_of(shape)
    found = re.match(r"[^\d]*[^\d\s]", name)
    family = given.pop("family", found[0] if found else name)
    return Row(name, family, shape, source, dict(cell(shape, key, value) for key, value in given.items()))


OWN = OwnCatalogue(
    group="sections",
    editor=STOCK,
    own=lambda: user_stock_path(),
    entry="stock size",
    called="tables",
    key="section",
    count=lambda path: len(STOCK.check(read_text(path), path)),
    shipped=lambda: [("shipped tables", len(shipped_sizes()))],
    examples=("'TUBE 60x4'", "'OUR 60x4'"),
    helps={"add": ADD_HELP, "import": IMPORT_HELP, "check": CHECK_HELP},
    such_as="thickness='4 mm'",
    made=_made,
    table=lambda path: lw.sections.with_file(path).table,
    read={
        ".yaml": lambda path: [row_of(size) for size in STOCK.check(read_text(path), path)],
        ".csv": read_table,
        ".xlsx": read_table,
    },
)


def edit_section(
    name: Name,
    changes: Changes = None,
    source: Source = "",
    unset: Annotated[str | None, typer.Option("--unset", metavar="KEY", help="Take this key away.")] = None,
    catalogue: OwnFile = None,
) -> None:
    """Run `sections edit`."""
    path = OWN.path(catalogue)
    if unset is not None:
        if changes or source:
            raise InputError("", "--unset", "stands alone")
        say(STOCK.remove_cell(path, name, unset), path)
    elif changes or source:
        say(STOCK.change_cells(path, name, changes_of(changes or [], OWN.such_as), source=source), path)
    else:
        OWN.edit_in_editor(path, name)


def export_sections(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME...]", help="Which; all without a name.")] = None,
    family: Annotated[list[str] | None, typer.Option("--family", help="This family too; may be repeated.")] = None,
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="A .yaml, .csv, .parquet, .md or .tex file.")
    ] = Path("sections.yaml"),
    catalogue: StockFile = None,
) -> None:
    """Run `sections export`."""
    check_target(out, catalogue)
    known = lw.sections.with_file(catalogue)
    found = [*(known[name] for name in names or ()), *known.of_family(*family or ())]
    if not names and not family:
        found = list(known.values())
    rows = [row_of(size) for size in {size.name: size for size in found}.values()]
    OWN.write(
        out, rows, {".yaml": rows_text, ".csv": write_table}, lambda: rows_of(known.table, [row.name for row in rows])
    )


def commands() -> Commands:
    """These commands by name."""
    return OWN.commands({"edit": (edit_section, EDIT_HELP), "export": (export_sections, EXPORT_HELP)})
