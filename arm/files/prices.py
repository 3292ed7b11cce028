"""Prices in an arm file: of joints, of links, and of work on links; each with its date where it has one."""

from __future__ import annotations

from typing import Any

from linkwright.core.arm.chain.chain import Machining
from linkwright.core.units.quantities import format_quantity
from linkwright.core.units.reading import Mapping


def read_cost(mapping: Mapping) -> tuple[float | None, str]:
    """The `cost` (EUR) of a joint or link, None where it has none, and its date: `120 EUR`, or
    `{value: 120 EUR, date: 2026-01}`. Raises `InputError`."""
    if not mapping.has("cost"):
        return None, ""
    if not isinstance(mapping.content["cost"], dict):
        return mapping.not_negative("cost", "cost"), ""
    with mapping.mapping("cost").reading() as cost:
        return cost.not_negative("value", "cost"), cost.when("date", "")


def read_machining(mapping: Mapping) -> Machining:
    """What work on the links costs (`machining` of an arm file), nothing where the file does not say. Raises
    `InputError`."""
    if not mapping.has("machining"):
        return Machining()
    with mapping.mapping("machining").reading() as work:
        return Machining(
            per_kilogram=work.not_negative("per_kilogram", "cost_per_mass", 0.0),
            per_metre=work.not_negative("per_metre", "cost_per_length", 0.0),
            per_part=work.not_negative("per_part", "cost", 0.0),
            date=work.when("date", ""),
        )


def cost_to_value(cost: float, date: str) -> Any:
    """A joint's or link's cost as a file holds it."""
    written = format_quantity(cost, "cost")
    return {"value": written, "date": date} if date else written


def machining_to_mapping(machining: Machining) -> dict[str, Any]:
    """What work costs as a file holds it; empty where it says nothing."""
    out: dict[str, Any] = {}
    kinds = {"per_kilogram": "cost_per_mass", "per_metre": "cost_per_length", "per_part": "cost"}
    for name, kind in kinds.items():
        if value := getattr(machining, name):
            out[name] = format_quantity(value, kind)
    return {**out, "date": machining.date} if out and machining.date else out
