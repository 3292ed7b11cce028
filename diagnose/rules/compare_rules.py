"""Rules of comparing two recordings of one arm."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import JUDGED, rule


@dataclass(frozen=True)
class CompareRules:
    """What has changed, and where two recordings can be set against each other."""

    level: float = rule(
        0.05,
        "chance",
        "Over all parameters together, of calling anything changed that did not.",
        "the usual level; S. Holm, Scand. J. Statist. 6 (1979) 65",
    )
    least_visits: int = rule(
        10,
        "visits",
        "From so many on each visit may have an error of its own.",
        JUDGED,
        rows="The spread of fewer visits' errors is itself unknown.",
    )
    least_rows: int = rule(
        5,
        "readings",
        "A region is shown where each recording has so many there.",
        JUDGED,
        rows="It only decides what a table shows.",
    )
    cells: int = rule(3, "regions along an axis", "Into which the workspace is cut.", JUDGED)
    same_load: float = rule(0.01, "kg", "Poses under loads that differ by more are not set against each other.", JUDGED)
