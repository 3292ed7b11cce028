"""A described result as HTML: its items in order, pictures where they belong, and where it is from at the end."""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from linkwright.report.page import page
from linkwright.report.pictures.plots import Figure
from linkwright.report.pictures.svg import element
from linkwright.report.pictures.svg import text as escaped
from linkwright.results.document import (
    Bars,
    Cell,
    Description,
    Drawn,
    Fact,
    Facts,
    Item,
    Lines,
    Paragraph,
    Picture,
    Section,
    Table,
    plain,
    words,
)
from linkwright.version import program_version

MOST_ROWS = 40
"""A longer table shows its brief rows; the others are folded."""
MOST_NARROW = 2
"""Columns that a phone has room for: the rows of a wider table are taken apart there."""
MOST_FOLDED = 150
"""Rows that are folded at most: a page stays below two megabytes, whatever a result has."""


def text(content: str) -> str:
    """Text that cannot be taken for markup, without control characters."""
    return escaped(plain(content))


def page_of(described: Description) -> str:
    """A result's page as one HTML file that loads nothing: what is not under a heading first, then tiles, then a part
    for each section. A first section that begins with a picture goes before the tiles, so that a first page has one."""
    figures: dict[str, Figure] = {}
    tiles = [_tiles(item.facts) for item in described.items if isinstance(item, Facts)]
    rest = [item for item in described.items if not isinstance(item, Facts)]
    opening = _items([item for item in rest if not isinstance(item, Section)], figures, 3)
    sections = [item for item in rest if isinstance(item, Section)]
    pictured = int(bool(sections) and isinstance(sections[0].items[0], Picture))
    made = [_section(item, figures, 2) for item in sections]
    parts = [*opening, *made[:pictured], *tiles, *made[pictured:]]
    return page(plain(described.title), plain(described.headline), parts, figures, described.without)


def _items(items: Iterable[Item], figures: dict[str, Figure], level: int) -> list[str]:
    """Items as HTML, in order; `figures` gets those of their pictures."""
    made: list[str] = []
    for item in items:
        if isinstance(item, Picture):
            drawn = item.draw()
            drawn = Drawn(drawn) if isinstance(drawn, str) else drawn
            figures.update(drawn.figures)
            made.append(drawn.html)
        elif isinstance(item, Facts):
            made.append(_tiles(item.facts))
        elif isinstance(item, Section):
            made.append(_section(item, figures, level))
        elif isinstance(item, Paragraph):
            class_ = item.tone if item.tone in ("lead", "warning", "statement", "under") else None
            content = element("strong", text(item.text)) if item.tone == "strong" else text(item.text)
            made.append(element("p", content, class_=class_))
        elif isinstance(item, Lines):
            lines = (element("li", text(line)) for line in item.lines)
            made.append(element("ul", *lines, class_="binding") if item.lines else "")
        else:
            title = element("h3", text(item.title)) if item.title else ""
            shown = table_html(item)
            folded = element("details", element("summary", text(item.title)), shown) if item.folded else ""
            made.append(folded or title + shown)
    return made


def _section(item: Section, figures: dict[str, Figure], level: int) -> str:
    opening = element("p", text(item.lead), class_="lead") if item.lead else ""
    inside = _items(item.items, figures, level + 1)
    heading = element(f"h{level}", text(item.title))
    return element("section" if level == 2 else "div", heading, opening, *inside)


def _tiles(facts: Sequence[Fact]) -> str:
    made: list[str] = []
    for fact in facts:
        before = "" if fact.before is None else f"before {words(fact.before)}"
        note = ", ".join(item for item in (before, fact.note) if item)
        definition = element("dd", text(words(fact.value)), element("small", text(note)))
        made.append(element("div", element("dt", text(fact.name)), definition, class_="tile"))
    return element("dl", *made, class_="tiles")


def table_html(given: Table) -> str:
    """A table; of one with many rows the brief ones (or the first), the others folded, while there is room."""
    if len(given.rows) <= MOST_ROWS:
        return _rows_html(given, None)
    first = given.brief or tuple(range(MOST_ROWS))
    others = sorted(set(range(len(given.rows))) - set(first))
    folded, left = others[:MOST_FOLDED], len(others[MOST_FOLDED:])
    summary = element("summary", text(f"{len(folded)} more"))
    beyond = element("p", text(f"and {left} more, in the result's JSON"), class_="lead") if left else ""
    return _rows_html(given, first) + element("details", summary, _rows_html(given, folded), beyond)


def _rows_html(table: Table, chosen: Iterable[int] | None) -> str:
    # The first column heads its rows, and stays left even where it is a number.
    numbers = set(table.numbers) - {0}

    def cell(tag: str, k: int, content: Cell, **more: str) -> str:
        inside = _bars(content) if isinstance(content, Bars) else text(words(content))
        class_ = "drawn" if isinstance(content, Bars) else "number" if k in numbers else None
        return element(tag, inside, class_=class_, **more)

    drawn = any(isinstance(content, Bars) for row in table.rows for content in row)
    # Where rows are taken apart on a phone, each cell tells its heading.
    apart = drawn or len(table.columns) > MOST_NARROW
    attributes = [{"data_head": plain(column.heading)} if apart and column.heading else {} for column in table.columns]
    heads = [cell("th", k, column.heading, scope="col") for k, column in enumerate(table.columns)]
    head = element("thead", element("tr", *heads)) if table.headed else ""
    lines: list[str] = []
    for row in table.rows if chosen is None else [table.rows[k] for k in chosen]:
        cells = [cell("td", k, content, **attributes[k]) for k, content in enumerate(row[1:], 1)]
        head_too = attributes[0] if words(row[0]).isdigit() else {}
        lines.append(element("tr", cell("th", 0, row[0], scope="row", **head_too), *cells))
    made = element("table", head, element("tbody", *lines), class_="apart" if apart else None)
    return element("div", made, class_="scroll")


def _bars(cell: Bars) -> str:
    drawn: list[str] = []
    for colour, part in cell.bars:
        width = 100.0 * min(1.0, max(0.0, part)) if math.isfinite(part) else 0.0
        fill = element("span", class_=f"fill {colour}", style=f"width:{width:.2f}%")
        drawn.append(element("div", element("span", fill, class_="track"), class_="bar"))
    return "".join(drawn)


_END = "</main>"


@dataclass(frozen=True)
class Origin:
    """`date` (UTC, ISO 8601), the program's `version`, the `files` that were read as names and SHA-256 sums; `author`
    and `comment` are the user's, and may be empty."""

    date: str
    version: str
    files: tuple[tuple[str, str], ...] = ()
    author: str = ""
    comment: str = ""

    @property
    def rows(self) -> tuple[tuple[str, str], ...]:
        """All of it, as what it is and what it says."""
        rows = [("date", self.date), ("made by", f"linkwright {self.version}")]
        rows += [("author", plain(self.author))] if self.author else []
        rows += [("comment", plain(self.comment))] if self.comment else []
        return (*rows, *((name, f"SHA-256 {total}" if total else "no longer there") for name, total in self.files))


def origin_of(files: Iterable[Path] = (), *, author: str = "", comment: str = "") -> Origin:
    """The origin of a report that is made now; SOURCE_DATE_EPOCH, where it is set, says when now is
    (https://reproducible-builds.org/specs/source-date-epoch/). A file that is gone has no sum."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    now = datetime.fromtimestamp(int(epoch), UTC) if epoch.isdecimal() and len(epoch) < 12 else datetime.now(UTC)
    named = tuple((path.name, _sum_of(path)) for path in dict.fromkeys(Path(file) for file in files))
    return Origin(now.date().isoformat(), program_version(), named, author, comment)


def signed(page: str, origin: Origin) -> str:
    """A page with its origin as the last part."""
    begin, end, rest = page.rpartition(_END)
    return f"{begin}{_part(origin)}{end}{rest}"


def _part(origin: Origin) -> str:
    lines = (
        element("tr", element("th", text(name), scope="row"), element("td", text(said))) for name, said in origin.rows
    )
    return element(
        "section", element("h2", "Where this is from"), element("table", element("tbody", *lines), class_="origin")
    )


def _sum_of(path: Path) -> str:
    """The sum of a file; none of a pipe, which was read and is empty."""
    try:
        if not path.is_file():
            return ""
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:
        return ""
