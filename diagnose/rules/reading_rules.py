"""Rules of reading a file: what is no longer a column or an orientation."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import JUDGED, rule


@dataclass(frozen=True)
class ReadingRules:
    """What a file may lack."""

    mostly_blank: float = rule(
        0.5,
        "share of the rows",
        "A required column with more bad cells than this is no column: rows are not set aside one by one.",
        JUDGED,
    )
    unit_length: float = rule(
        0.01,
        "1",
        "A quaternion whose length is further from 1 is no orientation; files round to three digits or more.",
        JUDGED,
    )
