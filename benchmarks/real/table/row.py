"""A row of the table, why it misses, and how all are shown."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

MISS = 1.05
"""Times the textbook's figure up to which a row is as good."""
MEAN = 0.9
"""Times it, in the mean of all rows (geometric)."""


@dataclass(frozen=True)
class Figures:
    """RMS that each leaves, mm or N*m: the nominal file, the textbook's, the one that was written."""

    nominal: float
    textbook: float
    ours: float


@dataclass(frozen=True)
class Row:
    """One machine and recording (tips, mm) or joint (torques, N*m; N of a slide).

    Args:
        machine: Its name.
        learned: What both were fitted to.
        judged: What neither was fitted to, with the joint of a torque.
        held: What each leaves of that.
        seen: What each leaves of what it was fitted to.
        said: The verdict and how many names, or why there is no file.
        changed: Whether the written file differs from the given one.
        promised: What the diagnosis says that its file leaves of what it was fitted to; nan where it says nothing.
    """

    machine: str
    learned: str
    judged: str
    held: Figures
    seen: Figures
    said: str
    changed: bool = True
    promised: float = math.nan

    @property
    def ratio(self) -> float:
        """Ours over the textbook's."""
        return self.held.ours / self.held.textbook

    @property
    def misses(self) -> bool:
        """Whether ours is worse than the textbook's by more than a twentieth."""
        return self.ratio > MISS

    @property
    def reason(self) -> str:
        """Why it misses, read from the figures; empty where it does not."""
        if not self.misses:
            return ""
        seen = f"of its own rows ours leaves {_text(self.seen.ours)}, the textbook {_text(self.seen.textbook)}"
        if not self.changed:
            why = f"no file was written; the textbook leaves {_text(self.seen.textbook)} of its own rows"
        elif self.promised == self.promised and self.seen.ours > MISS * self.promised:
            why = f"the file leaves {_text(self.seen.ours)} of its own rows, {_text(self.promised)} was promised"
        elif self.seen.ours > MISS * self.seen.textbook:
            why = f"a cause is missing: {seen}"
        elif self.held.ours > self.held.nominal:
            why = f"worse than the given file beyond the poses it learned: {seen}"
        else:
            why = f"does not carry over: {seen}"
        return f"{why} ({self.said})"


def mean_ratio(rows: Sequence[Row]) -> float:
    """The geometric mean of the ratios."""
    return math.exp(sum(math.log(row.ratio) for row in rows) / len(rows)) if rows else math.nan


def header(tell: Callable[[str], None]) -> None:
    """The table's head."""
    tell("| machine | learned on | judged on | nominal | textbook | ours | ours / textbook | why it misses |")
    tell("|---|---|---|---|---|---|---|---|")


def shown(row: Row) -> str:
    """A row as Markdown; what is better than the textbook in bold."""
    held = row.held
    ratio = f"{row.ratio:.2f}"
    figures = " | ".join(_text(value) for value in (held.nominal, held.textbook, held.ours))
    best = ratio if row.misses else f"**{ratio}**"
    return f"| {row.machine} | {row.learned} | {row.judged} | {figures} | {best} | {row.reason} |"


def summary(rows: Sequence[Row]) -> str:
    """How many miss, and the mean, beside what is asked for."""
    missed = sum(row.misses for row in rows)
    return (
        f"{len(rows)} rows: {missed} above {MISS:g} (asked for 0); mean of the ratios {mean_ratio(rows):.2f} "
        f"(asked for {MEAN:g})"
    )


def _text(value: float) -> str:
    return "-" if value != value else f"{value:.3g}" if value < 100.0 else f"{value:.0f}"
