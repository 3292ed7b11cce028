"""The best of all designs from lists, with a bound that closes: branch and bound over the lists, an exchange for poses.

A part of all designs is bounded (`optimize.choice.at_once.relaxation`); options that would raise its bound above the
best design are out, and so are combinations whose losses do together. What few are left are compared one by one over
the poses known; those that could win over their whole workspace, whose worst poses join the rows. Where too many are
left the part is split in two by what the mixture of a link differs in (Land and Doig 1960, doi:10.2307/1910129).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.optimize.choice.at_once.pose_rows import PoseRow, rows_of
from linkwright.core.optimize.choice.at_once.relaxation import Node, Relaxed
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.design import numeric_beams
from linkwright.core.optimize.exchange.exchange import Context
from linkwright.core.optimize.result import Iteration
from linkwright.core.sections.numeric import Array

from .designs_at_once import Table
from .listed_search import ListedSearch, Progress, SearchOutcome
from .options import LinkList, agreeing_parts
from .rows import Integers, TableRow, greatest, product, table_row

CLOSE = 1e-4
"""A part whose bound is this near to the best design (relative) holds nothing worth winning: the exchange's gap."""
WANTED = 1e-2
"""The gap that is always worth more parts."""
MOST_PARTS, MOST_CLOSING = 400, 60
"""Parts looked at to bring the gap down to what is wanted, and to close it wholly."""
_MOST_COMPARED = 300_000
"""So many combinations of a part are compared one by one."""
_TRIED = 40_000
"""Combinations of the options that cost least, tried to find a good design."""
_MOST_IN_ALL = 5_000_000
"""So many in all."""
_OFFERED = 512
"""Designs searched over their workspaces before rows are made of the poses that turned up."""
_MOST_OFFERS = 40


class ListSearch(ListedSearch):
    """Looks for the best design where lengths stay."""

    def __init__(
        self,
        context: Context,
        lists: tuple[LinkList, ...],
        *,
        progress: Progress | None = None,
        log: Callable[[Iteration], None] | None = None,
        table: Table | None = None,
    ) -> None:
        """`table` is that of the lists, where it is there already."""
        super().__init__(context, lists, "bounding all combinations", progress=progress, log=log, table=table)
        self._rows: list[TableRow] = []
        """The relaxation's rows over the lists' options."""
        self.close = CLOSE
        """The gap at which nothing is left to win."""
        self.place = 0
        """The choice of lengths, of those of the table."""
        self._known = Pool()
        self._first_rows = 0

    def at(self, place: int) -> SearchOutcome:
        """Look for a design with a choice of lengths of the table that is better than the best so far."""
        self.place, self._known, self.bounded = place, Pool(), True
        self.relaxation.rows, self._rows = [], []
        self.judge.pool = Pool()
        return self.run()

    @property
    def _pool(self) -> Pool:
        return self.judge.pool

    def run(self) -> SearchOutcome:
        """Split and compare until nothing better can be left, or enough parts were looked at."""
        self._begin_again()
        try:
            if not self._known.size:
                self._begin()
            for part in self._roots():
                self._push(part, part.bound)
            while self._heap and self.gap > self.close and self._worth_going_on():
                self._next()
            if not self.bounded and self.gap > self.close:
                self._link_by_link()
        except KeyboardInterrupt:
            if self.judge.best is None:
                raise
            return self._outcome(interrupted=True)
        return self._outcome()

    def _outcome(self, *, interrupted: bool = False) -> SearchOutcome:
        return self._ended(known=not interrupted and self._agrees(), interrupted=interrupted)

    def _values(self, pick: tuple[int, ...]) -> list[tuple[bool, float]]:
        rows = self._rows if pick[-1] == self.place else []
        return [(row.objective, float(row.values(np.array([pick[:-1]]))[0])) for row in rows]

    # ---- begin

    def _begin(self) -> None:
        """Poses of the arm as given, of the stiffest options and of the lightest; rows read off the stiffest."""
        for pick in ([int(link_list.columns[:, column].argmin()) for link_list in self.lists] for column in (2, 0)):
            arm = self.judge.table.arm_of([*pick, self.place])
            self.judge.learn(arm, numeric_beams(arm, self.context.problem.load_cases))
        stiff = [int(link_list.columns[:, 2].argmin()) for link_list in self.lists]
        self._arm = self.judge.table.arm_of([*stiff, self.place])
        self._p = numeric_beams(self._arm, self.context.problem.load_cases)
        self.worth = self._worth(stiff)
        rows = rows_of(self.context, Pool(), self._arm, self._p, self.worth)
        if rows is None:
            self.bounded = False
            return
        self._first_rows = len(rows)
        self._join(rows)
        self._refresh()

    def _worth(self, pick: Sequence[int]) -> float:
        problem = self.context.problem
        if problem.minimize == "max_error":
            return max(self.context.search.worst(self._p, certify=False).error, 1e-12)
        value = self.judge.objective_of(np.array([[*pick, self.place]]))
        return max(float(value[0]), 1e-9)

    def _refresh(self) -> None:
        """Rows of the poses that turned up since."""
        pool = self.judge.cuts()
        fresh = Pool(
            tuple(cut for cut in pool.errors if cut not in self._known.errors),
            tuple((name, tuple(cut for cut in cuts if cut not in self._known.of(name))) for name, cuts in pool.held),
        )
        self._known = pool
        if not self.bounded or not fresh.size:
            return
        rows = rows_of(self.context, fresh, self._arm, self._p, self.worth)
        if rows is None:
            self.bounded = False
            return
        self._join(rows[self._first_rows :])

    def _join(self, rows: Sequence[PoseRow]) -> None:
        self.relaxation.rows += rows
        self._rows += [table_row(row, self.lists) for row in rows]

    def _roots(self) -> list[Node]:
        """All designs, in parts that agree in what must be the same."""
        return [self.relaxation.root(options) for options in agreeing_parts(self.context.problem, self.lists)]

    # ---- parts

    def _divide(self, left: Node, relaxed: Relaxed, enough: float) -> None:
        least, losses = self._losses(left, relaxed)
        picks = combined(losses, enough - least, _MOST_COMPARED)
        if picks is not None and self._compare(self._picks(left, picks)):
            self._done_with(enough)
            return
        for item in self._halves(left, relaxed) or self._by_weight(left):
            self._push(item, left.bound)

    def _by_weight(self, node: Node) -> list[Node]:
        """A part in two, by the weights of the link that has most options."""
        k = max(range(len(self.lists)), key=lambda index: len(node.cells[index]))
        weights = self.lists[k].columns[node.cells[k], 0]
        below = np.argsort(np.argsort(weights, kind="stable")) < len(weights) // 2
        sides = (below, ~below)
        return [replace(node, cells=(*node.cells[:k], node.cells[k][side], *node.cells[k + 1 :])) for side in sides]

    def _worth_going_on(self) -> bool:
        """Whether one more part could help, and is not one too many."""
        if not self.judge.complete or self.compared > _MOST_IN_ALL:
            return False
        if not self.bounded and self.combinations > _MOST_COMPARED:
            return False
        return self.parts < (MOST_CLOSING if self.gap <= WANTED else MOST_PARTS)

    def _link_by_link(self) -> None:
        """Where nothing bounds designs: from the stiffest, the lightest and the best, one link at a time until none
        improves."""
        starts = [[int(link_list.columns[:, column].argmin()) for link_list in self.lists] for column in (2, 0)]
        if self.judge.best is not None:
            starts.insert(0, list(self.judge.best[0][:-1]))
        for start in starts:
            pick, improved = np.array(start, dtype=np.intp), True
            while improved and self.judge.complete:
                improved = False
                for k, item in enumerate(self.lists):
                    trials = np.repeat(pick[None], len(item.options), axis=0)
                    trials[:, k] = np.arange(len(item.options))
                    self.compared += len(trials)
                    if self.judge.offer(self._placed(trials)):
                        assert self.judge.best is not None
                        self._note()
                        pick, improved = np.array(self.judge.best[0][:-1], dtype=np.intp), True

    def _enough(self) -> float:
        return self.objective * (1.0 - self.close)

    def _compared_all(self, part: Node) -> bool:
        counts = [len(link_options) for link_options in part.cells]
        if math.prod(counts) > _MOST_COMPARED:
            return False
        enough = self._enough()
        if not self._compare(product(part.cells)):
            return False
        self._done_with(enough if math.isinf(self.objective) else self._enough())
        return True

    def _picks(self, part: Node, places: Integers) -> Integers:
        return np.stack([link_options[places[:, k]] for k, link_options in enumerate(part.cells)], axis=1)

    def _placed(self, picks: Integers) -> Integers:
        return np.hstack([picks, np.full((len(picks), 1), self.place, dtype=np.intp)])

    def _try(self, relaxed: Relaxed) -> None:
        """Combinations of the options of each link that cost least."""
        per_link = max(2, int(_TRIED ** (1.0 / len(self.lists))))
        self._compare(product(self._likely(relaxed, per_link)))

    def _compare(self, picks: Integers) -> bool:
        """Compare designs one by one; whether none of them is left that could win."""
        self.compared += len(picks)
        left, values = picks, np.zeros(len(picks))
        known: tuple[int, float] | None = None
        size = _OFFERED
        for _ in range(_MOST_OFFERS):
            if known != (now := (len(self._rows), self._enough())):
                values, keep = greatest(self._rows, left, now[1])
                order = np.argsort(values, kind="stable")
                left, values, known, size = left[keep][order], values[order], now, _OFFERED
            if not len(left):
                return True
            batch, left, values = left[:size], left[size:], values[size:]
            size *= 2
            if self.judge.offer(self._placed(batch)):
                self._note()
            self._refresh()
            if not self.judge.complete:
                return False
        return not len(left)


def combined(losses: Sequence[Array], room: float, most: int) -> Integers | None:
    """Every way to take an entry of each list with a sum below `room`, (N, lists); None where there are more than
    `most` on the way."""
    sums = np.zeros(1)
    picks = np.zeros((1, 0), dtype=np.intp)
    for link_losses in losses:
        order = np.argsort(link_losses, kind="stable")
        counts = np.searchsorted(link_losses[order], room - sums, side="left")
        if int(counts.sum()) > most:
            return None
        rows = np.repeat(np.arange(len(sums)), counts)
        starts = np.cumsum(counts) - counts
        places = order[np.arange(int(counts.sum())) - np.repeat(starts, counts)]
        sums = sums[rows] + link_losses[places]
        picks = np.hstack([picks[rows], places[:, None]])
    return picks
