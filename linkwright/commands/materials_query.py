"""Which materials a list shows, in which order and with which columns."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import cast

from materials.material import REFERENCE_TEMPERATURE, Material, PropertyName, property_kinds
from materials.quantities import InputError, format_quantity, read_quantity
from materials.reading import nearest

USUAL: tuple[PropertyName, ...] = ("elastic_modulus", "density", "yield_strength", "cost")
"""The columns of a list that nobody chose columns for."""
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
CONDITION = re.compile(r"\s*(\w+)\s*(<=|>=|==|=|<|>)\s*(.+)")
RELATIONS: Mapping[str, Callable[[float, float], bool]] = MappingProxyType(
    {
        "<": lambda one, other: one < other,
        "<=": lambda one, other: one <= other * (1 + 1e-12) if other >= 0 else one <= other,
        ">": lambda one, other: one > other,
        ">=": lambda one, other: one >= other * (1 - 1e-12) if other >= 0 else one >= other,
        "=": lambda one, other: abs(one - other) <= 1e-9 * abs(other),
        "==": lambda one, other: abs(one - other) <= 1e-9 * abs(other),
    }
)


@dataclass(frozen=True)
class Condition:
    """One `--where`: a property, a relation and a limit in SI."""

    name: PropertyName
    relation: str
    limit: float

    def holds(self, material: Material) -> bool:
        """Tell whether the material has the property and keeps the limit at 20 degC."""
        return material.has(self.name) and RELATIONS[self.relation](material.need(self.name), self.limit)


def property_of(text: str, option: str) -> PropertyName:
    """The property that a user names, by its name or its short heading. Raises `InputError`."""
    wanted = text.strip().replace(" ", "_").replace("-", "_")
    for name in property_kinds():
        if wanted in (name, SHORT.get(name, name)):
            return name
    raise InputError("", option, f"there is no property '{text.strip()}'{nearest(wanted, list(property_kinds()))}")


def condition(text: str) -> Condition:
    """`density < 3 g/cm^3` as a condition. Raises `InputError`."""
    found = CONDITION.fullmatch(text)
    if not found:
        raise InputError("", "--where", f"'{text}' is no condition; write e.g. 'density < 3 g/cm^3'")
    name = property_of(found[1], "--where")
    kind = property_kinds()[name]
    given: object = found[3].strip()
    return Condition(name, found[2], read_quantity(given, kind, file="--where", key=name))


def chosen(
    materials: Iterable[Material], families: Sequence[str], conditions: Sequence[Condition], sort: str | None
) -> list[Material]:
    """The materials that pass every filter, in the order asked for; those without the sorted property last.

    `sort` is `name`, `family` or a property, with `-` before it for the largest first. Raises `InputError`.
    """
    every = list(materials)
    known = sorted({material.family for material in every})
    for family in families:
        if family not in known:
            raise InputError("", "--family", f"there is no family '{family}'{nearest(family, known)}")
    found = [
        material
        for material in every
        if (not families or material.family in families) and all(each.holds(material) for each in conditions)
    ]
    if not sort:
        return found
    key, descending = sort.removeprefix("-"), sort.startswith("-")
    if key in ("name", "family"):
        return sorted(found, key=lambda material: cast(str, getattr(material, key)), reverse=descending)
    name = property_of(key, "--sort")
    having = [material for material in found if material.has(name)]
    having.sort(key=lambda material: material.need(name), reverse=descending)
    return having + [material for material in found if not material.has(name)]


def chosen_columns(text: str | None) -> tuple[PropertyName, ...]:
    """The columns of `--columns density,cost`; `all` is every property. Raises `InputError`."""
    if not text:
        return USUAL
    if text.strip() == "all":
        return tuple(property_kinds())
    return tuple(property_of(part, "--columns") for part in text.split(",") if part.strip())


def written(value: float, name: PropertyName, digits: int = DIGITS) -> str:
    """A value of a property with its unit."""
    return format_quantity(value, property_kinds()[name], digits=digits)


def value_of(material: Material, name: PropertyName) -> str:
    """A material's property at 20 degC, a dash where it has none."""
    return written(material.need(name, REFERENCE_TEMPERATURE), name) if material.has(name) else "–"
