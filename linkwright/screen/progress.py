"""Progress through the steps of one computation and when it ends: a bar on a terminal, on standard error."""

from __future__ import annotations

import threading
import time
from collections.abc import Generator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Column
from rich.text import Text

from linkwright.output.stream import printable
from linkwright.screen.console import console
from linkwright.screen.loudness import loudness

_ENOUGH = 0.01
"""A share behind from which an end is estimated."""
_ANEW = 0.5
"""Where the share falls below this part of what it was, another part of the work has begun."""


class Pace:
    """Hears shares (0 to 1) with the time of day at which each was reached; parts follow one another."""

    def __init__(self, now: float) -> None:
        self._began, self._before, self.share = now, 0.0, 0.0

    def heard(self, share: float, now: float) -> None:
        """A share that is reached now."""
        if share < _ANEW * self.share:
            self._began, self._before = now, share
        self.share = share

    def left(self, now: float) -> float | None:
        """Seconds until the end of the part; None as long as nothing can be said of it."""
        gone = self.share - self._before
        if gone < _ENOUGH or not self.share < 1.0:
            return None
        return (now - self._began) * (1.0 - self.share) / gone


def in_words(seconds: float | None) -> str:
    """An estimate of a time, as coarse as it is."""
    if seconds is None:
        return ""
    if seconds < 90.0:
        return f"about {max(round(seconds), 1)} s left"
    minutes = seconds / 60.0
    return f"about {minutes:.0f} min left" if minutes < 90.0 else f"about {minutes / 60.0:.0f} h left"


_PATIENCE = 1.0
"""Seconds of silence; what is done by then needs no bar."""
_BAR_WIDTH = 20


class Steps:
    """Hears what is being done and what share of the whole is behind (0 to 1).

    A terminal shows it after a second, whether something was heard by then or not, with the time that has passed and
    how long the part at work still takes.
    """

    def __init__(self, text: str = "working") -> None:
        """`text` is shown until something is heard."""
        self._screen: Console = console(errors=True)
        self._text, self._began = printable(text), time.monotonic()
        self._pace = Pace(self._began)
        self._bar: Progress | None = None
        self._task = TaskID(0)
        self._lock = threading.RLock()
        self._closed = False
        self._due: threading.Timer | None = None
        if self._screen.is_terminal and not self._screen.is_jupyter and loudness() != "answer":
            self._due = threading.Timer(_PATIENCE, self._show)
            self._due.daemon = True
            self._due.start()

    def __call__(self, text: str, share: float) -> None:
        """`text` says what is being done now."""
        now = time.monotonic()
        with self._lock:
            self._text = printable(text)
            self._pace.heard(share, now)
            # A notebook shows nothing of another thread.
            if self._bar is None and self._screen.is_jupyter and now - self._began >= _PATIENCE:
                self._show()
            if self._bar is not None:
                # Without a share there is no end to run towards.
                total = 1.0 if share > 0.0 else self._bar.tasks[0].total
                self._bar.update(self._task, completed=share, total=total, description=self._text)

    @property
    def doing(self) -> str:
        """What was heard last."""
        return self._text

    @contextmanager
    def aside(self) -> Generator[None]:
        """The bar taken away for as long as something else is printed."""
        with self._lock:
            if self._bar is not None:
                self._bar.stop()
            yield
            if self._bar is not None:
                self._bar.start()

    def close(self) -> None:
        """Take the bar away."""
        with self._lock:
            self._closed = True
            if self._due is not None:
                self._due.cancel()
            if self._bar is not None:
                self._bar.stop()
                self._bar = None

    def _show(self) -> None:
        with self._lock:
            if self._closed or self._bar is not None or loudness() == "answer":
                return
            # Where the screen is narrow the words go on below each other, and bar and times stay whole.
            bar, elapsed = (BarColumn(_BAR_WIDTH, table_column=_whole()), TimeElapsedColumn(table_column=_whole()))
            what = TextColumn("{task.description}", markup=False, table_column=Column())
            columns = (bar, elapsed, _Left(self._pace), what)
            self._bar = Progress(*columns, console=self._screen, transient=True, redirect_stdout=False)
            share = self._pace.share
            self._task = self._bar.add_task(self._text, total=1.0 if share > 0.0 else None)
            self._bar.update(self._task, completed=share)
            self._bar.start()


def _whole() -> Column:
    return Column(no_wrap=True)


class _Left(ProgressColumn):
    """How long it still takes."""

    max_refresh = 0.5

    def __init__(self, pace: Pace) -> None:
        super().__init__(table_column=_whole())
        self._pace = pace

    def render(self, task: Task) -> Text:  # noqa: ARG002 - the pace knows of parts
        """In words."""
        return Text(in_words(self._pace.left(time.monotonic())))


@contextmanager
def waiting(text: str) -> Generator[Steps]:
    """A sign of life while something is computed, which may tell of its steps. An interrupt after a second
    says at which it came."""
    steps, began = Steps(text), time.monotonic()
    try:
        yield steps
    except KeyboardInterrupt:
        steps.close()
        if time.monotonic() - began >= _PATIENCE:
            message = f"stopped at: {steps.doing}; no answer was finished yet, so there is none to keep"
            console(errors=True).print(message, soft_wrap=True)
        raise
    finally:
        steps.close()
