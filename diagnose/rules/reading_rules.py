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
    some_blank: float = rule(
        0.1,
        "share of the rows",
        "Where x, y or z is blank beside others in more rows than this, nobody forgot it: it was not measured.",
        JUDGED,
    )
    on_a_line: float = rule(
        1e-3,
        "share of the extent",
        "Touches of a plane that reach less far across than this lie on a line; places no further apart are one.",
        JUDGED,
    )
    elsewhere: float = rule(
        0.2,
        "share of the workspace reached",
        "Numbers further than this from the nominal ones, in the middle, are of something else.",
        JUDGED,
    )
    unit_length: float = rule(
        0.01,
        "1",
        "A quaternion whose length is further from 1 is no orientation; files round to three digits or more.",
        JUDGED,
    )
