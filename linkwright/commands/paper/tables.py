"""`linkwright tables`: the paper's Tables III to VII beside the truth."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any

import typer

from linkwright.commands.made import Made, Targets
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import read_text
from linkwright.output.files import write_file

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


TABLES: Mapping[str, Any] = MappingProxyType(
    {
        "csv": Annotated[
            Path | None, typer.Option("--csv", metavar="DIR", help="Write each table there, as CSV or what --as names.")
        ],
        "kind": Annotated[TableKind | None, typer.Option("--as", help="How the tables in --csv DIR are written.")],
        "markdown": Annotated[
            Path | None,
            typer.Option(
                "--markdown", metavar="FILE", help="Write as Markdown; between the marks of a file that has them."
            ),
        ],
    }
)
"""The options of `tables`."""


class Tables(Made):
    """`tables`: each can be written as a file of its own, and all into a page of Markdown that is there."""

    def checked(self, targets: Targets, words: dict[str, Any], inputs: Sequence[Path]) -> Targets:
        """The folder of tables too."""
        from linkwright.output.table_file import check_table
        from linkwright.paper.output.folders import claim

        json, csv, kind = targets.json, targets.csv, targets.kind or TableKind.CSV
        found = super().checked(replace(targets, csv=None), words, inputs)
        if json is not None and targets.markdown is not None and json.absolute() == targets.markdown.absolute():
            raise InputError(json, "", "is named for JSON and for Markdown; name two files")
        if csv is not None:
            names = [f"{key}.{kind.value}" for key in KEYS]
            check_table(csv / names[0])
            claim(csv, names, names[0], _SIGNATURES[kind])
        return replace(found, csv=csv, kind=kind)

    def write(self, result: Any, targets: Targets, read: Sequence[Path]) -> list[Path]:
        """Each table, and the page between its marks."""
        from linkwright.paper.output.pages import into, tables_markdown

        markdown = targets.markdown
        written = super().write(result, replace(targets, markdown=None), read)
        if targets.csv is not None:
            written += _write_each(result, targets.csv, targets.kind)
        if markdown is not None:
            text = read_text(markdown) if os.path.isfile(markdown) else ""
            write_file(markdown, into(text, tables_markdown(result.book, result.verdicts, result.proofs)))
            written.append(markdown)
        return written

    def answer(self, result: Any) -> None:
        """The tables and the verdicts."""
        from linkwright.paper.output.screen import show_tables
        from linkwright.screen.console import console

        show_tables(console(), result.book, result.verdicts, result.proofs)


def _write_each(made: Any, folder: Path, kind: TableKind) -> list[Path]:
    """Write each table as a file of its kind."""
    import pandas as pd

    from linkwright.output.table_file import write_table
    from linkwright.paper.output.pages import table_csv

    written: list[Path] = []
    for table in made.book.tables:
        file = folder / f"{table.key}.{kind.value}"
        if kind is TableKind.CSV:
            write_file(file, table_csv(table))
        else:
            write_table(pd.read_csv(io.StringIO(table_csv(table))), file)
        written.append(file)
    return written
