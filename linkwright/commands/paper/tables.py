"""`linkwright tables`: the paper's Tables III to VII beside the truth."""

from __future__ import annotations

import io
import os
from enum import StrEnum
from pathlib import Path
from types import MappingProxyType
from typing import Annotated

import typer

import linkwright as lw
from linkwright.commands.options import JsonFile
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import read_text
from linkwright.output.files import check_target, write_file, write_result

HELP = """The paper's Tables III to VII: printed, reproduced by its conventions, as its equations read, and corrected.

Example: linkwright tables --markdown tables.md --json tables.json
Example: linkwright tables --csv tables --as tex
"""
KEYS = ("clearance", "backlash", "backlash_direction", "material", "shape")
"""The tables' names in JSON and of the CSV files."""


class TableKind(StrEnum):
    """How a table is written."""

    CSV = "csv"
    PARQUET = "parquet"
    MARKDOWN = "md"
    LATEX = "tex"


_SIGNATURES = MappingProxyType(
    {
        TableKind.CSV: "label,paper_",
        TableKind.PARQUET: "PAR1",
        TableKind.MARKDOWN: "| label | paper_",
        TableKind.LATEX: "booktabs",
    }
)
"""What the first table begins with."""


def tables(
    json: JsonFile = None,
    csv: Annotated[
        Path | None, typer.Option("--csv", metavar="DIR", help="Write each table there, as CSV or what --as names.")
    ] = None,
    kind: Annotated[TableKind, typer.Option("--as", help="How the tables in --csv DIR are written.")] = TableKind.CSV,
    markdown: Annotated[
        Path | None,
        typer.Option(
            "--markdown", metavar="FILE", help="Write as Markdown; between the marks of a file that has them."
        ),
    ] = None,
) -> None:
    """Run the command."""
    import pandas as pd

    from linkwright.output.table_file import check_table, write_table
    from linkwright.screen.console import console

    check_target(json)
    check_target(markdown)
    if json is not None and markdown is not None and json.absolute() == markdown.absolute():
        raise InputError(json, "", "is named for JSON and for Markdown; name two files")
    if csv is not None:
        from linkwright.paper.output.folders import claim

        names = [f"{key}.{kind.value}" for key in KEYS]
        check_table(csv / names[0])
        claim(csv, names, names[0], _SIGNATURES[kind])
    from linkwright.paper.output.pages import into, table_csv, tables_markdown
    from linkwright.paper.output.screen import show_tables

    made = lw.tables()
    screen = console()
    written: list[Path] = []
    if json is not None:
        write_result(json, made.to_json())
        written.append(json)
    if csv is not None:
        files = {table.key: table_csv(table) for table in made.book.tables}
        for key, text in files.items():
            file = csv / f"{key}.{kind.value}"
            if kind is TableKind.CSV:
                write_file(file, text)
            else:
                write_table(pd.read_csv(io.StringIO(text)), file)
            written.append(file)
    if markdown is not None:
        block = tables_markdown(made.book, made.verdicts, made.proofs)
        write_file(markdown, into(_text_of(markdown), block))
        written.append(markdown)
    show_tables(screen, made.book, made.verdicts, made.proofs)
    for path in written:
        screen.print(f"written: {path}", soft_wrap=True)


def _text_of(path: Path) -> str:
    return read_text(path) if os.path.isfile(path) else ""
