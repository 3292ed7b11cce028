"""The console that everything is printed to, and how much it shows.

`LINKWRIGHT_SHOW` says how much; `--quiet` and `--verbose` set it for one command.

Tables on terminals too narrow for them break no word and tear no figure from its unit while there is a way.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from textwrap import TextWrapper
from typing import Any, Literal, NoReturn

from rich.box import SIMPLE_HEAD
from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.measure import Measurement
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from linkwright.core.units.quantities import InputError
from linkwright.output.stream import OutputClosed, asked_measure, drop_output, printable

PLAIN_WIDTH = 100
"""Columns where the output is not a terminal, unless COLUMNS says otherwise."""
_NARROWEST = 20


class _Console(Console):
    broken = False
    """Whether sentences are broken at words; elsewhere each is one line, which can be searched for."""

    def print(self, *objects: Any, soft_wrap: bool | None = None, **options: Any) -> None:
        """As `rich` does; what is wrapped softly is a sentence, broken where there is something to fit it to."""
        if soft_wrap and self.broken:
            objects = tuple(_broken(item, self.width) if isinstance(item, str) else item for item in objects)
        super().print(*objects, soft_wrap=soft_wrap, **options)

    def on_broken_pipe(self) -> NoReturn:
        """Send the rest nowhere, and let the command end quietly."""
        drop_output()
        raise OutputClosed

    def render_str(self, text: str, **options: Any) -> Text:
        """Names from files and file names are shown, not obeyed."""
        return super().render_str(printable(text), **options)


def console(*, errors: bool = False, broken: bool = False) -> Console:
    """A console on standard output (or error), without colours and 100 columns wide where that is no terminal.

    COLUMNS says another width. Sentences are broken at words on a terminal, wherever a width is asked for, and where
    `broken` says so.
    """
    stream = sys.stderr if errors else sys.stdout
    asked, terminal = asked_measure("COLUMNS"), stream.isatty()
    asked = asked and max(asked, _NARROWEST)
    width = asked or (None if terminal else PLAIN_WIDTH)
    others = {name: value for name, value in os.environ.items() if name not in ("COLUMNS", "LINES")}  # read here
    made = _Console(stderr=errors, width=width, highlight=False, emoji=False, markup=False, _environ=others)
    made.broken = broken or terminal or asked is not None
    return made


def _broken(sentence: str, width: int) -> str:
    """Broken between words, what follows as far in as the first line; a word that is too long stays whole."""
    lines: list[str] = []
    for line in sentence.split("\n"):
        inset = " " * min(len(line) - len(line.lstrip(" ")), width // 4)
        wrapper = TextWrapper(width, subsequent_indent=inset, break_long_words=False, break_on_hyphens=False)
        lines += wrapper.wrap(line) if len(line) > width else [line]
    return "\n".join(lines)


def table(*headings: str, numbers: tuple[int, ...] = (), title: str | None = None) -> Table:
    """An empty table; the columns `numbers` (from 0) are set right."""
    made = FittingTable(box=SIMPLE_HEAD, title=title, title_justify="left", title_style="bold")
    made.pad_edge = made.show_edge = False
    for index, heading in enumerate(headings):
        made.add_column(heading, justify="right" if index in numbers else "left", overflow="fold")
    return made


def tell(*parts: str | Table, title: str = "") -> None:
    """Print a title, then tables and lines, each of these whole, so that it can be searched for; no empty line."""
    out = console()
    if title:
        out.print(title, style="bold")
    for part in parts:
        if part != "":
            out.print(part, soft_wrap=isinstance(part, str))


SHOW = "LINKWRIGHT_SHOW"
Loudness = Literal["answer", "usual", "all"]


def loudness() -> Loudness:
    """`answer`: the answer and warnings alone; `usual`; `all`: what is else left to the report too. Raises `InputError`
    where the environment says something else."""
    level = os.environ.get(SHOW) or "usual"
    for known in ("answer", "usual", "all"):
        if level == known:
            return known
    raise InputError("", SHOW, f"is 'answer', 'usual' or 'all', not {level!r}; or leave it unset")


@contextmanager
def showing(*, quiet: bool, verbose: bool) -> Generator[None]:
    """For the length of a command. Raises `InputError` for both at once."""
    if quiet and verbose:
        raise InputError("", "--quiet", "goes without --verbose; leave one out")
    before = os.environ.get(SHOW)
    if quiet or verbose:
        os.environ[SHOW] = "answer" if quiet else "all"
    try:
        loudness()
        yield
    finally:
        if before is None:
            os.environ.pop(SHOW, None)
        else:
            os.environ[SHOW] = before


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
