"""The height, the width and the proportions of sections, and the room for cables through them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .figure import Figure, OfLinks

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
