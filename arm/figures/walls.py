"""The slenderness of walls over what lets them yield before they buckle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from linkwright.core.sections import is_solid, slenderness_limits

from .figure import Asked, Figure, OfLinks

if TYPE_CHECKING:
    from linkwright.core.materials.material import MaterialValues
    from linkwright.core.sections import Section


def _utilisations(section: Section, material: MaterialValues) -> tuple[Any, ...] | None:
    """Each wall's slenderness over the greatest, evenly pressed: safe for every load and pose (EN 1993-1-1:2005, table
    5.2, class 3; see `sections.walls`)."""
    if is_solid(type(section)):
        return ()
    if material.yield_strength is None or material.wall_modulus is None:
        return None
    limits = slenderness_limits(section, material.yield_strength, material.wall_modulus)
    return None if limits is None else tuple(limit.utilisation for limit in limits)


def _unknown(section: Section, material: MaterialValues) -> str:
    if material.yield_strength is None or material.wall_modulus is None:
        return "the material of link {link} has no yield strength"
    return f"the walls of link {{link}} ({section.shape}) are not known"


def _assumed(problem: Asked) -> float | None:
    """Nobody has it without asking; files from when everybody had it say `off`."""
    del problem
    return None


WALL_SLENDERNESS = Figure(
    name="wall_slenderness",
    synonyms=("slenderness", "wall_buckling"),
    title="wall slenderness",
    senses=("<=",),
    key="wall_slenderness",
    follows=OfLinks(_utilisations, _unknown),
    note="greatest; up to 1 walls yield first",
    needs=("yield_strength",),
    assumed=_assumed,
    by=("link",),
)
