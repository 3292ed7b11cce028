"""`choose.sizes` of a problem file: the sections that each link may have, one by one.

`stock` is every stock size of the shapes to choose from; names of stock sizes or families are just these; dimensions
with values (`{diameter: [40 mm, 50 mm], thickness: {from: 2 mm, to: 8 mm, step: 0.5 mm}}`) are all combinations of
them. Said by link (`{1: stock, others: {...}}`), or as a list of such entries, each link has its own.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import cast

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.optimize.reading.by_link import by_link
from linkwright.core.optimize.reading.ranges import Ranges
from linkwright.core.sections import SHAPES, SectionError, Stock, StockSize, load_stock
from linkwright.core.sections.section import Section
from linkwright.core.sections.stock.tables import plain_name
from linkwright.core.units.quantities import InputError, read_quantity, shown
from linkwright.core.units.reading import Mapping

_WITHIN = 1e-9
_MOST = 200_000
"""More sections than this for one link are refused: a step is far too small."""


@dataclass(frozen=True)
class Listed:
    """A section that a link may have; `stock` is the size that it is, whose name the arm file then holds."""

    section: Section
    stock: StockSize | None = None


def read_sizes(
    body: Mapping, arm: Arm, shapes: Sequence[tuple[str, ...] | None], ranges: Sequence[Ranges]
) -> tuple[tuple[Listed, ...], ...] | None:
    """The sections of each link (none for rigid ones); None where the file lists none.

    `shapes` are those that each link may have, or None for its own; `ranges` of dimensions that the file gives
    leave out what is outside of them.
    """
    if not body.has("sizes"):
        return None
    raw = body.raw("sizes")
    nested = isinstance(raw, list) and any(not isinstance(entry, str) for entry in cast(list[object], raw))
    entries = cast(list[object], raw) if nested else by_link(body, "sizes", arm, lambda item, key: item.raw(key)).each
    if len(entries) != arm.size:
        raise body.error("sizes", f"is one entry for all links, or one for each of the {arm.size} links")
    both = zip(shapes, arm.links, strict=True)
    named = {shape for element, link in both if link.section is not None for shape in element or (link.section.shape,)}
    made: dict[object, tuple[Listed, ...]] = {}
    sizes: list[tuple[Listed, ...]] = []
    for number, (entry, link) in enumerate(zip(entries, arm.links, strict=True), start=1):
        if link.section is None:
            sizes.append(())
            continue
        shape_names = shapes[number - 1] or (link.section.shape,)
        within = ranges[number - 1]
        key = (id(entry), shape_names, within.section_size, within.thickness)
        if key not in made:
            path = body.path_of(f"sizes[{number}]" if nested else "sizes")
            every = _read(entry, body.file, path, shape_names, named)
            made[key] = tuple(item for item in every if _within(item.section, within))
            if not made[key]:
                what = "no size of" if not every else "section_size and thickness leave no size of"
                raise InputError(body.file, path, f"{what} shape {' or '.join(shape_names)}")
        sizes.append(made[key])
    return tuple(sizes)


def _read(entry: object, file: object, path: str, shapes: Sequence[str], named: Collection[str]) -> list[Listed]:
    known = load_stock()
    if entry == "stock":
        return [Listed(item.section, item) for item in known if item.shape in shapes]
    if isinstance(entry, str | list):
        names = cast(list[object], entry) if isinstance(entry, list) else [entry]
        listed: list[Listed] = []
        for name in names:
            if not isinstance(name, str):
                would_do = "names of stock sizes, `stock`, or {width: [10 mm, 20 mm], ...}"
                raise InputError(file, path, f"needs {would_do}, not {shown(name)}")
            try:
                sizes = _named(known, name)
            except InputError as error:
                raise InputError(file, path, error.message) from None
            listed += [Listed(size.section, size) for size in sizes]
        return list({item.stock.name: item for item in listed if item.stock is not None}.values())
    with Mapping(entry, file=file, key=path).reading() as body:
        return [item for shape in shapes for item in _combined(body, shape, named)]


def _named(known: Stock, name: str) -> tuple[StockSize, ...]:
    """The stock size of that name, or the family's sizes."""
    families = {plain_name(family): family for family in known.families}
    if plain_name(name) in families:
        return known.of_family(name)
    return (known.find(name),)


def _combined(body: Mapping, shape: str, named: Collection[str]) -> list[Listed]:
    """Every possible section of a shape with the values that its dimensions may have."""
    kind = SHAPES[shape]
    names = _dimensions(body, shape)
    for name in body.content:  # a dimension of another of the shapes that links may have
        if any(name == dimension.name for other in named for dimension in SHAPES[other].dimensions):
            body.has(name)
    values = [_values(body, name) for name in names]
    if math.prod(len(value) for value in values) > _MOST:
        raise body.error("", f"names more than {_MOST} sections of {shape}; a coarser step would do")
    listed: list[Listed] = []
    for pick in itertools.product(*values):
        try:
            section = kind(**dict(zip(names, pick, strict=True)))
        except SectionError:
            continue
        if not section.check():
            listed.append(Listed(section))
    return listed


def _dimensions(body: Mapping, shape: str) -> list[str]:
    """The dimensions of a shape that have values, all that it needs among them."""
    dimensions = SHAPES[shape].dimensions
    names = [dimension.name for dimension in dimensions if dimension.kind != "points" and body.has(dimension.name)]
    for item in dimensions:
        if item.name not in names and not item.optional and not (item.unless and set(item.unless) <= set(names)):
            raise body.error("", f"needs values for the {item.name} of {shape}, e.g. {item.name}: [40 mm, 50 mm]")
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
    values = [
        read_quantity(entry, "length", file=body.file, key=path if entry is raw else f"{path}[{number}]")
        for number, entry in enumerate(entries, start=1)
    ]
    if not values or min(values) <= 0.0:
        raise body.error(name, "needs lengths above zero, e.g. [40 mm, 50 mm]")
    return list(dict.fromkeys(values))


def _within(section: Section, ranges: Ranges) -> bool:
    spans = {"outer": ranges.section_size, "wall": ranges.thickness}
    for dimension in section.dimensions:
        value, span = getattr(section, dimension.name), spans.get(dimension.kind)
        if value is None or span is None:
            continue
        if not span[0] * (1.0 - _WITHIN) <= float(value) <= span[1] * (1.0 + _WITHIN):
            return False
    return True
