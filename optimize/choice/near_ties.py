"""The combinations that come within a few per cent of the best, each solved to the end, so that none is passed over for
a difference that no workshop sees."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from arm.chain.chain import Arm
from optimize.exchange.design import arm_of

from .at_once.branching import Branching
from .chooser import Chooser
from .picks import Combination

NEAR = 0.03
"""How far (relative) from the best objective a combination counts as a near tie."""
MOST_SOLVED = 24
"""So many are solved to the end."""
_MOST_TRIED = 150
"""So many are solved for the binding poses alone, to see whether they come near."""


@dataclass(frozen=True)
class Tie:
    """A combination solved to the end: its objective (SI) and its arm."""

    combination: Combination
    objective: float
    arm: Arm


@dataclass(frozen=True)
class Ties:
    """The near ties, best first (the best itself left out), and how many more could be that were not solved.

    `all_solved`: every combination that its bound lets come as near was solved, so that none other is better.
    """

    solved: tuple[Tie, ...] = ()
    left: int = 0
    all_solved: bool = False


def near_ties(chooser: Chooser, branching: Branching | None) -> Ties:
    """Solve what could be within `NEAR` of the best; `branching` bounds combinations that were not looked at alone.

    A combination that turns out better than the best takes its place.
    """
    found: dict[Combination, tuple[float, Arm]] = {}
    left = tried = 0
    failed = False
    for pick, more in _promising(chooser, branching):
        if len(found) >= MOST_SOLVED or tried >= _MOST_TRIED:
            left = more + 1
            break
        if chooser.best is None or pick == chooser.best[0]:
            continue
        tried += 1
        if chooser.progress is not None:
            chooser.progress(len(found), len(found) + 1 + min(more, MOST_SOLVED), "solving near ties")
        limit = chooser.objective * (1.0 + NEAR)
        solved = chooser.solve(pick)
        if solved.objective is None or solved.solution is None:
            failed = failed or chooser.candidates[pick].outcome == "unsolved"
            continue
        if solved.objective > limit:
            chooser.note(pick, solved.objective, "bounded out")
            continue
        done = chooser.finish(pick, solved.solution.x, above=limit)
        objective = chooser.candidates[pick].objective
        if done is not None and not done.bounded_out and objective is not None:
            space = solved.exchange.space
            found[pick] = (objective, arm_of(space, done.x, pick.materials))
    best = chooser.best
    limit = chooser.objective * (1.0 + NEAR)
    ties = [
        Tie(pick, objective, arm)
        for pick, (objective, arm) in found.items()
        if objective <= limit and best is not None and pick != best[0]
    ]
    return Ties(tuple(sorted(ties, key=lambda each: each.objective)), left, left == 0 and not failed)


def _promising(chooser: Chooser, branching: Branching | None) -> Iterator[tuple[Combination, int]]:
    """Combinations that could be near ties, the most promising first, each with how many more there are."""
    limit = chooser.objective * (1.0 + NEAR)
    if branching is not None:
        yield from branching.within(limit)
        return
    near = [
        (each.objective, number, pick)
        for number, (pick, each) in enumerate(chooser.candidates.items())
        if each.objective is not None and each.objective <= limit
    ]
    for number, (_, _, pick) in enumerate(sorted(near, key=lambda each: each[:2])):
        yield pick, len(near) - 1 - number
