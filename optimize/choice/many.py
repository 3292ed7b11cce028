"""The best of many combinations: those that their bounds leave in the running are solved, the most promising first.

Every combination solved raises the bounds of the others (`optimize.choice.bounds`); those whose bound is no better than
the best design are out without a solution of their own. Where there are too many for a bound each, all are bounded at
once (`at_once.branching`), and so they are where lengths are chosen. Where the model is no sum of products, play
depends on the design, or poses of a place in space turn with the lengths, nothing bounds them: they are then searched
link by link.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .at_once.branching import Branching, Proof
from .bounds import MOST_AT_ONCE, CombinationBounds, combination_bounds
from .chooser import Chooser
from .picks import Combination, count, uniform

CLOSE = 1e-4
"""A bound this near to the best design (relative) leaves nothing to win: the exchange's own gap."""
WANTED = 1e-2
"""The gap that is always worth more solutions."""
_MOST_CLOSING, _MOST_SOLVED = 200, 600
"""Combinations solved to close the gap wholly, and to bring it down to what is wanted."""
_LOOSE = 2e-3
"""A solution this far (relative) above its combination's bound can raise bounds."""


_MOST_PARTS, _MOST_PARTS_FREE = 40, 400
"""So many parts of all combinations are looked at where they are bounded at once; with lengths to choose."""


@dataclass(frozen=True)
class Among:
    """What is known of the combinations that were not solved: how much better (relative) one could be at most, None
    where nothing tells; and where all were bounded at once, the bound and what it came from."""

    gap: float | None
    proof: Proof | None = None
    branching: Branching | None = None


def among_many(chooser: Chooser) -> Among:
    """Look for the best of all combinations."""
    context = chooser.context
    problem = context.problem
    sums = (problem.arm.play == "worst" or not context.uses_error) and context.scenarios is None
    if problem.link_length is not None:
        # A pose of a place in space turns with the lengths.
        if sums and problem.workspace.kind == "joints":
            return _at_once(chooser, _MOST_PARTS_FREE)
    elif sums and count(problem) > MOST_AT_ONCE:
        return _at_once(chooser, _MOST_PARTS)
    gap = _one_by_one(chooser)
    return Among(gap if gap is not None and math.isfinite(gap) else None)


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
    ties = None if chooser.context.problem.link_length is not None else branching
    return Among(gap if math.isfinite(gap) else None, branching.proof(), ties)


def _one_by_one(chooser: Chooser) -> float | None:
    """Look for the best of all combinations, a bound for each; returns how much better (relative) one that was not
    solved could be, or None where nothing bounds them: they were then searched link by link.

    A combination at which the solver failed counts as not solved.
    """
    context = chooser.context
    bounds = combination_bounds(context)
    if bounds is None or _begin(chooser, bounds) is False:
        chooser.link_by_link()
        return None
    for number in range(_MOST_SOLVED):
        gap = _gap(chooser, bounds)
        running = ~bounds.closed & (bounds.bounds < chooser.objective * (1.0 - CLOSE))
        left = int(running.sum())
        if not left or (gap <= WANTED and number >= _MOST_CLOSING):
            return gap
        if chooser.progress is not None:
            told = "" if math.isinf(gap) else f", none more than {gap:.2%} better"
            chooser.progress(number, number + left, f"solving combinations{told}")
        place = np.unravel_index(int(np.argmin(np.where(running, bounds.bounds, np.inf))), running.shape)
        _solve(chooser, bounds, bounds.combination([int(k) for k in place]))
    chooser.link_by_link()
    return _gap(chooser, bounds)


def possible(chooser: Chooser, picks: list[Combination]) -> list[Combination]:
    """The combinations that may keep the limits: where none in which the links agree does, the multipliers of the least
    relaxation of one prove others impossible as well, which are noted as infeasible."""
    problem = chooser.context.problem
    bounds: CombinationBounds | None = None
    for pick in uniform(problem):
        if bounds is not None and bounds.impossible[bounds.place(pick)]:
            continue
        solved = chooser.solve(pick, explain=True)
        if solved.objective is not None:
            break
        if solved.relaxed is not None:
            bounds = bounds or combination_bounds(chooser.context)
            if bounds is None:
                break
            bounds.learn(solved.exchange, solved.relaxed, solved.materials, pick, solved.pool, relaxed=True)
    chooser.pool = None
    if bounds is None:
        return picks
    left = [pick for pick in picks if not bounds.impossible[bounds.place(pick)]]
    for pick in picks:
        if bounds.impossible[bounds.place(pick)]:
            chooser.note_infeasible(pick)
    return left


def _gap(chooser: Chooser, bounds: CombinationBounds) -> float:
    """How much better than the best design (relative) a combination that was not solved could be."""
    least = float(np.where(bounds.impossible, np.inf, bounds.bounds).min())
    if least == math.inf:
        return 0.0
    if math.isinf(chooser.objective):
        return math.inf
    return max(0.0, 1.0 - least / chooser.objective)


def _begin(chooser: Chooser, bounds: CombinationBounds) -> bool | None:
    """Solve a first combination; False where it raises no bound: there is no such sum for this model. None where no
    combination in which the links agree has a solution."""
    starts = [pick for pick in uniform(chooser.context.problem) if not bounds.impossible[bounds.place(pick)]]
    for pick in starts:
        if pick in chooser.candidates or bounds.impossible[bounds.place(pick)]:
            continue
        learnt = _solve(chooser, bounds, pick)
        if learnt is not None:
            return learnt
    return None


def _solve(chooser: Chooser, bounds: CombinationBounds, pick: Combination) -> bool | None:
    """Solve a combination, with an exchange where it could win; whether bounds could be raised by it, None where it has
    no solution that could."""
    place = bounds.place(pick)
    known = float(bounds.bounds[place])
    solved = chooser.solve(pick, explain=True)
    bounds.closed[place] = True
    if solved.objective is None or solved.solution is None:
        if solved.relaxed is not None:
            bounds.impossible[place] = True
            bounds.learn(solved.exchange, solved.relaxed, solved.materials, pick, solved.pool, relaxed=True)
        return None
    learnt = True
    if known < solved.objective * (1.0 - _LOOSE):
        learnt = bounds.learn(solved.exchange, solved.solution, solved.materials, pick, solved.pool, relaxed=False)
    bounds.bounds[place] = max(float(bounds.bounds[place]), solved.objective)
    if solved.objective < chooser.objective:
        chooser.finish(pick, solved.solution.x)
        candidate = chooser.candidates[pick]
        if candidate.objective is not None:
            bounds.bounds[place] = max(float(bounds.bounds[place]), candidate.objective)
        bounds.impossible[place] = candidate.outcome == "infeasible"
    return learnt
