"""Which materials of the catalogue keep a problem's conditions, in place of a list of names."""

from __future__ import annotations

from collections.abc import Mapping as MappingLike
from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import needs_shear_modulus, needs_thermal_expansion
from linkwright.core.materials.catalogue import Catalogue
from linkwright.core.materials.material import Material, MissingProperty, OutOfRange, PropertyName, property_kinds
from linkwright.core.units.names import nearest
from linkwright.core.units.reading import Mapping

if TYPE_CHECKING:
    from linkwright.core.optimize.problem import Problem
    from linkwright.core.optimize.reading.choices import LinkLists

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


@dataclass(frozen=True)
class LeftOut:
    """A material that cannot be chosen: its name, and why."""

    material: str
    why: str


def needed_figures(problem: Problem) -> dict[str, str]:
    """The figures that a problem needs of every material, each with what needs it."""
    needed: dict[str, str] = dict.fromkeys(("elastic_modulus", "density"), "every design")
    if needs_shear_modulus(problem.arm, problem.load_cases):
        needed["shear_modulus"] = "the model of the arm (links that shear or twist)"
    if needs_thermal_expansion(problem.arm):
        needed["thermal_expansion"] = "the arm's thermal expansion"
    needed |= dict.fromkeys(problem.objective.needs, f"minimize: {problem.minimize}")
    for limit in problem.limits:
        if not limit.assumed and not limit.aim:
            needed |= dict.fromkeys(limit.figure.needs, limit.text)
    return {name: by for name, by in needed.items() if name in property_kinds()}


def without_lacking(mapping: Mapping, problem: Problem) -> Problem:
    """The problem with only those materials to choose of which all is known that it needs, at the arm's temperature.
    Raises `InputError` where a link is left without one."""
    if problem.materials is None:
        return problem  # what an arm's material lacks is an error where it is asked for
    needed = needed_figures(problem)
    reasons = {material: _reason(material, needed, problem.arm.temperature) for material in problem.materials}
    lacking = {material.name: why for material, why in reasons.items() if why}
    if not lacking:
        return problem
    materials = tuple(material for material in problem.materials if not reasons[material])
    lists = None if problem.lists is None else tuple(_list(entry, materials) for entry in problem.lists)
    if not materials or any(entry.materials == () for entry in lists or ()):
        whole = "; ".join(f"{name}: {why}" for name, why in lacking.items())
        message = f"leaves a link without a material, as figures are missing ({whole}); name another material"
        raise mapping.error("choose.material", f"{message}, or add the figure with `linkwright materials edit`")
    left_out = [LeftOut(name, f"{why}; `linkwright materials edit {name}` adds it") for name, why in lacking.items()]
    return replace(problem, materials=materials, lists=lists, left_out=tuple(left_out))


def _list(lists: LinkLists, materials: tuple[Material, ...]) -> LinkLists:
    if lists.materials is None:
        return lists
    return replace(lists, materials=tuple(material for material in lists.materials if material in materials))


def _reason(material: Material, needed: MappingLike[str, str], temperature: float) -> str:
    """Which figures it lacks, and what needs them; an empty text where it lacks none."""
    missing: list[str] = []
    for name, by in needed.items():
        try:
            material.need(name, temperature)  # type: ignore[arg-type]
        except MissingProperty:
            missing.append(f"its {_known_by(material, name)} is not known, and {by} needs it")
        except OutOfRange:
            missing.append(f"its {name.replace('_', ' ')} is not known at the arm's temperature, and {by} needs it")
    return ", ".join(missing)


def _known_by(material: Material, name: str) -> str:
    """A figure that a material lacks, in words: of one that would follow from others, which of those it lacks."""
    if name == "shear_modulus" and material.isotropic and material.has("elastic_modulus"):
        return "shear modulus (or Poisson's ratio, from which that follows)"
    return name.replace("_", " ")
