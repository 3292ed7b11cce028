"""The height, the width and the proportions of sections, the room for cables, and the slenderness of walls."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from linkwright.core.arm.figures.figure import Asked, Figure, OfLinks
from linkwright.core.sections import is_solid, slenderness_limits

if TYPE_CHECKING:
    from linkwright.core.materials.material import MaterialValues
    from linkwright.core.sections import Section

_ANY_RATIO = 0.3
"""A Poisson's ratio; sizes do not depend on it."""


def _height_and_width(section: Section) -> tuple[Any, Any]:
    """How high and how wide a section is (m), as it lies in the plane in which its link bends."""
    properties = section.properties(_ANY_RATIO)
    return properties.height, properties.width


def _aspect(section: Section, material: MaterialValues) -> tuple[Any, ...]:
    """Height over width, both outer; 1 for a round or a regular one."""
    del material
    height, width = _height_and_width(section)
    return (height / width,)


ASPECT = Figure(
    name="aspect",
    synonyms=("aspect_ratio", "proportions"),
    title="height over width",
    senses=("<=",),
    key="aspect",
    follows=OfLinks(_aspect),
    note="greatest of any section",
    by=("link",),
)


def _outer_size(name: str, where: str, number: int, synonyms: tuple[str, ...]) -> Figure:
    """The greatest height (`number` 0) or width (1) of any section."""

    def size(section: Section, material: MaterialValues) -> tuple[Any, ...]:
        del material
        return (_height_and_width(section)[number],)

    return Figure(
        name=f"section_{name}",
        synonyms=synonyms,
        title=f"section {name}",
        kind="length",
        unit="mm",
        factor=1e3,
        senses=("<=",),
        key=f"section_{name}_mm",
        follows=OfLinks(size),
        note=f"greatest of any section, {where}",
        by=("link",),
    )


SECTION_HEIGHT = _outer_size("height", "where its link bends", 0, ("max_height", "profile_height"))
SECTION_WIDTH = _outer_size("width", "across that", 1, ("max_width", "profile_width"))


def _inner(section: Section, material: MaterialValues) -> tuple[Any, ...] | None:
    """The widths of the section's closed hollow, the least of which the thickest round cable has that fits through it;
    0 where it has none."""
    del material
    return section.inner_widths


def _unknown(section: Section, material: MaterialValues) -> str:
    del material
    return f"what fits through link {{link}} ({section.shape}) is not known"


INNER_SIZE = Figure(
    name="inner_size",
    synonyms=("inner_diameter", "bore", "cable_diameter", "inner_width", "hollow"),
    title="inner size",
    kind="length",
    unit="mm",
    factor=1e3,
    senses=(">=",),
    key="inner_size_mm",
    follows=OfLinks(_inner, _unknown),
    more_is_better=True,
    note="least free inner diameter of any link",
    # Where a link is solid it is zero, which no axis can show.
    traded=False,
    everywhere=False,
    by=("link",),
)


def _utilisations(section: Section, material: MaterialValues) -> tuple[Any, ...] | None:
    """Each wall's slenderness over the greatest, evenly pressed: safe for every load and pose (EN 1993-1-1:2005, table
    5.2, class 3; see `sections.walls`)."""
    if is_solid(type(section)):
        return ()
    if material.yield_strength is None or material.wall_modulus is None:
        return None
    limits = slenderness_limits(section, material.yield_strength, material.wall_modulus)
    return None if limits is None else tuple(limit.utilisation for limit in limits)


def _unknown_walls(section: Section, material: MaterialValues) -> str:
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
    follows=OfLinks(_utilisations, _unknown_walls),
    note="greatest; up to 1 walls yield first",
    needs=("yield_strength",),
    assumed=_assumed,
    by=("link",),
)
