"""Progress through the steps of one computation and when it ends: a bar on a terminal, on standard error."""

from __future__ import annotations

import threading
import time
from collections.abc import Generator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TaskID
from rich.table import Column
from rich.text import Text

from linkwright.output.stream import printable
from linkwright.screen.console import console, loudness

_PATIENCE = 1.0
"""Seconds of silence; what is done by then needs no bar."""
_BAR_WIDTH = 20
_PERIOD = 600.0
"""Seconds whose steps an end is estimated from: those of a long search are minutes apart."""


class Steps:
    """Hears what is being done and what share of the whole is behind (0 to 1).

    A terminal shows it after a second, whether something was heard by then or not, with the time that has passed and
    how long the part at work still takes.
    """

    def __init__(self, text: str = "working") -> None:
        """`text` is shown until something is heard."""
        self._screen: Console = console(errors=True)
        self._text, self._began = printable(text), time.monotonic()
        self._share = 0.0
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
        with self._lock:
            self._text, self._share = printable(text), share
            # A notebook shows nothing of another thread.
            if self._bar is None and self._screen.is_jupyter and time.monotonic() - self._began >= _PATIENCE:
                self._show()
            if self._bar is not None:
                # Without a share there is no end to run towards.
                total = 1.0 if share > 0.0 else self._bar.tasks[0].total
                if share < self._bar.tasks[0].completed:  # another part of the work, with a pace of its own
                    self._bar.reset(self._task)
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
            # Where the screen is narrow the words go on below each other, and the bar stays whole.
            bar = BarColumn(_BAR_WIDTH, table_column=Column(no_wrap=True))
            look: Any = {"transient": True, "redirect_stdout": False, "speed_estimate_period": _PERIOD}
            self._bar = Progress(bar, _Words(), console=self._screen, **look)
            self._task = self._bar.add_task(self._text, total=1.0 if self._share > 0.0 else None)
            self._bar.update(self._task, completed=self._share)
            self._bar.start()


class _Words(ProgressColumn):
    """What is being done, and how long it still takes, or where that is not known how long it took."""

    def render(self, task: Task) -> Text:
        """The words of a task."""
        left, passed = task.time_remaining, task.elapsed or 0.0
        time_text = f"{_rounded(passed)} so far" if left is None else f"{_rounded(left)} left"
        return Text(f"{task.description}, {time_text}")


def _rounded(seconds: float) -> str:
    """A time in s, from two minutes on in min."""
    return f"{seconds:.0f} s" if seconds < 120.0 else f"{seconds / 60.0:.0f} min"


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
