"""What a list of materials can be asked for."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

from linkwright.commands.catalogues.query import Query
from linkwright.core.materials.material import Material, PropertyName, property_kinds
from linkwright.core.units.quantities import format_quantity
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE

Asked = PropertyName | Literal["magnetic"]
"""What a material can be listed, chosen and compared by."""
SHORT: Mapping[Asked, str] = MappingProxyType(
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


def value(material: Material, name: Asked) -> float | None:
    """A material's property at 20 degC in SI, 1 or 0 whether it is magnetic; None where nobody knows."""
    if name == "magnetic":
        return None if material.magnetic is None else float(material.magnetic)
    return material.need(name) if material.has(name) else None


QUERY = Query[Material, Asked](
    names=lambda: (*property_kinds(), "magnetic"),
    short=SHORT,
    usual=("elastic_modulus", "density", "yield_strength", "cost"),
    every=(*property_kinds(), "magnetic"),
    kind=lambda name: "dimensionless" if name == "magnetic" else property_kinds()[name],
    value=value,
    yes_or_no=("magnetic",),
    lacks="there is no property '{}'",
    example="density < 3 g/cm^3",
)


def written(value: float, name: PropertyName, digits: int = DIGITS) -> str:
    """A value of a property with its unit."""
    return format_quantity(value, property_kinds()[name], digits=digits)


def value_of(material: Material, name: Asked) -> str:
    """A material's property at 20 degC, or whether it is magnetic; a dash where nobody knows."""
    if name == "magnetic":
        return "–" if material.magnetic is None else "yes" if material.magnetic else "no"
    return written(material.need(name, REFERENCE_TEMPERATURE), name) if material.has(name) else "–"


def is_unconfirmed(material: Material, name: Asked) -> bool:
    """Whether a material's property could not be found in the source that it names."""
    return bool(material.magnetic_unconfirmed if name == "magnetic" else material.unconfirmed(name))


def marked(material: Material, name: Asked) -> str:
    """`value_of`, with a question mark behind what could not be found in its source."""
    return value_of(material, name) + (" ?" if is_unconfirmed(material, name) else "")
