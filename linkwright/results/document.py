"""What a result says, described once: sentences, figures and tables for screen, page and Markdown."""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from .figures_in_words import figure, with_unit


@dataclass(frozen=True)
class Value:
    """A cell of a table that holds a number as people read it; it is set right."""

    text: str


@dataclass(frozen=True)
class Bars:
    """Bars one under another, each (colour, share of the longest): `before` or `after`, and 0 to 1."""

    bars: tuple[tuple[str, float], ...]


Cell = str | Value | Bars


def words(cell: Cell) -> str:
    """What a cell says; a bar says nothing that the figures beside it do not."""
    return cell if isinstance(cell, str) else "" if isinstance(cell, Bars) else cell.text


def amount(value: float | None, unit: str = "", digits: int = 4) -> Value:
    """A number in the unit that people read, with so many digits; a dash where it is not known."""
    return Value(with_unit(value, unit, digits).strip())


def length(metres: float | None, digits: int = 4) -> Value:
    """A length (m) in mm."""
    return amount(None if metres is None else 1e3 * metres, "mm", digits)


def share(value: float, digits: int = 2) -> Value:
    """A ratio as a percentage; a dash where it is not known."""
    shown = None if math.isnan(value) else 100.0 * value
    return amount(shown, "%", digits)


def count(number: int) -> Value:
    """A whole number."""
    return Value(str(number))


@dataclass(frozen=True)
class Column:
    """A column with its `heading`; `detail`: a screen has no room for it."""

    heading: str
    detail: bool = False


BARS = Column("", detail=True)
"""The column of bars of a table that a screen shows without them."""


@dataclass(frozen=True)
class Table:
    """A table; `title` stands over it.

    `brief` are the rows that a screen shows (all by default), `rest` what it says of the others. `detail`: it is for
    page and Markdown alone. `folded`: a page opens it when asked to.
    """

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    title: str = ""
    brief: tuple[int, ...] | None = None
    rest: str = ""
    detail: bool = False
    folded: bool = False

    @property
    def numbers(self) -> tuple[int, ...]:
        """The columns of numbers, which are set right."""
        cells = [[row[k] for row in self.rows] for k in range(len(self.columns))]
        return tuple(k for k, cell in enumerate(cells) if any(isinstance(x, Value) for x in cell))

    def shortened(self) -> Table:
        """The table as a screen has room for: its brief rows, without the columns of detail."""
        kept = [k for k, column in enumerate(self.columns) if not column.detail]
        rows = self.rows if self.brief is None else [self.rows[k] for k in self.brief]
        shown = tuple(tuple(row[k] for k in kept) for row in rows)
        return replace(self, columns=tuple(self.columns[k] for k in kept), rows=shown, brief=None)

    @property
    def headed(self) -> bool:
        """Whether any column has a heading."""
        return any(column.heading for column in self.columns)


def table(
    columns: Iterable[str | Column], rows: Iterable[Sequence[Cell]], *, first: int | None = None, **more: Any
) -> Table:
    """A table; a column may be its heading alone. A screen shows the `first` rows."""
    headed = tuple(Column(x) if isinstance(x, str) else x for x in columns)
    held = tuple(tuple(row) for row in rows)
    if first is not None and len(held) > first:
        more["brief"] = tuple(range(first))
    return Table(headed, held, **more)


Tone = Literal["", "strong", "under", "lead", "warning", "statement"]


@dataclass(frozen=True)
class Paragraph:
    """A sentence or a few. `under`: what belongs to the line above; `lead`: an explanation; `detail`: not for a
    screen."""

    text: str
    tone: Tone = ""
    detail: bool = False


@dataclass(frozen=True)
class Lines:
    """Sentences that stand one under another."""

    lines: tuple[str, ...]
    detail: bool = False


@dataclass(frozen=True)
class Drawn:
    """A picture of a page: HTML, and the figures that its script draws in it, by their names."""

    html: str
    figures: Mapping[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True)
class Picture:
    """Where a page shows what `draw` draws, HTML alone or with figures; elsewhere nothing is shown, nor drawn."""

    draw: Callable[[], Drawn | str]


@dataclass(frozen=True)
class Fact:
    """A figure of the result: what it is, its value, a note; and what it was before, where something changed."""

    name: str
    value: Cell
    note: str = ""
    before: Value | None = None


@dataclass(frozen=True)
class Facts:
    """The figures that sum a result up: a table on a screen (not with `detail`), tiles at the head of a page.

    `headed`: the table has headings.
    """

    facts: tuple[Fact, ...]
    headed: bool = True
    detail: bool = False

    @property
    def table(self) -> Table:
        """The same as a table."""
        if any(fact.before is not None for fact in self.facts):
            rows = [(fact.name, fact.before or "", fact.value, fact.note) for fact in self.facts]
            return table(("", "before", "after", ""), rows)
        headings = ("figure", "value", "") if self.headed else ("", "", "")
        return table(headings, [(fact.name, fact.value, fact.note) for fact in self.facts])


@dataclass(frozen=True)
class Section:
    """A part under a heading; `lead` says what to see in it. A screen shows what it holds without the heading.

    `opened`: on a screen, too, the title stands over it. `detail`: not for a screen.
    """

    title: str
    items: tuple[Item, ...]
    lead: str = ""
    opened: bool = False
    detail: bool = False


Item = Paragraph | Lines | Table | Picture | Facts | Section


@dataclass(frozen=True)
class Description:
    """A result: `title` heads a page, `headline` is the answer in a sentence, `items` are the rest in order.

    `brief` is the answer in a few words; `subject` is what a screen, which shows no title, puts before the headline;
    `without` what a reader of the page misses whose browser runs no scripts.
    """

    title: str
    headline: str
    items: tuple[Item, ...]
    brief: str = ""
    subject: str = ""
    without: str = "Without JavaScript the maps are not drawn. result.json has the figures."


def section(title: str, *items: Item | None, lead: str = "", opened: bool = False, detail: bool = False) -> Section:
    """A section of what there is: None is left out."""
    return Section(title, tuple(item for item in items if item is not None), lead, opened, detail)


def plain(text: str) -> str:
    """Text without control characters, which could move a terminal's cursor or break a table's line."""
    return "".join(" " if x in "\n\r\t" else "\ufffd" if unicodedata.category(x) == "Cc" else x for x in text)


def number(value: float | None, digits: int = 4) -> Value:
    """A number without a unit."""
    return Value(figure(value, digits))
