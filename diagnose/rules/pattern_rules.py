"""Rules of what could be missing: which candidates and forms are tried, and which can be seen at all."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import PROOF, rule


@dataclass(frozen=True)
class PatternRules:
    """The grid of candidates and forms."""

    stands: float = rule(0.05, "rad", "A joint that travels less is taken to stand.", PROOF)
    seen: float = rule(
        5.0,
        "standard deviations",
        "A direction whose whole pattern, at its physical bounds, stays below is not seen.",
        PROOF,
    )
    weight: float = rule(
        1e-3,
        "share of the largest direction",
        "A smaller share is no finding of its own, as where a wrist's small links add to a drive's sag under unknown "
        "weights.",
        PROOF,
    )
    visits_for_each: int = rule(
        3,
        "visits",
        "The least number of visits for each half wave.",
        PROOF,
        rows="Waves with fewer only copy the visits.",
    )
    rows_for_curves: int = rule(
        60,
        "readings",
        "With more, fields in the plane are tried with one order more.",
        PROOF,
        rows="With fewer, a field of ten to twelve coefficients fits anything.",
    )
