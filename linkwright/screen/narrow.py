"""Tables on terminals too narrow for them: no word is broken and no figure torn from its unit while there is a way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.measure import Measurement
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from linkwright.output.stream import printable

_BETWEEN = 3
"""Columns between two columns of a table."""


class FittingTable(Table):
    """A table that widens columns whose words would be broken at the cost of those that can be wrapped; first figures
    keep their units beside them, then they may stand under each other, and where words still do not fit, the rows
    stand one below the other, each cell with its heading."""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """The table, as wide as there is room."""
        room = options.max_width - _BETWEEN * (len(self.columns) - 1)
        widths = [self._asked(console, options, k) for k in range(len(self.columns))]
        usual = self._calculate_column_widths(console, options.update_width(options.max_width - self._extra_width))
        inside = [width - self._get_padding_width(k) for k, width in enumerate(usual)]
        if any(has < least for has, (least, _, _) in zip(inside, widths, strict=True)):
            least = next(
                (item for item in zip(*((a, b) for a, b, _ in widths), strict=True) if sum(item) <= room), None
            )
            if least is None:
                yield from self._one_below_the_other(options.max_width)
                return
            for column, width in zip(self.columns, _shared(least, [most for *_, most in widths], room), strict=True):
                column.width = width
        yield from super().__rich_console__(console, options)

    def _cells(self, index: int) -> Iterator[RenderableType]:
        column = self.columns[index]
        if self.show_header:
            yield column.header
        yield from column.cells

    def _asked(self, console: Console, options: ConsoleOptions, index: int) -> tuple[int, int, int]:
        """How wide a column has to be for whole figures with units, for whole words, and for whole cells."""
        column = self.columns[index]
        cells = [Measurement.get(console, options.update(max_width=10_000), cell) for cell in self._cells(index)]
        least = max((cell.minimum for cell in cells), default=0)
        most = max((cell.maximum for cell in cells), default=0)
        heads = 1 if self.show_header else 0
        figures = max([least, *(cell.maximum for cell in cells[heads:])]) if column.justify == "right" else least
        return figures, least, most

    def _one_below_the_other(self, width: int) -> Iterator[RenderableType]:
        if self.title:
            yield Text(printable(str(self.title)), style=self.title_style or "")
        headings = [str(column.header) if self.show_header else "" for column in self.columns]
        for row in zip(*(tuple(column.cells) for column in self.columns), strict=True):
            cells = [(heading, printable(str(cell))) for heading, cell in zip(headings, row, strict=True)]
            yield from _stacked(cells, width)
        if self.caption:
            yield Text(printable(str(self.caption)))


def _stacked(row: Sequence[tuple[str, str]], width: int) -> Iterator[RenderableType]:
    heading, first = row[0]
    if first:
        # A bare number says nothing without its heading.
        yield Text(f"{heading} {first}".strip() if first.isdigit() else first, style="bold", overflow="fold")
    for name, cell in row[1:]:
        if cell:
            yield Padding(Text(f"{name}: {cell}" if name else cell, overflow="fold"), (0, 0, 0, min(2, width // 8)))


def _shared(least: Sequence[int], most: Sequence[int], room: int) -> list[int]:
    """Widths between `least` and `most` that fill the room: what is left goes round by what each column lacks."""
    lacking = [high - low for low, high in zip(least, most, strict=True)]
    left, whole = room - sum(least), max(sum(lacking), 1)
    steps = [0]
    for lack in lacking:
        steps.append(steps[-1] + lack)
    parts = [high * left // whole - low * left // whole for low, high in pairwise(steps)]
    return [low + part for low, part in zip(least, parts, strict=True)]
