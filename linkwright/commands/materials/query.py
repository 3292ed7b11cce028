"""What a list of materials can be asked for."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from linkwright.commands.catalogues.query import Query
from materials.material import Material, PropertyName, property_kinds
from units.quantities import format_quantity
from units.temperature import REFERENCE_TEMPERATURE

SHORT: Mapping[PropertyName, str] = MappingProxyType(
    {
        "elastic_modulus": "E",
        "poisson_ratio": "nu",
        "shear_modulus": "G",
        "yield_strength": "yield",
        "tensile_strength": "tensile",
        "fatigue_strength": "fatigue",
        "thermal_expansion": "expansion",
        "thermal_conductivity": "conductivity",
        "highest_service_temperature": "usable to",
    }
)
"""Headings shorter than the properties' names."""
DIGITS = 6


QUERY = Query[Material, PropertyName](
    names=lambda: tuple(property_kinds()),
    short=SHORT,
    usual=("elastic_modulus", "density", "yield_strength", "cost"),
    every=tuple(property_kinds()),
    kind=lambda name: property_kinds()[name],
    value=lambda material, name: material.need(name) if material.has(name) else None,
    lacks="there is no property '{}'",
    example="density < 3 g/cm^3",
)


def written(value: float, name: PropertyName, digits: int = DIGITS) -> str:
    """A value of a property with its unit."""
    return format_quantity(value, property_kinds()[name], digits=digits)


def value_of(material: Material, name: PropertyName) -> str:
    """A material's property at 20 degC, a dash where it has none."""
    return written(material.need(name, REFERENCE_TEMPERATURE), name) if material.has(name) else "–"
