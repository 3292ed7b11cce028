"""The slenderness of walls over what lets them yield before they buckle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from linkwright.core.sections import is_solid, slenderness_limits

from .figure import Asked, Figure, OfLinks

if TYPE_CHECKING:
    from linkwright.core.materials.material import MaterialValues
    from linkwright.core.sections import Section


def _utilisations(section: Section, material: MaterialValues) -> tuple[Any, ...] | None:
    """Each wall's slenderness over the greatest (see `arm.limits.walls`)."""
    if is_solid(type(section)):
        return ()
    if material.yield_strength is None or material.wall_modulus is None:
        return None
    found = slenderness_limits(section, material.yield_strength, material.wall_modulus)
    return None if found is None else tuple(each.utilisation for each in found)


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
    follows=OfLinks(_utilisations),
    of=lambda evaluation: evaluation.walls.worst,
    note="greatest; up to 1 walls yield first",
    needs=("yield_strength",),
    assumed=_assumed,
)
