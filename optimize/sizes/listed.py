"""`choose.sizes` of a problem file: the sections that each link may have, one by one.

`stock` is every stock size of the shapes to choose from; names of stock sizes or families are just these; dimensions
with values (`{diameter: [40 mm, 50 mm], thickness: {from: 2 mm, to: 8 mm, step: 0.5 mm}}`) are all combinations of
them. A list of such entries, nested where it holds names, is one for each link.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

from linkwright.core.arm.chain.chain import Arm, askew
from linkwright.core.sections import SHAPES, SectionError, Stock, StockSize, load_stock
from linkwright.core.sections.section import Section
from linkwright.core.sections.stock.tables import plain_name
from linkwright.core.units.quantities import InputError, read_quantity, shown
from linkwright.core.units.reading import Mapping

_WITHIN = 1e-9
_MOST = 200_000
"""More sections than this for one link are refused: a step is far too small."""

Span = tuple[float, float]


@dataclass(frozen=True)
class Listed:
    """A section that a link may have; `stock` is the size that it is, whose name the arm file then holds."""

    section: Section
    stock: StockSize | None = None


def read_sizes(
    body: Mapping, arm: Arm, shapes: tuple[str, ...] | None, size: Span | None, wall: Span | None
) -> tuple[tuple[Listed, ...], ...] | None:
    """The sections of each link (none for rigid ones); None where the file lists none.

    `shapes` are those to choose from, or None for each link's own; `size` and `wall` are the ranges that the file
    gives (m), outside of which sizes are left out.
    """
    if not body.has("sizes"):
        return None
    raw = body.raw("sizes")
    nested = isinstance(raw, list) and any(not isinstance(entry, str) for entry in cast(list[object], raw))
    entries = cast(list[object], raw) if nested else [raw] * arm.size
    if len(entries) != arm.size:
        raise body.error("sizes", f"is one entry for all links, or one for each of the {arm.size} links")
    made: dict[object, tuple[Listed, ...]] = {}
    found: list[tuple[Listed, ...]] = []
    for number, (entry, link) in enumerate(zip(entries, arm.links, strict=True), start=1):
        if link.section is None:
            found.append(())
            continue
        own = shapes or (link.section.shape,)
        key = (id(entry), own)
        if key not in made:
            path = body.path_of(f"sizes[{number}]" if nested else "sizes")
            every = _read(entry, body.file, path, own)
            made[key] = tuple(each for each in every if _within(each.section, size, wall))
            if not made[key]:
                what = "no size of" if not every else "section_size and thickness leave no size of"
                raise InputError(body.file, path, f"{what} shape {' or '.join(own)}")
        found.append(made[key])
    return tuple(found)


def _read(entry: object, file: object, path: str, shapes: Sequence[str]) -> list[Listed]:
    known = load_stock()
    if entry == "stock":
        return [Listed(each.section, each) for each in known if each.shape in shapes]
    if isinstance(entry, str | list):
        names = cast(list[object], entry) if isinstance(entry, list) else [entry]
        found: list[Listed] = []
        for name in names:
            if not isinstance(name, str):
                would_do = "names of stock sizes, `stock`, or {width: [10 mm, 20 mm], ...}"
                raise InputError(file, path, f"needs {would_do}, not {shown(name)}")
            try:
                sizes = _named(known, name)
            except InputError as error:
                raise InputError(file, path, error.message) from None
            _refuse_askew(sizes[0].section, file, path)
            found += [Listed(size.section, size) for size in sizes]
        return list({each.stock.name: each for each in found if each.stock is not None}.values())
    with Mapping(entry, file=file, key=path).reading() as body:
        return [each for shape in shapes for each in _combined(body, shape, shapes)]


def _named(known: Stock, name: str) -> tuple[StockSize, ...]:
    """The stock size of that name, or the family's sizes."""
    families = {plain_name(family): family for family in known.families}
    if plain_name(name) in families:
        return known.of_family(name)
    return (known.find(name),)


def _combined(body: Mapping, shape: str, shapes: Sequence[str]) -> list[Listed]:
    """Every possible section of a shape with the values that its dimensions may have."""
    kind = SHAPES[shape]
    names = _dimensions(body, shape)
    for name in body.content:  # a dimension of another of the shapes
        if any(name == each.name for other in shapes for each in SHAPES[other].dimensions):
            body.has(name)
    values = [_values(body, name) for name in names]
    if math.prod(len(each) for each in values) > _MOST:
        raise body.error("", f"names more than {_MOST} sections of {shape}; a coarser step would do")
    found: list[Listed] = []
    for pick in itertools.product(*values):
        try:
            section = kind(**dict(zip(names, pick, strict=True)))
        except SectionError:
            continue
        if not section.check():
            found.append(Listed(section))
    if found:
        _refuse_askew(found[0].section, body.file, body.key)
    return found


def _dimensions(body: Mapping, shape: str) -> list[str]:
    """The dimensions of a shape that have values, all that it needs among them."""
    dimensions = SHAPES[shape].dimensions
    names = [each.name for each in dimensions if each.kind != "points" and body.has(each.name)]
    for each in dimensions:
        if each.name not in names and not each.optional and not (each.unless and set(each.unless) <= set(names)):
            raise body.error("", f"needs values for the {each.name} of {shape}, e.g. {each.name}: [40 mm, 50 mm]")
    return names


def _values(body: Mapping, name: str) -> list[float]:
    """The values (m) of a dimension: one, a list, or from one to another in steps."""
    raw = body.raw(name)
    path = body.path_of(name)
    if isinstance(raw, dict):
        with Mapping(cast(object, raw), file=body.file, key=path).reading() as inner:
            low, high, step = (inner.quantity(key, "length") for key in ("from", "to", "step"))
            if step <= 0.0 or high < low or low <= 0.0:
                raise inner.error("", "needs from below to, both above zero, and a step above zero")
            count = math.floor((high - low) / step + 1e-6) + 1
            if count > _MOST:
                raise inner.error("step", f"makes {count} values; a coarser one would do")
            return [float(f"{low + k * step:.12g}") for k in range(count)]
    entries = cast(list[object], raw) if isinstance(raw, list) else [raw]
    found = [
        read_quantity(entry, "length", file=body.file, key=path if entry is raw else f"{path}[{number}]")
        for number, entry in enumerate(entries, start=1)
    ]
    if not found or min(found) <= 0.0:
        raise body.error(name, "needs lengths above zero, e.g. [40 mm, 50 mm]")
    return list(dict.fromkeys(found))


def _refuse_askew(section: Section, file: object, path: str) -> None:
    if askew(section):
        raise InputError(file, path, f"a {section.shape} bends askew, and cannot be chosen")


def _within(section: Section, size: Span | None, wall: Span | None) -> bool:
    spans = {"outer": size, "wall": wall}
    for dimension in section.dimensions:
        value, span = getattr(section, dimension.name), spans.get(dimension.kind)
        if value is None or span is None:
            continue
        if not span[0] * (1.0 - _WITHIN) <= float(value) <= span[1] * (1.0 + _WITHIN):
            return False
    return True
