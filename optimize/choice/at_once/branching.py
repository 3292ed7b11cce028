"""The best of any number of combinations with a bound that closes: parts of all designs are bounded at once, and split.

A part's bound (`relaxation`) is where each link may be a mixture of its options. Where that is too good
to be true, the part is split by one of the columns in which the mixture's ingredients differ; a part that cannot beat
the best design by what is wanted is out (Land and Doig 1960, doi:10.2307/1910129).
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.optimize.choice.agreement import agreements, parts
from linkwright.core.optimize.choice.at_once.splitting import BranchAndBound
from linkwright.core.optimize.choice.chooser import Chooser
from linkwright.core.optimize.choice.picks import Combination, agreeing, option_table, uniform
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.design import arm_of, design_space, material_row, numeric_beams, starting_points
from linkwright.core.optimize.exchange.exchange import first_pool
from linkwright.core.optimize.exchange.totals import carried_mass
from linkwright.core.sections.numeric import Array

from .cells import link_cells
from .lengths import LengthRows, log_spans
from .pose_rows import PoseRow, rows_of
from .relaxation import LOOSE, Node, Relaxation, Relaxed
from .splitting import split

_LITTLE = 1e-9
_NEAR = 0.1
"""Combinations that a mixture is made of by this share of what the nearest is are solved too."""
_SHARE, _LOOSEST = 0.1, 0.01
"""How loose cells may be with free lengths, as a share of the gap and at most."""


@dataclass(frozen=True)
class Proof:
    """What stands at the end: a bound (SI) that no design of any combination goes below, by how much (relative) the
    best design is above it, how many parts were looked at, and whether the wanted gap was reached."""

    bound: float
    gap: float
    parts: int
    reached: bool


class Branching(BranchAndBound[Node]):
    """Bounds all combinations of a problem against a chooser's best design."""

    def __init__(self, chooser: Chooser, wanted: float) -> None:
        super().__init__("bounding all combinations")
        self.chooser, self.wanted = chooser, wanted
        self.context = chooser.context
        self.options = option_table(self.context.problem)
        problem = self.context.problem
        links = self.options.links
        logs = log_spans(problem, links) if problem.free_lengths else None
        self.relaxation = Relaxation(link_cells(problem), links, problem.arm.size, logs)
        self._free = LengthRows(self.context) if problem.free_lengths else None
        self._rows_for: object = None
        self._read_off: tuple[Arm, Array] | None = None
        self._summed = True
        """Whether the model is a sum of products, so that parts can be bounded."""

    @property
    def objective(self) -> float:
        """The best objective so far, relative to `worth`."""
        return self.chooser.objective / self.worth

    def run(self, most: int) -> Proof | None:
        """Split until the gap is what is wanted, or so many parts were looked at; None where the model is no sum of
        products."""
        if not self._begin():
            return None
        for node in self._roots():
            relaxed = self.relaxation.solve(node, math.inf, rough=True)
            self._push(replace(relaxed.node, bound=relaxed.bound), relaxed.bound)
        if self._heap and self._heap[0][2].prices is not None:
            first = self.relaxation.solve(self._heap[0][2], math.inf, rough=True)
            self._try(next(self._picks(first)))
            if not self._refresh():
                return None
        while self._summed and self._heap and self.parts < most and self.gap > self.wanted:
            if self._free is not None:
                # Many parts differ in lengths: cells are split as finely as the gap is worth.
                self.relaxation.loose = min(max(LOOSE, _SHARE * self.gap), _LOOSEST)
            self._next()
        return self.proof() if self._summed else None

    def proof(self) -> Proof:
        """What stands now."""
        return Proof(self.bound * self.worth, self.gap, self.parts, self.gap <= self.wanted)

    def within(self, objective: float) -> Iterator[tuple[Combination, int]]:
        """The combinations that could do as well as an objective (SI), those first that one set of prices for all
        likes best, each with how many more there are at most."""
        enough = objective / self.worth
        heap: list[tuple[float, int, tuple[int, ...], list[list[tuple[float, int]]]]] = []
        left = 0
        asked, seen = agreements(self.context.problem), set[Combination]()
        for node in self._roots():
            relaxed = self.relaxation.solve(node, math.inf)
            if relaxed.bound >= enough:
                continue
            bound, losses = self.relaxation.by_option(relaxed, enough - relaxed.bound)
            room = enough - bound
            ranked = [sorted((loss, o) for o, loss in item.items() if loss < room) for item in losses]
            left += _sums_below(room, [[loss for loss, _ in item] for item in ranked])
            heapq.heappush(heap, (bound, next(self._order), (0,) * len(ranked), ranked))
        while heap:
            bound, _, places, ranked = heapq.heappop(heap)
            left -= 1
            pick = self.options.combination([item[k][1] for item, k in zip(ranked, places, strict=True)])
            # Parts of several kinds have those of fewer in common.
            if pick not in seen and pick.agrees(asked):
                yield pick, max(left, len(heap))
            seen.add(pick)
            # Each next worse one has one parent: only links from the last that was moved on are moved.
            last = max((j for j, k in enumerate(places) if k), default=0)
            for j in range(last, len(places)):
                if places[j] + 1 < len(ranked[j]):
                    more = bound + ranked[j][places[j] + 1][0] - ranked[j][places[j]][0]
                    if more < enough:
                        after = (*places[:j], places[j] + 1, *places[j + 1 :])
                        heapq.heappush(heap, (more, next(self._order), after, ranked))

    def could_reach(self, pick: Combination, objective: float) -> bool:
        """Whether one combination could do as well as an objective (SI), by its bound as far as that is cheap."""
        alone = [np.array([place]) for place in self.options.place(pick)]
        enough = objective / self.worth
        return self.relaxation.solve(self.relaxation.root(alone), enough, rough=True).bound < enough

    def _say(self, done: int, of: int, text: str) -> None:
        if self.chooser.progress is not None:
            self.chooser.progress(done, of, text)

    def _begin(self) -> bool:
        """Rows of some poses read off a first design; False where the error is no sum of products."""
        problem = self.context.problem
        pick = uniform(problem)[0]
        space = design_space(problem, pick.shapes)
        start = starting_points(space, material_row(pick.materials, problem), 1)[0]
        arm = arm_of(space, start, pick.materials)
        self._read_off = arm, numeric_beams(arm, problem.load_cases)
        self.chooser.pool = self.chooser.pool or first_pool(self.context, space, start, pick.materials)
        if problem.minimize == "max_error":
            self.worth = self.context.search.worst(self._read_off[1], certify=False).error
        else:
            mass, cost, _ = self.chooser.totals(pick, start)
            by_name = {"mass": mass, "total_mass": mass + carried_mass(problem)}
            self.worth = max(by_name.get(problem.minimize, cost), _LITTLE)
        return self._refresh()

    def _refresh(self) -> bool:
        """The rows of the pool as it is now; False where there are none."""
        pool = self.chooser.pool
        assert pool is not None
        assert self._read_off is not None
        if self._rows_for is pool:
            return True
        rows = self._rows(pool, *self._read_off)
        if rows is None:
            return False
        if self._rows_for is not None:
            self._heap = [(bound, n, replace(node, tangents=())) for bound, n, node in self._heap]
        self.relaxation.rows, self._rows_for = rows, pool
        return True

    def _rows(self, pool: Pool, arm: Arm, p: Array) -> list[PoseRow] | None:
        if self._free is not None:
            return self._free.rows_of(pool, arm, p, self.worth)
        return rows_of(self.context, pool, arm, p, self.worth)

    def _roots(self) -> list[Node]:
        """All designs, in parts that agree in what they must."""
        asked = agreeing(self.context.problem, self.options)
        return [self.relaxation.root(list(part)) for part in parts(asked, self.options.shape)]

    def _step(self, part: Node) -> None:
        enough = self.objective * (1.0 - 0.9 * self.wanted)
        if part.bound >= enough:
            self._done_with(part.bound)
            return
        relaxed = self.relaxation.solve(part, enough)
        bound = max(relaxed.bound, part.bound)
        if bound >= enough:
            self._done_with(bound)
            return
        untried = (pick for pick in self._picks(relaxed) if pick not in self.chooser.candidates)
        pick = next(untried, None)
        if pick is not None:
            self._try(pick)
            self._summed = self._refresh()
        parts = split(self.relaxation, replace(relaxed.node, bound=bound), relaxed)
        if not parts:
            self._done_with(bound)
        for item in parts:
            self._push(item, bound)

    def _picks(self, relaxed: Relaxed) -> Iterator[Combination]:
        """The combinations that a relaxed solution is mixed of, the nearest first."""
        mixed: list[dict[int, float]] = []
        for k, cells in enumerate(self.relaxation.cells):
            weights: dict[int, float] = {}
            for column, share in relaxed.shares:
                if column.link == k:
                    option = int(cells.option[column.cell])
                    weights[option] = weights.get(option, 0.0) + share
            mixed.append(weights)
        every = [(math.prod(w for _, w in item), item) for item in itertools.product(*(w.items() for w in mixed))]
        every.sort(key=lambda item: -item[0])
        for weight, each in every:
            if weight >= _NEAR * every[0][0]:
                yield self.options.combination([option for option, _ in each])

    def _try(self, pick: Combination) -> None:
        """Solve a combination, with an exchange where it could win."""
        if not pick.agrees(agreements(self.context.problem)):
            return
        solved = self.chooser.solve(pick)
        if solved.objective is None or solved.solution is None:
            return
        if solved.objective < self.chooser.objective:
            self.chooser.finish(pick, solved.solution.x)
        else:
            self.chooser.note(pick, solved.objective, "bounded out")


def _sums_below(room: float, lists: Sequence[Sequence[float]]) -> int:
    """How many ways there are to take a number from each list with a sum below `room`; no fewer, a few more."""
    bins = 4000
    counts = np.zeros(bins)
    counts[0] = 1.0
    for link_list in lists:
        steps = np.bincount((np.array(link_list) / room * bins).astype(int), minlength=bins)[:bins]
        counts = np.convolve(counts, steps)[:bins]
    return int(counts.sum())
