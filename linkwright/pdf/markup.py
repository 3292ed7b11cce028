"""A described result as Typst's markup. Every word goes in as a quoted string, so that none is taken for markup."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

from linkwright.pdf.pieces import FONT, Piece, pieces_of
from linkwright.report.contents import Contents
from linkwright.report.pictures.plots import Figure
from linkwright.results.document import Bars, Cell, Facts, Item, Lines, Paragraph, Picture, Section, Table, plain, words

MOST_ROWS = 60
"""A longer table shows its brief rows, or so many."""
_COLOURS = MappingProxyType({"before": "#8b95a3", "after": "#1f6feb"})
_BAD = "#b42318"
_TITLES = (14, 12, 10.5)
_WIDEST, _TALLEST, _SMALL = 170.0, 80.0, 40.0
"""Room for a drawing on the page, mm."""
_BAR = 28.0


def markup(contents: Contents, origin: Sequence[tuple[str, str]]) -> str:
    """The whole document; `origin` are lines of its last part."""
    described = contents.described
    shown = described.headline[:1].upper() + described.headline[1:]
    writer = _Writer({**contents.pictures, **contents.printed}, contents.figures)
    blocks = [
        f"#set document(title: {quoted(described.title)}, date: none)",
        '#set page(paper: "a4", margin: (x: 18mm, y: 18mm), numbering: "1 / 1")',
        f'#set text(font: {quoted(FONT)}, size: 10pt, lang: "en")',
        "#set par(leading: 0.55em)",
        "#set table(stroke: (x, y) => (bottom: 0.4pt + luma(200)), inset: (x: 3pt, y: 2.5pt))",
        "#show table: set text(size: 8pt, hyphenate: false)",
        "#show heading: it => block(above: 1.4em, below: 0.7em, sticky: true, it.body)",
        _heading(described.title, 0, 19),
        f"#block(text(size: 11.5pt, {quoted(shown)}))",
        *writer.blocks(described.items, 1),
    ]
    rows = [f"[#text({quoted(name)})], [#text({quoted(said)})]," for name, said in origin]
    if rows:
        blocks += [_heading("Where this is from", 1), f"#table(columns: (auto, 1fr), {' '.join(rows)})"]
    return "\n\n".join(blocks) + "\n"


def quoted(said: str) -> str:
    """Text as a string of Typst's."""
    held = plain(said).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{held}"'


def _heading(title: str, level: int, size: float | None = None) -> str:
    points = size or _TITLES[min(level, len(_TITLES)) - 1]
    return f'#heading(level: {level + 1}, outlined: false, text(size: {points:g}pt, weight: "bold", {quoted(title)}))'


class _Writer:
    def __init__(self, pictures: Mapping[str, str], figures: Mapping[str, Figure]) -> None:
        self._pictures, self._figures = pictures, figures

    def blocks(self, items: Iterable[Item], level: int) -> list[str]:
        """The items in order; a section in which nothing stands is left out with its heading."""
        made: list[str] = []
        for item in items:
            if isinstance(item, Section):
                inside = self.blocks(item.items, level + 1)
                lead = [f"#block(text(fill: luma(80), {quoted(item.lead)}))"] if item.lead else []
                made += [_heading(item.title, level), *lead, *inside] if inside else []
            elif isinstance(item, Picture):
                made += _drawn(pieces_of(self._pictures.get(item.name, ""), self._figures))
            elif isinstance(item, Paragraph):
                made.append(_paragraph(item))
            elif isinstance(item, Lines):
                made += [f"#list({', '.join(f'text({quoted(line)})' for line in item.lines)})"] if item.lines else []
            else:
                made += _table(item.table if isinstance(item, Facts) else item)
        return made


def _paragraph(item: Paragraph) -> str:
    if item.tone == "warning":
        bad = f'rgb("{_BAD}")'
        return f"#block(stroke: (left: 2pt + {bad}), inset: (left: 6pt), text(fill: {bad}, {quoted(item.text)}))"
    if item.tone in ("strong", "statement"):
        return f'#block(text(weight: "bold", {quoted(item.text)}))'
    fill = ", fill: luma(80)" if item.tone in ("lead", "under") else ""
    return f"#block(text(size: 10pt{fill}, {quoted(item.text)}))"


def _table(given: Table) -> list[str]:
    rows = given.rows
    left = 0
    if len(rows) > MOST_ROWS:
        kept = [rows[k] for k in given.brief] if given.brief is not None else rows[:MOST_ROWS]
        left, rows = len(rows) - len(kept), tuple(kept)
    if not rows:
        return []
    numbers = given.numbers
    widths = ", ".join("auto" for _ in given.columns)
    sides = ", ".join("right" if k in numbers else "left" for k in range(len(given.columns)))
    cells = [", ".join(_cell(cell) for cell in row) for row in rows]
    head = ", ".join(f"text(fill: luma(80), {quoted(column.heading)})" for column in given.columns)
    heading = [f"table.header({head})"] if given.headed else []
    body = ",\n  ".join([f"columns: ({widths},)", f"align: ({sides},)", *heading, *cells])
    title = (
        [f'#block(above: 1em, below: 0.6em, sticky: true, text(weight: "bold", {quoted(given.title)}))']
        if given.title
        else []
    )
    more = [f"#block(text(size: 8pt, fill: luma(80), {quoted(f'and {left} more')}))"] if left > 0 else []
    return [*title, f"#table(\n  {body},\n)", *more]


def _cell(cell: Cell) -> str:
    if not isinstance(cell, Bars):
        return f"text({quoted(words(cell))})"
    bars = [
        f'rect(width: {_BAR * max(0.0, min(1.0, part)):.2f}mm, height: 1.6mm, fill: rgb("{_COLOURS[colour]}"))'
        for colour, part in cell.bars
    ]
    return f"stack(spacing: 0.6mm, {', '.join(bars)})"


def _drawn(pieces: Sequence[Piece]) -> list[str]:
    """Drawings one under another, or side by side where two or more of them fit."""
    if not pieces:
        return []
    columns = _columns(pieces)
    room = (_WIDEST - 6.0 * (columns - 1)) / columns
    cells = ",\n  ".join(_piece(piece, room) for piece in pieces)
    return [f"#grid(columns: ({', '.join(f'{room:.1f}mm' for _ in range(columns))},), gutter: 6mm,\n  {cells},\n)"]


def _columns(pieces: Sequence[Piece]) -> int:
    if len(pieces) < 3 or any(piece.wide for piece in pieces):
        return min(len(pieces), 2)
    pairs = len(pieces) % 2 == 0 and not any(piece.heading for piece in pieces[1::2])
    return 4 if pairs else 3


def _piece(piece: Piece, room: float) -> str:
    tallest = _TALLEST if piece.wide or room > 0.5 * _WIDEST else _SMALL
    width = min(room, tallest * piece.aspect)
    parts: list[str] = []
    if piece.heading:
        parts.append(f'text(weight: "bold", size: 9pt, {quoted(piece.heading)})')
    if piece.drawing:
        parts.append(f'image(bytes({quoted(piece.drawing)}), format: "svg", width: {width:.1f}mm)')
    if piece.caption:
        parts.append(f"text(size: 8pt, fill: luma(80), {quoted(piece.caption)})")
    return f"block(breakable: false, stack(spacing: 1.6mm, {', '.join(parts)}))"
