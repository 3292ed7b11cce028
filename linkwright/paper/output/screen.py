"""The paper's tables on the screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console

from linkwright.paper.rows import Table
from linkwright.paper.tables import Book
from linkwright.paper.verdicts import Proof, Verdict
from linkwright.screen.console import table as empty_table

from .pages import cells, heading, notes, tally_words


def show_tables(out: Console, book: Book, verdicts: Sequence[Verdict], proofs: Sequence[Proof]) -> None:
    """Print all tables, what they rest on, and the verdicts."""
    out.print("The paper's position errors beside the truth.", style="bold")
    for remark in book.tables[0].remarks[1:]:
        out.print(f"- {remark}")
    out.print()
    for each in book.tables:
        _show(out, each)
    out.print(tally_words(book), style="bold")
    out.print()
    out.print("The paper's four conclusions", style="bold")
    for verdict in verdicts:
        out.print(f"{verdict.number}. “{verdict.claim}”: {verdict.judgement}.")
        out.print(f"   {verdict.reason}")
    out.print()
    out.print("What it says about reach", style="bold")
    for proof in proofs:
        out.print(f"- {proof.statement} {'Holds' if proof.holds else 'Does not hold'}.")
        out.print(f"  {proof.shown_by}")


def _show(out: Console, table: Table) -> None:
    headings = ("", "paper, “mm”", "reproduced, mm²", "equations, mm", "corrected, mm")
    shown = empty_table(*headings, numbers=(1, 2, 3, 4), title=heading(table))
    for row in table.rows:
        shown.add_row(row.label, *cells(row))
    out.print(shown)
    out.print(table.remarks[0])
    for labels, note in notes(table):
        out.print(f"- {labels}: {note}")
    out.print()
