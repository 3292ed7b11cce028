"""Rules of what could be missing: which candidates and forms are tried, and which can be seen at all."""

from __future__ import annotations

from dataclasses import dataclass

from .rule import JUDGED, PROOF, TIME, rule


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
        "What a wrist's small links add to a drive's sag under links of unknown weight is no finding of its own.",
        PROOF,
    )
    visible: float = rule(
        1e-5, "share of the pattern", "Where the nuisances leave less, it cannot be seen at all.", JUDGED
    )
    wanders: tuple[int, ...] = rule(
        (6, 12), "half waves", "Over the recording, of which a force that wanders is made.", PROOF
    )
    visits_for_each: int = rule(
        3,
        "visits",
        "So many for each half wave, at least.",
        PROOF,
        rows="Waves with fewer are no description but the visits themselves.",
    )
    core: float = rule(0.15, "m", "Nearer than about this a pull grows no further: what pulls has a size.", JUDGED)
    grid_in_plane: int = rule(6, "points along an axis", "From which pulls begin in the plane.", TIME)
    grid_in_space: int = rule(4, "points along an axis", "From which pulls begin in space.", TIME)
    least_core: float = rule(0.02, "m", "The core of a pull that is moved off the grid is as wide, at least.", JUDGED)
    widest_core: float = rule(3.0, "m", "The core of a pull that is moved off the grid is as wide, at most.", JUDGED)
    starts: int = rule(2, "points", "Of the grid from which a pull is moved to where it fits best.", TIME)
    magnet: float = rule(
        3.0,
        "power of the distance",
        "Of a pull that is moved off the grid; how wide its core is tells the rest.",
        JUDGED,
    )
    rows_for_curves: int = rule(
        60,
        "readings",
        "From more on fields in the plane are tried with one order more.",
        PROOF,
        rows="With fewer, a field of ten to twelve coefficients fits anything.",
    )
    ends: float = rule(0.05, "share of the recording", "Nearer to its beginning or end no step is looked for.", JUDGED)
    steps_in_time: int = rule(40, "moments", "At which a step may lie, spread evenly over the visits.", TIME)
    periods: int = rule(130, "periods", "That are tried, 0.4 cycles apart.", TIME)
    visits_for_periods: int = rule(
        12,
        "visits",
        "From so many on periods are sought.",
        JUDGED,
        rows="A period is two coefficients an axis, picked from many: fewer visits show none.",
    )
    many_visits: int = rule(
        200,
        "visits",
        "Beyond these no period is sought for each joint by itself.",
        TIME,
        rows="Patterns of as many readings, so many for each joint, would take most of the memory and time.",
    )
    regions: int = rule(12, "centres", "Of regions of the workspace that are off by themselves.", TIME)
    edges: int = rule(10, "stretches", "That a joint's travel is cut into.", JUDGED)
    widest: int = rule(4, "stretches", "Neighbours that are one part of the travel, at most.", JUDGED)
