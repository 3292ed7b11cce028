"""Branch and bound: parts of all designs, the one with the least bound split next (Land and Doig 1960,
doi:10.2307/1910129). What a part is, how it is bounded and how it is split is each search's own."""

from __future__ import annotations

import heapq
import itertools
import math
from abc import ABC, abstractmethod
from typing import Generic, TypeVar

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
