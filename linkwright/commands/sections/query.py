"""What a list of stock sizes can be asked for, and how its figures are written."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from linkwright.commands.catalogues.query import Query
from linkwright.core.sections import SHAPES, SectionProperties, StockSize
from linkwright.results.figures_in_words import figure

POISSON_RATIO = 0.3
"""With which shear areas are listed; it changes them by some per cent at most."""

FIGURES: Mapping[str, tuple[str, int]] = MappingProxyType(
    {
        "area": ("area", 2),
        "second_moment_y": ("second moment about y", 4),
        "second_moment_z": ("second moment about z", 4),
        "torsion_constant": ("torsion constant", 4),
        "shear_area_y": ("shear area along y", 2),
        "shear_area_z": ("shear area along z", 2),
        "section_modulus_y": ("section modulus about y", 3),
        "section_modulus_z": ("section modulus about z", 3),
        "plastic_modulus_y": ("plastic modulus about y", 3),
        "plastic_modulus_z": ("plastic modulus about z", 3),
    }
)
"""What is computed of a size: its name in words, and the power of cm in which it is shown."""

SHORT: Mapping[str, str] = MappingProxyType(
    {
        "area": "A",
        "second_moment_y": "I_y",
        "second_moment_z": "I_z",
        "torsion_constant": "J",
        "shear_area_y": "A_sy",
        "shear_area_z": "A_sz",
        "section_modulus_y": "W_y",
        "section_modulus_z": "W_z",
        "plastic_modulus_y": "W_pl,y",
        "plastic_modulus_z": "W_pl,z",
    }
)
"""Headings shorter than the figures' names."""

_KINDS = MappingProxyType({2: "area", 3: "section_modulus", 4: "second_moment_of_area"})
_POWERS = "\N{SUPERSCRIPT TWO}\N{SUPERSCRIPT THREE}\N{SUPERSCRIPT FOUR}"


def properties_of(size: StockSize) -> SectionProperties:
    """The size's properties, for a Poisson's ratio of 0.3."""
    return size.section.properties(POISSON_RATIO)


def value_of(size: StockSize, name: str) -> float | None:
    """A figure or dimension in SI; None where the size has no such dimension.

    `width` and `height` are those of the bounding box, so that a round tube has them too.
    """
    if name in FIGURES or name in ("width", "height"):
        return float(getattr(properties_of(size), name))
    return size.dimensions.get(name)


def unit_of(name: str) -> str:
    """The unit in which a figure or dimension is shown."""
    return f"cm{_POWERS[FIGURES[name][1] - 2]}" if name in FIGURES else "mm"


def written(size: StockSize, name: str) -> str:
    """A figure or dimension of a size in its unit, a dash where it has none."""
    value = value_of(size, name)
    if value is None:
        return "–"
    return figure(value * 100.0 ** FIGURES[name][1], 4) if name in FIGURES else figure(1e3 * value, 5)


def heading(name: str) -> str:
    """A column's heading, with its unit."""
    return f"{SHORT.get(name, name.replace('_', ' '))} {unit_of(name)}"


def _names() -> tuple[str, ...]:
    dimensions = (each.name for kind in SHAPES.values() for each in kind.dimensions if each.kind != "points")
    return tuple(dict.fromkeys([*FIGURES, "width", "height", *dimensions]))


QUERY = Query[StockSize, str](
    names=_names,
    short=SHORT,
    usual=("area", "second_moment_y", "second_moment_z", "torsion_constant"),
    every=tuple(FIGURES),
    kind=lambda name: _KINDS[FIGURES[name][1]] if name in FIGURES else "length",
    value=value_of,
    lacks="a section has no '{}'",
    example="area < 10 cm^2",
)
