"""What searches for the best design from lists share: designs are judged whole, and parts of them bounded."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.optimize.choice.agreement import number_of
from linkwright.core.optimize.choice.at_once.cells import LENGTH, Cells
from linkwright.core.optimize.choice.at_once.lengths import log_spans
from linkwright.core.optimize.choice.at_once.relaxation import Node, Relaxation, Relaxed
from linkwright.core.optimize.choice.at_once.splitting import BranchAndBound, split
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.exchange import Context
from linkwright.core.optimize.result import Iteration
from linkwright.core.optimize.sizes.designs_at_once import Table
from linkwright.core.optimize.sizes.judge import Judge
from linkwright.core.optimize.sizes.options import LinkList
from linkwright.core.optimize.sizes.rows import Integers
from linkwright.core.sections.numeric import Array


class Points(Cells):
    """The options of a link: each is a cell that is never split, with the number that the list gives it."""

    def __init__(self, link_list: LinkList) -> None:
        count = len(link_list.options)
        self.count = count
        self.option = np.arange(count)
        self.roots = np.arange(count)
        self.corners = np.repeat(link_list.columns[:, None], 2, axis=1)
        self.kept = np.ones((count, 2), dtype=bool)
        self.bends = np.zeros((count, 0, link_list.columns.shape[1]))
        self.held, self.held_bends = np.zeros((count, 1, 0)), np.zeros((count, 0, 0))
        self.across = np.zeros(count, dtype=bool)

    @property
    def spent(self) -> bool:
        """A point has no parts."""
        return True


Progress = Callable[[int, int, str], None]
_AGREE = 1e-6
"""A row may be this far (relative) above what the whole evaluation of a design says."""


@dataclass(frozen=True)
class SearchOutcome:
    """How a search ended: the best design (an option of each link, then a choice of lengths) or None, its objective
    (SI), the bound that no design goes below, parts looked at, designs compared and searched, and whether it was
    interrupted."""

    pick: tuple[int, ...] | None
    objective: float
    bound: float
    parts: int
    compared: int
    searched: int
    interrupted: bool = False

    @property
    def gap(self) -> float | None:
        """By how much (relative) the objective is above the bound; None where nothing is known."""
        if self.pick is None or not math.isfinite(self.bound):
            return None
        return max(0.0, 1.0 - self.bound / self.objective) if self.objective else 0.0


class ListedSearch(BranchAndBound[Node]):
    """Looks for the best design of a problem whose sections are listed: each listed section is a cell of one point of
    the relaxation on all combinations (`optimize.choice.at_once.relaxation`)."""

    def __init__(
        self,
        context: Context,
        lists: tuple[LinkList, ...],
        doing: str,
        *,
        progress: Progress | None = None,
        log: Callable[[Iteration], None] | None = None,
        table: Table | None = None,
    ) -> None:
        """`doing` as for `BranchAndBound`; `table` is that of the lists, where it is there already."""
        super().__init__(doing)
        self.named = "listed sizes"
        """What is compared, for progress."""
        self.context, self.lists, self.progress, self._log = context, lists, progress, log
        self.history: list[Iteration] = []
        self.judge = Judge(context, table or Table(context.problem, lists), self._heard)
        problem = context.problem
        self.links = tuple(link_list.link for link_list in lists)
        points = {id(link_list.columns): Points(link_list) for link_list in lists}
        self._points = [points[id(link_list.columns)] for link_list in lists]
        spans = log_spans(problem, self.links) if problem.free_lengths else None
        self.relaxation = Relaxation(self._points, self.links, problem.arm.size, spans)
        self.compared = 0
        self.bounded = True
        """Whether there are rows, so that anything can be bounded."""

    @property
    def objective(self) -> float:
        """The best objective so far, relative to `worth`."""
        return math.inf if self.judge.best is None else self.judge.best[1] / self.worth

    @property
    def combinations(self) -> int:
        """How many combinations of sections there are."""
        asked, sizes = self.judge.table.agreed, [len(link_list.options) for link_list in self.lists]
        return number_of(asked, sizes) if asked else math.prod(sizes)

    @property
    @abstractmethod
    def _pool(self) -> Pool:
        """The poses that are rows."""

    @abstractmethod
    def _values(self, pick: tuple[int, ...]) -> list[tuple[bool, float]]:
        """What the rows say of a design, and whether each is of the objective; none of one that they are not for."""

    def _agrees(self) -> bool:
        """Whether the best design, which was looked at as a whole, is where its rows say: above those of the objective,
        and within all others. What they bound is worth nothing otherwise."""
        values = [] if self.judge.best is None else self._values(self.judge.best[0])
        return all(value <= (self.objective * (1.0 + _AGREE) if item else _AGREE) for item, value in values)

    @abstractmethod
    def _enough(self) -> float:
        """The bound (relative to `worth`) from which a part holds nothing worth winning."""

    @abstractmethod
    def _try(self, relaxed: Relaxed) -> None:
        """Look for a better design near a relaxed part."""

    @abstractmethod
    def _divide(self, left: Node, relaxed: Relaxed, enough: float) -> None:
        """Compare what is left of a part, or put its parts on the heap."""

    def _compared_all(self, part: Node) -> bool:
        """Whether a part was small enough to compare its designs one by one."""
        del part
        return False

    def _step(self, part: Node) -> None:
        if part.bound >= self._enough():
            self._done_with(part.bound)
            return
        if self._compared_all(part):
            return
        relaxed = self.relaxation.solve(part, self._enough())
        bound = max(relaxed.bound, part.bound)
        if bound < self._enough():
            self._try(relaxed)
        enough = self._enough()
        if bound >= enough:
            self._done_with(bound)
            return
        left = self._filtered(replace(relaxed.node, bound=bound), relaxed, enough)
        if any(len(ids) == 0 for ids in left.cells):
            self._done_with(enough)
            return
        self._divide(left, relaxed, enough)

    @abstractmethod
    def run(self) -> SearchOutcome:
        """Look for the best design until nothing much better can be left, or enough parts were looked at."""

    def exclude(self, pick: tuple[int, ...]) -> None:
        """Leave a design out of the next run: it turned out to break a limit after all."""
        self.judge.exclude(pick)

    def _columns(self, pick: Sequence[int]) -> Array:
        return self.relaxation.full(
            np.array([link_list.columns[option] for link_list, option in zip(self.lists, pick, strict=True)])
        )

    def _losses(self, node: Node, relaxed: Relaxed) -> tuple[float, list[Array]]:
        """A bound on a part by the prices of a relaxed one, and by how much it rises at least where a link must be each
        of the part's options."""
        bound, losses = relaxed.constant, list[Array]()
        parts = zip(self._points, node.cells, relaxed.prices, node.low, node.high, strict=True)
        for points, ids, price, low, high in parts:
            scores = points.corners[ids, 0] @ price
            least = float(scores.min())
            bound += least + float(price[LENGTH]) * float((low if price[LENGTH] >= 0.0 else high)[LENGTH])
            losses.append(scores - least)
        return bound, losses

    def _filtered(self, node: Node, relaxed: Relaxed, enough: float) -> Node:
        """The part without the options that alone bring its bound to what is enough."""
        bound, losses = self._losses(node, relaxed)
        cells = zip(node.cells, losses, strict=True)
        return replace(node, cells=tuple(ids[link_losses < enough - bound] for ids, link_losses in cells))

    def _likely(self, relaxed: Relaxed, most: int) -> list[Integers]:
        """So many options of each link of a part: what it is mixed of, and those that cost least."""
        mixed = [{column.cell for column, _ in relaxed.shares if column.link == k} for k in range(len(self.lists))]
        few: list[Integers] = []
        for ids, losses, link_mixed in zip(
            relaxed.node.cells, self._losses(relaxed.node, relaxed)[1], mixed, strict=True
        ):
            order = np.lexsort((losses, ~np.isin(ids, list(link_mixed))))
            few.append(ids[order[:most]])
        return few

    def _halves(self, node: Node, relaxed: Relaxed) -> list[Node]:
        """A part in two; none where that wins nothing."""
        halves: list[Node] = []
        for part in split(self.relaxation, node, relaxed, by_kind=False):
            # What cells hold says where they are; sides of their columns would only be rows more.
            low, high = np.full_like(part.low, -np.inf), np.full_like(part.high, np.inf)
            low[:, LENGTH], high[:, LENGTH] = part.low[:, LENGTH], part.high[:, LENGTH]
            halves.append(replace(part, low=low, high=high))
        return halves

    def _ended(self, *, known: bool, interrupted: bool) -> SearchOutcome:
        """How the search ended; `known`: whether the bound holds."""
        bound = min(self.bound, self.objective) * self.worth if known else -math.inf
        pick, objective = self.judge.best or (None, math.inf)
        return SearchOutcome(pick, objective, bound, self.parts, self.compared, self.judge.searched, interrupted)

    def _note(self) -> None:
        """A line of the log: a better design."""
        assert self.judge.best is not None
        number = len(self.history) + 1
        self.history.append(Iteration(number, self.judge.best[1], math.nan, self._pool.size, 0.0, False))
        if self._log is not None:
            self._log(self.history[-1])

    def tell(self) -> None:
        """Tell how many designs were compared so far."""
        self._heard(self.judge.offered, self.judge.searched)

    def _heard(self, offered: int, searched: int) -> None:
        self._say(searched, searched + 1, f"comparing {self.named}, {offered} designs so far")

    def _say(self, done: int, of: int, text: str) -> None:
        if self.progress is not None:
            self.progress(done, of, text)
