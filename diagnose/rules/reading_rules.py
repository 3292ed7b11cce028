"""Rules of reading a file: what is no longer a column or an orientation."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import rule


@dataclass(frozen=True)
class ReadingRules:
    """What a file may lack."""

    elsewhere: float = rule(
        0.2,
        "share of the workspace reached",
        "Numbers further than this from the nominal ones, in the middle, are of something else.",
    )
