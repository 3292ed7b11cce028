"""`observes:` of recording.yaml: what an instrument reads, along which direction, from which anchor, on which link."""

from __future__ import annotations

from types import MappingProxyType
from typing import Literal, cast

from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import InputError, read_number, shown
from linkwright.core.units.reading import Mapping

from .instrument import KINDS, Instrument, Kind, direction_along

_GO_WITH: MappingProxyType[str, Kind] = MappingProxyType(
    {"direction": "along", "anchor": "distance", "tilt_link": "tilt", "camera": "camera"}
)
"""Settings, and the kind of observation that each is of."""


def read_instrument(mapping: Mapping) -> Instrument | None:
    """What the settings say that a recording observes, None where they say nothing. Raises `InputError`."""
    if not mapping.has("observes"):
        for name, kind in _GO_WITH.items():
            if mapping.has(name):
                raise mapping.error(name, f"goes with `observes: {kind}`; write that as well")
        return None
    raw = mapping.raw("observes")
    of_kind: dict[str, Mapping] = {}
    names: list[object]
    if isinstance(raw, dict):
        body = mapping.mapping("observes")
        names = list(body.content)
        of_kind = {name: body.mapping(name) for name in body.content if body.has(name)}
    else:
        names = cast(list[object], raw) if isinstance(raw, list) else [raw]
    kinds: list[Kind] = []
    for name in names:
        if name not in KINDS:
            near = nearest(str(name), list(KINDS)) if isinstance(name, str) else ""
            raise mapping.error("observes", f"{shown(name)} is not one of {', '.join(KINDS)}{near}")
        if name in kinds:
            raise mapping.error("observes", f"names {name} twice")
        kinds.append(cast(Kind, name))
    if not kinds:
        raise mapping.error("observes", f"names nothing; it is one or more of {', '.join(KINDS)}")
    direction, anchor, link = None, None, 0
    camera: Literal["fixed", "on_tool"] = "fixed"
    if "camera" in kinds and len(kinds) > 1:
        others = ", ".join(kind for kind in kinds if kind != "camera")
        raise mapping.error("observes", f"has {others} beside camera; give the camera a recording of its own")
    for kind in kinds:
        own = of_kind.get(kind, mapping)
        if kind == "along":
            direction = _direction(own)
        if kind == "distance":
            anchor = _anchor(own)
        if kind == "tilt":
            link = _link(own)
        if kind == "camera":
            camera = _camera(own)
        if kind in of_kind:
            of_kind[kind].close()
    for name, kind in _GO_WITH.items():
        if mapping.has(name) and kind not in kinds:
            raise mapping.error(name, f"goes with `observes: {kind}`; add {kind} or take it out")
    return Instrument(tuple(kinds), direction, anchor, tilt_link=link, camera=camera)


def _camera(mapping: Mapping) -> Literal["fixed", "on_tool"]:
    would_do = "`camera: fixed` (the target is on the tool) or `camera: on_tool` (the target is fixed)"
    if not mapping.has("camera"):
        raise mapping.error("camera", f"is missing; write where the camera is: {would_do}")
    raw = mapping.raw("camera")
    if raw not in ("fixed", "on_tool"):
        raise mapping.error("camera", f"{shown(raw)} is no place of a camera; write {would_do}")
    return raw


def _link(mapping: Mapping) -> int:
    would_do = "where the level stands: `tilt_link: base`, or the number of a link, from 1 at the base"
    if not mapping.has("tilt_link"):
        raise mapping.error("tilt_link", f"is missing; write {would_do}")
    raw = mapping.raw("tilt_link")
    if raw == "base":
        return 0
    if isinstance(raw, bool) or not isinstance(raw, int) or raw < 1:
        raise mapping.error("tilt_link", f"{shown(raw)} is no link; write {would_do}")
    return raw


def _direction(mapping: Mapping) -> tuple[float, float, float]:
    would_do = "the direction measured along, e.g. `direction: [0, 0, 1]`"
    if not mapping.has("direction"):
        raise mapping.error("direction", f"is missing; write {would_do}")
    values = mapping.items("direction")
    if len(values) not in (2, 3) or not all(isinstance(x, int | float) and not isinstance(x, bool) for x in values):
        raise mapping.error("direction", f"needs three numbers, not {shown(values)}; e.g. [0, 0, 1]")
    place = mapping.path_of("direction")
    numbers = [read_number(value, file=mapping.file, key=f"{place}[{k}]") for k, value in enumerate(values, start=1)]
    direction = direction_along(numbers)
    if direction is None:
        raise mapping.error("direction", f"{shown(values)} has no length; write {would_do}")
    return direction


def _anchor(mapping: Mapping) -> tuple[float, float, float] | None:
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
