"""What one link can be, in cells: a shape of a material with ranges of its dimensions, split where it matters.

A cell knows what its sections bring (`optimize.choice.products`) at its corners and at its middle. A sum of their
logarithms is least at a corner where it rises or falls along each dimension; by how much the middle is off the mean of
the corners tells how curved it is between them, and twice that is taken off. Logarithms of a solid circle, ellipse or
rectangle are straight in those of its dimensions, so that one cell of all sizes is as good as many.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from arm.chain.beam import elastic_beam
from arm.errors.model import needs_shear_modulus
from materials.material import Material, MaterialValues
from optimize.choice.picks import options
from optimize.choice.products import FEATURES
from optimize.exchange.design import MATERIAL_FIELDS, material_row, material_values
from optimize.limits import Limit, OfLinks
from optimize.problem import Problem
from sections import SHAPES
from sections.numeric import Array
from sections.properties import SectionProperties
from sections.section import Section

COLUMNS = (*FEATURES, "price", "length")
"""What a cell holds of a section: the logarithms of its features, thermal expansion as it is, the logarithm of the
price of its material by length (EUR/m); and the logarithm of the link's length where that is free, which no section
settles (nought in every cell)."""
EXPANSION, PRICE, LENGTH = FEATURES.index("expansion"), len(FEATURES), len(FEATURES) + 1
_PLAIN = 4
"""So many of the features every section has; one of the others that is not known is in no sum."""
_LEAST_PRICE = 1e-12
_CURVED = 2.0
"""What is taken off for curvature, over the difference of the middle from the mean of the corners: exactly one where
the middle is the lowest point of a parabola."""
_FIRST = 4
"""Cells along each dimension of a shape whose features are not straight, at first, all together at most that many."""
_GIVES = 1e-7
"""By how much a section may break its own limits and still count."""
_NARROW = 0.3
"""A cell this narrow (in logarithms) whose corners are no sections is left out: what is possible ends far inside."""
MOST_CELLS, MOST_CELLS_FREE = 100_000, 60_000
"""So many cells are made of a link's options, with lengths that stay and free ones; from then on they stay as they
are."""
NARROWEST = 1e-5
"""Cells are not split further than this (in logarithms)."""

Ids = NDArray[np.intp]


@dataclass(frozen=True)
class _Kind:
    """A shape: by which numbers its sections are made, and between which logarithms they lie."""

    shape: str
    names: tuple[str, ...]
    variables: bool
    lower: Array
    upper: Array

    def section(self, values: Sequence[Array]) -> Section:
        kind = SHAPES[self.shape]
        if self.variables:
            return kind.from_variables(list(values))
        return kind(**dict(zip(self.names, values, strict=True)))


def _kind_of(shape: str, problem: Problem) -> _Kind:
    kind = SHAPES[shape]
    bounds = {"outer": problem.section_size, "wall": problem.thickness}
    plain = all(variable.kind in bounds for variable in kind.variables)
    used: Sequence[Any] = (
        kind.variables if plain else [d for d in kind.dimensions if d.kind in bounds and not d.optional]
    )
    spans = np.log([bounds[each.kind] for each in used])
    return _Kind(shape, tuple(each.name for each in used), plain, spans[:, 0], spans[:, 1])


class Cells:
    """The cells of a link's options (shape with material); more of them as they are split. Arrays by cell: `option`,
    `low` and `high` (logarithms of dimensions), `corners` (N, C + 1, K) whose last is the middle, `kept` (N, C + 1)
    which of those keep all limits on single links, `pad` (N, K) what is taken off for curvature."""

    def __init__(self, problem: Problem, options: Sequence[tuple[str, Material]]) -> None:
        self.problem, self.options = problem, tuple(options)
        self._shear = needs_shear_modulus(problem.arm, problem.load_cases)
        self._limits = tuple(limit for limit in problem.limits if isinstance(limit.figure.follows, OfLinks))
        shapes = tuple(dict.fromkeys(shape for shape, _ in self.options))
        self._kinds = tuple(_kind_of(shape, problem) for shape in shapes)
        self._kind = np.array([shapes.index(shape) for shape, _ in self.options])
        self._rows = np.array([material_row((material,), problem) for _, material in self.options])
        self._width = max(len(kind.names) for kind in self._kinds)
        count = 2**self._width + 1
        room = 4 * len(self.options)
        self.count = 0
        self.option: Ids = np.zeros(room, dtype=np.intp)
        self.low, self.high = np.zeros((room, self._width)), np.zeros((room, self._width))
        self.corners = np.zeros((room, count, len(COLUMNS)))
        self.kept = np.zeros((room, count), dtype=bool)
        self.pad = np.zeros((room, len(COLUMNS)))
        self._children: dict[tuple[int, int], Ids] = {}
        self.roots = self._first_cells()

    def _first_cells(self) -> Ids:
        found: list[Ids] = []
        for number, kind in enumerate(self._kinds):
            options = np.flatnonzero(self._kind == number)
            size = len(kind.names)
            own = np.zeros((len(options), self._width))
            low, high = own.copy(), own.copy()
            low[:, :size], high[:, :size] = kind.lower, kind.upper
            ids, _ = self._made(options, low, high)
            for _ in range(24):
                poor = (self.pad[ids, :_PLAIN].max(axis=1) > _FIRST) | ~np.isfinite(self.pad[ids]).all(axis=1)
                if not poor.any():
                    break
                widest = (self.high - self.low)[ids[poor]].argmax(axis=1)
                ids = np.concatenate([ids[~poor], self.split(ids[poor], widest)])
            found.append(ids)
        return np.concatenate(found)

    def _made(self, options: Ids, low: Array, high: Array) -> tuple[Ids, Ids]:
        """New cells, those that hold no section that keeps its limits left out; and where each stands in what was
        given."""
        found: list[tuple[Ids, Ids]] = []
        for number, kind in enumerate(self._kinds):
            own = np.flatnonzero(self._kind[options] == number)
            if len(own):
                ids, stay = self._made_of(kind, options[own], low[own], high[own])
                found.append((ids, own[stay]))
        nothing = np.zeros(0, dtype=np.intp)
        return tuple(np.concatenate(each) for each in zip(*found, strict=True)) if found else (nothing, nothing)  # type: ignore[return-value]

    def _made_of(self, kind: _Kind, options: Ids, low: Array, high: Array) -> tuple[Ids, NDArray[np.bool_]]:
        size = len(kind.names)
        shares = np.array([*itertools.product((0.0, 1.0), repeat=size), (0.5,) * size])
        points = low[:, None, :size] + shares * (high - low)[:, None, :size]
        columns, kept, held = self._measured(kind, options, points)
        middle, corners = columns[:, -1], columns[:, :-1]
        with np.errstate(invalid="ignore"):
            pad = _CURVED * np.abs(middle - corners.mean(axis=1))
            bend = _CURVED * np.abs(held[:, -1] - held[:, :-1].mean(axis=1))
            least = held[:, :-1].min(axis=1) - bend
        impossible = (least > _GIVES).any(axis=1)
        narrow = (high - low).max(axis=1) <= _NARROW
        impossible |= narrow & ~np.isfinite(pad[:, :_PLAIN]).all(axis=1)
        times = (self.corners.shape[1] - 1) // corners.shape[1]
        full = np.concatenate([np.repeat(corners, times, axis=1), middle[:, None]], axis=1)
        flags = np.concatenate([np.repeat(kept[:, :-1], times, axis=1), kept[:, -1:]], axis=1)
        stay = ~impossible
        place = self._more(int(stay.sum()))
        self.option[place] = options[stay]
        self.low[place], self.high[place] = low[stay], high[stay]
        self.corners[place], self.kept[place], self.pad[place] = full[stay], flags[stay], pad[stay]
        return np.arange(place.start, place.stop), stay

    def _more(self, number: int) -> slice:
        """Where so many more cells go; the arrays double where they are full."""
        first, self.count = self.count, self.count + number
        while self.count > len(self.option):
            for name in ("option", "low", "high", "corners", "kept", "pad"):
                own = getattr(self, name)
                setattr(self, name, np.concatenate([own, np.zeros_like(own)]))
        return slice(first, self.count)

    def _measured(self, kind: _Kind, options: Ids, points: Array) -> tuple[Array, NDArray[np.bool_], Array]:
        """The columns of sections, whether they keep all limits, and the values that must not be above nought."""
        materials = material_values(self._rows[options].T[:, :, None], 0)
        count = points.shape[:2]
        with np.errstate(all="ignore"):
            section = kind.section([np.exp(points[..., k]) for k in range(points.shape[2])])
            found = features(section.properties(materials.poisson_ratio), materials, shear=self._shear)
            columns = np.zeros((*count, len(COLUMNS)))
            for k, each in enumerate(found):
                columns[..., k] = np.log(np.broadcast_to(each, count))
            prices = self._rows[options, MATERIAL_FIELDS.index("cost")][:, None]
            columns[..., PRICE] = np.log(np.maximum(prices * np.exp(columns[..., 0]), _LEAST_PRICE))
            rows = [np.broadcast_to(np.asarray(value, dtype=float), count) for value in self._held(section, materials)]
        columns[..., EXPANSION] = self._rows[options, MATERIAL_FIELDS.index("thermal_expansion")][:, None]
        columns[..., _PLAIN:] = np.where(np.isfinite(columns[..., _PLAIN:]), columns[..., _PLAIN:], 0.0)
        held = np.stack(rows, axis=-1) if rows else np.full((*count, 1), -1.0)
        kept = np.asarray((held <= _GIVES).all(axis=-1) & np.isfinite(columns).all(axis=-1))
        return columns, kept, np.where(np.isfinite(held), held, np.inf)

    def _held(self, section: Section, materials: MaterialValues) -> list[Any]:
        problem = self.problem
        own = (*section.constraints(), *section.bound_constraints(problem.section_size, problem.thickness))
        return [*(each.value for each in own), *(x for limit in self._limits for x in held(limit, section, materials))]

    def split(self, ids: Ids, axes: Ids) -> Ids:
        """The halves of cells, each along a dimension. Splitting one again gives the same ones."""
        asked = list(zip(ids.tolist(), axes.tolist(), strict=True))
        fresh = [each for each in asked if each not in self._children]
        if fresh:
            parents = np.repeat(np.array([cell for cell, _ in fresh]), 2)
            along = np.repeat(np.array([axis for _, axis in fresh]), 2)
            low, high = self.low[parents], self.high[parents]
            every = np.arange(len(parents))
            middle = 0.5 * (low + high)[every, along]
            low[every[1::2], along[1::2]] = middle[1::2]
            high[every[::2], along[::2]] = middle[::2]
            made, places = self._made(self.option[parents], low, high)
            order = np.argsort(places, kind="stable")
            made, owners = made[order], places[order] // 2
            ends = np.searchsorted(owners, np.arange(len(fresh) + 1))
            for number, each in enumerate(fresh):
                self._children[each] = made[ends[number] : ends[number + 1]]
        return np.concatenate([self._children[each] for each in asked]) if asked else ids

    def telling_axes(self, ids: Ids, price: Array) -> Ids:
        """The dimension of each cell along which a sum of its columns differs most between its corners, or is widest
        where the cell is curved more than that."""
        scores = (self.corners[ids, :-1] @ price).reshape(len(ids), *(2,) * self._width)
        effects = np.stack(
            [np.abs(np.diff(scores, axis=1 + k)).reshape(len(ids), -1).max(axis=1) for k in range(self._width)], axis=1
        )
        widths = (self.high - self.low)[ids]
        curved = self.pad[ids] @ np.abs(price) > 0.5 * effects.max(axis=1)
        return np.where(curved, widths.argmax(axis=1), np.where(widths > 0.0, effects, -1.0).argmax(axis=1))

    @property
    def spent(self) -> bool:
        """Whether there are as many cells as there may be."""
        return self.count >= (MOST_CELLS if self.problem.link_length is None else MOST_CELLS_FREE)

    def width(self, ids: Ids) -> Array:
        """The widest range of each cell (in logarithms)."""
        return (self.high - self.low)[ids].max(axis=1)

    def spans(self, ids: Ids) -> tuple[Array, Array]:
        """The least and the greatest of each column in each cell."""
        corners, pad = self.corners[ids, :-1], self.pad[ids]
        return corners.min(axis=1) - pad, corners.max(axis=1) + pad

    def values(self, cell: int, corner_shares: Array) -> tuple[str, tuple[str, ...], Array]:
        """A section inside a cell: its shape, the names of its dimensions and their values (m)."""
        kind = self._kinds[self._kind[self.option[cell]]]
        size = len(kind.names)
        at = self.low[cell, :size] + corner_shares[:size] * (self.high - self.low)[cell, :size]
        return kind.shape, kind.names, cast(Array, np.exp(at))


def features(found: SectionProperties, materials: MaterialValues, *, shear: bool) -> list[Any]:
    """A section's features but for expansion (see `products.FEATURES`), in floats, arrays or symbols."""
    beam = elastic_beam(1.0, found, materials, shear=shear)
    across = (beam.torsional_rigidity, beam.shear_rigidity_height, beam.shear_rigidity_width)
    rigid = [beam.axial_rigidity, beam.flexural_rigidity_height, beam.flexural_rigidity_width, *across]
    strong = [
        each * materials.yield_strength for each in (found.area, found.section_modulus_y, found.section_modulus_z)
    ]
    return [
        beam.mass_per_length,
        *(1.0 if each is None or (k > 2 and not shear) else 1.0 / each for k, each in enumerate(rigid)),
        *(1.0 / each for each in strong),
    ]


def held(limit: Limit, section: Section, materials: MaterialValues) -> list[Any]:
    """What must not be above nought for a single link to keep a limit."""
    follows = limit.figure.follows
    assert isinstance(follows, OfLinks)
    sign = -1.0 if limit.relation == ">=" else 1.0
    return [sign * (value / limit.value - 1.0) for value in follows.values(section, materials) or ()]


def elastic_links(problem: Problem) -> tuple[int, ...]:
    """The links that have a section, from 0."""
    return tuple(k for k, link in enumerate(problem.arm.links) if link.section is not None)


def link_cells(problem: Problem) -> tuple[Cells, ...]:
    """The cells of each elastic link; links with the same options share them."""
    shapes, materials = options(problem)
    made: dict[tuple[tuple[str, str], ...], Cells] = {}
    found: list[Cells] = []
    for k in elastic_links(problem):
        own = [(shape, material) for shape in shapes[k] if shape for material in materials[k] if material]
        key = tuple((shape, material.name) for shape, material in own)
        if key not in made:
            made[key] = Cells(problem, own)
        found.append(made[key])
    return tuple(found)
