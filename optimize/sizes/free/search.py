"""The best of all designs from lists with lengths to choose, with a bound that closes where one can be had.

All sections and lengths are bounded at once (`optimize.choice.at_once.relaxation`, each listed section a cell of one
point) and split by what counts (Land and Doig 1960, doi:10.2307/1910129). What a relaxed part is nearest to is settled
in turn: sections at its lengths, then the best lengths for these sections, with the worst poses of that design joining
the rows. Where the model is no sum of products, poses of a place turn with the lengths, or limits are no rows,
sections for settled lengths and lengths for settled sections are looked for by turns as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.optimize.choice.at_once.cells import COLUMNS, LENGTH
from linkwright.core.optimize.choice.at_once.lengths import LengthRows
from linkwright.core.optimize.choice.at_once.relaxation import Node, Relaxed
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.design import numeric_beams
from linkwright.core.optimize.exchange.exchange import Context, context_of
from linkwright.core.optimize.exchange.program import cut_of
from linkwright.core.optimize.result import Iteration
from linkwright.core.optimize.sizes.free.program import SettledRow, fitted, moved
from linkwright.core.optimize.sizes.listed_search import ListedSearch, Progress, SearchOutcome
from linkwright.core.optimize.sizes.options import LinkList, agreeing_parts
from linkwright.core.optimize.sizes.rows import greatest, product, table_row
from linkwright.core.optimize.sizes.search import ListSearch
from linkwright.core.sections.numeric import Array

from .program import LengthProgram, Lengths

WANTED = 1e-2
"""The gap that is always worth more parts."""
MOST_PARTS = 600
_SHARE = 0.9
"""A part whose bound is nearer to the best design than this share of the gap wanted is done with."""
_TRIED = 20_000
"""Combinations of the options that cost least at a part's lengths, tried to find a good design."""
_SETTLED = 2
"""So many of them get lengths of their own."""
_MOST_ROUNDS = 12
_TOLERANCE = 2e-5
"""A pose that is worse than the rows say by more (relative) becomes a row."""
_ADDED = 2
_BETTER = 1e-6
_STEPS = (0.1, 0.03, 0.01, 0.003)
"""By how much lengths are changed where they are looked for one by one, relative."""
_WORTH = 0.05
"""A step that wins less than this share of it (relative) is not taken again."""
_TURNS = 4
_SUMS = ("mass", "total_mass", "cost")


class FreeListSearch(ListedSearch):
    """Looks for the best design where lengths are free."""

    def __init__(
        self,
        context: Context,
        lists: tuple[LinkList, ...],
        *,
        progress: Progress | None = None,
        log: Callable[[Iteration], None] | None = None,
    ) -> None:
        super().__init__(context, lists, "bounding all sections and lengths", progress=progress, log=log)
        problem = context.problem
        sums = problem.arm.play == "worst" or not context.uses_error
        self.bounded = sums and not problem.workspace.in_space and problem.minimize in ("max_error", *_SUMS)
        self._rows = LengthRows(context)
        self._held = Pool()
        self._settled: list[SettledRow] = []
        self._program: LengthProgram | None = None
        self._tried: set[tuple[int, ...]] = set()
        self._begun = False

    @property
    def _pool(self) -> Pool:
        return self._held

    def run(self) -> SearchOutcome:
        """Split and settle until nothing much better can be left, or enough parts were looked at."""
        self._begin_again()
        self._tried = set()
        try:
            if not self._begun:
                self._begin()
            first = fitted(self.context.problem, self.context.problem.arm.lengths)
            if not self.bounded or self.context.families:
                self._by_turns(first)
            if self.bounded:
                self._branch()
            if self.bounded and self.context.families and self.judge.best is not None:
                self._by_turns(self.judge.table.lengths[self.judge.best[0][-1]])
        except KeyboardInterrupt:
            if self.judge.best is None:
                raise
            return self._outcome(interrupted=True)
        return self._outcome()

    def _outcome(self, *, interrupted: bool = False) -> SearchOutcome:
        looked = bool(self._heap or math.isfinite(self._out) or self.judge.best is None)
        return self._ended(known=self.bounded and looked and self._agrees(), interrupted=interrupted)

    def _values(self, pick: tuple[int, ...]) -> list[tuple[bool, float]]:
        at = self._columns(pick[:-1])
        at[LENGTH :: len(COLUMNS)] = np.log(self.judge.table.lengths[pick[-1]])
        return [(row.objective, row.value(at)) for row in self.relaxation.rows]

    # ---- rows

    def _begin(self) -> None:
        """Rows of the worst poses of the stiffest options and of the lightest."""
        self._begun = True
        problem = self.context.problem
        lengths = self.judge.table.add_lengths([fitted(problem, problem.arm.lengths)])[0]
        picks = [[int(link_list.columns[:, column].argmin()) for link_list in self.lists] for column in (2, 0)]
        arms = [self.judge.table.arm_of([*pick, lengths]) for pick in picks]
        self._p = numeric_beams(arms[0], problem.load_cases)
        self._arm = arms[0]
        if not self.bounded:
            return
        if problem.minimize == "max_error":
            self.worth = max(self.context.search.worst(self._p, certify=False).error, 1e-12)
        else:
            self.worth = max(float(self.judge.objective_of(np.array([[*picks[0], lengths]]))[0]), 1e-9)
        for arm in arms:
            self._learn(numeric_beams(arm, problem.load_cases), -math.inf)
        self._refresh()

    def _learn(self, p: Array, allowed: float) -> bool:
        """Add a design's worst poses whose errors (m) are not `allowed`; whether there were new ones."""
        if not self.context.uses_error:
            return False
        worst = self.context.search.worst(p, certify=False)
        worse = [pose for pose in worst.poses if pose.error > max(allowed * (1.0 + _TOLERANCE), 0.9 * worst.error)]
        before = self._pool.size
        self._held = self._held.with_errors(tuple(cut_of(self.context.model, pose) for pose in worse[:_ADDED]))
        return self._pool.size > before

    def _refresh(self) -> None:
        """The rows of the pool as it is now; parts keep the tangents of the rows that they had."""
        rows = self._rows.rows_of(self._pool, self._arm, self._p, self.worth)
        if rows is None:
            self.bounded = False
            return
        self.relaxation.rows = rows
        self._settled = [*self._settled, *(SettledRow(row) for row in rows[len(self._settled) :])]
        self._program = LengthProgram(rows, self.context.problem.limits, self.links, self.relaxation.lengths)

    # ---- parts

    def _branch(self) -> None:
        for options in agreeing_parts(self.context.problem, self.lists):
            node = self.relaxation.root(options)
            relaxed = self.relaxation.solve(node, math.inf)
            self._push(replace(relaxed.node, bound=relaxed.bound), relaxed.bound)
            self._try(relaxed)
        while self._heap and self.parts < MOST_PARTS and self.gap > WANTED:
            self._next()

    def _enough(self) -> float:
        return self.objective * (1.0 - _SHARE * WANTED)

    def _divide(self, left: Node, relaxed: Relaxed, enough: float) -> None:
        del enough
        parts = self._halves(left, relaxed)
        if not parts:
            self._done_with(left.bound)
        for item in parts:
            self._push(item, left.bound)

    # ---- designs

    def _try(self, relaxed: Relaxed) -> None:
        """Sections that are best at a part's lengths, each with the lengths that are best for it."""
        if not np.isfinite(relaxed.bound) or not len(relaxed.prices):
            return
        problem = self.context.problem
        lengths = list(problem.arm.lengths)
        for link, value in zip(self.links, np.exp(relaxed.y[:, LENGTH]).tolist(), strict=True):
            lengths[link] = value
        for pick in self._picks(relaxed, fitted(problem, lengths)):
            if pick not in self._tried:
                self._tried.add(pick)
                self._settle(pick, lengths)

    def _picks(self, relaxed: Relaxed, lengths: Sequence[float]) -> list[tuple[int, ...]]:
        """The best few combinations of the options that cost least, at lengths (m)."""
        per_link = max(2, int(_TRIED ** (1.0 / len(self.lists))))
        few = self._likely(relaxed, per_link)
        logarithms = np.log(np.array(lengths))
        sub = [
            LinkList(link_list.link, tuple(link_list.options[k] for k in ids), link_list.columns[ids])
            for link_list, ids in zip(self.lists, few, strict=True)
        ]
        rows = [table_row(row.at(logarithms), sub) for row in self._settled]
        picks = product([range(len(ids)) for ids in few])
        self.compared += len(picks)
        values, left = greatest(rows, picks, math.inf)
        if not len(left):
            # Other lengths may keep the limits.
            best = [ids[:1] for ids in few]
            return [tuple(int(ids[0]) for ids in best)]
        first = left[np.argsort(values, kind="stable")[:_SETTLED]]
        return [tuple(int(ids[k]) for ids, k in zip(few, picks[row], strict=True)) for row in first]

    def _settle(self, pick: tuple[int, ...], lengths: Sequence[float]) -> None:
        """The exchange for the lengths of sections that are settled; what it comes to is judged."""
        columns = self._columns(pick)
        start = [lengths[link] for link in self.links]
        for _ in range(_MOST_ROUNDS):
            assert self._program is not None
            result: Lengths | None = self._program.solve(columns, start)
            if result is None or result.value >= self.objective * (1.0 - _BETTER):
                return
            start = list(result.lengths)
            whole = list(self.context.problem.arm.lengths)
            for link, length in zip(self.links, result.lengths, strict=True):
                whole[link] = length
            place = self._offer(pick, [fitted(self.context.problem, whole)])[0]
            p = self.judge.table.figures(np.array([[*pick, place]])).p[0]
            allowed = result.value * self.worth if self.context.problem.minimize == "max_error" else self._allowed
            if not self._learn(p, allowed):
                return
            self._refresh()
            if not self.bounded:
                return

    @property
    def _allowed(self) -> float:
        return min((limit.value for limit in self.context.problem.limit("max_error")), default=math.inf)

    def _offer(self, pick: Sequence[int], choices: Sequence[tuple[float, ...]]) -> list[int]:
        """Have designs of the same sections judged; the numbers of their choices of lengths."""
        places = self.judge.table.add_lengths(choices)
        if self.judge.offer(np.array([[*pick, place] for place in places], dtype=np.intp)):
            self._note()
        return places

    def _by_turns(self, lengths: Sequence[float]) -> None:
        """Sections for settled lengths and lengths for settled sections by turns, until neither is better."""
        problem = self.context.problem
        for _ in range(_TURNS):
            before = self.judge.best
            arm = problem.arm
            links = [replace(link, length=length) for link, length in zip(arm.links, lengths, strict=True)]
            settled = replace(problem, arm=arm.with_links(tuple(links))).with_ranges(link_length=None)
            try:
                best = ListSearch(context_of(settled), self.lists, progress=self.progress).run()
            except Unreachable:
                return
            if best.pick is None:
                return
            self._offer(best.pick[:-1], [tuple(lengths)])
            if self.judge.best is None or self.judge.best == before:
                return
            self._move()
            lengths = self.judge.table.lengths[self.judge.best[0][-1]]

    def _move(self) -> None:
        """Change the lengths of the best design a little, less and less, until none is better."""
        assert self.judge.best is not None
        for step in _STEPS:
            while True:
                pick, before = self.judge.best
                lengths = self.judge.table.lengths[pick[-1]]
                self._offer(pick[:-1], list(moved(self.context.problem, lengths, self.links, step)))
                if not self.judge.complete or self.judge.best[1] >= before * (1.0 - step * _WORTH):
                    break
