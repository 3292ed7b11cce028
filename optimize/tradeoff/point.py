"""The best design at one point of a trade-off: one figure held, the other pushed, over all shapes and materials.

A combination of shapes and materials that was bounded under one limit can do no better under a tighter one, and nothing
follows for a looser one. Whichever figure was pushed, a bound is a corner: no design of the combination is better than
it in both figures. Corners rule out what a better design is known for, so that along a front most combinations are not
solved again. The designs at neighbouring points are where the search starts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from linkwright.core.arm.figures import Cut
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.optimize.choice.combinations import MOST_COMBINATIONS
from linkwright.core.optimize.choice.picks import Combination, combinations, count, one_link_changed, uniform
from linkwright.core.optimize.exchange.assembled import Compiled
from linkwright.core.optimize.exchange.binding_poses import ErrorCut, Pool
from linkwright.core.optimize.exchange.design import design_space, material_row, starting_points
from linkwright.core.optimize.exchange.exchange import Context, Exchange, Exchanged, context_of, first_pool
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections.numeric import Array

from .question import Question

AnyCut = TypeVar("AnyCut", ErrorCut, Cut)
Notify = Callable[[str], None]
"""Hears what is being done, often; may raise to stop."""

_KEPT, _KEPT_SMALL = 6, 160
"""Compiled programs kept: those with room for many poses are large, those for bounds are not."""
_STARTS = 5
_SLACK = 1e-9
_SAME = 1e-8
"""Bounds that differ by less (relative) are the same: with so much less a bound excludes no design that just attains
it."""
_APART = 0.05
"""Designs whose numbers differ by more than this are tried as starts of their own."""


@dataclass(frozen=True)
class Design:
    """The best design found at a point: its combination, the optimiser's numbers, and the poses that hold it.

    `badness` is that of the figure that was pushed; `elasticity` how many per cent less badness of y one per cent more
    of x would buy (None where the limit on x does not hold the design, or where y was not pushed against it).
    """

    combination: Combination
    numbers: tuple[float, ...]
    pool: Pool
    badness: float
    elasticity: float | None
    converged: bool
    unsolved: int = 0
    """How many combinations could be better for all that is known: the solver failed on them here."""


Corner = tuple[float, float]
"""Badness of x and of y: no design of a combination has less of the one and no more of the other."""


class Search:
    """Finds designs for one problem (of a group) of a trade-off; what it has learnt about combinations it keeps."""

    def __init__(self, asked: Question, problem: Problem, notify: Notify) -> None:
        """`notify` is called between the parts of the work."""
        self.asked, self.problem, self._notify = asked, problem, notify
        self.share = 0.0
        self.context: Context = context_of(problem)
        self.exhaustive = count(problem) <= MOST_COMBINATIONS
        self.picks = combinations(problem) if self.exhaustive else uniform(problem)
        self._large: dict[tuple[str | None, ...], Exchange] = {}
        self._small: dict[tuple[str | None, ...], Exchange] = {}
        self._compiled = Compiled()
        self._met = Pool()
        self._first: Pool | None = None
        self._corners: dict[Combination, list[Corner]] = {}
        self._known: dict[Combination, Array] = {}

    def best(self, push: int, held: float, near: Sequence[Design], *, wide: bool = False) -> Design | None:
        """The design with the least badness of the figure pushed (the number of its limit) while the other has at most
        `held` (infinity: any); None where there is none.

        `near` are designs to start from; `wide` tries further starts for the best combination.
        """
        trial = _Trial(self, push, held)
        pool = self._first
        for design in near:
            pool = design.pool if pool is None else pool.joined(design.pool)
        trial.pool = pool
        for design in near:
            self._notify("starting from the neighbours")
            trial.finish(design.combination, np.array(design.numbers))
        trial.average(near)
        if not near:
            trial.first(self.picks)
        trial.try_all(self.picks)
        if not self.exhaustive:
            trial.link_by_link()
        if wide:
            trial.polish()
        design = trial.design
        if design is None or design.badness > self.asked.cap(push) * (1.0 + 1e-6):
            return None
        return replace(design, unsolved=len(trial.unsolved))

    def bound_on(self, push: int, pick: Combination, held: float) -> float:
        """No design of a combination whose figure held has at most that badness has less of the other than this, from
        all that was learnt under the same limit or looser ones."""
        pushed = 0 if push == self.asked.x_limit else 1
        known = [corner[pushed] for corner in self._corners.get(pick, ()) if corner[1 - pushed] >= held]
        return max(known, default=0.0)

    def learn(self, push: int, pick: Combination, held: float, bound: float) -> None:
        """Keep, for later points, that no design of a combination has less than `bound` of the figure pushed where the
        other has at most `held`."""
        bound *= 1.0 - _SAME
        self._keep(pick, (bound, held) if push == self.asked.x_limit else (held, bound))

    def _keep(self, pick: Combination, corner: Corner) -> None:
        """Keep a corner, and only those that say more than others."""
        corners = self._corners.setdefault(pick, [])
        if not any(item[0] >= corner[0] and item[1] >= corner[1] for item in corners):
            corners[:] = [item for item in corners if item[0] > corner[0] or item[1] > corner[1]]
            corners.append(corner)

    def exchange(self, shapes: tuple[str | None, ...], *, small: bool = False) -> Exchange:
        """The exchange for a combination of shapes, the latest used last to go; the `small` ones are for bounds."""
        cache = self._small if small else self._large
        exchange = cache.pop(shapes, None)
        if exchange is None:
            exchange = Exchange(self.context, design_space(self.problem, shapes), self._compiled)
            if len(cache) >= (_KEPT_SMALL if small else _KEPT):
                cache.pop(next(iter(cache)))
        cache[shapes] = exchange
        return exchange

    def few_poses(self, pool: Pool) -> Pool:
        """A pool with at least one pose of every kind that ever held a design, so that what is compiled can stay."""
        met = self._met = self._met.joined(pool)
        spare = Pool(_others(met.errors, pool.errors))
        for family, cuts in met.held:
            spare = spare.with_cuts(family, _others(cuts, pool.of(family)))
        return pool.joined(spare)

    def starts(self, pick: Combination, number: int = 2) -> list[Array]:
        """Where to start for a combination: where it ended last, and its starting points."""
        space = self.exchange(pick.shapes, small=True).space
        known = [] if pick not in self._known else [self._known[pick]]
        return [*known, *starting_points(space, material_row(pick.materials, self.problem), number)]

    def remember(self, pick: Combination, x: Array) -> None:
        """Keep where a combination ended."""
        self._known[pick] = x

    def keep_first(self, pool: Pool) -> None:
        """Keep the poses that every later point starts with."""
        self._first = pool

    def say(self, text: str, share: float = 0.0) -> None:
        """Tell what is being done, and what share of it is behind."""
        self.share = share
        self._notify(text)


def _others(met: tuple[AnyCut, ...], cuts: tuple[AnyCut, ...]) -> tuple[AnyCut, ...]:
    """A cut of each group (load case) that has none of its own."""
    covered = {cut.group for cut in cuts}
    return tuple({cut.group: cut for cut in met if cut.group not in covered}.values())


class _Trial:
    """One point: the best design so far and the poses met."""

    def __init__(self, search: Search, push: int, held: float) -> None:
        self._search, self._push, self._held = search, push, held
        self._limits = search.asked.limits(push, held)
        self.pool: Pool | None = None
        self.design: Design | None = None
        self.unsolved: set[Combination] = set()

    @property
    def badness(self) -> float:
        return math.inf if self.design is None else self.design.badness

    def _exchange(self, pick: Combination, *, small: bool = False) -> tuple[Exchange, Array]:
        exchange = self._search.exchange(pick.shapes, small=small)
        exchange.set_limits(self._limits)
        return exchange, material_row(pick.materials, self._search.problem)

    def first(self, picks: Sequence[Combination]) -> None:
        """Finish the first combination that has a design at all."""
        search = self._search
        for pick in picks:
            search.say("looking for a first design")
            if self.pool is None:
                exchange, _ = self._exchange(pick, small=True)
                self.pool = first_pool(exchange.context, exchange.space, search.starts(pick)[0], pick.materials)
                search.keep_first(self.pool)
            bound = self._bound(pick, self.pool)
            if bound is not None and self.finish(pick, bound[1]) and self.design is not None:
                return

    def _bound(self, pick: Combination, pool: Pool) -> tuple[float, Array] | None:
        """A combination's least badness for some poses alone, and where; None where it has no design, or the solver
        failed, which proves nothing."""
        search = self._search
        exchange, materials = self._exchange(pick, small=True)
        failed = False
        for start in search.starts(pick):
            bound = exchange.bound(materials, pool, start, push=self._push)
            if bound is not None:
                search.learn(self._push, pick, self._held, bound[1])
                search.remember(pick, bound[0].x)
                return bound[1], bound[0].x
            failed = failed or not exchange.infeasible
        if failed:
            self.unsolved.add(pick)
        else:
            search.learn(self._push, pick, self._held, math.inf)
        return None

    def finish(self, pick: Combination, start: Array) -> bool:
        """The exchange for a combination from a start; a better design is kept. Whether the exchange ended."""
        if self.pool is None:
            return False
        exchange, materials = self._exchange(pick)
        try:
            done = exchange.run(
                materials, pick.materials, self.pool, start, give_up_above=self.badness, push=self._push
            )
        except Unreachable:
            return False  # lengths that lead nowhere say nothing of others
        if done is None:
            return exchange.infeasible
        self.unsolved.discard(pick)
        self.pool = self.pool.joined(done.solution.active)
        if done.bounded_out:
            return True
        # The limit pushed stood at a badness of one.
        badness = math.exp(done.solution.slacks[self._push])
        self._search.remember(pick, done.x)
        if badness < self.badness * (1.0 - _SLACK):
            self.design = Design(
                combination=pick,
                numbers=tuple(done.x.tolist()),
                pool=done.solution.active,
                badness=badness,
                elasticity=self._elasticity(done),
                converged=done.converged,
            )
        return True

    def _elasticity(self, done: Exchanged) -> float | None:
        """From the multiplier of the limit that is held: d log(badness of y) / d log(badness of x), not above zero."""
        question = self._search.asked
        held = question.x_limit if self._push == question.y_limit else question.y_limit
        multiplier = abs(done.solution.limit_prices[held])
        if self._push == question.y_limit:
            return -multiplier
        return -1.0 / multiplier if multiplier > 1e-9 else None

    def average(self, near: Sequence[Design]) -> None:
        """Between two designs of one combination that are far apart there may be one better than from either."""
        if len(near) == 2 and near[0].combination == near[1].combination:
            one, other = (np.array(design.numbers) for design in near)
            if float(np.abs(one - other).max(initial=0.0)) > _APART:
                self.finish(near[0].combination, 0.5 * (one + other))

    def try_all(self, picks: Sequence[Combination]) -> None:
        """Bound the combinations that could still win, then finish them best first."""
        search = self._search
        bounds: list[tuple[float, int, Array]] = []
        if self.pool is None:
            return
        done = None if self.design is None else self.design.combination
        # The poses that hold the best design bound the others: fewer poses only make the bounds lower.
        pool = search.few_poses(self.pool if self.design is None else self.design.pool)
        for number, pick in enumerate(picks):
            if pick == done or search.bound_on(self._push, pick, self._held) >= self.badness:
                continue
            search.say(f"bounding combination {number + 1} of {len(picks)}", number / len(picks))
            result = self._bound(pick, pool)
            if result is not None:
                bounds.append((result[0], number, result[1]))
        bounds.sort(key=lambda entry: entry[:2])
        for done_of, (bound, number, start) in enumerate(bounds):
            if bound < self.badness:
                search.say("optimising the best combinations", done_of / len(bounds))
                if not self.finish(picks[number], start):
                    self.unsolved.add(picks[number])

    def link_by_link(self) -> None:
        """Change one link at a time until none improves."""
        improved = True
        while improved and self.design is not None:
            before = self.badness
            for link in range(self._search.problem.arm.size):
                self.try_all(one_link_changed(self._search.problem, self.design.combination, link))
            improved = self.badness < before * (1.0 - 1e-6)

    def polish(self) -> None:
        """Further starts for the best combination."""
        if self.design is None or len(self.design.numbers) < 2:
            return
        pick = self.design.combination
        for start in self._search.starts(pick, _STARTS):
            self._search.say("solving from further starts")
            self.finish(pick, start)
