"""A part of all combinations in two: by the column, the price, or the kind of section and material in which what a link
is mixed of differs most.

Branch and bound: the part of the least bound is split next (Land and Doig 1960, doi:10.2307/1910129). What a part is,
how it is bounded and how it is split is each search's own.
"""

from __future__ import annotations

import heapq
import itertools
import math
from abc import ABC, abstractmethod
from dataclasses import replace
from typing import Generic, TypeVar

import numpy as np

from linkwright.core.optimize.choice.at_once.cells import COLUMNS, LENGTH, PRICE, Ids
from linkwright.core.optimize.choice.at_once.relaxation import Node, Relaxation, Relaxed
from linkwright.core.sections.numeric import Array

Part = TypeVar("Part")


class BranchAndBound(ABC, Generic[Part]):
    """A heap of parts by their bounds, which are relative to `worth`, as the objective is."""

    def __init__(self, doing: str) -> None:
        """`doing` says what is done, for progress."""
        self.worth = 1.0
        self.parts = 0
        """So many were looked at."""
        self._doing = doing
        self._order = itertools.count()
        self._heap: list[tuple[float, int, Part]] = []
        self._out = math.inf
        """The least bound of the parts that are done with."""

    @property
    @abstractmethod
    def objective(self) -> float:
        """The best objective so far, relative to `worth`."""

    @abstractmethod
    def _step(self, part: Part) -> None:
        """Bound a part: it is done with, or its parts join the heap."""

    @abstractmethod
    def _say(self, done: int, of: int, text: str) -> None:
        """Tell how far the search has come."""

    @property
    def bound(self) -> float:
        """What no design goes below that is not the best so far, as far as is known."""
        return min([self._out, *(entry[0] for entry in self._heap[:1])])

    @property
    def gap(self) -> float:
        """By how much (relative) the best design is above the bound."""
        if math.isinf(self.objective) or self.bound == -math.inf:
            return math.inf
        return max(0.0, 1.0 - self.bound / self.objective)

    def _begin_again(self) -> None:
        self._heap, self._out, self.parts = [], math.inf, 0

    def _push(self, part: Part, bound: float) -> None:
        heapq.heappush(self._heap, (bound, next(self._order), part))

    def _done_with(self, bound: float) -> None:
        """Leave a part of that bound as it is."""
        self._out = min(self._out, bound)

    def _next(self) -> None:
        """Tell of the search, and look at the part with the least bound."""
        gap_text = "" if math.isinf(self.gap) else f", none more than {self.gap:.2%} better"
        self._say(self.parts, self.parts + len(self._heap), f"{self._doing}{gap_text}")
        part = heapq.heappop(self._heap)[2]
        self.parts += 1
        self._step(part)


_LEAST_SCORE = 1e-7
"""Where splitting could win less than this (relative), a part stays as it is."""
_RATE_SHARE = 0.05
"""Prices by the kilogram are split where they promise more than this share of what the best column does: they tell
materials apart wholly, which takes many splits of columns."""
_ASIDE = 1e-4
"""A side of a part this near (in logarithms) is where the split would be."""


def split(relaxation: Relaxation, node: Node, relaxed: Relaxed, *, by_kind: bool = True) -> list[Node]:
    """A part in two, by the column in which what is mixed differs most, or (`by_kind`) by shape and material."""
    scores = relaxed.chords.copy()
    for k in range(len(relaxation.cells)):
        mixed: dict[int, tuple[float, Array]] = {}
        for column, share in relaxed.shares:
            if column.link == k:
                weight, at = mixed.get(column.cell, (0.0, np.zeros(len(COLUMNS))))
                mixed[column.cell] = (weight + share, at + share * column.values)
        for weight, at in mixed.values():
            scores[k] += np.abs(relaxed.prices[k]) * np.abs(at - weight * relaxed.y[k])
    # At a side that the part has already nothing is split.
    beside = (relaxed.y > node.low + _ASIDE) & (relaxed.y < node.high - _ASIDE)
    beside[:, LENGTH] = node.high[:, LENGTH] > node.low[:, LENGTH] + _ASIDE
    scores = np.where(beside, scores, 0.0)
    k, column = (int(x) for x in np.unravel_index(int(scores.argmax()), scores.shape))
    by_rate = _by_rate(relaxation, node, relaxed, float(scores[k, column]))
    if by_rate is not None:
        return by_rate
    kinds = _by_kind(relaxation, node, relaxed, float(scores[k, column])) if by_kind else None
    if kinds is not None:
        return kinds
    if scores[k, column] <= _LEAST_SCORE:
        return []
    at = float(relaxed.y[k, column])
    if column == LENGTH:
        room = 0.1 * (node.high - node.low)[k, LENGTH]
        at = min(max(at, node.low[k, LENGTH] + room), node.high[k, LENGTH] - room)
    parts: list[Node] = []
    for side in (0, 1):
        low, high = node.low.copy(), node.high.copy()
        (high if side == 0 else low)[k, column] = at
        least, most = relaxation.cells[k].spans(node.cells[k])
        inside = (least[:, column] <= at) if side == 0 else (most[:, column] >= at)
        if column == LENGTH:
            inside = np.ones(len(inside), dtype=bool)
        cells: tuple[Ids, ...] = tuple(ids[inside] if j == k else ids for j, ids in enumerate(node.cells))
        parts.append(replace(node, cells=cells, low=low, high=high))
    return parts


def _by_rate(relaxation: Relaxation, node: Node, relaxed: Relaxed, score: float) -> list[Node] | None:
    """A part in two by the price of the materials by the kilogram, which tells options apart wholly where columns
    of sections overlap; None where splitting by a column promises far more than that (`score`)."""
    best: tuple[float, int, float] | None = None
    for k in range(len(relaxation.cells)):
        mixed = [(share, _rate(relaxation, k, column.cell)) for column, share in relaxed.shares if column.link == k]
        shares, rates = np.array(mixed).T
        middle = float(shares @ rates / shares.sum())
        worth = float(np.abs(relaxed.prices[k, PRICE]) * (shares @ np.abs(rates - middle)))
        if rates.max() - rates.min() > _ASIDE and (best is None or worth > best[0]):
            best = worth, k, middle
    if best is None or best[0] <= max(_LEAST_SCORE, _RATE_SHARE * score):
        return None
    _, k, at = best
    rates = np.array([_rate(relaxation, k, cell) for cell in node.cells[k]])
    return [
        replace(node, cells=tuple(ids[side] if j == k else ids for j, ids in enumerate(node.cells)))
        for side in (rates <= at, rates > at)
    ]


def _by_kind(relaxation: Relaxation, node: Node, relaxed: Relaxed, score: float) -> list[Node] | None:
    """A part in two by what is alike to either of the two options that a link is mostly mixed of; None where splitting
    by a column promises more than that (`score`)."""
    best: tuple[float, int, list[int]] | None = None
    for k, cells in enumerate(relaxation.cells):
        mixed: dict[int, tuple[float, Array]] = {}
        for column, share in relaxed.shares:
            if column.link == k:
                option = int(cells.option[column.cell])
                weight, at = mixed.get(option, (0.0, np.zeros(len(COLUMNS))))
                mixed[option] = (weight + share, at + share * column.values)
        worth = sum(float(np.abs(relaxed.prices[k]) @ np.abs(at - w * relaxed.y[k])) for w, at in mixed.values())
        first = sorted(mixed, key=lambda item: -mixed[item][0])[:2]
        if len(first) == 2 and (best is None or worth > best[0]):
            best = worth, k, first
    if best is None or best[0] <= max(_LEAST_SCORE, score):
        return None
    _, k, (one, other) = best
    cells = relaxation.cells[k]
    nearer = cells.distances(one) <= cells.distances(other)
    side = nearer[cells.option[node.cells[k]]]
    return [
        replace(node, cells=tuple(ids[item] if j == k else ids for j, ids in enumerate(node.cells)))
        for item in (side, ~side)
    ]


def _rate(relaxation: Relaxation, k: int, cell: int) -> float:
    """The logarithm of the price of a cell's material by the kilogram."""
    middle = relaxation.cells[k].corners[cell, -1]
    return float(middle[PRICE] - middle[0])
