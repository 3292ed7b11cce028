"""What a link's section and length can be rounded to: a grid of sizes, or the rows of the stock tables."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from linkwright.core.materials.catalogue import shipped_layers
from linkwright.core.materials.material import Material
from linkwright.core.optimize.exchange.other_lengths import allowed, free_links
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.reading.ranges import Ranges
from linkwright.core.sections import SHAPES, StockSize, load_stock
from linkwright.core.sections.section import Section
from linkwright.core.units.quantities import InputError, NoAnswer, format_quantity, read_quantity

LENGTH_STEP = 1e-3
"""The grid of link lengths unless another is given, m."""
_ON_GRID = 1e-4
"""A size this near to the grid (in steps) is on it."""
_WITHIN = 1e-9

_STEELS = ("steel-s235", "steel-s275", "steel-s355", "steel-s460n")
_WROUGHT = (
    "aluminium-2024-t3",
    "aluminium-5083-h111",
    "aluminium-6061-t6",
    "aluminium-6063-t6",
    "aluminium-6082-t6",
    "aluminium-7075-t6",
)
GRADES = MappingProxyType(
    {
        "EN 10210": _STEELS,
        "EN 10219": _STEELS,
        "EN 10365": _STEELS,
        "EN 755": _WROUGHT,
        "Aluminum Design Manual": _WROUGHT,
        "Misumi": ("aluminium-6063-t6",),
    }
)
"""The shipped materials that a standard of dimensions is delivered in, by the technical conditions that go with it:
EN 10210-1, EN 10219-1, EN 10025 (for EN 10365), EN 755-2 and ASTM B221 (for the Aluminum Design Manual). Misumi's
alloys are near 6063."""


@dataclass(frozen=True)
class Rounding:
    """What to round to: a grid with this `step` (m), or the stock tables where it is None; lengths go to their own."""

    step: float | None
    length_step: float = LENGTH_STEP

    @property
    def text(self) -> str:
        """As people write it."""
        return "stock" if self.step is None else format_quantity(self.step, "length")


@dataclass(frozen=True)
class Option:
    """A section with its material for one link, its name where it is a stock size, and where it stands in a problem's
    list of sizes, material after material."""

    section: Section
    material: Material
    stock: str | None = None
    place: int = 0


def read_rounding(text: str, length: str | None = None) -> Rounding:
    """What `--round stock` or `--round "0.5 mm"` asks for, lengths to 1 mm unless given. Raises `InputError`."""
    step = None if text.strip().casefold() == "stock" else _step(text, "--round")
    return Rounding(step, LENGTH_STEP if length is None else _step(length, "--round-length"))


def _step(text: str, key: str) -> float:
    step = read_quantity(text, "length", file="", key=key)
    if not 1e-6 <= step <= 0.1:
        raise InputError("", key, f"is a step from 1 um to 100 mm, not {text}")
    return step


# ---- stock


def stock_rows(ranges: Ranges, shape: str) -> list[StockSize]:
    """The stock sizes of a shape whose dimensions lie within the problem's bounds."""
    return [size for size in load_stock() if size.shape == shape and _in_bounds(ranges, size.section)]


def _in_bounds(ranges: Ranges, section: Section) -> bool:
    """Whether outer sizes and walls (not the radii of fillets and corners) lie within the problem's bounds."""
    return not _out_of_bounds(ranges, section)


def _out_of_bounds(ranges: Ranges, section: Section) -> dict[str, float]:
    """The outer sizes and walls beyond the problem's bounds, each with how far in logarithms."""
    bounds = ranges.by_kind
    excesses: dict[str, float] = {}
    for dimension in section.dimensions:
        value = getattr(section, dimension.name)
        if value is None or dimension.kind not in bounds:
            continue
        low, high = bounds[dimension.kind]
        if not low * (1.0 - _WITHIN) <= float(value) <= high * (1.0 + _WITHIN):
            excesses[dimension.name] = max(math.log(low / value), math.log(value / high))
    return excesses


def why_no_stock(ranges: Ranges, shapes: Sequence[str], materials: Sequence[Material]) -> str:
    """Why no stock size of these shapes can be had in these materials within the problem's bounds, and which comes
    nearest to them."""
    named = " or ".join(material.name for material in materials)
    every = [size for size in load_stock() if size.shape in shapes]
    what = f"no stock size of shape {' or '.join(shapes)}"
    if not every:
        return f"there is {what}"
    had = [size for size in every if any(comes_in(size, material) for material in materials)]
    if not had:
        return f"{what} comes in {named}"
    beyond = {size.name: _out_of_bounds(ranges, size.section) for size in had}
    near = min(had, key=lambda size: sum(beyond[size.name].values()))
    sizes = [
        f"{name} {format_quantity(float(getattr(near.section, name)), 'length', digits=4)}"
        for name in beyond[near.name]
    ]
    nearest = f"; the nearest, {near.name}, has {' and '.join(sizes)}" if sizes else ""
    return f"{what} within section_size and thickness comes in {named}{nearest}"


def comes_in(size: StockSize, material: Material) -> bool:
    """Whether a stock size is delivered in a material. A standard that is not known here, or a material that is not the
    program's own, is taken at its user's word."""
    for standard, grades in GRADES.items():
        if re.search(rf"\b{re.escape(standard)}(?!\d)", size.source):
            return material.name in grades or material.name not in _shipped_names()
    return True


def _shipped_names() -> frozenset[str]:
    return frozenset(name for layer in shipped_layers() for name in layer.materials)


def stock_options(ranges: Ranges, shapes: Iterable[str], materials: Iterable[Material]) -> list[Option]:
    """Every stock size of these shapes in every one of the materials that it comes in."""
    materials = tuple(materials)
    return [
        Option(size.section, material, size.name)
        for shape in shapes
        for size in stock_rows(ranges, shape)
        for material in materials
        if comes_in(size, material)
    ]


def on_grid(problem: Problem, rounding: Rounding) -> Problem:
    """The problem with bounds on sizes, walls and lengths drawn in to multiples of the steps; the same where they are.

    Raises `NoAnswer` where a bound leaves no multiple.
    """
    ranges: list[Ranges] = []
    for link, link_ranges in enumerate(problem.ranges):
        lengths, (sizes, walls) = link_ranges.link_length, link_ranges.sizes
        if lengths is not None:
            lengths = _drawn_in("link_length", lengths, rounding.length_step)
        if rounding.step is None:
            ranges.append(replace(link_ranges, link_length=lengths))
            continue
        sizes = _drawn_in("section_size", sizes, rounding.step)
        if any(dimension.kind == "wall" for shape in problem.shapes_of(link) for dimension in SHAPES[shape].dimensions):
            walls = _drawn_in("thickness", walls, rounding.step)
        ranges.append(replace(link_ranges, section_size=sizes, thickness=walls, link_length=lengths))
    return replace(problem, ranges=tuple(ranges))


def _fixed(bounds: tuple[float, float]) -> bool:
    """Whether the problem says the size itself: it is one that can be had, on the grid or not."""
    return bounds[1] - bounds[0] <= _WITHIN * bounds[1]


def _drawn_in(name: str, bounds: tuple[float, float], step: float) -> tuple[float, float]:
    if _fixed(bounds):
        return bounds
    low, high = math.ceil(bounds[0] / step - _ON_GRID) * step, math.floor(bounds[1] / step + _ON_GRID) * step
    if low > high * (1.0 + _WITHIN):
        span = " to ".join(format_quantity(bound, "length") for bound in bounds)
        raise NoAnswer(f"{name} {span} holds no multiple of {format_quantity(step, 'length')}")
    drawn = (float(f"{low:.12g}"), float(f"{high:.12g}"))
    # A bound that is on the grid stays what it was, digit by digit.
    return (
        bounds[0] if abs(drawn[0] - bounds[0]) < _WITHIN * bounds[0] else drawn[0],
        bounds[1] if abs(drawn[1] - bounds[1]) < _WITHIN * bounds[1] else drawn[1],
    )


# ---- the grid


def multiples(value: float, step: float, bounds: tuple[float, float], reach: int) -> list[float]:
    """The multiples of a step nearest to a value (m), `reach` to either side, within bounds; a fixed size stays."""
    if _fixed(bounds):
        return [bounds[0]]
    at = value / step
    whole = round(at)
    if abs(at - whole) < _ON_GRID:
        numbers = range(whole - reach, whole + reach + 1)
    else:
        numbers = range(math.floor(at) - reach + 1, math.floor(at) + reach + 1)
    values = [float(f"{number * step:.12g}") for number in numbers if number > 0]
    low, high = bounds
    return [item for item in values if low * (1.0 - _WITHIN) <= item <= high * (1.0 + _WITHIN)]


def grid_sections(problem: Problem, section: Section, step: float, reach: int, link: int) -> list[Section]:
    """The possible sections whose every dimension is one of the nearest multiples of a step (m).

    Raises `NoAnswer` where a bound leaves no multiple.
    """
    choices: dict[str, list[float]] = {}
    for dimension in section.dimensions:
        value = getattr(section, dimension.name)
        if value is None:
            continue
        name = "section_size" if dimension.kind == "outer" else "thickness"
        bounds = problem.ranges[link].by_kind["outer" if dimension.kind == "outer" else "wall"]
        choices[dimension.name] = multiples(float(value), step, bounds, reach)
        if not choices[dimension.name]:
            span = " to ".join(format_quantity(bound, "length") for bound in bounds)
            grid = format_quantity(step, "length")
            raise NoAnswer(f"{name} {span} holds no multiple of {grid} for the {dimension.name} of link {link + 1}")
    made = [type(section)(**dict(zip(choices, sizes, strict=True))) for sizes in itertools.product(*choices.values())]
    return [item for item in made if not item.check() and _keeps_bounds(problem.ranges[link], item)]


def _keeps_bounds(ranges: Ranges, section: Section) -> bool:
    rows = section.bound_constraints(*ranges.sizes)
    return all(float(row.value) <= 1e-9 for row in rows)


def length_choices(problem: Problem, lengths: tuple[float, ...], step: float) -> list[tuple[float, ...]]:
    """All links' lengths together: the multiples of a step (m) next to the free ones that keep the limits on the reach.

    Raises `NoAnswer` where none do.
    """
    choices: list[list[float]] = []
    for number, (length, link_ranges) in enumerate(zip(lengths, problem.ranges, strict=True), start=1):
        if link_ranges.link_length is None:
            choices.append([length])
            continue
        choices.append(multiples(length, step, link_ranges.link_length, 1))
        if not choices[-1]:
            span = " to ".join(format_quantity(bound, "length") for bound in link_ranges.link_length)
            grid = format_quantity(step, "length")
            raise NoAnswer(f"link_length {span} holds no multiple of {grid} for link {number}")
    picks = [pick for pick in itertools.product(*choices) if keeps_lengths(problem, pick)]
    if not picks:
        limit = problem.limit("reach")[0]
        grid = format_quantity(step, "length")
        hint = "; give a finer --round-length" if problem.free_lengths else ""
        raise NoAnswer(f"{limit.text}: no lengths in steps of {grid} keep it{hint}")
    return picks


def moved_lengths(problem: Problem, lengths: tuple[float, ...], by: float) -> list[tuple[float, ...]]:
    """The lengths (m) with one of them, or two to opposite sides, moved by so much; those that keep the limits."""
    free = free_links(problem)
    moves = [{k: sign * by} for k in free for sign in (1.0, -1.0)]
    moves += [{one: by, other: -by} for one, other in itertools.permutations(free, 2)]
    moved = [tuple(float(f"{x + move.get(k, 0.0):.12g}") for k, x in enumerate(lengths)) for move in moves]
    return [pick for pick in moved if keeps_lengths(problem, pick)]


def keeps_lengths(problem: Problem, lengths: tuple[float, ...]) -> bool:
    """Whether lengths (m) keep the problem's bounds and its limits on the reach."""
    return not problem.free_lengths or allowed(problem, np.array([lengths[k] for k in free_links(problem)]))
