"""A bound from below on all designs of a part: each link a mixture of its options.

What a link alone adds to a row is mixed as it is; a product of several links with a positive coefficient is convex in
the logarithms that are mixed, one with a negative coefficient lies above its chord. A linear program over tangents
(Kelley 1960, doi:10.1137/0108053) and over the options that it asks for gives multipliers; with any multipliers the
rows become one sum over links, whose least over each link's options is a bound that needs no linear program to be right
(Geoffrion 1974, doi:10.1007/BFb0120690).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import linprog

from linkwright.core.sections.numeric import Array

from .options import LinkList
from .rows import Integers, TableRow

_MOST_ROUNDS = 60
_CLOSED = 1e-4
"""Linear program and bound are this near to each other at the end (relative)."""
_PRICES = (30.0, 1e3, 1e5)
"""What it costs the relaxation to break a limit wholly, at first and where it is broken nevertheless."""
_BROKEN = 1e-6
_LITTLE = 1e-6
_TOUCHED = 1e-7
"""A row that is above t by less (relative) needs no tangent there."""
_SEVERAL = 4
"""Options of a link that join the linear program at once."""


@dataclass(frozen=True)
class Cut:
    """A row along a direction, its positive products touched somewhere: a constant and each link's part by option;
    `chorded` where products are left that a part bounds by their chords."""

    row: int
    direction: Array
    objective: bool
    constant: float
    parts: tuple[Array, ...]
    chorded: bool


@dataclass(frozen=True)
class Part:
    """A part of all designs: the options that each link has in it, and the cuts that counted where it came from."""

    options: tuple[Integers, ...]
    bound: float = -np.inf
    cuts: tuple[Cut, ...] = ()
    columns: tuple[Integers, ...] = ()


@dataclass
class Relaxed:
    """What a part came to: its bound, each option's loss (by how much the bound rises where a link must be it), which
    options each link is mixed of with their shares, and the cuts with multipliers."""

    part: Part
    bound: float
    losses: tuple[Array, ...]
    shares: tuple[Array, ...]
    cuts: list[Cut] = field(default_factory=list)
    multipliers: Array = field(default_factory=lambda: np.zeros(0))


class Relaxation:
    """The relaxation over lists of options; rows may join it."""

    def __init__(self, lists: Sequence[LinkList]) -> None:
        self.lists = tuple(lists)
        self.rows: list[TableRow] = []

    def solve(self, part: Part, enough: float) -> Relaxed:
        """Bound a part; given up where the bound is `enough`."""
        return _Solve(self, part).run(enough)

    def cut(self, number: int, direction: Array, y: Sequence[Array]) -> Cut:
        """The tangent of a row along a direction at columns y of each link (K)."""
        row = self.rows[number]
        c = row.coefficients @ direction
        constant = row.shift + float(row.constant @ direction)
        parts = [link_part @ direction for link_part in row.own]
        up = c > 0.0
        if up.any():
            there = sum(powers[up] @ item for powers, item in zip(row.powers, y, strict=True))
            size = c[up] * np.exp(there)
            constant += float(size @ (1.0 - there))
            parts = [
                part + link_list.columns @ (size @ powers[up])
                for part, link_list, powers in zip(parts, self.lists, row.powers, strict=True)
            ]
        return Cut(number, direction, row.objective, constant, tuple(parts), bool((c < 0.0).any()))

    def chords(self, cut: Cut, low: Sequence[Array], high: Sequence[Array]) -> tuple[float, list[Array]]:
        """What is left of a cut, between the least and the greatest columns of each link: a constant, and the gradient
        over each link's columns."""
        row = self.rows[cut.row]
        c = row.coefficients @ cut.direction
        down = c < 0.0
        powers = [link_powers[down] for link_powers in row.powers]
        first = sum(np.minimum(p * a, p * b).sum(axis=1) for p, a, b in zip(powers, low, high, strict=True))
        last = sum(np.maximum(p * a, p * b).sum(axis=1) for p, a, b in zip(powers, low, high, strict=True))
        wide = np.maximum(last - first, 0.0)
        slope = np.exp(first) * np.where(wide > 1e-9, np.expm1(wide) / np.where(wide > 1e-9, wide, 1.0), 1.0)
        return float(c[down] @ (np.exp(first) - slope * first)), [
            (c[down] * slope) @ link_powers for link_powers in powers
        ]


class _Solve:
    def __init__(self, relaxation: Relaxation, part: Part) -> None:
        self.relaxation, self.part = relaxation, part
        self.count = len(part.options)
        self.low = [item.columns[ids].min(axis=0) for item, ids in self._pairs()]
        self.high = [item.columns[ids].max(axis=0) for item, ids in self._pairs()]
        self.cuts: list[Cut] = []
        self.constants: list[float] = []
        self.parts: list[list[Array]] = [[] for _ in range(self.count)]
        """By link and cut, what each option of the part adds."""
        self.columns: list[list[int]] = [[] for _ in range(self.count)]
        """By link, the options (by their place in the part) that the linear program has."""
        self.best = -np.inf
        self.losses: tuple[Array, ...] = ()
        for cut in part.cuts:
            self._add(cut)

    def _pairs(self) -> list[tuple[LinkList, Integers]]:
        return list(zip(self.relaxation.lists, self.part.options, strict=True))

    def _add(self, cut: Cut) -> None:
        constant, parts = (
            cut.constant,
            [link_part[ids] for link_part, ids in zip(cut.parts, self.part.options, strict=True)],
        )
        if cut.chorded:
            more, gradients = self.relaxation.chords(cut, self.low, self.high)
            constant += more
            parts = [
                link_part + item.columns[ids] @ gradient
                for link_part, (item, ids), gradient in zip(parts, self._pairs(), gradients, strict=True)
            ]
        self.cuts.append(cut)
        self.constants.append(constant)
        for k, own in enumerate(parts):
            self.parts[k].append(own)

    def run(self, enough: float) -> Relaxed:
        self._begin()
        answer, broken = self._rounds(enough, 1.0, _PRICES[0])
        for price in _PRICES[1:]:
            if broken <= _BROKEN or self.best >= enough:
                break
            if price == _PRICES[1] and self._impossible():
                return replace(answer, bound=np.inf)
            answer, broken = self._rounds(enough, 1.0, price)
        return answer

    def _impossible(self) -> bool:
        """Whether limits cannot be kept, whatever the objective."""
        known, losses, self.best = self.best, self.losses, -np.inf
        self._rounds(0.1 * _BROKEN, 0.0, 1.0)
        impossible = self.best > 0.1 * _BROKEN
        self.best, self.losses = known, losses
        return impossible

    def _begin(self) -> None:
        """Options to begin with, and tangents at their middle where there are no cuts yet."""
        for k, (item, ids) in enumerate(self._pairs()):
            if self.part.columns:
                places = np.flatnonzero(np.isin(ids, self.part.columns[k]))
                self.columns[k] = places.tolist()
            columns = item.columns[ids]
            heavy = [int(columns[:, column].argmin()) for column in (0, 2)]
            middle = int(np.abs(columns[:, :3] - columns[:, :3].mean(axis=0)).sum(axis=1).argmin())
            self.columns[k] = list(dict.fromkeys([*self.columns[k], *heavy, middle]))
        known = {cut.row for cut in self.cuts}
        y = [each.columns[ids].mean(axis=0) for each, ids in self._pairs()]
        for number, row in enumerate(self.relaxation.rows):
            if number not in known:
                self._add(self.relaxation.cut(number, _direction(self._vector(row, y, None)), y))

    def _vector(self, row: TableRow, y: Sequence[Array], shares: Sequence[Array] | None) -> Array:
        """A row's vector where each link is a mixture (of all its options alike without shares)."""
        vector = row.constant.copy()
        for k, link_part in enumerate(row.own):
            values = link_part[self.part.options[k]]
            vector = vector + (values.mean(axis=0) if shares is None else shares[k] @ values)
        if len(row.coefficients):
            logs = sum(powers @ item for powers, item in zip(row.powers, y, strict=True))
            vector = vector + np.exp(logs) @ row.coefficients
        return vector

    def _rounds(self, enough: float, cost: float, price: float) -> tuple[Relaxed, float]:
        """Options and tangents join until the linear program and the bound meet."""
        answer: Relaxed | None = None
        broken = 0.0
        for _ in range(_MOST_ROUNDS):
            value, t, shares, multipliers = self._program(cost, price)
            broken = (value - cost * t) / price
            total, fresh = 0.0, False
            losses: list[Array] = []
            total = float(multipliers @ np.array(self.constants))
            for k in range(self.count):
                scores = multipliers @ np.array(self.parts[k])
                least = float(scores.min())
                total += least
                losses.append(scores - least)
                fresh = self._join(k, scores) or fresh
            if total > self.best:
                self.best, self.losses = total, tuple(losses)
            answer = Relaxed(
                self._after(multipliers, shares), self.best, self.losses, shares, list(self.cuts), multipliers
            )
            if self.best >= enough:
                break
            met = value - self.best <= _CLOSED * max(abs(value), _LITTLE)
            if not self._touch(shares, t) and (not fresh or met):
                break
        assert answer is not None
        return answer, broken

    def _join(self, k: int, scores: Array) -> bool:
        """Let the best few options of a link join; whether the best was not there yet."""
        few = min(_SEVERAL, len(scores))
        order = np.argpartition(scores, few - 1)[:few]
        best = int(scores.argmin())
        fresh = best not in self.columns[k]
        self.columns[k] = list(dict.fromkeys([*self.columns[k], best, *order.tolist()]))
        return fresh

    def _after(self, multipliers: Array, shares: Sequence[Array]) -> Part:
        used = tuple(cut for cut, m in zip(self.cuts, multipliers, strict=True) if m > 1e-8)
        columns = tuple(ids[share > 1e-9] for ids, share in zip(self.part.options, shares, strict=True))
        return replace(self.part, bound=self.best, cuts=used, columns=columns)

    def _touch(self, shares: Sequence[Array], t: float) -> bool:
        """Tangents where rows are above what the linear program believes; whether there were any."""
        y = [share @ item.columns[ids] for share, (item, ids) in zip(shares, self._pairs(), strict=True)]
        room = _TOUCHED * max(abs(t), _LITTLE)
        fresh = False
        for number, row in enumerate(self.relaxation.rows):
            vector = self._vector(row, y, shares)
            length = float(vector[0]) if len(vector) == 1 else float(np.linalg.norm(vector))
            allowed = (t if row.objective else 0.0) + room
            if row.shift + length <= allowed:
                continue
            self._add(self.relaxation.cut(number, _direction(vector), y))
            # What is lost to chords may leave nothing of it.
            there = self.constants[-1] + sum(
                float(link_part[-1] @ share) for link_part, share in zip(self.parts, shares, strict=True)
            )
            if there <= allowed:
                self._drop()
            else:
                fresh = True
        return fresh

    def _drop(self) -> None:
        for own in (self.cuts, self.constants, *self.parts):
            own.pop()

    def _program(self, cost: float, price: float) -> tuple[float, float, tuple[Array, ...], Array]:
        """The linear program over the options that joined: its value, t, shares by link over the part's options, and
        multipliers of the cuts that hold with any options."""
        objective = np.array([cut.objective for cut in self.cuts])
        blocks = [np.array(link_part)[:, places] for link_part, places in zip(self.parts, self.columns, strict=True)]
        head = np.stack([-objective.astype(float), objective.astype(float) - 1.0], axis=1)
        table = np.hstack([head, *blocks])
        sizes = [len(places) for places in self.columns]
        one = np.zeros((self.count, table.shape[1]))
        ends = np.cumsum([2, *sizes])
        for k in range(self.count):
            one[k, ends[k] : ends[k + 1]] = 1.0
        costs = np.zeros(table.shape[1])
        costs[:2] = cost, price
        result = linprog(
            costs, table, -np.array(self.constants), one, np.ones(self.count), bounds=(0.0, None), method="highs"
        )
        multipliers = np.maximum(-np.asarray(result.ineqlin.marginals), 0.0)
        # t is not below nought: a bound holds where the multipliers of its rows are not above one together.
        weight = float(multipliers[objective].sum())
        if weight > 0.0 and cost > 0.0:
            multipliers[objective] *= min(1.0, cost / weight)
        if cost == 0.0:
            multipliers[objective] = 0.0
        shares: list[Array] = []
        for k, places in enumerate(self.columns):
            coefficients = np.zeros(len(self.part.options[k]))
            coefficients[places] = np.maximum(result.x[ends[k] : ends[k + 1]], 0.0)
            shares.append(coefficients / coefficients.sum())
        return float(result.fun), float(result.x[0]), tuple(shares), multipliers


def _direction(vector: Array) -> Array:
    if len(vector) == 1:
        return np.ones(1)
    return vector / max(float(np.linalg.norm(vector)), 1e-300)
