"""What one link can be, in cells: a shape of a material with ranges of its dimensions, split where it matters.

A cell knows what its sections bring (`optimize.choice.products`) at its corners, at its middle and at the middles of
its sides. A sum of their logarithms is least at a corner where it rises or falls along each dimension; by how much the
middle is below two opposite sides tells how it sags along that dimension, and twice that is taken off, for each along
which the sum sags. Logarithms of a solid circle, ellipse or rectangle are straight in those of its dimensions, so that
one cell of all sizes is as good as many.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.bodies.warping import FREE, Warping, warping_of
from linkwright.core.arm.chain.beam import elastic_beam
from linkwright.core.arm.errors.model import needs_shear_modulus
from linkwright.core.arm.figures import ChosenMaterial, Limit, OfLinks
from linkwright.core.materials.material import Material
from linkwright.core.optimize.choice.picks import option_table
from linkwright.core.optimize.choice.products import FEATURES
from linkwright.core.optimize.exchange.design import MATERIAL_FIELDS, material_row, material_values
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.reading.ranges import Ranges
from linkwright.core.sections import SHAPES
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import Section

from .partial_cells import mixture, multipliers

COLUMNS = (*FEATURES, "price", "length")
"""What a cell holds of a section: the logarithms of its features, thermal expansion as it is, the logarithm of the
price of its material by length (EUR/m); and the logarithm of the link's length where that is free, which no section
settles (zero in every cell)."""
EXPANSION, PRICE, LENGTH = FEATURES.index("expansion"), len(FEATURES), len(FEATURES) + 1
_PLAIN = 4
"""So many of the features every section has; one of the others that is not known is in no sum."""
_LEAST_PRICE = 1e-12
_CURVED = 2.0
"""What is taken off for curvature along a dimension, over the difference of the middle from the mean of the two sides:
exactly one where the middle is the lowest point of a parabola."""
_FIRST = 4
"""Cells along each dimension of a shape whose features are not straight, at first, all together at most that many."""
_GIVES = 1e-7
"""By how much a section may break its limits and still count."""
_NARROW = 0.3
"""A cell this narrow (in logarithms) whose corners are no sections is left out: what is possible ends far inside."""
MOST_CELLS, MOST_CELLS_FREE = 100_000, 60_000
"""So many cells are made of a link's options, with lengths that stay and free ones; from then on they stay as they
are."""
_CANCELLED = 0.25
"""This share of all curvature is taken off as well: where columns' curvatures cancel at the middle they need not do so
all along."""
_AT_ONCE = 128
"""So many cells across a limit are looked at together."""
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


def _kind_of(shape: str, ranges: Ranges) -> _Kind:
    kind = SHAPES[shape]
    bounds = ranges.by_kind
    plain = all(variable.kind in bounds for variable in kind.variables)
    used: Sequence[Any] = (
        kind.variables if plain else [d for d in kind.dimensions if d.kind in bounds and not d.optional]
    )
    spans = np.log([bounds[item.kind] for item in used])
    return _Kind(shape, tuple(item.name for item in used), plain, spans[:, 0], spans[:, 1])


class Cells:
    """The cells of a link's options (shape with material); more of them as they are split. Arrays by cell: `option`,
    `low` and `high` (logarithms of dimensions), `corners` (N, C + 1, K) whose last is the middle, `kept` (N, C + 1)
    which of those keep all limits on single links, `bends` (N, D, K) what is taken off for curvature along each
    dimension: what sags counts, what arches does not. `held` (N, C, H) is what must not be above zero at the
    corners, and `held_bends` (N, D, H) what is taken off of it; `across` tells which cells lie across such a limit."""

    def __init__(self, problem: Problem, link: int, options: Sequence[tuple[str, Material]]) -> None:
        """`link` (from 0) is the one, or the first of those alike."""
        self.problem, self.options, self.ranges = problem, tuple(options), problem.ranges[link]
        self._shear = needs_shear_modulus(problem.arm, problem.load_cases)
        self._twisted = twisted(problem, link)
        self._limits = problem.limits_on_link(link)
        shapes = tuple(dict.fromkeys(shape for shape, _ in self.options))
        self._kinds = tuple(_kind_of(shape, self.ranges) for shape in shapes)
        self._kind = np.array([shapes.index(shape) for shape, _ in self.options])
        self._rows = np.array([material_row((material,), problem, link) for _, material in self.options])
        self._width = max(len(kind.names) for kind in self._kinds)
        count = 2**self._width + 1
        room = 4 * len(self.options)
        self.count = 0
        self.option: Ids = np.zeros(room, dtype=np.intp)
        self.low, self.high = np.zeros((room, self._width)), np.zeros((room, self._width))
        self.corners = np.zeros((room, count, len(COLUMNS)))
        self.kept = np.zeros((room, count), dtype=bool)
        self.bends = np.zeros((room, self._width, len(COLUMNS)))
        most = max(self._held_at_middle(number) for number in range(len(self._kinds)))
        self.held = np.full((room, count - 1, most), -1.0)
        self.held_bends = np.zeros((room, self._width, most))
        self.across = np.zeros(room, dtype=bool)
        self._children: dict[tuple[int, int], Ids] = {}
        self.roots = self._first_cells()

    def _held_at_middle(self, number: int) -> int:
        """How many conditions the sections of a shape have."""
        kind = self._kinds[number]
        middle = 0.5 * (kind.lower + kind.upper)[None, None]
        return self._measured(kind, np.flatnonzero(self._kind == number)[:1], middle)[2].shape[2]

    def _first_cells(self) -> Ids:
        cells: list[Ids] = []
        for number, kind in enumerate(self._kinds):
            options = np.flatnonzero(self._kind == number)
            size = len(kind.names)
            values = np.zeros((len(options), self._width))
            low, high = values.copy(), values.copy()
            low[:, :size], high[:, :size] = kind.lower, kind.upper
            ids, _ = self._made(options, low, high)
            for _ in range(24):
                pad = self.pad(ids)
                poor = (pad[:, :_PLAIN].max(axis=1) > _FIRST) | ~np.isfinite(pad).all(axis=1)
                if not poor.any():
                    break
                widest = (self.high - self.low)[ids[poor]].argmax(axis=1)
                ids = np.concatenate([ids[~poor], self.split(ids[poor], widest)])
            cells.append(ids)
        return np.concatenate(cells)

    def _made(self, options: Ids, low: Array, high: Array) -> tuple[Ids, Ids]:
        """New cells, those that hold no section that keeps its limits left out; and where each stands in what was
        given."""
        made: list[tuple[Ids, Ids]] = []
        for number, kind in enumerate(self._kinds):
            members = np.flatnonzero(self._kind[options] == number)
            if len(members):
                ids, stay = self._made_of(kind, options[members], low[members], high[members])
                made.append((ids, members[stay]))
        nothing = np.zeros(0, dtype=np.intp)
        return tuple(np.concatenate(item) for item in zip(*made, strict=True)) if made else (nothing, nothing)  # type: ignore[return-value]

    def _made_of(self, kind: _Kind, options: Ids, low: Array, high: Array) -> tuple[Ids, NDArray[np.bool_]]:
        size = len(kind.names)
        corners = np.array([*itertools.product((0.0, 1.0), repeat=size)])
        sides = 0.5 + 0.5 * np.concatenate([-np.eye(size), np.eye(size)])
        shares = np.concatenate([corners, np.full((1, size), 0.5), sides])
        points = low[:, None, :size] + shares * (high - low)[:, None, :size]
        columns, feasible, held = self._measured(kind, options, points)
        last = len(corners)
        with np.errstate(invalid="ignore"):
            bends, held_bends = _sagging(columns, last), _sagging(held, last)
            # Where a corner is no section at all, nothing is known of how the cell curves.
            bends[~np.isfinite(columns[:, :last]).all(axis=(1, 2))] = np.inf
            held_bends = np.where(np.all(np.isfinite(held[:, :last]), axis=1, keepdims=True), held_bends, np.inf)
            least = held[:, :last].min(axis=1) - np.maximum(held_bends, 0.0).sum(axis=1)
        impossible = (least > _GIVES).any(axis=1)
        narrow = (high - low).max(axis=1) <= _NARROW
        impossible |= narrow & ~np.isfinite(bends[..., :_PLAIN]).all(axis=(1, 2))
        times = (self.corners.shape[1] - 1) // last
        full = np.concatenate([np.repeat(columns[:, :last], times, axis=1), columns[:, last : last + 1]], axis=1)
        flags = np.concatenate([np.repeat(feasible[:, :last], times, axis=1), feasible[:, last : last + 1]], axis=1)
        stay = ~impossible
        known = np.all(np.isfinite(held_bends), axis=1, keepdims=True)
        known_held = np.repeat(np.where(known, held[:, :last], -1.0), times, axis=1)[stay]
        limits = slice(0, held.shape[2])
        place = self._more(int(stay.sum()))
        self.option[place] = options[stay]
        self.low[place], self.high[place] = low[stay], high[stay]
        self.corners[place], self.kept[place], self.bends[place, :size] = full[stay], flags[stay], bends[stay]
        self.held[place], self.held_bends[place] = -1.0, 0.0
        self.held[place, :, limits] = known_held
        self.held_bends[place, :size, limits] = np.where(known, held_bends, 0.0)[stay]
        self.across[place] = (known_held > 0.0).any(axis=(1, 2)) & np.isfinite(bends[stay]).all(axis=(1, 2))
        return np.arange(place.start, place.stop), stay

    def _more(self, number: int) -> slice:
        """Where so many more cells go; the arrays double where they are full."""
        first, self.count = self.count, self.count + number
        while self.count > len(self.option):
            for name in ("option", "low", "high", "corners", "kept", "bends", "held", "held_bends", "across"):
                present = getattr(self, name)
                setattr(self, name, np.concatenate([present, np.zeros_like(present)]))
        return slice(first, self.count)

    def _measured(self, kind: _Kind, options: Ids, points: Array) -> tuple[Array, NDArray[np.bool_], Array]:
        """The columns of sections, whether they keep all limits, and the values that must not be above zero."""
        materials = material_values(self._rows[options].T[:, :, None], 0)
        count = points.shape[:2]
        with np.errstate(all="ignore"):
            section = kind.section([np.exp(points[..., k]) for k in range(points.shape[2])])
            columns = columns_of(section, materials, count, shear=self._shear, twisted=self._twisted)
            rows = [
                np.broadcast_to(np.asarray(value, dtype=float), count)
                for value in section_rows(section, materials, self.ranges, self._limits)
            ]
        held = np.stack(rows, axis=-1) if rows else np.full((*count, 1), -1.0)
        feasible = np.asarray((held <= _GIVES).all(axis=-1) & np.isfinite(columns).all(axis=-1))
        return columns, feasible, np.where(np.isfinite(held), held, np.inf)

    def split(self, ids: Ids, axes: Ids) -> Ids:
        """The halves of cells, each along a dimension. Splitting one again gives the same ones."""
        pairs = list(zip(ids.tolist(), axes.tolist(), strict=True))
        fresh = [pair for pair in pairs if pair not in self._children]
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
            for number, item in enumerate(fresh):
                self._children[item] = made[ends[number] : ends[number + 1]]
        return np.concatenate([self._children[pair] for pair in pairs]) if pairs else ids

    def pad(self, ids: Ids) -> Array:
        """By how much a column of cells may leave the range of its corners, either way (N, K)."""
        return np.abs(self.bends[ids]).sum(axis=1)

    def least_kept(self, ids: Ids, price: Array, room: float) -> tuple[Array, Array]:
        """The least of a sum of columns (N) over what of each cell keeps its limits, from below: as well as it is known
        for those cells that come within `room` of the least of all. And how much curvature may have done to it, along
        all dimensions together; infinite where limits were not looked at, or nothing is known of corners."""
        result, bent = self._sags(ids, price)
        values = (self.corners[ids, :-1] @ price).min(axis=1) - result
        bent = np.where(self.across[ids], np.inf, bent)
        doubtful = self.across[ids]
        while (doubtful & (values <= values.min() + room)).any():
            near = np.flatnonzero(doubtful)
            if len(near) > _AT_ONCE:
                near = near[np.argpartition(values[near], _AT_ONCE - 1)[:_AT_ONCE]]
            result, curved = self._over_kept(ids[near], price)
            values[near], bent[near], doubtful[near] = np.maximum(values[near], result), curved, False
        return values, bent

    def _over_kept(self, ids: Ids, price: Array) -> tuple[Array, Array]:
        scores, held = self.corners[ids, :-1] @ price, self.held[ids]
        room = np.maximum(self.held_bends[ids], 0.0).sum(axis=1)
        weights = multipliers(scores, held - room[:, None])
        sag, bent = self._sags(ids, price, weights)
        total = scores + np.einsum("nch,nh->nc", held, weights) - _GIVES * weights.sum(axis=1)[:, None]
        return total.min(axis=1) - sag, bent

    def _sags(self, ids: Ids, price: Array, weights: Array | None = None) -> tuple[Array, Array]:
        """What is taken off of a sum of columns for curvature (N), limits added with `weights` (N, H); and all that
        curves, whether it adds up or cancels."""
        bends = self.bends[ids]
        along, every = bends @ price, np.abs(bends) @ np.abs(price)
        if weights is not None:
            limits = self.held_bends[ids]
            along += np.einsum("ndh,nh->nd", limits, weights)
            every += np.einsum("ndh,nh->nd", np.abs(limits), weights)
        bent = every.sum(axis=1)
        return np.maximum(along, 0.0).sum(axis=1) + _CANCELLED * bent, bent

    def best_of(self, ids: Ids, values: Array, price: Array) -> tuple[int, Array]:
        """The cell (its place in `ids`) of the least sum of columns, and the columns that it comes from; `values` are
        raised where they were not exact."""
        exact: dict[int, Array] = {}
        while (best := int(values.argmin())) not in exact:
            value, exact[best] = self._exact(int(ids[best]), price)
            values[best] = max(float(values[best]), value)
        return best, exact[best]

    def _exact(self, cell: int, price: Array) -> tuple[float, Array]:
        """The least of a sum of columns over what of a cell keeps its limits, and the columns that it comes from;
        infinite where nothing keeps them all."""
        scores, held, bends = self.corners[cell, :-1] @ price, self.held[cell], self.held_bends[cell]
        shares, result = np.eye(len(scores))[scores.argmin()], np.zeros(held.shape[1])
        empty = False
        if self.across[cell]:
            mixed = mixture(scores, held - np.maximum(bends, 0.0).sum(axis=0))
            empty = mixed is None
            shares, result = mixed or (shares, result)
        values = self.bends[cell]
        along = values @ price + bends @ result
        sag, _ = self._sags(np.array([cell]), price, result[None])
        value = float((scores + held @ result).min() - _GIVES * result.sum() - sag[0])
        there = shares > 0.0
        taken = shares[there] @ self.corners[cell, :-1][there] - values[along > 0.0].sum(axis=0)
        taken -= _CANCELLED * np.sign(price) * np.abs(values).sum(axis=0)
        return np.inf if empty else value, taken

    def telling_axes(self, ids: Ids, price: Array) -> Ids:
        """The dimension of each cell along which a sum of its columns sags most, or differs most between its corners
        where that is far more."""
        scores = (self.corners[ids, :-1] @ price).reshape(len(ids), *(2,) * self._width)
        effects = np.stack(
            [np.abs(np.diff(scores, axis=1 + k)).reshape(len(ids), -1).max(axis=1) for k in range(self._width)], axis=1
        )
        widths = (self.high - self.low)[ids]
        sags = np.maximum(self.bends[ids] @ price, 0.0)
        curved = sags.sum(axis=1) > 0.5 * effects.max(axis=1)
        return np.where(curved, sags.argmax(axis=1), np.where(widths > 0.0, effects, -1.0).argmax(axis=1))

    def distances(self, option: int) -> Array:
        """How unlike each option is to one of them: in stiffness, density and price of its material, and in shape."""
        fields = [MATERIAL_FIELDS.index(name) for name in ("elastic_modulus", "density", "cost")]
        logs = np.log(np.maximum(self._rows[:, fields], _LEAST_PRICE))
        return np.abs(logs - logs[option]).sum(axis=1) + (self._kind != self._kind[option])

    @property
    def spent(self) -> bool:
        """Whether there are as many cells as there may be."""
        return self.count >= (MOST_CELLS_FREE if self.problem.free_lengths else MOST_CELLS)

    def width(self, ids: Ids) -> Array:
        """The widest range of each cell (in logarithms)."""
        return (self.high - self.low)[ids].max(axis=1)

    def spans(self, ids: Ids) -> tuple[Array, Array]:
        """The least and the greatest of each column in each cell."""
        corners, pad = self.corners[ids, :-1], self.pad(ids)
        return corners.min(axis=1) - pad, corners.max(axis=1) + pad


def _sagging(values: Array, corners: int) -> Array:
    """What is taken off of values (N, P, K) along each dimension (N, D, K): of so many corners, the middle, the lower
    sides and the upper ones."""
    middle, sides = values[:, corners : corners + 1], values[:, corners + 1 :]
    half = sides.shape[1] // 2
    return _CURVED * (0.5 * (sides[:, :half] + sides[:, half:]) - middle)


@dataclass(frozen=True)
class Twisted:
    """How a link's length (m) and ends make it stiffer against twisting than its section alone."""

    length: float
    warping: Warping


def twisted(problem: Problem, link: int) -> Twisted:
    """That of a link (from 0); of one whose length is free none, as torsion is then in no bound where it counts."""
    arm = problem.arm
    return Twisted(arm.links[link].length, FREE if problem.free_lengths else warping_of(arm, link))


def columns_of(
    section: Section, materials: ChosenMaterial, shape: tuple[int, ...], *, shear: bool, twisted: Twisted
) -> Array:
    """The columns (*shape, K) of sections in materials."""
    columns = np.zeros((*shape, len(COLUMNS)))
    price: Any = materials.cost
    with np.errstate(all="ignore"):
        result = features(section.properties(materials.poisson_ratio), materials, shear=shear, twisted=twisted)
        for k, feature in enumerate(result):
            columns[..., k] = np.log(np.broadcast_to(feature, shape))
        columns[..., PRICE] = np.log(np.maximum(price * np.exp(columns[..., 0]), _LEAST_PRICE))
    columns[..., EXPANSION] = materials.thermal_expansion
    columns[..., _PLAIN:] = np.where(np.isfinite(columns[..., _PLAIN:]), columns[..., _PLAIN:], 0.0)
    return columns


def features(properties: SectionProperties, materials: ChosenMaterial, *, shear: bool, twisted: Twisted) -> list[Any]:
    """A section's features but for expansion (see `products.FEATURES`), in floats, arrays or symbols."""
    beam = elastic_beam(twisted.length, properties, materials, shear=shear, warping=twisted.warping)
    across = (beam.torsional_rigidity, beam.shear_rigidity_height, beam.shear_rigidity_width)
    rigid = [beam.axial_rigidity, beam.flexural_rigidity_height, beam.flexural_rigidity_width, *across]
    strong = [
        item * materials.allowed_stress
        for item in (properties.area, properties.section_modulus_y, properties.section_modulus_z)
    ]
    return [
        beam.mass_per_length,
        *(1.0 if item is None or (k > 2 and not shear) else 1.0 / item for k, item in enumerate(rigid)),
        *(1.0 / item for item in strong),
    ]


def section_rows(section: Section, materials: ChosenMaterial, ranges: Ranges, limits: Sequence[Limit]) -> list[Any]:
    """What must not be above zero for a section to be possible and a single link of it to keep its limits."""
    constraints = (*section.constraints(), *section.bound_constraints(*ranges.sizes))
    return [*(item.value for item in constraints), *(x for limit in limits for x in _kept(limit, section, materials))]


def _kept(limit: Limit, section: Section, materials: ChosenMaterial) -> list[Any]:
    follows = limit.figure.follows
    assert isinstance(follows, OfLinks)
    sign = -1.0 if limit.relation == ">=" else 1.0
    return [sign * (value / limit.value - 1.0) for value in follows.values(section, materials) or ()]


def link_cells(problem: Problem) -> tuple[Cells, ...]:
    """The cells of each elastic link; links that are alike share them."""
    table = option_table(problem)
    first = table.first_alike(problem)
    made = {k: Cells(problem, table.links[k], table.options[k]) for k in dict.fromkeys(first)}
    return tuple(made[k] for k in first)
