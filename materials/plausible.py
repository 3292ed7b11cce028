"""Figures of a material that are hardly believable: most often a unit that slipped."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from linkwright.core.units.quantities import format_quantity

from .material import Material, PropertyName, property_kinds

_USUAL: Mapping[PropertyName, tuple[float, float, str]] = MappingProxyType(
    {
        "elastic_modulus": (1e5, 1.3e12, "diamond, the stiffest, has 1143 GPa"),
        "shear_modulus": (3e4, 6e11, "diamond, the stiffest, has half of its 1143 GPa"),
        "transverse_modulus": (3e4, 1.3e12, "diamond, the stiffest, has 1143 GPa"),
        "density": (10.0, 2.3e4, "osmium, the densest, has 22.59 g/cm^3; foams have some tens of kg/m^3"),
        "yield_strength": (1e4, 2e10, "whiskers reach some 20 GPa"),
        "tensile_strength": (1e4, 2e10, "whiskers reach some 20 GPa"),
        "fatigue_strength": (1e3, 1e10, "no fibre endures 10 GPa"),
        "thermal_expansion": (-2e-5, 5e-4, "metals have 1e-6 to 3e-5 1/K, rubber some 2e-4"),
        "transverse_expansion": (-2e-5, 5e-4, "resins have some 6e-5 1/K, rubber some 2e-4"),
        "thermal_conductivity": (0.01, 2500.0, "diamond, the best, has some 2200 W/(m*K)"),
        "heat_capacity": (100.0, 5000.0, "metals have 130 to 2000 J/(kg*K)"),
        "damping": (0.0, 3.0, "a loss factor above 1 is rubber's where it turns to glass"),
        "cost": (0.02, 2e5, "gold has some 1e5 EUR/kg"),
        "machining_cost": (0.0, 1e4, "work on a kilogram that costs more is a jeweller's"),
        "highest_service_temperature": (233.15, 3800.0, "graphite sublimes at some 3600 degC"),
    }
)
"""Lowest and highest that a solid one makes arms of can have (SI), and what it is measured by.

Modulus of diamond: Klein and Cardinale, Diamond and Related Materials 2 (1993) 918, doi:10.1016/0925-9635(93)90224-U;
density of osmium: Crabtree, Platinum Metals Review 39 (1995) 164. The others are round figures, judged: they question,
and forbid nothing.
"""
_SPECIFIC_MODULUS = 5e8
"""m^2/s^2; diamond, at 1143 GPa and 3515 kg/m^3, has 3.3e8."""
_DENSE, _SPECIFIC_MODULUS_OF_DENSE = 6000.0, 6e7
"""kg/m^3 and m^2/s^2: tungsten carbide, at 700 GPa and 15630 kg/m^3, has 4.5e7, chromium 3.9e7, steel 2.6e7."""
_SPECIFIC_MODULUS_OF = MappingProxyType(
    {"steel": (1.6e7, 4e7), "stainless": (1.6e7, 4e7), "aluminium": (1.6e7, 4e7), "titanium": (1.6e7, 4e7)}
)
"""m^2/s^2 by family; all their alloys lie about 2.5e7."""


def doubts_of(material: Material) -> tuple[str, ...]:
    """What is hardly believable of a material's figures at 20 degC, a line each that begins with its name."""
    doubts: list[str] = []
    for name, (low, high, measure) in _USUAL.items():
        if material.has(name) and not low <= (value := material.need(name)) <= high:
            written = format_quantity(value, property_kinds()[name], digits=4)
            doubts.append(f"{material.name}: {name} {written} is hardly believable ({measure}); is its unit right?")
    if not doubts and material.has("elastic_modulus") and material.has("density"):
        density = material.need("density")
        ratio = material.need("elastic_modulus") / density
        low, high, measure = _specific_modulus(material.family, density)
        if not low <= ratio <= high:
            doubts.append(
                f"{material.name}: E / density of {1e-6 * ratio:.4g} MN*m/kg is hardly believable ({measure}); are "
                "their units right?"
            )
    return tuple(doubts)


def _specific_modulus(family: str, density: float) -> tuple[float, float, str]:
    """Lowest and highest E / density (m^2/s^2), and what it is measured by."""
    if family in _SPECIFIC_MODULUS_OF:
        return *_SPECIFIC_MODULUS_OF[family], "steel, aluminium and titanium have 24 to 27"
    if density > _DENSE:
        return 0.0, _SPECIFIC_MODULUS_OF_DENSE, "steel has 26, of what is as dense tungsten carbide most, 45"
    return 0.0, _SPECIFIC_MODULUS, "diamond, the stiffest for its weight, has 325"
