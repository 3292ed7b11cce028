"""What can be asked of a design, each held against every choice singly or independent physics."""

from __future__ import annotations

from benchmarks.results.row import Row

from . import asked, built


def questions(*, quick: bool) -> list[Row]:
    """By how much each answer is off."""
    del quick
    return [*asked.rows(), *built.rows()]
