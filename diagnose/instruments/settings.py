"""`observes:` of recording.yaml: what an instrument reads, along which direction, from which anchor, on which link."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

from linkwright.core.units.quantities import InputError, read_number, shown
from linkwright.core.units.reading import Mapping

from .instrument import direction_along


def read_direction(mapping: Mapping, name: str, would_do: str) -> tuple[float, float, float]:
    """A direction by two or three numbers. Raises `InputError`."""
    would_do = f"{would_do} `{name}: [0, 0, 1]`"
    if not mapping.has(name):
        raise mapping.error(name, f"is missing; write {would_do}")
    values = mapping.items(name)
    if len(values) not in (2, 3) or not all(isinstance(x, int | float) and not isinstance(x, bool) for x in values):
        raise mapping.error(name, f"needs three numbers, not {shown(values)}; e.g. [0, 0, 1]")
    place = mapping.path_of(name)
    numbers = [read_number(value, file=mapping.file, key=f"{place}[{k}]") for k, value in enumerate(values, start=1)]
    direction = direction_along(numbers)
    if direction is None:
        raise mapping.error(name, f"{shown(values)} has no length; write {would_do}")
    return direction


def unit_along(name: str, numbers: Sequence[float]) -> tuple[float, float, float]:
    """A caller's direction. Raises `InputError`."""
    unit = direction_along(numbers)
    if unit is None:
        message = f"needs three numbers of a direction that has a length, not {shown(list(numbers))}"
        raise InputError("", name, message)
    return unit


def read_anchor(mapping: Mapping) -> tuple[float, float, float] | None:
    """Where distances are measured from; None where that is free. Raises `InputError`."""
    would_do = "where distances are measured from, e.g. `anchor: [1 m, 0 m, 0.3 m]`, or `anchor: free`"
    if not mapping.has("anchor"):
        raise mapping.error("anchor", f"is missing; write {would_do}")
    raw = mapping.raw("anchor")
    if raw == "free":
        return None
    if not isinstance(raw, list):
        raise mapping.error("anchor", f"needs three lengths or free, not {shown(raw)}; write {would_do}")
    count = len(cast(list[object], raw))
    if count not in (2, 3):
        raise InputError(mapping.file, mapping.path_of("anchor"), f"needs three lengths, not {count}; write {would_do}")
    x, y, z = [*mapping.vector("anchor", "length", count), 0.0][:3]
    return (x, y, z)
