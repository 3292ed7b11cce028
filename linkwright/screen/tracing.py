"""How far the tracing of a trade-off has come, on the screen."""

from __future__ import annotations

import time

from rich.status import Status

from linkwright.results.figures_in_words import percent
from optimize.tradeoff.trace import Progress

from .console import console
from .loudness import loudness

MOST_ROWS = 25
_PATIENCE = 2.0


class TracingProgress:
    """How far the front has come: a status line on a terminal, nothing elsewhere."""

    def __init__(self, *, groups: bool) -> None:
        """`groups`: fronts have names of their own."""
        self._screen, self._groups = console(errors=True), groups
        self._began = time.monotonic()
        self._status: Status | None = None

    def __call__(self, progress: Progress) -> None:
        """Show it."""
        now = time.monotonic()
        if now - self._began < _PATIENCE:
            return
        if self._screen.is_terminal and loudness() != "answer":
            if self._status is None:
                self._status = self._screen.status("")
                self._status.start()
            self._status.update(self._words(progress))

    def _words(self, progress: Progress) -> str:
        name = f"{progress.front}: " if self._groups else ""
        off = "" if progress.error is None else f", straight lines right within {percent(progress.error)}"
        known = f" ({progress.resumed} from the journal)" if progress.resumed else ""
        return f"{name}{progress.points} points{known}{off}: {progress.doing}"

    def close(self) -> None:
        """Take the line away."""
        if self._status is not None:
            self._status.stop()
            self._status = None
