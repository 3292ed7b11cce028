"""The console that everything is printed to, and how progress is shown on it."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Generator
from contextlib import contextmanager
from typing import NoReturn

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table

PLAIN_WIDTH = 100
"""Columns where the output is not a terminal."""
_PATIENCE = 2.0
_LINE_EVERY = 5.0


class OutputClosed(Exception):
    """Whoever read the output has closed it (`| head`)."""


class _Console(Console):
    def on_broken_pipe(self) -> NoReturn:
        """Send the rest nowhere, and let the command end quietly."""
        drop_output()
        raise OutputClosed


def drop_output() -> None:
    """Send what is still to be written to standard output nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


def console(*, errors: bool = False) -> Console:
    """A console on standard output (or error), without colours and 100 columns wide where that is no terminal."""
    stream = sys.stderr if errors else sys.stdout
    width = None if stream.isatty() else PLAIN_WIDTH
    return _Console(stderr=errors, width=width, highlight=False, emoji=False, markup=False)


def table(*headings: str, numbers: tuple[int, ...] = (), title: str | None = None) -> Table:
    """An empty table; the columns `numbers` (from 0) are set right."""
    made = Table(box=SIMPLE_HEAD, title=title, title_justify="left", title_style="bold")
    made.pad_edge = made.show_edge = False
    for index, heading in enumerate(headings):
        made.add_column(heading, justify="right" if index in numbers else "left", overflow="fold")
    return made


@contextmanager
def waiting(text: str) -> Generator[None]:
    """A sign of life on a terminal while something without parts to count is computed."""
    screen = console(errors=True)
    if not screen.is_terminal:
        yield
        return
    with screen.status(text):
        yield


class Tries:
    """Progress through many combinations: a bar on a terminal, a line now and then elsewhere; none in the first 2 s."""

    def __init__(self, out: Console) -> None:
        """`out` takes the lines where there is no terminal."""
        self._out, self._screen = out, console(errors=True)
        self._began = self._said = time.monotonic()
        self._bar: Progress | None = None
        self._task = TaskID(0)

    def __call__(self, done: int, total: int, text: str) -> None:
        """`done` of `total` are behind; `text` says what is being tried."""
        now = time.monotonic()
        if now - self._began < _PATIENCE:
            return
        if not self._screen.is_terminal:
            if now - self._said >= _LINE_EVERY:
                self._said = now
                self._out.print(f"tried {done} of {total} combinations: {text}")
            return
        if self._bar is None:
            columns = (TextColumn("trying"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
            what = TextColumn("{task.description}", markup=False)
            self._bar = Progress(*columns, what, console=self._screen, transient=True)
            self._bar.start()
            self._task = self._bar.add_task(text, total=total)
        self._bar.update(self._task, completed=done, total=total, description=text)

    def close(self) -> None:
        """Take the bar away."""
        if self._bar is not None:
            self._bar.stop()
            self._bar = None
