"""Which shape and material each link should have: every combination up to a thousand, else a search link by link.

The binding poses of one combination serve all others. A combination whose best design for those poses alone is already
worse than a finished one needs no exchange of its own: it is bounded out.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from materials.material import Material

from .design import DesignSpace, design_space, material_row, starting_points
from .exchange import Context, Exchange, Exchanged, first_pool, objective_of
from .pool import Pool
from .problem import Problem
from .result import Candidate, Iteration

Array = NDArray[np.float64]
Progress = Callable[[int, int, str], None]
"""(combinations done, combinations in all, what is being done)"""

MOST_COMBINATIONS = 1000
"""Up to this many combinations every one is tried."""
_FINAL_STARTS = 5


@dataclass(frozen=True)
class Combination:
    """A shape and a material for each link; None for links that are rigid."""

    shapes: tuple[str | None, ...]
    materials: tuple[Material | None, ...]


@dataclass(frozen=True)
class Choice:
    """The best combination, its finished exchange and objective (SI), and what became of the others."""

    combination: Combination
    space: DesignSpace
    materials: Array
    exchange: Exchange
    exchanged: Exchanged
    objective: float
    candidates: tuple[Candidate, ...]
    exhaustive: bool
    history: tuple[Iteration, ...]


def options(problem: Problem) -> tuple[list[tuple[str | None, ...]], list[tuple[Material | None, ...]]]:
    """The shapes and the materials that each link may have."""
    shapes: list[tuple[str | None, ...]] = []
    materials: list[tuple[Material | None, ...]] = []
    for link in problem.arm.links:
        if link.section is None:
            shapes.append((None,))
            materials.append((None,))
        else:
            shapes.append(problem.shapes or (link.section.shape,))
            materials.append(problem.materials or (link.material,))
    return shapes, materials


def _agreeing(picks: Iterable[tuple[object, ...]], same: bool) -> list[tuple[object, ...]]:
    """The picks in which all links that have a choice agree, where they must."""
    return [pick for pick in picks if not same or len({item for item in pick if item is not None}) <= 1]


def combinations(problem: Problem) -> list[Combination]:
    """Every allowed combination."""
    shapes, materials = options(problem)
    shape_picks = _agreeing(itertools.product(*shapes), "section" in problem.same or "size" in problem.same)
    material_picks = _agreeing(itertools.product(*materials), "material" in problem.same)
    return [Combination(s, m) for s in shape_picks for m in material_picks]  # type: ignore[arg-type]


def count(problem: Problem) -> int:
    """How many combinations there are, without listing them."""
    total = 1
    for picks, same in zip(
        options(problem), ("section" in problem.same or "size" in problem.same, "material" in problem.same), strict=True
    ):
        sizes = [len(pick) for pick in picks]
        total *= max(sizes) if same else math.prod(sizes)
    return total


class Chooser:
    """Works through combinations with one pool of poses and one incumbent."""

    def __init__(
        self,
        context: Context,
        progress: Progress | None,
        log: Callable[[Iteration], None] | None,
        known: float = math.inf,
    ) -> None:
        """`known`: an objective (SI) that is reached without these combinations; what cannot beat it is given up."""
        self.context, self.progress, self.known = context, progress, known
        self.history: list[Iteration] = []
        self._listener = log
        self.pool: Pool | None = None
        self.best: tuple[Combination, DesignSpace, Array, Exchange, Exchanged, float] | None = None
        self.candidates: dict[Combination, Candidate] = {}
        self._exchanges: dict[tuple[str | None, ...], Exchange] = {}

    @property
    def objective(self) -> float:
        """The best objective so far (SI)."""
        return self.known if self.best is None else self.best[5]

    def try_all(self, picks: list[Combination]) -> None:
        """Bound every combination on the pool, then finish them best first until the rest is bounded out."""
        bounds: list[tuple[float, int, Array]] = []
        if self.pool is None:
            self._first(picks)
        for number, pick in enumerate(picks):
            if pick in self.candidates:
                continue
            if self.progress is not None:
                self.progress(number, len(picks), "bounding combinations")
            found = self._bound(pick)
            if found is None:
                self._note(pick, None, "infeasible")
            else:
                bounds.append((found[0], number, found[1]))
        bounds.sort(key=lambda entry: entry[:2])
        for done, (bound, number, start) in enumerate(bounds):
            if self.progress is not None:
                self.progress(done, len(bounds), "finishing the best")
            if bound >= self.objective:
                self._note(picks[number], bound, "bounded out")
            else:
                self._finish(picks[number], start)

    def _first(self, picks: list[Combination]) -> None:
        """Finish the first feasible combination: the poses that hold it are what the others are bounded with."""
        for pick in picks:
            exchange = self._exchange(pick.shapes)
            materials = material_row(pick.materials, self.context.problem)
            for start in starting_points(exchange.space, materials, 2):
                self.pool = first_pool(self.context, exchange.space, start, pick.materials)
                if exchange.bound(materials, self.pool, start) is None:
                    continue
                self._finish(pick, start)
                if self.best is not None:
                    self.pool = self.best[4].solution.active
                if pick in self.candidates and self.candidates[pick].outcome != "infeasible":
                    return
            self._note(pick, None, "infeasible")

    def polish(self) -> None:
        """Further starts for the best combination: a better local optimum replaces it."""
        if self.best is None:
            return
        pick, space, materials, _, _, _ = self.best
        start_count = _FINAL_STARTS if len(space.variables) > 1 else 1
        for number, start in enumerate(starting_points(space, materials, start_count)):
            if self.progress is not None:
                self.progress(number, start_count, "further starts")
            self._finish(pick, start)

    def _exchange(self, shapes: tuple[str | None, ...]) -> Exchange:
        if shapes not in self._exchanges:
            if len(self._exchanges) > 1:
                self._exchanges.pop(next(iter(self._exchanges)))  # compiled programs are large
            self._exchanges[shapes] = Exchange(self.context, design_space(self.context.problem, shapes))
        return self._exchanges[shapes]

    def _bound(self, pick: Combination) -> tuple[float, Array] | None:
        exchange = self._exchange(pick.shapes)
        materials = material_row(pick.materials, self.context.problem)
        assert self.pool is not None
        for start in starting_points(exchange.space, materials, 2):
            found = exchange.bound(materials, self.pool, start)
            if found is not None:
                return found[1], found[0].x
        return None

    def _finish(self, pick: Combination, start: Array) -> None:
        assert self.pool is not None
        exchange = self._exchange(pick.shapes)
        materials = material_row(pick.materials, self.context.problem)
        done = exchange.run(materials, pick.materials, self.pool, start, give_up_above=self.objective, log=self._heard)
        if done is None:
            if pick not in self.candidates:
                self._note(pick, None, "infeasible")
            return
        self.pool = self.pool.joined(done.solution.active)
        program = exchange.program(done.pool)
        error = done.solution.error if done.worst is None else done.worst.error
        objective = objective_of(self.context, program, done.x, materials, error)
        if done.bounded_out:
            if pick not in self.candidates:
                self._note(pick, objective, "bounded out")
            return
        if pick not in self.candidates or objective < (self.candidates[pick].objective or math.inf):
            self._note(pick, objective, "solved")
        if objective < self.objective * (1.0 - 1e-7):
            self.best = (pick, exchange.space, materials, exchange, done, objective)

    def _heard(self, iteration: Iteration) -> None:
        """Exchanges of one choice after another make one log, numbered through."""
        self.history.append(replace(iteration, number=len(self.history) + 1))
        if self._listener is not None:
            self._listener(self.history[-1])

    def _note(self, pick: Combination, objective: float | None, outcome: str) -> None:
        names = tuple(None if material is None else material.name for material in pick.materials)
        self.candidates[pick] = Candidate(pick.shapes, names, objective, outcome)  # type: ignore[arg-type]


def choose(
    context: Context,
    *,
    progress: Progress | None = None,
    log: Callable[[Iteration], None] | None = None,
    known: float = math.inf,
) -> Choice | None:
    """The best combination of shapes and materials; None where none has a solution (better than `known`, SI)."""
    problem = context.problem
    chooser = Chooser(context, progress, log, known)
    exhaustive = count(problem) <= MOST_COMBINATIONS
    if exhaustive:
        chooser.try_all(combinations(problem))
    else:
        _link_by_link(problem, chooser)
    chooser.polish()
    if chooser.best is None:
        return None
    pick, space, materials, exchange, exchanged, objective = chooser.best
    noted: list[Candidate] = []
    for other, candidate in chooser.candidates.items():
        outcome = "best" if other == pick else candidate.outcome
        value = objective if other == pick else candidate.objective
        noted.append(Candidate(candidate.shapes, candidate.materials, value, outcome))
    noted.sort(key=_rank)
    return Choice(pick, space, materials, exchange, exchanged, objective, tuple(noted), exhaustive,
    tuple(chooser.history))


def _rank(candidate: Candidate) -> float:
    return math.inf if candidate.objective is None else candidate.objective


def uniform(problem: Problem) -> list[Combination]:
    """The combinations in which all links that can agree do."""
    shapes, materials = options(problem)
    kinds = list(dict.fromkeys(itertools.chain.from_iterable(shapes)))
    stuffs = list(dict.fromkeys(itertools.chain.from_iterable(materials)))
    found = [
        Combination(
            tuple(shape if shape in own else next(iter(own)) for own in shapes),
            tuple(material if material in own else next(iter(own)) for own in materials),
        )
        for shape in kinds
        for material in stuffs
    ]
    return list(dict.fromkeys(found))


def one_link_changed(problem: Problem, pick: Combination, link: int) -> list[Combination]:
    """The combinations that differ from one in a link (from 0), or in all links where they must agree."""
    shapes, materials = options(problem)
    trials: list[Combination] = []
    for shape, material in itertools.product(shapes[link], materials[link]):
        new_shapes = tuple(shape if k == link else own for k, own in enumerate(pick.shapes))
        new_materials = tuple(material if k == link else own for k, own in enumerate(pick.materials))
        if "section" in problem.same or "size" in problem.same:
            new_shapes = tuple(shape if own is not None else None for own in pick.shapes)
        if "material" in problem.same:
            new_materials = tuple(material if own is not None else None for own in pick.materials)
        trials.append(Combination(new_shapes, new_materials))
    return list(dict.fromkeys(trials))


def _link_by_link(problem: Problem, chooser: Chooser) -> None:
    """Coordinate search: the best combination in which all links agree, then one link at a time until none improves."""
    chooser.try_all(uniform(problem))
    improved = True
    while improved and chooser.best is not None:
        before = chooser.objective
        for link in range(problem.arm.size):
            trials = one_link_changed(problem, chooser.best[0], link)
            chooser.try_all([trial for trial in trials if trial not in chooser.candidates])
        improved = chooser.objective < before * (1.0 - 1e-6)
