"""How far the tracing of a trade-off has come, on the screen."""

from __future__ import annotations

from linkwright.core.optimize.tradeoff.trace import Progress
from linkwright.results.figures_in_words import percent

from .progress import Steps


class TracingProgress:
    """How far the front has come: a bar on a terminal, nothing elsewhere."""

    def __init__(self, *, groups: bool) -> None:
        """`groups`: fronts have names of their own."""
        self._groups = groups
        self._steps = Steps("setting up the trade-off")

    def __call__(self, progress: Progress) -> None:
        """Show it."""
        self._steps(self._words(progress), progress.share)

    def _words(self, progress: Progress) -> str:
        name = f"{progress.front}: " if self._groups else ""
        off = "" if progress.error is None else f", straight lines right within {percent(progress.error)}"
        known = f" ({progress.resumed} from the journal)" if progress.resumed else ""
        return f"{name}{progress.points} points{known}{off}: {progress.doing}"

    def close(self) -> None:
        """Take the bar away."""
        self._steps.close()
