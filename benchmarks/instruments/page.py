"""Tables of a page, written anew by the command that computes them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """The lines of a table in Markdown."""
    return [f"| {' | '.join(head)} |", "|" + "---|" * len(head), *(f"| {' | '.join(row)} |" for row in rows)]


def write_table(page: Path, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Put a table in place of the one of a page whose first two columns are called alike. Raises ValueError where the
    page has none, or several."""
    lines = page.read_text(encoding="utf-8").splitlines()
    starts = [number for number, line in enumerate(lines) if line.startswith(f"| {head[0]} | {head[1]} |")]
    if len(starts) != 1:
        raise ValueError(f"{page}: {len(starts)} tables begin with {head[0]!r} and {head[1]!r}, one was expected")
    end = next((number for number in range(starts[0], len(lines)) if not lines[number].startswith("|")), len(lines))
    lines[starts[0] : end] = table(head, rows)
    page.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
