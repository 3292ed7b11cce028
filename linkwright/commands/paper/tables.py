"""`linkwright tables`: the paper's Tables III to VII beside the truth."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from linkwright.writing import check_target, write_file, write_json
from materials.quantities import InputError

from .options import JsonFile

if TYPE_CHECKING:
    from linkwright.paper.rows import ExtendedTable

HELP = """The paper's Tables III to VII: printed, reproduced by its conventions, as its equations read, and corrected.

After them the extended tables, which the paper lacks; they take about a minute, and --quick leaves them out.

Example: linkwright tables --markdown tables.md --json tables.json
"""
KEYS = ("clearance", "backlash", "backlash_direction", "material", "shape")
"""The tables' names in JSON and of the CSV files."""
EXTENDED_KEYS = (
    "shapes_at_their_best",
    "materials_fairly",
    "step_by_step",
    "tolerances",
    "seam",
    "heat_and_field",
    "rail",
    "dual_arm",
)
"""The same of the extended tables."""


def tables(
    json: JsonFile = None,
    csv: Annotated[Path | None, typer.Option("--csv", metavar="DIR", help="Write each table as CSV there.")] = None,
    markdown: Annotated[
        Path | None,
        typer.Option(
            "--markdown", metavar="FILE", help="Write as Markdown; between the marks of a file that has them."
        ),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Leave the extended tables out.")] = False,
) -> None:
    """Run the command."""
    from linkwright.screen.console import console, waiting

    check_target(json)
    check_target(markdown)
    if json is not None and markdown is not None and json.absolute() == markdown.absolute():
        raise InputError(json, "", "is named for JSON and for Markdown; name two files")
    if csv is not None:
        from linkwright.paper.folders import claim

        claim(csv, [f"{key}.csv" for key in (*KEYS, *EXTENDED_KEYS)], f"{KEYS[0]}.csv", "label,paper_")
    with waiting("computing the paper's tables"):
        from linkwright.paper.output import all_into, extended_csv, table_csv, tables_json, tables_markdown
        from linkwright.paper.screen import show_extended, show_tables
        from linkwright.paper.tables import make_tables
        from linkwright.paper.verdicts import proofs, verdicts

        book = make_tables()
        judged, shown = verdicts(book), proofs(book)
    screen = console()
    extended: tuple[ExtendedTable, ...] = ()
    if not quick:
        from linkwright.paper.extended import make_extended

        extended = make_extended(_say)
    written: list[Path] = []
    if json is not None:
        write_json(json, tables_json(book, judged, shown, extended))
        written.append(json)
    if csv is not None:
        for table in book.tables:
            write_file(csv / f"{table.key}.csv", table_csv(table))
            written.append(csv / f"{table.key}.csv")
        for each in extended:
            write_file(csv / f"{each.key}.csv", extended_csv(each))
            written.append(csv / f"{each.key}.csv")
    if markdown is not None:
        write_file(markdown, all_into(_text_of(markdown), tables_markdown(book, judged, shown), extended))
        written.append(markdown)
    show_tables(screen, book, judged, shown)
    show_extended(screen, extended)
    for path in written:
        screen.print(f"written: {path}", soft_wrap=True)


def _say(done: int, total: int, text: str) -> None:
    """A line for each extended table begun, beside the output."""
    from linkwright.screen.console import console

    console(errors=True).print(f"{text} ({done + 1} of {total})")


def _text_of(path: Path) -> str:
    if not path.is_file():
        return ""
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise InputError(path, "", "is no text file; name another to write") from None
