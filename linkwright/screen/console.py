"""The console that everything is printed to, and how much it shows.

`LINKWRIGHT_SHOW` says how much; `--quiet` and `--verbose` set it for one command.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Generator
from contextlib import contextmanager
from textwrap import TextWrapper
from typing import Any, Literal, NoReturn

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from linkwright.core.units.quantities import InputError
from linkwright.output.stream import OutputClosed, asked_measure, drop_output, printable
from linkwright.screen.narrow import FittingTable

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
