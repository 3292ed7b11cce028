"""A described result on the screen: the answer first, then its tables; what is detail is left to page and Markdown."""

from __future__ import annotations

from collections.abc import Iterable

import rich.table
from rich.console import Console

from linkwright.results.document import (
    Bars,
    Cell,
    Description,
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
from linkwright.screen.console import Loudness, loudness

from .console import table as empty_table

_BAR = 24
_WIDE = 80
_STYLES = (("strong", "bold"), ("warning", "bold red"))


def show(out: Console, description: Description) -> None:
    """Print a result, as much of it as `linkwright.screen.console` says."""
    how = loudness()
    _say(out, f"{description.subject}{description.headline}", "bold")
    _Shown(out, how).show(_warnings(description.items) if how == "answer" else description.items)


def _warnings(items: Iterable[Item]) -> list[Item]:
    return [item for item in items if isinstance(item, Paragraph) and item.tone == "warning"]


class _Shown:
    """Prints items with a blank line before every table and every section, and none between sentences."""

    def __init__(self, out: Console, how: Loudness) -> None:
        self._out, self._how, self._gap = out, how, False

    def show(self, items: Iterable[Item]) -> None:
        for item in items:
            if isinstance(item, Picture) or (item.detail and self._how != "all"):
                continue
            if isinstance(item, Section):
                self._section(item)
            elif isinstance(item, Paragraph):
                prefix = "  " if item.tone == "under" else "WARNING: " if item.tone == "warning" else ""
                self._say(f"{prefix}{item.text}", dict(_STYLES).get(item.tone))
            elif isinstance(item, Lines):
                for line in item.lines:
                    self._say(line)
            else:
                self._part()
                given = item.table if isinstance(item, Facts) else item
                self._out.print(drawn(given, self._out.width, whole=self._how == "all"))
                self._gap = False

    def _section(self, item: Section) -> None:
        self._part()
        if item.opened:
            self._say(item.title, "bold")
        self.show(item.items)

    def _part(self) -> None:
        if not self._gap:
            self._out.print()
        self._gap = True

    def _say(self, text: str, style: str | None = None) -> None:
        _say(self._out, text, style)
        self._gap = False


def _say(out: Console, text: str, style: str | None = None) -> None:
    # A sentence is printed whole where it is not to fit anything, so that it can be searched for.
    for line in text.split("\n"):
        out.print(plain(line), style=style, soft_wrap=True)


def drawn(given: Table, width: int, *, whole: bool = False) -> rich.table.Table:
    """A table as a screen of so many columns shows it: its brief rows (or the `whole` of it), bars as blocks."""
    blocks = _BAR if width >= _WIDE else _BAR // 3
    short = given if whole else given.shortened()
    headings = (plain(column.heading) for column in short.columns)
    made = empty_table(*headings, numbers=short.numbers, title=plain(given.title) or None)
    made.show_header = short.headed
    for row in short.rows:
        made.add_row(*(_cell(cell, blocks) for cell in row))
    if len(short.rows) < len(given.rows) and given.rest:
        made.caption, made.caption_justify = plain(given.rest), "left"
    return made


def _cell(cell: Cell, blocks: int) -> str:
    if not isinstance(cell, Bars):
        return plain(words(cell))
    part = cell.bars[0][1]
    return "█" * round(blocks * part) or "▏" if part > 0.0 else ""
