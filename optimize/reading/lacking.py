"""Materials that may be chosen but lack a figure that the problem needs: they leave the choice."""

from __future__ import annotations

from collections.abc import Mapping as MappingLike
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from linkwright.core.arm.errors.model import needs_shear_modulus, needs_thermal_expansion
from linkwright.core.materials.material import Material, MissingProperty, OutOfRange, property_kinds
from linkwright.core.units.reading import Mapping

if TYPE_CHECKING:
    from linkwright.core.optimize.problem import LinkLists, Problem


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
    left_out = tuple(LeftOut(material.name, why) for material, why in reasons.items() if why)
    if not left_out:
        return problem
    materials = tuple(material for material in problem.materials if not reasons[material])
    lists = None if problem.lists is None else tuple(_list(entry, materials) for entry in problem.lists)
    if not materials or any(entry.materials == () for entry in lists or ()):
        whole = "; ".join(f"{item.material}: {item.why}" for item in left_out)
        message = f"leaves a link without a material, as figures are missing ({whole}); name another material"
        raise mapping.error("choose.material", f"{message}, or add the figure with `linkwright materials edit`")
    return replace(problem, materials=materials, lists=lists, left_out=left_out)


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
            missing.append(f"its {name.replace('_', ' ')} is not known, and {by} needs it")
        except OutOfRange:
            missing.append(f"its {name.replace('_', ' ')} is not known at the arm's temperature, and {by} needs it")
    return ", ".join(missing)
