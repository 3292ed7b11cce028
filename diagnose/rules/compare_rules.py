"""Rules of comparing two recordings of one arm."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import rule


@dataclass(frozen=True)
class CompareRules:
    """What has changed, and where two recordings can be set against each other."""

    level: float = rule(
        0.05,
        "chance",
        "Over all parameters together, of calling anything changed that did not.",
        "the usual level; S. Holm, Scand. J. Statist. 6 (1979) 65",
    )
