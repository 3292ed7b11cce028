"""The best of many combinations: those that their bounds do not exclude are solved, the most promising first.

Every combination solved raises the bounds of the others (`optimize.choice.bounding`); those whose bound is no better
than the best design are out without a separate solution. Where there are too many for a bound each, all are bounded at
once (`at_once.branching`), and so they are where lengths are chosen. Where the model is no sum of products, play
depends on the design, or poses of a place in space turn with the lengths, nothing bounds them: they are then searched
link by link; and so they are where tapers or counterweights are chosen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from linkwright.core.optimize.choice.bounding import CombinationBounds, combination_bounds

from .at_once.branching import Branching, Proof
from .at_once.feasibility import MOST_AT_ONCE, feasibility_of
from .chooser import Chooser, Solved
from .picks import Combination, count, uniform

CLOSE = 1e-4
"""A bound this near to the best design (relative) leaves nothing to win: the exchange's gap."""
NEAR = 0.03
"""How far (relative) from the best objective a combination counts as a near tie."""
WANTED = 1e-2
"""The gap that is always worth more solutions."""
_MOST_CLOSING, _MOST_SOLVED = 200, 600
"""Combinations solved to close the gap wholly, and to bring it down to what is wanted."""
_LOOSE = 2e-3
"""A solution this far (relative) above its combination's bound can raise bounds."""


_MOST_PARTS, _MOST_PARTS_FREE = 120, 400
"""So many parts of all combinations are looked at where they are bounded at once; with lengths to choose."""


@dataclass(frozen=True)
class Among:
    """Bounds on the combinations that were not solved: how much better (relative) than the incumbent one could be,
    those on which the solver failed left out, None where it is unknown; where all were bounded at once, that bound and
    its origin; else the bound of each combination."""

    gap: float | None
    proof: Proof | None = None
    branching: Branching | None = None
    bounds: CombinationBounds | None = None

    def gap_of(self, objective: float) -> float | None:
        """How much better than an objective (SI) that was reached since one could be at most."""
        if self.gap is None or self.proof is None or not math.isfinite(self.proof.bound):
            return self.gap
        return min(self.gap, max(0.0, 1.0 - self.proof.bound / objective))

    @property
    def bounded(self) -> bool:
        """Whether anything tells which combinations come near the best."""
        return self.branching is not None or self.bounds is not None


def among_many(chooser: Chooser) -> Among:
    """Look for the best of all combinations."""
    context = chooser.context
    problem = context.problem
    sums = (problem.arm.play == "worst" or not context.uses_error) and context.scenarios is None
    if problem.free_tapers or problem.balances:
        chooser.link_by_link()
        return Among(None)
    if problem.free_lengths:
        # A pose of a place in space turns with the lengths.
        if sums and not problem.workspace.in_space:
            return _at_once(chooser, _MOST_PARTS_FREE)
    elif sums and count(problem) > MOST_AT_ONCE:
        return _at_once(chooser, _MOST_PARTS)
    chooser.feasibility = chooser.feasibility or feasibility_of(context)
    bounds = combination_bounds(problem, chooser.feasibility)
    gap = _one_by_one(chooser, bounds)
    return Among(gap if gap is not None and math.isfinite(gap) else None, bounds=None if gap is None else bounds)


def _at_once(chooser: Chooser, most: int) -> Among:
    """Bound all combinations at once, in so many parts at most, and solve those that a bound points at."""
    branching = Branching(chooser, WANTED)
    proof = branching.run(most)
    if proof is None or (chooser.best is None and proof.bound < math.inf):
        chooser.link_by_link()
    if proof is None:
        return Among(None)
    gap = branching.gap
    # With lengths to choose each near tie takes seconds.
    ties = None if chooser.context.problem.free_lengths else branching
    return Among(gap if math.isfinite(gap) else None, branching.proof(), ties)


def _one_by_one(chooser: Chooser, bounds: CombinationBounds | None) -> float | None:
    """Look for the best of all combinations, a bound for each; returns how much better (relative) one that was not
    solved could be, or None where nothing bounds them: they were then searched link by link.

    Combinations on which the solver failed, and that their bounds do not exclude, are noted as unsolved; the figure is
    of the others.
    """
    if bounds is None or _begin(chooser, bounds) is False:
        chooser.link_by_link()
        return None
    for number in range(_MOST_SOLVED):
        gap = _gap(chooser, bounds)
        running = ~bounds.closed & (bounds.bounds < chooser.objective * (1.0 - CLOSE))
        left = int(running.sum())
        if not left or (gap <= WANTED and number >= _MOST_CLOSING):
            return _settled(chooser, bounds)
        if chooser.progress is not None:
            gap_text = "" if math.isinf(gap) else f", none more than {gap:.2%} better"
            chooser.progress(number, number + left, f"solving combinations{gap_text}")
        # What has no bound tells nothing of where the best is.
        finite = running & np.isfinite(bounds.bounds)
        place = np.argmin(np.where(finite, bounds.bounds, np.inf)) if finite.any() else np.argmax(running)
        _solve(
            chooser, bounds, bounds.options.combination([int(k) for k in np.unravel_index(int(place), running.shape)])
        )
    chooser.link_by_link()
    return _settled(chooser, bounds)


def _settled(chooser: Chooser, bounds: CombinationBounds) -> float:
    """The gap at the end, when it is known which of the combinations on which the solver failed are excluded."""
    for place in np.argwhere(bounds.unsolved).tolist():
        bound = float(bounds.bounds[tuple(place)])
        if bound >= chooser.objective * (1.0 - CLOSE):
            chooser.note(bounds.options.combination(place), bound, "bounded out")
    return _gap(chooser, bounds)


def possible(chooser: Chooser, picks: list[Combination]) -> list[Combination]:
    """The combinations that may keep the limits: where none in which the links agree does, what they show rules out
    others as well, which are noted as infeasible. One that was seen to keep them comes first."""
    first: list[Combination] = []
    for pick in uniform(chooser.context.problem):
        solved = chooser.solve_unless_ruled_out(pick)
        if solved is not None and (solved.objective is not None or chooser.feasibility is None):
            first = [pick]
            break
    chooser.pool = None
    left = [pick for pick in picks if not chooser.ruled_out(pick)]
    return [*(pick for pick in first if pick in left), *(pick for pick in left if pick not in first)]


def _gap(chooser: Chooser, bounds: CombinationBounds) -> float:
    """How much better than the best design (relative) a combination that was not solved could be, but for those on
    which the solver failed."""
    least = float(np.where(bounds.impossible | bounds.unsolved, np.inf, bounds.bounds).min())
    if least == math.inf:
        return 0.0
    if math.isinf(chooser.objective):
        return math.inf
    return max(0.0, 1.0 - least / chooser.objective)


def _begin(chooser: Chooser, bounds: CombinationBounds) -> bool | None:
    """Solve a first combination; False where it raises no bound: there is no such sum for this model. None where no
    combination in which the links agree has a solution."""
    starts = [pick for pick in uniform(chooser.context.problem) if not bounds.impossible[bounds.options.place(pick)]]
    for pick in starts:
        if pick in chooser.candidates or bounds.impossible[bounds.options.place(pick)]:
            continue
        learnt = _solve(chooser, bounds, pick)
        if learnt is not None:
            return learnt
    return None


def _solve(chooser: Chooser, bounds: CombinationBounds, pick: Combination) -> bool | None:
    """Solve a combination, with an exchange where it could win; whether bounds could be raised by it, None where it has
    no solution that could."""
    solved = chooser.solve(pick, explain=True)
    learnt = learn_from(bounds, pick, solved, chooser.objective * (1.0 + NEAR))
    if solved.objective is None or solved.solution is None:
        return None
    if solved.objective < chooser.objective:
        place = bounds.options.place(pick)
        chooser.finish(pick, solved.solution.x)
        candidate = chooser.candidates[pick]
        if candidate.objective is not None:
            bounds.bounds[place] = max(float(bounds.bounds[place]), candidate.objective)
        bounds.impossible[place] = candidate.outcome == "infeasible"
    return learnt


def learn_from(bounds: CombinationBounds, pick: Combination, solved: Solved, enough: float) -> bool | None:
    """Raise the bounds by what a combination came to, of combinations whose bound is below `enough` (SI); whether they
    could be, None where it has no solution that could."""
    place = bounds.options.place(pick)
    known = float(bounds.bounds[place])
    bounds.closed[place] = True
    if solved.objective is None or solved.solution is None:
        if solved.relaxed is not None:
            bounds.impossible[place] = True
            bounds.rule_out(solved.exchange, solved.relaxed, pick, solved.pool)
        bounds.unsolved[place] = solved.unsolved
        return None
    learnt = True
    if known < solved.objective * (1.0 - _LOOSE):
        learnt = bounds.learn(solved.exchange, solved.solution, pick, solved.objective, enough)
    bounds.bounds[place] = max(float(bounds.bounds[place]), solved.objective)
    return learnt
