"""Progress through the steps of one computation: a bar on a terminal, on standard error; nothing elsewhere."""

from __future__ import annotations

import time

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from linkwright.output.stream import printable

from .console import console
from .loudness import loudness

_PATIENCE = 1.0


class Steps:
    """Hears what is being done and what share of the whole is behind (0 to 1); silent in the first second."""

    def __init__(self) -> None:
        self._screen: Console = console(errors=True)
        self._began = time.monotonic()
        self._bar: Progress | None = None
        self._task = TaskID(0)

    def __call__(self, text: str, share: float) -> None:
        """`text` says what is being done now."""
        now, text = time.monotonic(), printable(text)
        if now - self._began < _PATIENCE:
            return
        if not (self._screen.is_terminal or self._screen.is_jupyter) or loudness() == "answer":
            return
        if self._bar is None:
            what = TextColumn("{task.description}", markup=False)
            self._bar = Progress(BarColumn(), TimeElapsedColumn(), what, console=self._screen, transient=True)
            self._bar.start()
            self._task = self._bar.add_task(text, total=1.0)
        self._bar.update(self._task, completed=share, description=text)

    def close(self) -> None:
        """Take the bar away."""
        if self._bar is not None:
            self._bar.stop()
            self._bar = None
