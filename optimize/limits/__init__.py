"""What can be limited. A new limit is one object, shipped here or registered; all else follows from it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from linkwright.core.registries import Registry
from linkwright.core.units.quantities import Relation
from linkwright.core.units.units import kinds

from .aspect import ASPECT
from .design import DesignExpressions, Designs, Totals
from .error import MAX_ERROR
from .figure import Asked, Cut, Figure, Held, Limit, OfDesign, OfLinks, PoseFamily, ThroughPoses, Worst, WorstError
from .frequency import FIRST_FREQUENCY
from .limit import KEPT_WITHIN, broken, excess, figures_of, shortfall
from .local_buckling import LOCAL_BUCKLING
from .sideways import SIDEWAYS_STIFFNESS
from .strength import BUCKLING, SAFETY_FACTOR
from .sums import COST, MASS, REACH, TOTAL_MASS
from .tip_stiffness import TIP_STIFFNESS
from .torque import TORQUE_USE
from .walls import WALL_SLENDERNESS

RANGES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {"link_length": (1e-3, 100.0), "section_size": (5e-3, 0.5), "thickness": (1e-3, 50e-3)}
)
"""Keys of `subject_to` that are ranges of sizes (m) and no limits, with what may stand there at most."""
RANGES_CALLED: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "link_length": ("length", "lengths", "link_lengths"),
        "section_size": ("diameter", "outer_diameter", "width", "height", "size", "sizes", "dimensions"),
        "thickness": ("wall", "wall_thickness", "walls"),
    }
)
"""What people call those ranges as well."""


def _fault(entry: object) -> str | None:
    if not isinstance(entry, Figure):
        return f"a limit must be an optimize.limits.Figure, not {entry!r}"
    if entry.name in RANGES:
        return f"the limit '{entry.name}' has the name of a range of sizes; choose another"
    if entry.kind not in kinds():
        return f"the limit '{entry.name}': there is no kind of quantity '{entry.kind}'"
    if not entry.senses:
        return f"the limit '{entry.name}' needs senses, the relations that it may have"
    if entry.of is None and not isinstance(entry.follows, OfLinks):
        return f"the limit '{entry.name}' needs `of`, its value in an evaluation"
    return None


FIGURES: Registry[Figure] = Registry(
    "limit", "linkwright.limits", lambda figure: figure.name, _fault, "linkwright.core.optimize.limits:FIGURES"
)
"""The figures that a problem can limit, by name, in the order in which limits are read and told; users and installed
packages (`linkwright.limits`) add theirs."""

FIGURES.ship(
    MAX_ERROR,
    MASS,
    TOTAL_MASS,
    REACH,
    COST,
    SAFETY_FACTOR,
    FIRST_FREQUENCY,
    BUCKLING,
    TORQUE_USE,
    LOCAL_BUCKLING,
    WALL_SLENDERNESS,
    ASPECT,
    TIP_STIFFNESS,
    SIDEWAYS_STIFFNESS,
)


def limit_on(name: str, relation: Relation, value: float) -> Limit:
    """The limit (SI) on a figure of that name."""
    return Limit(FIGURES[name], relation, value)


def families_of(figures: Mapping[str, Figure]) -> tuple[PoseFamily, ...]:
    """The families of figures that have a value at every pose."""
    found = (each.follows.family for each in figures.values() if isinstance(each.follows, ThroughPoses))
    return tuple(dict.fromkeys(found))


__all__ = [
    "FIGURES",
    "KEPT_WITHIN",
    "RANGES",
    "RANGES_CALLED",
    "Asked",
    "Cut",
    "DesignExpressions",
    "Designs",
    "Figure",
    "Held",
    "Limit",
    "OfDesign",
    "OfLinks",
    "PoseFamily",
    "ThroughPoses",
    "Totals",
    "Worst",
    "WorstError",
    "broken",
    "excess",
    "families_of",
    "figures_of",
    "limit_on",
    "shortfall",
]
