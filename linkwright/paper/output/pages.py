"""The paper's tables as plain data, JSON, CSV and Markdown, and on the screen, drawn from the results alone."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

from linkwright.output.table_file import frame
from linkwright.paper.extended import Extended
from linkwright.paper.output.figures import Figure
from linkwright.paper.printed import Row, Table, tally
from linkwright.paper.tables import Book, Proof, Verdict
from linkwright.results.document import Description, Lines, Paragraph, Section, Value, number, section
from linkwright.results.document import table as shown

BEGIN, END = "<!-- begin: linkwright tables -->", "<!-- end: linkwright tables -->"
"""Between these lines `--markdown` replaces, in a file that has them."""


def tables_json(book: Book, verdicts: Sequence[Verdict], proofs: Sequence[Proof]) -> dict[str, Any]:
    """All tables by their keys, with what was judged and what was fitted."""
    counted = tally(book.tables)
    content: dict[str, Any] = {table.key: [_row_json(row) for row in table.rows] for table in book.tables}
    content["columns"] = {table.key: list(table.columns) for table in book.tables}
    content["remarks"] = {table.key: list(table.remarks) for table in book.tables}
    content["figures_reproduced"] = {"met": counted.met, "printed": counted.printed}
    content["fitted_to_the_paper_mm"] = {"weight": 1e3 * book.paper.weight_sag, "tool": 1e3 * book.paper.tool_sag}
    content["verdicts"] = [
        {"conclusion": verdict.number, "claim": verdict.claim, "judgement": verdict.judgement, "reason": verdict.reason}
        for verdict in verdicts
    ]
    content["reach"] = [_proof_json(proof) for proof in proofs]
    return content


def _row_json(row: Row) -> dict[str, Any]:
    return {
        "label": row.label,
        "paper": [float(text) for text in row.printed],
        "reproduced": [float(text) for text in row.reproduced_printed],
        "agrees": list(row.agrees),
        **row.computed,
        "note": row.note,
    }


def _proof_json(proof: Proof) -> dict[str, Any]:
    seam = proof.seam
    content: dict[str, Any] = {"statement": proof.statement, "holds": proof.holds, "shown_by": proof.shown_by}
    if seam is not None:
        first = seam.first_unreachable
        content["seam"] = {
            "from_mm": [1e3 * value for value in seam.start],
            "to_mm": [1e3 * value for value in seam.end],
            "verdict": seam.verdict,
            "exact": seam.exact,
            "proved_to_share": seam.proved_to,
            "first_unreachable_mm": None if first is None else [1e3 * value for value in first],
            "missing_mm": 1e3 * seam.missing,
        }
    return content


def figures_json(figures: Sequence[Figure]) -> dict[str, Any]:
    """All figures' data; null where a map has no pose."""
    return {
        "figures": [
            {
                "number": figure.number,
                "title": figure.title,
                "marks": dict(figure.marks),
                "remarks": list(figure.remarks),
                "columns": {name: [plain(value) for value in values] for name, values in figure.columns.items()},
            }
            for figure in figures
        ],
    }


def plain(value: float) -> float | None:
    """The value to ten digits, None for NaN."""
    return None if value != value else float(f"{value:.10g}")


def table_csv(table: Table) -> str:
    """A table as CSV: a line per row, each measure's columns side by side, then the note."""
    names = [column.replace(" ", "_") for column in table.columns]
    rows: list[dict[str, Any]] = []
    for row in table.rows:
        measures: dict[str, Iterable[Any]] = {"paper": row.printed}
        measures |= {name: map(plain, values) for name, values in row.computed.items()}
        cells = {
            f"{name}_{of}": value for name, values in measures.items() for of, value in zip(names, values, strict=False)
        }
        rows.append({"label": row.label, **cells, "note": row.note})
    return _csv(rows)


def figure_csv(figure: Figure) -> str:
    """A figure's columns as CSV; empty where a map has no pose."""
    return _csv({name: [plain(value) for value in values] for name, values in figure.columns.items()})


def _csv(rows: Any) -> str:
    return str(frame(rows).to_csv(index=False, lineterminator="\n"))


def cells(row: Row) -> tuple[str, str, str, str]:
    """A row's four cells: printed, reproduced (≠ where it differs), as the equations read, corrected."""
    reproduced = [text if met else f"≠ {text}" for text, met in zip(row.reproduced_printed, row.agrees, strict=True)]
    if len(set(row.printed)) == 1 and row.counted == 1:
        return row.printed[0], reproduced[0], _millimetres(row.as_read[:1]), _millimetres(row.corrected[:1])
    return " / ".join(row.printed), " / ".join(reproduced), _millimetres(row.as_read), _millimetres(row.corrected)


def _millimetres(values: Sequence[float]) -> str:
    def millimetres(value: float) -> str:
        return "0" if value == 0.0 else f"{1e3 * value:.4f}" if value < 0.1 else f"{1e3 * value:.0f}"

    return " / ".join(map(millimetres, values))


def notes(table: Table) -> list[tuple[str, str]]:
    """The rows' notes, each with the labels of the rows that it holds for."""
    labels_by_note: dict[str, list[str]] = {}
    for row in table.rows:
        labels_by_note.setdefault(row.note, []).append(row.label)
    return [("; ".join(labels), note) for note, labels in labels_by_note.items() if note]


def heading(table: Table) -> str:
    """A table's heading, with what its figures stand for."""
    meaning = f" ({' / '.join(table.columns)})" if len(table.columns) > 1 else ""
    return f"Table {table.number}: {table.title}{meaning}"


def tally_words(book: Book) -> str:
    """How many printed figures are met, in a sentence."""
    counted = tally(book.tables)
    return (
        f"{counted.met} of the {counted.printed} figures printed in Tables III to VII are reproduced to their last "
        "digit. The others are marked ≠ and explained."
    )


def describe(
    book: Book, verdicts: Sequence[Verdict], proofs: Sequence[Proof], extended: Sequence[Extended] = ()
) -> Description:
    """All tables, those that the paper lacks, the verdicts and the statements on reach."""
    counted = tally(book.tables)
    judged = [f"{verdict.number}. “{verdict.claim}”: {verdict.judgement}. {verdict.reason}" for verdict in verdicts]
    reach = [f"{proof.statement} {'Holds' if proof.holds else 'Does not hold'}. {proof.shown_by}" for proof in proofs]
    items = (
        Paragraph(tally_words(book)),
        Lines(book.tables[0].remarks[1:]),
        *(_section(table) for table in book.tables),
        *(_further(table) for table in extended),
        section("The paper's four conclusions", Lines(tuple(judged)), opened=True),
        section("What it says about reach", Lines(tuple(reach)), opened=True),
    )
    headline = "The paper's position errors beside the truth."
    brief = f"{counted.met} of {counted.printed} printed figures reproduced"
    return Description("The paper's tables", headline, items, brief)


def _section(table: Table) -> Section:
    columns = ("", "paper, “mm”", "reproduced, mm²", "equations, mm", "corrected, mm")
    rows = [(row.label, *map(Value, cells(row))) for row in table.rows]
    notes_here = tuple(f"{labels}: {note}" for labels, note in notes(table))
    return section(heading(table), Paragraph(table.remarks[0]), shown(columns, rows), Lines(notes_here), opened=True)


def _further(table: Extended) -> Section:
    rows = [
        tuple(cell if isinstance(cell, str) else number(cell, 3) for cell in (row[key] for key in table.columns))
        for row in table.rows
    ]
    return section(table.title, Paragraph(table.note), shown(table.columns.values(), rows), opened=True)


def into(document: str, block: str, begin: str = BEGIN, end: str = END) -> str:
    """The document with what stands between its two marks replaced; the block alone where there are none."""
    if begin not in document or end not in document:
        return block
    between = re.compile(re.escape(begin) + ".*?" + re.escape(end), re.DOTALL)
    return between.sub(lambda _: f"{begin}\n{block}{end}", document, count=1)
