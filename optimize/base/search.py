"""Where an arm's base stands, chosen with its design (`choose.base`).

Loads and errors of a pose do not depend on where the base is; which poses reach the places of the tip does. So each
place of the base is a problem of its own, and the best of those is sought in rounds: first with the design held, which
takes some poses of each place, then with a design for each place, along directions turned at random from
step to step (after C. Audet and J. E. Dennis, Mesh adaptive direct search algorithms for constrained optimization, SIAM
Journal on Optimization 17, 2006, 188-217, doi:10.1137/040603371), as a worst case has ridges that axes cannot follow.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm, FloatVector
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.arm.worst.coverage import unreached
from linkwright.core.arm.worst.parts import worst_search
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.core.optimize.choice.picks import count
from linkwright.core.optimize.nominal import Options
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.problem_summary import choices_in_words, map_of
from linkwright.core.optimize.reading.choices import LinkLists
from linkwright.core.optimize.result import BindingLimit, OptimizationResult
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import NoAnswer, format_quantity

from .read import AXES, based_at

Optimise = Callable[[Problem, Options], OptimizationResult]
Score = Callable[[Array], float]
"""Of a place of the base, its coordinates as shares of their ranges; less is better."""

_GRID = (25, 9, 5)
"""Places along each of one, two or three axes that are looked at with the arm as given."""
_BEGUN = 3
"""From so many of them, no neighbours, designs are begun."""
_APART = 0.25
_ROUNDS = 3
_HELD, _FREE = (0.1, 2e-4), (0.06, 4e-3)
"""The first and the last step with the design held, and with one for each place, as shares of the ranges."""
_BETTER = 1e-6
_FAR = 1.0
"""m; the error of a place of the base from which one of the tip is out of reach, without by how much."""
_POSES = 256
_AT_END = 1e-3
_PRICED = 0.01
"""The share of a range by which its end is moved to see what it is worth."""


@dataclass
class _Search:
    """Places of the base tried so far, with the best design."""

    problem: Problem
    optimise: Optimise
    options: Options
    best: OptimizationResult | None = None
    at: Array = field(default_factory=lambda: np.zeros(0))
    why: NoAnswer | None = None
    """Why the first place that was tried has no design."""
    tried: int = 0
    narrow: tuple[LinkLists, ...] | None = None
    """Each link's shape and material, once a design is known: others wait for the end of a round."""

    @property
    def axes(self) -> list[int]:
        """The axes (from 0) along which the base may move."""
        return [axis for axis, span in enumerate(self._spans) if any(span)]

    @property
    def _spans(self) -> tuple[tuple[float, float], ...]:
        assert self.problem.base is not None
        return self.problem.base

    def base(self, at: Array) -> FloatVector:
        """The base (m) for shares of the ranges."""
        shares = dict(zip(self.axes, at.tolist(), strict=True))
        x, y, z = (low + shares.get(axis, 0.0) * (high - low) for axis, (low, high) in enumerate(self._spans))
        return x, y, z

    def solved(self, at: Array) -> float:
        """The badness of the best design for a place, infinite where there is none; the best of all is kept. Raises
        `KeyboardInterrupt` where it was interrupted."""
        figure = self.problem.objective
        self.tried += 1
        if self.options.progress is not None:
            self.options.progress(0, 0, f"base at {in_mm(self.base(at))}")
        problem = replace(self.problem, arm=based_at(self.problem.arm, self.base(at)), base=None)
        if self.narrow is not None:
            problem = replace(problem, lists=self.narrow)
        try:
            result = self.optimise(problem, Options(executor=self.options.executor))
        except NoAnswer as error:
            self.why = self.why or error
            return math.inf
        if result.after.unreached is not None:
            self.why = self.why or NoAnswer(f"workspace: {result.after.unreached.where(self.problem.workspace.kind)}")
            return math.inf
        badness = figure.badness(result.objective)
        if self.best is None or badness < figure.badness(self.best.objective):
            self.best, self.at = result, at
        if result.interrupted:
            raise KeyboardInterrupt
        return badness

    def held_error(self, arm: Arm) -> Score:
        """The worst error (m) over some poses with a design held, by the place of its base."""
        cases, workspace = self.problem.load_cases, self.problem.workspace
        model, p = error_model(arm, cases), beam_values(beams_of(arm, cases))
        now = np.array(arm.joints[0].origin_translation) - self.problem.arm.joints[0].origin_translation

        def error(at: Array) -> float:
            shift = np.array(self.base(at)) - now
            points = tuple((x, y, z) for x, y, z in (np.array(workspace.points) - shift).tolist())
            search = worst_search(model, replace(workspace, points=points))
            try:
                if workspace.kind == "box":  # of which an evaluation takes what is reached
                    missed = unreached(search.workspace, lambda q: search.motion(q, p), search.lower, search.upper)
                    if missed is not None:
                        return _FAR + missed.missing
                q = search.poses(p, _POSES)
            except Unreachable as away:
                return _FAR + away.missing
            return max(float(search.errors(q, p, case).error.max()) for case in range(len(search.model.cases)))

        return error

    def run(self) -> None:
        """Look for the best place. Raises `NoAnswer` where none has a design, `KeyboardInterrupt` without any yet."""
        for start in self._begun():
            self.solved(start)
            self._narrow()
        if self.best is None:
            assert self.why is not None
            raise self.why
        for _ in range(_ROUNDS):
            self._narrow()
            self._alternate()
            descend(self.solved, self.at, self._badness, _FREE)
            self._alternate()
            if self.narrow is None:
                return
            before, self.narrow = self._badness, None
            narrowed, self.best = self.best, None
            self.solved(self.at)
            if self.best is None or self._badness >= before * (1.0 - _BETTER):
                self.best = self.best or narrowed
                return

    @property
    def _badness(self) -> float:
        assert self.best is not None
        return self.problem.objective.badness(self.best.objective)

    def _begun(self) -> Iterator[Array]:
        """The best places of a grid for the arm as given that are no neighbours, those out of reach last; then where
        the arm file has it, for no answer may be worse than that place gives."""
        error = self.held_error(self.problem.arm)
        steps = np.linspace(0.0, 1.0, _GRID[len(self.axes) - 1])
        grid = [np.array(at) for at in itertools.product(steps, repeat=len(self.axes))]
        places = sorted(((error(at), k) for k, at in enumerate(grid)))
        begun: list[Array] = []
        for score, k in places:
            at = grid[k]
            if score >= _FAR and not begun:
                at, _ = descend(error, at, score, _HELD)
            if len(begun) < _BEGUN and all(float(np.abs(at - other).max()) > _APART for other in begun):
                begun.append(at)
        spans = [self._spans[axis] for axis in self.axes]
        given = [low / (low - high) for low, high in spans if low <= 0.0 <= high]
        if len(given) == len(self.axes) and not any(np.allclose(given, at) for at in begun):
            begun.append(np.array(given))
        yield from begun

    def _narrow(self) -> None:
        """Keep to the shapes and materials of the best design so far."""
        problem = self.problem
        if self.best is None or problem.sizes is not None or problem.actuators or problem.motors or count(problem) == 1:
            return
        lists: list[LinkLists] = []
        for link in self.best.arm.links:
            section = link.section.near if isinstance(link.section, Tapered) else link.section
            shapes = None if section is None else (section.shape,)
            lists.append(LinkLists(shapes, None if link.material is None else (link.material,)))
        self.narrow = tuple(lists)

    def _alternate(self) -> None:
        """The best place for the design, the best design there, and so on while that is better."""
        improved = True
        while improved and self.best is not None:
            before, error = self._badness, self.held_error(self.best.arm)
            at, _ = descend(error, self.at, error(self.at), _HELD)
            improved = bool(np.any(at != self.at)) and self.solved(at) < before * (1.0 - 1e2 * _BETTER)

    def bounds(self) -> Iterator[BindingLimit]:
        """The ends of ranges at which the base stands, with what one millimetre more of them would change."""
        assert self.best is not None
        figure, best, at = self.problem.objective, self.best, self.at
        for number, axis in enumerate(self.axes):
            if min(at[number], 1.0 - at[number]) > _AT_END:
                continue
            low, high = self._spans[axis]
            upper = at[number] > 0.5
            inward = at.copy()
            inward[number] += -_PRICED if upper else _PRICED
            other = figure.badness(self.solved(inward))
            self.best, self.at = best, at
            change = (best.objective - other if upper else other - best.objective) * figure.factor
            price = change / (1e3 * _PRICED * (high - low))
            end = high if upper else low
            text = f"base {AXES[axis]} {'<=' if upper else '>='} {format_quantity(end, 'length')}"
            unit = f"{figure.unit}/mm" if figure.unit else "1/mm"
            yield BindingLimit("base", text, 1e3 * end, 1e3 * end, "mm", price, unit)


def descend(score: Score, at: Array, value: float, steps: tuple[float, float]) -> tuple[Array, float]:
    """A place from which no step (shares of the ranges; the first and the last) is better, and its score."""
    generator = np.random.default_rng(5)
    step, least = steps
    turn = np.eye(len(at))
    while step >= least:
        for direction in (*turn, *-turn):
            trial = np.clip(at + step * direction, 0.0, 1.0)
            other = score(trial) if np.any(trial != at) else value
            if other < value * (1.0 - _BETTER):
                at, value = trial, other
                break
        else:
            step *= 0.5
        turn = np.linalg.qr(generator.normal(size=(len(at), len(at))))[0]
    return at, value


def in_mm(base: FloatVector) -> str:
    """A place in words."""
    return f"({', '.join(f'{1e3 * item:.4g}' for item in base)}) mm"


def best_base(problem: Problem, options: Options, optimise: Optimise) -> OptimizationResult:
    """The best design with the best place of the base; `optimise` gives the best design of a place.

    An interrupt ends the search with the best so far. Raises `NoAnswer` where no place has a design.
    """
    began = time.perf_counter()
    before = _reaching(problem, problem.arm)
    if before is not None and options.begun is not None:
        options.begun(before)
    search, interrupted = _Search(problem, optimise, options), False
    bounds: tuple[BindingLimit, ...] = ()
    try:
        search.run()
        bounds = tuple(search.bounds())
    except KeyboardInterrupt:
        if search.best is None:
            raise
        interrupted = True
    best, base = search.best, search.base(search.at)
    assert best is not None
    start = best.start
    if before is None:
        start = f'the arm as given does not reach it all: "before" is that arm with its base at {in_mm(base)}'
    return replace(
        best,
        status="interrupted" if interrupted else best.status,
        interrupted=interrupted,
        choices=choices_in_words(problem),
        before=before or best.before,
        before_map=best.before_map if before is None else map_of(problem, before),
        start=start,
        lower_bound=best.objective if best.bound_of == "all_designs" else best.lower_bound,
        bound_of="binding_poses",
        optimum="local",
        binding=(*best.binding, *bounds),
        base=base,
        seconds=time.perf_counter() - began,
    )


def _reaching(problem: Problem, arm: Arm) -> Evaluation | None:
    """An arm's evaluation; None where it does not reach all of the workspace."""
    try:
        evaluation = evaluate(arm, problem.workspace, problem.load_cases)
    except Unreachable:
        return None
    return evaluation if evaluation.unreached is None else None
