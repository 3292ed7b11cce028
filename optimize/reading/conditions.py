"""Which materials of the catalogue keep a problem's conditions, in place of a list of names."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import needs_shear_modulus, needs_thermal_expansion
from linkwright.core.materials.catalogue import Catalogue
from linkwright.core.materials.material import Material, MissingProperty, OutOfRange, PropertyName, property_kinds
from linkwright.core.units.names import nearest
from linkwright.core.units.reading import Mapping

_ALIASES = MappingProxyType({"service_temperature": "highest_service_temperature"})


def materials_where(mapping: Mapping, catalogue: Catalogue, arm: Arm, needs: frozenset[str]) -> tuple[Material, ...]:
    """The materials that keep every condition of a `where`, by name, among those of which all is known, at the arm's
    temperature, that its model and the problem's limits need (`needs`).

    Conditions are `magnetic: false`, `family: [aluminium, stainless]` and a bound on any property,
    `density: "<= 3000 kg/m^3"`; `service_temperature` is the highest at which a material serves. What is not known of a
    material keeps no condition. Raises `InputError` where none is left.
    """
    temperature = arm.temperature
    needed = {"elastic_modulus", "density", *needs}
    if needs_shear_modulus(arm):
        needed.add("shear_modulus")
    if needs_thermal_expansion(arm):
        needed.add("thermal_expansion")
    with mapping.mapping("where").reading() as body:
        materials = list(catalogue)
        if body.has("family"):
            families = _families(body, materials)
            materials = [material for material in materials if material.family in families]
        if body.has("magnetic"):
            magnetic = body.boolean("magnetic")
            materials = [material for material in materials if material.magnetic is magnetic]
        kinds = property_kinds()
        for name in (*kinds, *_ALIASES):
            if not body.has(name):
                continue
            property_name: PropertyName = _ALIASES.get(name, name)  # type: ignore[assignment]
            bound = body.bound(name, kinds[property_name])
            materials = [
                material
                for material in materials
                if _keeps(material, property_name, bound.relation, bound.value, temperature)
            ]
    materials = [material for material in materials if all(_known(material, name, temperature) for name in needed)]
    if not materials:
        would_do = "loosen one, or add what is not known with `linkwright materials edit`"
        raise mapping.error("where", f"no material of the catalogue keeps all conditions; {would_do}")
    return tuple(materials)


def _families(body: Mapping, materials: Sequence[Material]) -> list[str]:
    """The families that a condition names, each of which some of the materials are of."""
    raw = body.raw("family")
    families = [str(item) for item in (raw if isinstance(raw, list) else [raw])]  # type: ignore[union-attr]
    known = sorted({material.family for material in materials})
    for number, family in enumerate(families, start=1):
        if family not in known:
            raise body.error(f"family[{number}]", f"there is no family '{family}'{nearest(family, known)}")
    return families


def _known(material: Material, name: str, temperature: float) -> bool:
    try:
        material.need(name, temperature)  # type: ignore[arg-type]
    except (MissingProperty, OutOfRange):
        return False
    return True


def _keeps(material: Material, name: PropertyName, relation: str, value: float, temperature: float) -> bool:
    if not _known(material, name, temperature):
        return False
    known = material.need(name, temperature)
    return known <= value if relation == "<=" else known >= value if relation == ">=" else known == value
