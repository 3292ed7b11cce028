"""The keys of a material that a file or a program describes in place, as a file holds them."""

from __future__ import annotations

from collections.abc import Mapping as MappingLike
from types import MappingProxyType
from typing import Any, cast

from linkwright.core.materials.material import property_kinds
from linkwright.core.units.quantities import SIFloat, SIInt, format_quantity

_LAMINATE = MappingProxyType({"angles": "angle", "thicknesses": "length"})


def with_units(content: MappingLike[str, Any]) -> dict[str, Any]:
    """The keys of a material described in place, the numbers that a program gave in SI as text with their units."""
    kinds: dict[str, str] = {**property_kinds()}
    found: dict[str, Any] = {}
    for name, value in content.items():
        if name in kinds:
            found[name] = _property(value, kinds[name])
        elif name == "laminate" and isinstance(value, dict):
            found[name] = _laminate(cast(dict[str, Any], value))
        else:
            found[name] = value
    return found


def _property(value: Any, kind: str) -> Any:
    if not isinstance(value, dict):
        return _written(value, kind)
    kinds = {"value": kind, "spread": kind, "range": "temperature"}
    found: dict[str, Any] = {}
    for name, each in cast(dict[str, Any], value).items():
        if name == "table" and isinstance(each, list):
            found[name] = [_row(row, kind) for row in cast(list[Any], each)]
        elif name == "polynomial" and isinstance(each, dict):
            inner = {"origin": "temperature", "coefficients": kind}
            found[name] = {k: _written(v, inner.get(k)) for k, v in cast(dict[str, Any], each).items()}
        else:
            found[name] = _written(each, kinds.get(name))
    return found


def _row(row: Any, kind: str) -> Any:
    """A temperature and the value there."""
    if not isinstance(row, list):
        return row
    pairs = zip(cast(list[Any], row), ("temperature", kind), strict=False)
    return [_written(each, own) for each, own in pairs]


def _laminate(value: dict[str, Any]) -> dict[str, Any]:
    ply = value.get("ply")
    found = {name: _written(each, _LAMINATE.get(name)) for name, each in value.items()}
    return {**found, "ply": with_units(cast(dict[str, Any], ply))} if isinstance(ply, dict) else found


def _written(value: Any, kind: str | None) -> Any:
    """A number in SI with its unit, also in a list; pure numbers and all else as they are."""
    if isinstance(value, list):
        return [_written(each, kind) for each in cast(list[Any], value)]
    if not isinstance(value, SIFloat | SIInt):
        return value
    return float(value) if kind in (None, "dimensionless") else format_quantity(float(value), kind)
