"""What can be limited. A new limit is one object, shipped here or registered; all else follows from it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from linkwright.core.arm.figures.geometry.proportions import WALL_SLENDERNESS
from linkwright.core.arm.figures.tip_stiffness import SIDEWAYS_STIFFNESS
from linkwright.core.registries import Registry
from linkwright.core.units.units import kinds

from .along import DIRECTED, ORIENTATION_ERROR, REPEATABILITY, Directed, Direction
from .design import ChosenMaterial, DesignExpressions, Designs, DesignValues, Totals
from .error import AVERAGE_ERROR, MAX_ERROR, error_at_point, error_of_case
from .figure import (
    Asked,
    Cut,
    Figure,
    FigureResult,
    Held,
    OfDesign,
    OfKinds,
    OfLinks,
    PoseFamily,
    ThroughPoses,
    Worst,
    WorstError,
)
from .frequency import FIRST_FREQUENCY
from .geometry.proportions import ASPECT, INNER_SIZE, SECTION_HEIGHT, SECTION_WIDTH
from .geometry.separation import SEPARATION
from .limit import KEPT_WITHIN, Demands, Limit, broken, excess, figures_of, shortfall
from .local_buckling import LOCAL_BUCKLING
from .motion.cycle import MOTION_USE, PEAK_TORQUE, RMS_TORQUE
from .statics import OfStatics, at_poses
from .strength import BUCKLING, SAFETY_FACTOR
from .sums import COST, MASS, MATERIALS, PARTS, PAYLOAD, REACH, TOTAL_MASS
from .tip_stiffness import TIP_STIFFNESS
from .torque import TORQUE_USE

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
        return f"a limit must be an arm.figures.Figure, not {entry!r}"
    if entry.name in RANGES:
        return f"the limit '{entry.name}' has the name of a range of sizes; choose another"
    if entry.kind not in kinds():
        return f"the limit '{entry.name}': there is no kind of quantity '{entry.kind}'"
    if not entry.senses:
        return f"the limit '{entry.name}' needs senses, the relations that it may have"
    family = entry.follows.family if isinstance(entry.follows, ThroughPoses) else None
    if isinstance(family, OfStatics) and family.name != entry.name:
        return f"the limit '{entry.name}' follows from values called '{family.name}'; give both one name"
    return None


FIGURES: Registry[Figure] = Registry(
    "limit", "linkwright.limits", lambda figure: figure.name, _fault, "linkwright.core.arm.figures:FIGURES"
)
"""The figures that a problem can limit, by name, in the order in which limits are read and told; users and installed
packages (`linkwright.limits`) add theirs."""

FIGURES.ship(
    MAX_ERROR,
    AVERAGE_ERROR,
    MASS,
    TOTAL_MASS,
    REACH,
    COST,
    SAFETY_FACTOR,
    FIRST_FREQUENCY,
    BUCKLING,
    TORQUE_USE,
    RMS_TORQUE,
    PEAK_TORQUE,
    MOTION_USE,
    LOCAL_BUCKLING,
    WALL_SLENDERNESS,
    ASPECT,
    SECTION_HEIGHT,
    SECTION_WIDTH,
    INNER_SIZE,
    TIP_STIFFNESS,
    SIDEWAYS_STIFFNESS,
    ORIENTATION_ERROR,
    REPEATABILITY,
    SEPARATION,
    MATERIALS,
    PARTS,
)


def families_of(figures: Mapping[str, Figure]) -> tuple[PoseFamily[Any], ...]:
    """The families of figures that have a value at every pose."""
    families = (figure.follows.family for figure in figures.values() if isinstance(figure.follows, ThroughPoses))
    return tuple(dict.fromkeys(families))


__all__ = [
    "DIRECTED",
    "FIGURES",
    "KEPT_WITHIN",
    "PARTS",
    "PAYLOAD",
    "RANGES",
    "RANGES_CALLED",
    "Asked",
    "ChosenMaterial",
    "Cut",
    "Demands",
    "DesignExpressions",
    "DesignValues",
    "Designs",
    "Directed",
    "Direction",
    "Figure",
    "FigureResult",
    "Held",
    "Limit",
    "OfDesign",
    "OfKinds",
    "OfLinks",
    "PoseFamily",
    "ThroughPoses",
    "Totals",
    "Worst",
    "WorstError",
    "at_poses",
    "broken",
    "error_at_point",
    "error_of_case",
    "excess",
    "families_of",
    "figures_of",
    "shortfall",
]
