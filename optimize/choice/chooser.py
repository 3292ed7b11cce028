"""Combinations of shapes and materials worked through with one pool of poses and one best design.

The binding poses of one combination serve all others. A combination whose best design for those poses alone is already
worse than a finished one needs no exchange of its own: it is bounded out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.executors import Executor
from linkwright.core.materials.material import Material
from linkwright.core.optimize.choice.pose_products import one_signed
from linkwright.core.optimize.exchange.assembled import Compiled
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.design import (
    DesignSpace,
    arm_of,
    design_space,
    material_row,
    numeric_beams,
    starting_points,
)
from linkwright.core.optimize.exchange.exchange import GAINED, Context, Exchange, Exchanged, first_pool
from linkwright.core.optimize.exchange.program import Solution
from linkwright.core.optimize.exchange.rescue import breaks_limits
from linkwright.core.optimize.result import Candidate, Iteration

from .at_once.feasibility import Feasibility, feasibility_of
from .bounding import Bounded, bound_all, bounding
from .picks import Combination, one_link_changed, uniform
from .solution_cache import Answer, Ended, Solutions, key_of

Array = NDArray[np.float64]
Progress = Callable[[int, int, str], None]
"""(combinations done, combinations in all, what is being done)"""

_KEPT = 2
"""Compiled programs are large: so many are kept."""


Known = TypeVar("Known", Answer, Ended)
Best = tuple[Combination, DesignSpace, Array, Exchange, Exchanged, float]
"""A combination with its space and its materials' row, the exchange and how it ended, and the objective (SI)."""


@dataclass(frozen=True)
class Solved:
    """A combination solved for the pool alone: its objective (SI) and solution, both None where it has none; `relaxed`
    is then the solution in which limits give way as little as they must, where they have to."""

    exchange: Exchange
    materials: Array
    pool: Pool
    objective: float | None
    solution: Solution | None
    relaxed: Solution | None = None
    unsolved: bool = False
    """Whether the solver failed, which proves nothing."""


class Chooser:
    """Works through combinations with one pool of poses and one incumbent."""

    def __init__(
        self,
        context: Context,
        progress: Progress | None,
        log: Callable[[Iteration], None] | None,
        known: float = math.inf,
        executor: Executor | None = None,
        solutions: Solutions | None = None,
    ) -> None:
        """`known`: an objective (SI) that is reached without these combinations; what cannot beat it is given up.
        `executor` bounds combinations; without one this process does. `solutions` answers what it knows and notes what
        is found."""
        self._solutions = Solutions() if solutions is None else solutions
        self._arm = arm_to_yaml(context.problem.arm)
        self._executor, self._bounding = executor, bounding(context.problem)
        self.context, self.progress, self.known = context, progress, known
        self.history: list[Iteration] = []
        self._listener = log
        self.pool: Pool | None = None
        self.best: Best | None = None
        self.candidates: dict[Combination, Candidate] = {}
        self.kept = _KEPT
        self.feasibility: Feasibility | None = None
        """What rules out combinations, from the first on that cannot keep the limits."""
        self._compiled = Compiled()
        self._exchanges: dict[tuple[str | None, ...], Exchange] = {}
        self._rows: dict[tuple[Material | None, ...], Array] = {}

    @property
    def objective(self) -> float:
        """The best objective so far (SI)."""
        return self.known if self.best is None else self.best[5]

    def try_all(self, picks: list[Combination]) -> None:
        """Bound every combination on the pool, then finish them best first until the rest is bounded out."""
        bounds: list[tuple[float, int, Array]] = []
        if self.pool is None:
            self._first(picks)
        if self._executor is not None:
            bounds = self._bounded(self._executor, picks)
        for number, pick in enumerate(picks if self._executor is None else []):
            if pick in self.candidates:
                continue
            if self.progress is not None:
                self.progress(number, len(picks), "bounding combinations")
            result = self.solve_unless_ruled_out(pick)
            if result is not None and result.objective is not None and result.solution is not None:
                bounds.append((result.objective, number, result.solution.x))
        bounds.sort(key=lambda entry: entry[:2])
        for done, (bound, number, start) in enumerate(bounds):
            if self.progress is not None:
                self.progress(done, len(bounds), "optimising the best of them")
            if bound >= self.objective:
                self.note(picks[number], bound, "bounded out")
            else:
                self.finish(picks[number], start)

    def _bounded(self, executor: Executor, picks: list[Combination]) -> list[tuple[float, int, Array]]:
        """The bound of each combination that has one, its number and where it was found, by an executor."""
        left = [(number, pick) for number, pick in enumerate(picks) if pick not in self.candidates]
        if not left or self.pool is None:
            return []
        keys = {pick: self._key("bound", pick) for _, pick in left}
        bounded: dict[Combination, Bounded] = {
            pick: self._solutions[key] for pick, key in keys.items() if key in self._solutions
        }
        known = len(bounded)

        def notify(done: int) -> None:
            if self.progress is not None:
                self.progress(known + done, len(left), "bounding combinations")

        def keep(pick: Combination, bound: Bounded) -> None:
            bounded[pick] = self._solutions[keys[pick]] = bound

        fresh = [pick for _, pick in left if pick not in bounded]
        bound_all(executor, self._bounding, fresh, self.pool, notify, keep)
        bounds: list[tuple[float, int, Array]] = []
        for number, pick in left:
            answer = bounded[pick]
            if answer.objective is None:
                self.note(pick, None, answer.outcome)
            else:
                bounds.append((answer.objective, number, np.array(answer.x)))
        return bounds

    def _first(self, picks: list[Combination]) -> None:
        """Finish the first feasible combination: the poses that hold it are what the others are bounded with."""
        for pick in picks:
            if self.ruled_out(pick):
                continue
            if self._some_infeasible:
                # Poses of its own take long to find: those of one that fails are enough to see that others do.
                solved = self.solve_unless_ruled_out(pick)
                if solved is None or (solved.solution is None and not solved.unsolved):
                    continue
            exchange = self.exchange(pick.shapes)
            materials = self.materials(pick)
            unsolved = False
            for start in starting_points(exchange.space, materials, 2):
                self.pool = first_pool(self.context, exchange.space, start, pick.materials)
                alone = self._from(pick, exchange, materials, start)
                if alone.solution is None:
                    unsolved = unsolved or alone.unsolved
                    continue
                self.finish(pick, start)
                if self.best is not None:
                    self.pool = self.best[4].solution.active
                if pick in self.candidates and self.candidates[pick].objective is not None:
                    return
            if pick not in self.candidates:
                self.note(pick, None, "unsolved" if unsolved else "infeasible")
                if not unsolved and len(picks) > 1:
                    self.solve_unless_ruled_out(pick)

    def one_signed(self, *, everywhere: bool = False) -> bool:
        """Whether no terms of the error cancel at the poses that hold the best design, so that it has no pits; or
        `everywhere` that any design was held against. Not asked where scenarios count: no answer then claims it."""
        if self.best is None or not self.context.uses_error or self.context.scenarios is not None:
            return True
        pick, space, _, _, exchanged, _ = self.best
        p = self.beams(pick, space, exchanged.x)
        cuts = exchanged.solution.active.errors
        if everywhere and self.pool is not None:
            cuts = self.pool.errors
        return one_signed(self.context.model, cuts, p)

    def beams(self, pick: Combination, space: DesignSpace, x: Array) -> Array:
        """What the error model knows of the links of a design of a combination."""
        return numeric_beams(arm_of(space, x, pick.materials), self.context.problem.load_cases)

    def totals(self, pick: Combination, x: Array) -> tuple[float, float, float]:
        """Mass (kg), cost (EUR) and reach (m) of a combination's links for the optimiser's numbers."""
        assert self.pool is not None
        materials = self.materials(pick)
        return self.exchange(pick.shapes).program(self.pool).mass_cost_reach(x, materials)

    def materials(self, pick: Combination) -> Array:
        """What the programs know of a combination's materials, which many share."""
        if pick.materials not in self._rows:
            self._rows[pick.materials] = material_row(pick.materials, self.context.problem)
        return self._rows[pick.materials]

    def exchange(self, shapes: tuple[str | None, ...]) -> Exchange:
        """The exchange of combinations of these shapes, from those kept."""
        if shapes not in self._exchanges:
            if len(self._exchanges) >= self.kept:
                self._exchanges.pop(next(iter(self._exchanges)))
            space = design_space(self.context.problem, shapes)
            self._exchanges[shapes] = Exchange(self.context, space, self._compiled)
        return self._exchanges[shapes]

    def _known(
        self, what: str, pick: Combination, exchange: Exchange, given: tuple[Any, ...], solve: Callable[[], Known]
    ) -> tuple[Known, bool]:
        """What a combination came to for the poses known, and whether it was found now, not kept from before."""
        key = self._key(what, pick, *given, exchange.room)
        if key in self._solutions:
            answer = self._solutions[key]
            exchange.room = answer.room
            return answer, False
        answer = self._solutions[key] = solve()
        return answer, True

    def _key(self, what: str, pick: Combination, *given: object) -> Hashable:
        """Under what an answer for the poses known stands."""
        return key_of(self._arm, what, pick, self.pool, *given)

    def solve(self, pick: Combination, *, explain: bool = False) -> Solved:
        """A combination for the pool alone; with `explain` also how little the limits would have to give way."""
        exchange = self.exchange(pick.shapes)
        materials = self.materials(pick)
        starts = starting_points(exchange.space, materials, 2)
        pool = self.pool = self.pool or first_pool(self.context, exchange.space, starts[0], pick.materials)

        def answered() -> Answer:
            alone = _alone(exchange, materials, pool, starts, doubtful=self._some_infeasible)
            if not explain or alone.solution is not None or alone.unsolved or alone.relaxed is not None:
                return alone
            return replace(alone, relaxed=exchange.breach(materials, pool, starts[0]))

        answer, _ = self._known("solve", pick, exchange, (explain,), answered)
        if answer.solution is None:
            self.note(pick, None, "unsolved" if answer.unsolved else "infeasible")
        return Solved(exchange, materials, pool, answer.objective, answer.solution, answer.relaxed, answer.unsolved)

    def _from(self, pick: Combination, exchange: Exchange, materials: Array, start: Array) -> Answer:
        """What a combination comes to for the pool alone from one start."""
        pool = self.pool
        assert pool is not None

        def answered() -> Answer:
            return _alone(exchange, materials, pool, [start], doubtful=self._some_infeasible)

        return self._known("start", pick, exchange, (start,), answered)[0]

    @property
    def _some_infeasible(self) -> bool:
        """Whether a combination was seen to keep the limits nowhere, so that others may not either."""
        return any(candidate.outcome == "infeasible" for candidate in self.candidates.values())

    @property
    def undecided(self) -> bool:
        """Whether the solver failed on a combination that could be better for all that is known."""
        return any(candidate.outcome == "unsolved" for candidate in self.candidates.values())

    def ruled_out(self, pick: Combination) -> bool:
        """Whether others show that a combination cannot keep the limits; it is noted then."""
        out = self.feasibility is not None and self.feasibility.rules_out(pick)
        if out:
            self.note_infeasible(pick)
        return out

    def solve_unless_ruled_out(self, pick: Combination) -> Solved | None:
        """A combination for the pool alone, None where others show that it cannot keep the limits; where it cannot,
        others are ruled out by it."""
        if self.ruled_out(pick):
            return None
        solved = self.solve(pick, explain=True)
        if solved.relaxed is not None:
            self.feasibility = self.feasibility or feasibility_of(self.context)
            if self.feasibility is not None:
                self.feasibility.learn(solved.exchange, solved.relaxed, pick, solved.pool)
        return solved

    def finish(
        self, pick: Combination, start: Array, *, within: float | Array | None = None, above: float | None = None
    ) -> Exchanged | None:
        """The exchange of a combination from a start, unless it is given up: where it cannot beat the best so far, or
        an objective `above` that. The best design so far is kept; returns how the exchange ended, where it did."""
        assert self.pool is not None
        exchange = self.exchange(pick.shapes)
        materials = self.materials(pick)
        ended = self._ended(pick, exchange, materials, start, within, self.objective if above is None else above)
        done, objective = ended.done, ended.objective
        if done is None or objective is None:
            if pick not in self.candidates:
                # Lengths that lead nowhere say nothing of the others.
                self.note(pick, None, "infeasible" if ended.infeasible and not ended.unreachable else "unsolved")
            return None
        self.pool = self.pool.joined(done.solution.active)
        if done.bounded_out:
            if pick not in self.candidates:
                self.note(pick, objective, "bounded out")
            return None
        known = self.candidates.get(pick)
        # What it was bounded by, for fewer poses, is below what it comes to.
        if known is None or known.outcome != "solved" or objective < (known.objective or math.inf):
            self.note(pick, objective, "solved")
        if objective < self.objective * (1.0 - GAINED):
            self.best = (pick, exchange.space, materials, exchange, done, objective)
        return done

    def _ended(
        self,
        pick: Combination,
        exchange: Exchange,
        materials: Array,
        start: Array,
        within: float | Array | None,
        known: float,
    ) -> Ended:
        """How an exchange ends that is given up above what is known; as it ended before where that is kept."""
        pool = self.pool
        assert pool is not None
        rounds: list[Iteration] = []

        def heard(iteration: Iteration) -> None:
            rounds.append(iteration)
            self._heard(iteration)

        def run_exchange() -> Ended:
            done, objective, unreachable = None, None, False
            try:
                done = exchange.run(
                    materials, pick.materials, pool, start, give_up_above=known, log=heard, within=within
                )
            except Unreachable:
                unreachable = True
            if done is not None:
                solution, error = done.solution, done.solution.error if done.worst is None else done.worst.error
                known_worse = replace(solution, error=error)
                objective = exchange.objective(exchange.program(done.pool), known_worse, materials, self.context.aim)
            assert exchange.room is not None
            return Ended(exchange.room, done, objective, exchange.infeasible, unreachable, tuple(rounds))

        ended, fresh = self._known("finish", pick, exchange, (start, within, known), run_exchange)
        if not fresh:
            exchange.infeasible = ended.infeasible
            for item in ended.rounds:
                self._heard(item)
        return ended

    def _heard(self, iteration: Iteration) -> None:
        """Exchanges of one choice after another make one log, numbered through."""
        objective = self.context.problem.objective.badness(iteration.objective)
        self.history.append(replace(iteration, number=len(self.history) + 1, objective=objective))
        if self._listener is not None:
            self._listener(self.history[-1])

    def note(self, pick: Combination, objective: float | None, outcome: str) -> None:
        """Write down what became of a combination."""
        names = tuple(None if material is None else material.name for material in pick.materials)
        self.candidates[pick] = Candidate(pick.shapes, names, objective, outcome)  # type: ignore[arg-type]

    def note_infeasible(self, pick: Combination) -> None:
        """Note a combination that is known to keep the limits nowhere."""
        if pick not in self.candidates:
            self.note(pick, None, "infeasible")

    def link_by_link(self) -> None:
        """Coordinate search: the best combination in which all links agree, then one link at a time until none
        improves."""
        problem = self.context.problem
        self.try_all(uniform(problem))
        improved = True
        while improved and self.best is not None:
            before = self.objective
            for link in range(problem.arm.size):
                trials = one_link_changed(problem, self.best[0], link)
                self.try_all([trial for trial in trials if trial not in self.candidates])
            improved = self.objective < before * (1.0 - 1e-6)


def _alone(exchange: Exchange, materials: Array, pool: Pool, starts: Sequence[Array], *, doubtful: bool) -> Answer:
    """What a combination comes to for a pool alone, from one start after another until there is a solution.

    Where it is `doubtful` that there is one, it is asked first how little the limits must give way, from each start: a
    solver takes ten times as long to give up.
    """
    relaxed = None
    if doubtful:
        for start in starts:
            relaxed = exchange.breach(materials, pool, start)
            if not breaks_limits(relaxed):
                break
        else:
            assert exchange.room is not None
            return Answer(exchange.room, None, None, False, relaxed)
    result, unsolved = None, False
    for start in starts:
        result = exchange.bound(materials, pool, start)
        if result is not None:
            break
        unsolved = unsolved or not exchange.infeasible
    assert exchange.room is not None
    solution, objective = (None, None) if result is None else result
    return Answer(exchange.room, objective, solution, result is None and unsolved, None)
