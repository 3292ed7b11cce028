"""The console that everything is printed to."""

from __future__ import annotations

import sys
from typing import Any, NoReturn

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from linkwright.output.stream import OutputClosed, drop_output, printable

from .narrow import FittingTable

PLAIN_WIDTH = 100
"""Columns where the output is not a terminal."""


class _Console(Console):
    def on_broken_pipe(self) -> NoReturn:
        """Send the rest nowhere, and let the command end quietly."""
        drop_output()
        raise OutputClosed

    def render_str(self, text: str, **options: Any) -> Text:
        """Names from files and file names are shown, not obeyed."""
        return super().render_str(printable(text), **options)


def console(*, errors: bool = False) -> Console:
    """A console on standard output (or error), without colours and 100 columns wide where that is no terminal."""
    stream = sys.stderr if errors else sys.stdout
    width = None if stream.isatty() else PLAIN_WIDTH
    return _Console(stderr=errors, width=width, highlight=False, emoji=False, markup=False)


def table(*headings: str, numbers: tuple[int, ...] = (), title: str | None = None) -> Table:
    """An empty table; the columns `numbers` (from 0) are set right."""
    made = FittingTable(box=SIMPLE_HEAD, title=title, title_justify="left", title_style="bold")
    made.pad_edge = made.show_edge = False
    for index, heading in enumerate(headings):
        made.add_column(heading, justify="right" if index in numbers else "left", overflow="fold")
    return made
