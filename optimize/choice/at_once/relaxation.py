"""A bound from below on all combinations at once: every link anywhere in the convex hull of its cells.

In the logarithms of what links bring (`cells`), a product with a positive coefficient is convex and a
product with a negative one lies above its chord; so the finite problem with each link in the hull of its options is
convex, and a linear program with tangents (Kelley 1960, doi:10.1137/0108053) solves it. Its multipliers make one sum
over links, and the least of each link's part over its cells, which needs no linear program to be right, is the bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import linprog

from linkwright.core.sections.numeric import Array

from .cells import COLUMNS, LENGTH, NARROWEST, Cells, Ids
from .pose_rows import PoseRow

_WIDTH = len(COLUMNS)
_PRICES = (30.0, 1000.0)
"""What it costs the relaxation to break a limit wholly, at first and where it is broken nevertheless."""
_BROKEN = 1e-5
"""A limit broken by less (relative) is kept."""
_CLOSED = 2e-4
"""The linear program and the bound are this near to each other at the end."""
_MOST_ROUNDS = 40
_SEARCHING = 0.1
"""From this distance between linear program and bound on, cells are split where they are loose."""
LOOSE = 1e-3
"""A cell whose bound is this far below the best of its sections seen is loose."""
_ROUGHER = 3.0
"""So many times looser cells may be where it is only to be told which combinations come near the best."""
_RANKING_TURNS = 3
"""So often cells are split before options are ranked: what is won later is not worth its time."""
_LITTLE = 1e-3
"""The relaxation's value counts as at least this where something is held against it."""
_MOST_SPLIT = 128


@dataclass(frozen=True)
class Tangent:
    """A row along a direction, with what is convex of it touched at columns `at`."""

    row: int
    direction: Array
    at: Array


@dataclass(frozen=True)
class Node:
    """A part of all designs: each link's cells, between `low` and `high` (n, K) in its columns."""

    cells: tuple[Ids, ...]
    low: Array
    high: Array
    bound: float = -np.inf
    tangents: tuple[Tangent, ...] = ()
    prices: Array | None = None


@dataclass(frozen=True)
class Column:
    """A place in a cell of a link, with the columns that it counts with."""

    link: int
    cell: int
    values: Array


@dataclass
class Relaxed:
    """What a node came to: its bound, the least of the relaxation (columns `y` (n, K)), what each link is there (a
    column with its share), what each column is worth there, and what is lost to chords by column."""

    node: Node
    bound: float
    y: Array
    shares: list[tuple[Column, float]] = field(default_factory=list)
    prices: Array = field(default_factory=lambda: np.zeros(0))
    chords: Array = field(default_factory=lambda: np.zeros(0))
    broken: float = 0.0
    constant: float = 0.0
    """What the bound by these prices has beside the links' parts."""


class Relaxation:
    """The relaxation of the finite problem; `cells` of each elastic link, at its place in the arm. `lengths` (n, 2)
    are the logarithms between which each is free (zero where all stay)."""

    def __init__(self, cells: Sequence[Cells], links: Sequence[int], size: int, lengths: Array | None = None) -> None:
        self.cells, self.links, self.size = tuple(cells), tuple(links), size
        self.lengths = np.zeros((len(self.cells), 2)) if lengths is None else lengths
        self.rows: list[PoseRow] = []
        self.loose, self.little = LOOSE, _LITTLE

    def root(self, allowed: Sequence[Ids] | None = None) -> Node:
        """The node of all designs; `allowed`: of each link the options that it may be."""
        cells: list[Ids] = []
        for k, link_cells in enumerate(self.cells):
            ids = link_cells.roots
            cells.append(ids if allowed is None else ids[np.isin(link_cells.option[ids], allowed[k])])
        free = np.full((len(self.cells), _WIDTH), np.inf)
        low, high = -free, free.copy()
        low[:, LENGTH], high[:, LENGTH] = self.lengths.T
        return Node(tuple(cells), low, high)

    def solve(self, node: Node, enough: float, *, rough: bool = False) -> Relaxed:
        """Bound a node; given up where the bound is `enough`, and with `rough` before any cell is split for it."""
        if any(len(ids) == 0 for ids in node.cells):
            return Relaxed(node, np.inf, np.zeros((len(self.cells), _WIDTH)))
        return _Solve(self, node).run(enough, rough=rough)

    def least_breach(self, node: Node, within: Node, *, enough: float = np.inf) -> Relaxed:
        """By how much (relative) the limits are broken at least in a node, whatever the objective; what the prices say
        holds for all designs of another node that has it `within`. Given up where that is `enough`, or known to be
        less."""
        if any(len(ids) == 0 for ids in node.cells):
            return Relaxed(node, np.inf, np.zeros((len(self.cells), _WIDTH)))
        return _Solve(self, node, within).breach(enough)

    def by_option(self, relaxed: Relaxed, room: float) -> tuple[float, list[dict[int, float]]]:
        """A bound by what a relaxed node's prices say, and for each link by how much more (at least) each option that
        the node has raises it; exact to a few thousandths only where that is less than `room`."""
        bound = relaxed.constant
        losses: list[dict[int, float]] = []
        for link_cells, start, price in zip(self.cells, relaxed.node.cells, relaxed.prices, strict=True):
            ids = self._resolved(link_cells, start, price, room, LOOSE * max(abs(relaxed.bound), self.little))
            values, _ = link_cells.least_kept(ids, price, room)
            options, places = np.unique(link_cells.option[ids], return_inverse=True)
            least = np.full(len(options), np.inf)
            np.minimum.at(least, places, values)
            ends = relaxed.node.low if price[LENGTH] >= 0.0 else relaxed.node.high
            bound += float(least.min()) + float(price[LENGTH]) * float(ends[len(losses), LENGTH])
            losses.append(dict(zip(options.tolist(), (least - least.min()).tolist(), strict=True)))
        return bound, losses

    def _resolved(self, cells: Cells, ids: Ids, price: Array, room: float, loose: float) -> Ids:
        """A link's cells, split where an option that is less than `room` above the best one is not known well."""
        for _ in range(_RANKING_TURNS):
            values, bent = cells.least_kept(ids, price, room)
            least = np.full(len(cells.options), np.inf)
            np.minimum.at(least, cells.option[ids], values)
            real = np.where(cells.kept[ids], cells.corners[ids] @ price, np.inf).min(axis=1)
            coarse = (bent > _ROUGHER * loose) & (values <= least[cells.option[ids]] + loose)
            coarse &= values <= least.min() + room
            coarse &= (real - values > _ROUGHER * loose) & (cells.width(ids) > NARROWEST)
            if cells.spent or not coarse.any():
                break
            ids = np.concatenate([ids[~coarse], cells.split(ids[coarse], cells.telling_axes(ids[coarse], price))])
        return ids

    def full(self, y: Array) -> Array:
        """Columns of the elastic links (n, K) among those of all links, flat."""
        columns = np.zeros((self.size, _WIDTH))
        columns[list(self.links)] = y
        return columns.ravel()


class _Solve:
    def __init__(self, relaxation: Relaxation, node: Node, within: Node | None = None) -> None:
        self.relaxation, self.node, self.within = relaxation, node, within or node
        self.cells = list(node.cells)
        self.count = len(self.cells)
        self.columns: list[Column] = []
        self.tangents = list(node.tangents)
        self.known = {_key(tangent) for tangent in self.tangents}
        self._box()
        self.best = -np.inf
        self.price, self.cost = _PRICES[0], 1.0
        self.hopeless = -np.inf
        """Where the linear program is below this nothing more is asked; it falls only with columns to come."""

    def _box(self) -> None:
        """The least and the greatest of each column in the node."""
        low, high = self.node.low.copy(), self.node.high.copy()
        for k, link_cells in enumerate(self.relaxation.cells):
            least, most = link_cells.spans(self.within.cells[k])
            low[k] = np.maximum(low[k], least.min(axis=0))
            high[k] = np.minimum(high[k], most.max(axis=0))
        low[:, LENGTH], high[:, LENGTH] = self.node.low[:, LENGTH], self.node.high[:, LENGTH]
        self.low, self.high = self.relaxation.full(low), self.relaxation.full(np.maximum(low, high))
        self.cuts: list[tuple[Array, float, bool]] = [self._cut(tangent) for tangent in self.tangents]

    def _cut(self, tangent: Tangent) -> tuple[Array, float, bool]:
        """A tangent as (gradient of all columns (n, K), constant, whether it is of the objective)."""
        row = self.relaxation.rows[tangent.row]
        c = row.coefficients @ tangent.direction
        gradient = row.linear @ tangent.direction
        constant = row.shift + float(row.constant @ tangent.direction)
        up = c > 0.0
        there = row.powers[up] @ tangent.at
        size = c[up] * np.exp(there)
        gradient = gradient + size @ row.powers[up]
        constant += float(size @ (1.0 - there))
        if not up.all():
            powers = row.powers[~up]
            first, last = powers @ self.low, powers @ self.high
            wide = last - first > 1e-9
            slope = np.where(
                wide, np.exp(first) * np.expm1(last - first) / np.where(wide, last - first, 1.0), np.exp(first)
            )
            gradient = gradient + (c[~up] * slope) @ powers
            constant += float(c[~up] @ (np.exp(first) - slope * first))
        return gradient.reshape(-1, _WIDTH)[list(self.relaxation.links)], constant, row.objective

    def breach(self, enough: float) -> Relaxed:
        """The least by which the limits are broken, the objective left out."""
        self._begin()
        self.cost, self.price = 0.0, 1.0
        self.hopeless = enough if np.isfinite(enough) else -np.inf
        return self._rounds(enough, rough=False)

    def run(self, enough: float, *, rough: bool) -> Relaxed:
        """The bound with the objective."""
        self._begin()
        answer = self._rounds(enough, rough=rough)
        if rough or self.best >= enough or answer.broken <= _BROKEN:
            return answer
        # Can the limits be kept at all, whatever the objective?
        known, self.best, self.cost = self.best, -np.inf, 0.0
        if self._rounds(0.1 * _BROKEN, rough=False).bound > 0.1 * _BROKEN:
            return replace(answer, bound=np.inf)
        self.best, self.cost, self.price = known, 1.0, _PRICES[1]
        return self._rounds(enough, rough=False)

    def _begin(self) -> None:
        """Columns and tangents to begin with."""
        prices = self.node.prices if self.node.prices is not None else self._first_prices()
        for k in range(self.count):
            self._price(k, prices[k])
        if self.node.prices is None:
            for k in range(self.count):
                for column in (0, 2):
                    self._price(k, np.eye(_WIDTH)[column])
        for k in range(self.count):
            if self.node.high[k, LENGTH] > self.node.low[k, LENGTH]:
                self._price(k, prices[k] - (np.abs(prices[k]).sum() + 1.0) * np.eye(_WIDTH)[LENGTH])
        if not self.tangents:
            self._touch(self._mean(), -np.inf, every=True)

    def _rounds(self, enough: float, *, rough: bool) -> Relaxed:
        """Tangents and columns until the linear program and the bound meet."""
        answer: Relaxed | None = None
        for _ in range(_MOST_ROUNDS):
            value, t, shares, multipliers, sides = self._program()
            y = self._mixed(shares)
            prices, constant = self._lagrangian(multipliers, sides)
            near = value - self.best < _SEARCHING * max(abs(value), self.relaxation.little)
            if near and rough and answer is not None:
                break
            fresh = False
            total = constant
            for k in range(self.count):
                loose = self.relaxation.loose * max(abs(value), self.relaxation.little) if near else None
                least, added = self._price(k, prices[k], loose=loose)
                total += least
                fresh = fresh or added
            self.best = max(self.best, total)
            answer = Relaxed(
                self._after(multipliers, prices),
                self.best,
                y,
                shares,
                prices,
                self._chords(multipliers, y),
                (value - self.cost * t) / self.price,
                constant,
            )
            if self.best >= enough:
                break
            touched = self._touch(y, t)
            if not touched and value < self.hopeless:
                break
            if not touched and (not fresh or value - self.best <= _CLOSED * max(abs(value), self.relaxation.little)):
                break
        assert answer is not None
        return answer

    def _after(self, multipliers: Array, prices: Array) -> Node:
        used = tuple(tangent for tangent, m in zip(self.tangents, multipliers, strict=True) if m > 1e-7)
        return replace(self.node, cells=tuple(self.cells), bound=self.best, tangents=used, prices=prices)

    def _first_prices(self) -> Array:
        prices = np.zeros((self.count, _WIDTH))
        prices[:, 0], prices[:, 2] = 1.0, 1.0
        return prices

    def _mean(self) -> Array:
        """Columns somewhere in the middle of those begun with."""
        mean = np.zeros((self.count, _WIDTH))
        for k in range(self.count):
            mean[k] = np.mean([column.values for column in self.columns if column.link == k], axis=0)
        return mean

    def _mixed(self, shares: Sequence[tuple[Column, float]]) -> Array:
        mixed = np.zeros((self.count, _WIDTH))
        for column, share in shares:
            mixed[column.link] += share * column.values
        return mixed

    def _touch(self, y: Array, t: float, *, every: bool = False) -> bool:
        """Add tangents at columns y where rows are above t or zero."""
        at = self.relaxation.full(y)
        fresh = False
        for number, row in enumerate(self.relaxation.rows):
            vector = row.vector(at)
            length = float(np.linalg.norm(vector))
            value = row.shift + (float(vector[0]) if len(vector) == 1 else length)
            over = (value - t if self.cost else 0.0) if row.objective else value
            if not every and over <= _CLOSED * (max(t, _LITTLE) if row.objective else 1.0):
                continue
            direction = np.ones(1) if len(vector) == 1 else vector / max(length, 1e-300)
            tangent = Tangent(number, direction, at)
            key = _key(tangent)
            if key in self.known:
                continue
            self.known.add(key)
            self.tangents.append(tangent)
            self.cuts.append(self._cut(tangent))
            fresh = True
        return fresh

    def _program(self) -> tuple[float, float, list[tuple[Column, float]], Array, Array]:
        """The linear program over the columns so far: its value, t, shares, multipliers of the tangents and of the
        node's sides (2, n, K)."""
        columns = self.columns
        gradients = np.array([cut[0] for cut in self.cuts])
        constants = np.array([cut[1] for cut in self.cuts])
        objective = np.array([cut[2] for cut in self.cuts])
        links = np.array([item.link for item in columns])
        values = np.array([item.values for item in columns])
        table = np.einsum("mck,ck->mc", gradients[:, links], values)
        head = np.stack([-objective.astype(float), objective.astype(float) - 1.0], axis=1)
        rows, right = [np.hstack([head, table])], [-constants]
        sides: list[tuple[int, int, int]] = []
        for side, bounds in enumerate((self.node.low, self.node.high)):
            for k, column in np.argwhere(np.isfinite(bounds)).tolist():
                if column == LENGTH:  # every column of the program has one of its ends
                    continue
                sign = -1.0 if side == 0 else 1.0
                coefficients = np.where(links == k, sign * values[:, column], 0.0)
                rows.append(np.concatenate([[0.0, -1.0], coefficients])[None])
                right.append(np.array([sign * bounds[k, column]]))
                sides.append((side, k, column))
        one = np.zeros((self.count, 2 + len(columns)))
        one[links, np.arange(2, 2 + len(columns))] = 1.0
        cost = np.zeros(2 + len(columns))
        cost[:2] = self.cost, self.price
        result = linprog(
            cost, np.vstack(rows), np.concatenate(right), one, np.ones(self.count), bounds=(0.0, None), method="highs"
        )
        multipliers = np.maximum(-result.ineqlin.marginals, 0.0)
        count = len(self.cuts)
        # The bound holds for any multipliers whose sums keep to the costs of t and of breaking limits.
        weight = float(multipliers[:count] @ objective)
        limit = float(multipliers[:count] @ ~objective + multipliers[count:].sum())
        multipliers = multipliers * min(1.0, _over(self.cost, weight), _over(self.price, limit))
        held = np.zeros((2, self.count, _WIDTH))
        for (side, k, column), multiplier in zip(sides, multipliers[count:], strict=True):
            held[side, k, column] = multiplier
        mixture = [
            (column, share) for column, share in zip(columns, result.x[2:].tolist(), strict=True) if share > 1e-9
        ]
        return float(result.fun), float(result.x[0]), mixture, multipliers[:count], held

    def _lagrangian(self, multipliers: Array, sides: Array) -> tuple[Array, float]:
        """What each column is worth (n, K), and the constant beside."""
        prices = np.zeros((self.count, _WIDTH))
        constant = 0.0
        for (gradient, multiplier, _), weight in zip(self.cuts, multipliers.tolist(), strict=True):
            if weight > 0.0:
                prices += weight * gradient
                constant += weight * multiplier
        prices += sides[1] - sides[0]
        low = np.where(np.isfinite(self.node.low), self.node.low, 0.0)
        high = np.where(np.isfinite(self.node.high), self.node.high, 0.0)
        return prices, constant + float((sides[0] * low).sum() - (sides[1] * high).sum())

    def _price(self, k: int, price: Array, *, loose: float | None = None) -> tuple[float, bool]:
        """The least of a link's part over its cells, and whether a column was added for it; cells that are near
        the least and by more than `loose` below the best of their sections are split first."""
        cells = self.relaxation.cells[k]
        end = float((self.node.low if price[LENGTH] >= 0.0 else self.node.high)[k, LENGTH])
        while True:
            ids = self.cells[k]
            values, bent = cells.least_kept(ids, price, loose or 0.0)
            if loose is None or cells.spent:
                break
            near = (
                np.argpartition(values, _MOST_SPLIT - 1)[:_MOST_SPLIT]
                if len(ids) > _MOST_SPLIT
                else np.arange(len(ids))
            )
            real = np.where(self._inside(cells, ids[near], k), cells.corners[ids[near]] @ price, np.inf).min(axis=1)
            # A cell matters where it could be better than a section that is there, and is not known well enough.
            short = values[near] < np.minimum(real.min(), real) - loose
            short &= bent[near] > loose
            coarse = near[short & (values[near] <= values.min() + loose) & (cells.width(ids[near]) > NARROWEST)]
            if not len(coarse):
                break
            parts = cells.split(ids[coarse], cells.telling_axes(ids[coarse], price))
            parts = self._overlapping(cells, parts, k)
            self.cells[k] = np.concatenate([np.delete(ids, coarse), parts])
            gone = set(ids[coarse].tolist())
            self.columns = [column for column in self.columns if column.link != k or column.cell not in gone]
            if not len(self.cells[k]):
                return np.inf, False
        best, taken = cells.best_of(ids, values, price)
        cell = int(ids[best])
        taken[LENGTH] = end
        least = float(values[best]) + float(price[LENGTH]) * end
        if any(
            column.link == k and column.cell == cell and np.allclose(column.values, taken, atol=1e-12)
            for column in self.columns
        ):
            return least, False
        self.columns.append(Column(k, cell, taken))
        return least, True

    def _inside(self, cells: Cells, ids: Ids, k: int) -> Array:
        """Which sections of cells are real: they keep all limits on single links, and lie in the node."""
        points = cells.corners[ids]
        room = 1e-9
        within = (points >= self.node.low[k] - room) & (points <= self.node.high[k] + room)
        within[..., LENGTH] = True
        return cells.kept[ids] & within.all(axis=2)

    def _overlapping(self, cells: Cells, ids: Ids, k: int) -> Ids:
        least, most = cells.spans(ids)
        overlapping = (most >= self.node.low[k]) & (least <= self.node.high[k])
        overlapping[:, LENGTH] = True
        return ids[overlapping.all(axis=1)]

    def _chords(self, multipliers: Array, y: Array) -> Array:
        """What is lost to chords, shared among the columns (n, K) whose ranges it comes from."""
        lost = np.zeros(self.relaxation.size * _WIDTH)
        at = self.relaxation.full(y)
        for tangent, weight in zip(self.tangents, multipliers.tolist(), strict=True):
            if weight <= 1e-9:
                continue
            row = self.relaxation.rows[tangent.row]
            c = row.coefficients @ tangent.direction
            down = c < 0.0
            if not down.any():
                continue
            powers = row.powers[down]
            first, last, here = powers @ self.low, powers @ self.high, powers @ at
            share = np.clip((here - first) / np.maximum(last - first, 1e-12), 0.0, 1.0)
            chord = (1.0 - share) * np.exp(first) + share * np.exp(last)
            loss = -weight * c[down] * np.maximum(chord - np.exp(here), 0.0)
            wide = powers * (self.high - self.low)
            lost += loss @ (wide / np.maximum(wide.sum(axis=1, keepdims=True), 1e-12))
        return lost.reshape(-1, _WIDTH)[list(self.relaxation.links)]


def _over(most: float, sum_of_multipliers: float) -> float:
    """By how much multipliers must shrink for their sum to keep to the most."""
    return most / sum_of_multipliers if sum_of_multipliers > most else 1.0


def _key(tangent: Tangent) -> tuple[object, ...]:
    return tangent.row, tuple(np.round(tangent.direction, 9)), tuple(np.round(tangent.at, 9))
