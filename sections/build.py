"""A section from the name of its shape and its dimensions, with errors for people."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from linkwright.core.sections.numeric import is_symbol
from linkwright.core.sections.section import Section, SectionError
from linkwright.core.sections.shapes import SHAPES
from linkwright.core.units.names import nearest


def build(shape_name: str, dimensions: Mapping[str, Any]) -> Section:
    """The section of this shape and these dimensions (m; points of a polygon as pairs).

    Raises SectionError, with the key at fault and one line, for an unknown shape, an unknown or missing
    dimension,
    a dimension that is not a positive number, or dimensions that do not go together.
    """
    kind = SHAPES.get(shape_name)
    if kind is None:
        raise SectionError("shape", f"unknown shape {shape_name!r}{nearest(shape_name, SHAPES)}")
    known = {dimension.name: dimension for dimension in kind.dimensions}
    for name in dimensions:
        if name not in known:
            raise SectionError(name, f"a {shape_name} has no dimension {name!r}{nearest(name, known)}")
    for dimension in kind.dimensions:
        replaced = bool(dimension.unless) and all(name in dimensions for name in dimension.unless)
        if dimension.name not in dimensions and not dimension.optional and not replaced:
            instead = f" (or give {' and '.join(dimension.unless)})" if dimension.unless else ""
            raise SectionError(dimension.name, f"a {shape_name} needs its {dimension.name}{instead}")
    for name, value in dimensions.items():
        if known[name].kind != "points" and not is_symbol(value):
            _require_positive(name, value)
    section = kind(**dimensions)
    violated = section.check()
    if violated:
        walls = [name for name in dimensions if known[name].kind == "wall"]
        raise SectionError(walls[0] if walls else "shape", f"{violated[0]} in a {shape_name}")
    return section


def _require_positive(name: str, value: Any) -> None:
    if isinstance(value, (bool, str)) or value is None:
        raise SectionError(name, f"must be a length in metres, not {value!r}")
    array = np.asarray(value, dtype=float)
    if not np.all(np.isfinite(array)) or not np.all(array > 0.0):
        raise SectionError(name, f"must be positive, not {value}")
