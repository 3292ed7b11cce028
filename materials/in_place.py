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
    results: dict[str, Any] = {}
    for name, value in content.items():
        if name in kinds:
            results[name] = _property(value, kinds[name])
        elif name == "laminate" and isinstance(value, dict):
            results[name] = _laminate(cast(dict[str, Any], value))
        else:
            results[name] = value
    return results


def _property(value: Any, kind: str) -> Any:
    if not isinstance(value, dict):
        return _written(value, kind)
    kinds = {"value": kind, "spread": kind, "range": "temperature"}
    content: dict[str, Any] = {}
    for name, item in cast(dict[str, Any], value).items():
        if name == "table" and isinstance(item, list):
            content[name] = [_row(row, kind) for row in cast(list[Any], item)]
        elif name == "polynomial" and isinstance(item, dict):
            inner = {"origin": "temperature", "coefficients": kind}
            content[name] = {k: _written(v, inner.get(k)) for k, v in cast(dict[str, Any], item).items()}
        else:
            content[name] = _written(item, kinds.get(name))
    return content


def _row(row: Any, kind: str) -> Any:
    """A temperature and the value there."""
    if not isinstance(row, list):
        return row
    pairs = zip(cast(list[Any], row), ("temperature", kind), strict=False)
    return [_written(item, entry) for item, entry in pairs]


def _laminate(value: dict[str, Any]) -> dict[str, Any]:
    ply = value.get("ply")
    laminate = {name: _written(item, _LAMINATE.get(name)) for name, item in value.items()}
    return {**laminate, "ply": with_units(cast(dict[str, Any], ply))} if isinstance(ply, dict) else laminate


def _written(value: Any, kind: str | None) -> Any:
    """A number in SI with its unit, also in a list; pure numbers and all else as they are."""
    if isinstance(value, list):
        return [_written(item, kind) for item in cast(list[Any], value)]
    if not isinstance(value, SIFloat | SIInt):
        return value
    return float(value) if kind in (None, "dimensionless") else format_quantity(float(value), kind)
