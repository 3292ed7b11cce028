"""Infeasible combinations of shapes and materials, certified all at once.

The relaxation (`relaxation`) is solved for the least violation of the limits at the poses known, without an objective.
Its multipliers give one sum over links that is at most zero for every feasible design. A combination over whose options
the minimum of that sum is positive is infeasible, whatever its sizes (a certificate of infeasibility; J. W. Chinneck,
Feasibility and Infeasibility in Optimization, Springer 2008, ch. 2).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.optimize.choice.agreement import agreements
from linkwright.core.optimize.choice.picks import Combination, option_table
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.design import arm_of, numeric_beams
from linkwright.core.optimize.exchange.exchange import Context, Exchange
from linkwright.core.optimize.exchange.program import Solution
from linkwright.core.sections.numeric import Array

from .cells import Ids, link_cells
from .pose_rows import rows_of
from .relaxation import LOOSE, Node, Relaxation, Relaxed

_SURE = 1e-4
"""A combination that breaks limits by less (relative) is not ruled out."""
_ROUGH = 5e-3
"""How loose cells may be where combinations are ranked only."""
_ROOM = 1e-2
"""Bounds of options that are out by more than this need not be exact."""
_LEAST, _ROOM_AT_MOST = 1e-12, 1.5
"""An objective (SI) counts as at least so much; bounds beyond so many times one need not be exact."""
_WORTH_IT, _IN_VAIN = 4, 4
"""One combination that rules out fewer others was in vain; after so many of those no more are asked."""
MOST_AT_ONCE = 3_000_000
"""For more combinations it is not kept which of them are out, and what bounds each."""


@dataclass(frozen=True)
class Shown:
    """The point at which rows were linearised: a combination, its variables, the poses at which limits relax."""

    pick: Combination
    x: Array
    pool: Pool


class Feasibility:
    """Rules out combinations of a problem; `impossible` (an axis for each elastic link, with its options) says which
    are."""

    def __init__(self, context: Context) -> None:
        problem = context.problem
        self.context = context
        self.relaxation = Relaxation(link_cells(problem), option_table(problem).links, problem.arm.size)
        # By how much limits are broken is told to thousandths of them, however little that is.
        self.relaxation.little = 1.0
        self._root = self.relaxation.root()
        self._options = option_table(problem)
        self.impossible = np.zeros(self._options.shape, dtype=bool)
        self.shown: Shown | None = None
        self._broken = np.zeros(self.impossible.shape)
        """How far limits are broken at least (relative), as far as that is known."""
        self._pool: Pool | None = None
        self._in_vain = 0
        self._asked_all = False

    def rules_out(self, pick: Combination) -> bool:
        """Whether a combination is known to keep the limits nowhere."""
        return bool(self.impossible[self._options.place(pick)])

    def learn(self, exchange: Exchange, relaxed: Solution, pick: Combination, pool: Pool) -> None:
        """Rule out what a combination shows that has no solution for a pool: in `relaxed` limits give way as little as
        they can, `exchange` is one of its shapes."""
        self.impossible[self._options.place(pick)] = True
        if self._in_vain >= _IN_VAIN:
            return
        # Where the limits give way, other poses than the pool's break them as well.
        pool = exchange.worse_poses(relaxed, pick.materials, pool)
        self._pool = pool if self._pool is None else self._pool.joined(pool)
        if not self._read(exchange, relaxed.x, pick, self._pool):
            return
        self.shown = Shown(pick, relaxed.x, self._pool)
        before = int(self.impossible.sum())
        if not self._asked_all:
            self._asked_all = True
            self._note(self._root)
        if not self.impossible.all():
            self._note(self._only(pick))
        self._in_vain = self._in_vain + 1 if int(self.impossible.sum()) - before < _WORTH_IT else 0

    def nearest(self, exchange: Exchange, x: Array, pick: Combination, pool: Pool, number: int) -> list[Combination]:
        """So many combinations at most that break limits least, by the multipliers of all together; none where it is
        not known that one is broken by all. Rows are read off about a design: a combination with its numbers."""
        if not self._read(exchange, x, pick, pool):
            return []
        relaxed = self._roughly(lambda: self.relaxation.least_breach(self._root, self._root))
        if not math.isfinite(relaxed.bound) or relaxed.bound <= _SURE:
            return []
        return self._least(self._breaches(relaxed), number)

    def nearest_by_one(
        self, exchange: Exchange, x: Array, pick: Combination, pool: Pool, number: int, limit: int
    ) -> list[Combination] | None:
        """So many combinations at most in which one limit (its number) has to give way least for all others to be kept;
        None where it is known that none keeps the others. Rows as for `nearest`."""
        if not self._read(exchange, x, pick, pool):
            return []
        self.relaxation.rows = [
            replace(row, objective=True, shift=row.shift + 1.0) if row.limit == limit else row
            for row in self.relaxation.rows
        ]
        if not any(row.objective for row in self.relaxation.rows):
            return []
        relaxed = self._roughly(lambda: self.relaxation.solve(self._root, math.inf))
        return self._least(self._breaches(relaxed), number) if math.isfinite(relaxed.bound) else None

    def _roughly(self, solve: Callable[[], Relaxed]) -> Relaxed:
        self.relaxation.loose = _ROUGH
        try:
            return solve()
        finally:
            self.relaxation.loose = LOOSE

    def nearest_known(self, number: int) -> list[Combination]:
        """So many combinations at most that break limits least as far as is known of all; none where it is not known
        that all break one."""
        return self._least(self._broken, number) if bool((self._broken > _SURE).all()) else []

    def _least(self, table: NDArray[np.float64], number: int) -> list[Combination]:
        picks: list[Combination] = []
        asked = agreements(self.context.problem)
        for place in np.argsort(table, axis=None, kind="stable").tolist():
            near = self._options.combination([int(k) for k in np.unravel_index(place, table.shape)])
            if near.agrees(asked):
                picks.append(near)
            if len(picks) == number:
                break
        return picks

    def none_keeps(self, exchange: Exchange, x: Array, pick: Combination, pool: Pool) -> bool:
        """Whether it is known that no combination keeps the limits; rows are read off about a design."""
        if not self._read(exchange, x, pick, pool):
            return False
        return self.relaxation.least_breach(self._root, self._root, enough=2.0 * _SURE).bound > _SURE

    def bounds_by(
        self, exchange: Exchange, solution: Solution, pick: Combination, objective: float, enough: float
    ) -> NDArray[np.float64] | None:
        """A bound (SI) on every combination by the multipliers of one, of which a solution is given with its objective;
        well known only below `enough`. None where the model is no sum of products."""
        worth = max(objective, _LEAST)
        arm = arm_of(exchange.space, solution.x, pick.materials)
        p = numeric_beams(arm, self.context.problem.load_cases)
        rows = rows_of(self.context, solution.active, arm, p, worth)
        if rows is None or not any(row.objective for row in rows):
            return None
        self.relaxation.rows = rows
        relaxed = self.relaxation.solve(self._only(pick), math.inf)
        if not math.isfinite(relaxed.bound):
            return np.full(self.impossible.shape, -np.inf)
        room = min(enough / worth, _ROOM_AT_MOST) - relaxed.bound
        return worth * self._sums(relaxed, max(room, 0.0) + _ROOM)

    def _read(self, exchange: Exchange, x: Array, pick: Combination, pool: Pool) -> bool:
        """The rows of a pool, read off about a design; False where there are none."""
        arm = arm_of(exchange.space, x, pick.materials)
        rows = rows_of(self.context, pool, arm, numeric_beams(arm, self.context.problem.load_cases), 1.0)
        self.relaxation.rows = [row for row in rows or () if not row.objective]
        return bool(self.relaxation.rows)

    def _only(self, pick: Combination) -> Node:
        """The part of all designs in which every link is what a combination says."""
        allowed: list[Ids] = [np.array([place]) for place in self._options.place(pick)]
        return self.relaxation.root(allowed)

    def _note(self, node: Node) -> None:
        """Rule out what the multipliers of a part of all designs show to be impossible."""
        relaxed = self.relaxation.least_breach(node, self._root)
        if math.isfinite(relaxed.bound):
            self._broken = np.maximum(self._broken, self._breaches(relaxed))
            self.impossible |= self._broken > _SURE

    def _breaches(self, relaxed: Relaxed) -> NDArray[np.float64]:
        """How far limits are broken at least (relative), for every combination."""
        return self._sums(relaxed, max(_SURE - relaxed.bound, 0.0) + _ROOM)

    def _sums(self, relaxed: Relaxed, room: float) -> NDArray[np.float64]:
        """The bound by a relaxed part's prices on every combination, as for `Relaxation.by_option`."""
        everywhere = replace(relaxed, node=replace(relaxed.node, cells=self._root.cells))
        bound, losses = self.relaxation.by_option(everywhere, room)
        table = np.array(bound)
        for axis, (link_losses, cells) in enumerate(zip(losses, self.relaxation.cells, strict=True)):
            # An option without a cell has no section that keeps the limits on single links.
            values = np.array([link_losses.get(option, np.inf) for option in range(len(cells.options))])
            table = table + values.reshape([-1 if k == axis else 1 for k in range(len(losses))])
        return table


def feasibility_of(context: Context) -> Feasibility | None:
    """What rules out combinations of a problem; None where the model is no sum of products over links: lengths to be
    chosen, scenarios, play that depends on the design; or where there are too many."""
    problem = context.problem
    if problem.free_lengths or problem.free_tapers or problem.balances or context.scenarios is not None:
        return None
    if problem.arm.play != "worst" and context.uses_error:
        return None
    options = option_table(problem)
    return Feasibility(context) if options.links and math.prod(options.shape) <= MOST_AT_ONCE else None
