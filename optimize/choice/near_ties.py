"""The combinations that come within a few per cent of the best, each solved to the end, so that none is passed over for
a difference that no workshop sees."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.optimize.choice.bounding import CombinationBounds
from linkwright.core.optimize.exchange.design import arm_of

from .chooser import Chooser
from .large_choice import NEAR, Among, learn_from
from .picks import Combination

MOST_SOLVED = 100
"""So many are solved to the end."""
_MOST_TRIED = 300
"""So many are solved for the binding poses alone, to see whether they come near."""
_IN_VAIN = 20
"""After so many that have no solution no more of millions are tried: each costs as much as several that have one."""


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
    `interrupted`: an interrupt ended the search for them; these were solved until then.
    """

    solved: tuple[Tie, ...] = ()
    left: int = 0
    all_solved: bool = False
    interrupted: bool = False


def near_ties(chooser: Chooser, among: Among | None) -> Ties:
    """Solve what could be within `NEAR` of the best; `among` bounds combinations that were not looked at alone, None
    where all were.

    A combination that turns out better than the best takes its place.
    """
    search = _Search(chooser, among)
    interrupted = False
    try:
        search.run()
    except KeyboardInterrupt:
        interrupted = True
    left = search.left()
    best = chooser.best
    limit = chooser.objective * (1.0 + NEAR)
    ties = [
        Tie(pick, objective, arm)
        for pick, (objective, arm) in search.solved.items()
        if objective <= limit and best is not None and pick != best[0]
    ]
    all_solved = left == 0 and not search.failed and not interrupted
    return Ties(tuple(sorted(ties, key=lambda tie: tie.objective)), left, all_solved, interrupted)


class _Search:
    def __init__(self, chooser: Chooser, among: Among | None) -> None:
        self.chooser, self.among = chooser, among
        self.solved: dict[Combination, tuple[float, Arm]] = {}
        self.failed = False
        self.tried = self._in_vain = 0
        self._promising = self._most_promising()

    @property
    def limit(self) -> float:
        """What a near tie reaches (SI)."""
        return self.chooser.objective * (1.0 + NEAR)

    def left(self) -> int:
        """How many more could come near that were not solved."""
        return next((more + 1 for _, more in self._promising), 0)

    def run(self) -> None:
        """Solve the most promising."""
        while self._in_vain < _IN_VAIN and self.tried < _MOST_TRIED and len(self.solved) < MOST_SOLVED:
            item = next(self._promising, None)
            if item is None:
                return
            self._solve(*item)

    def _solve(self, pick: Combination, more: int) -> None:
        chooser = self.chooser
        if chooser.best is None or pick == chooser.best[0]:
            return
        self.tried += 1
        if chooser.progress is not None:
            count = len(self.solved)
            chooser.progress(count, min(count + 1 + more, MOST_SOLVED), "solving near ties")
        branching = None if self.among is None else self.among.branching
        # A bound takes longer than a solution; only to find that there is none takes longer still.
        if branching is not None and self._in_vain and not branching.could_reach(pick, self.limit):
            return
        solved = chooser.solve(pick)
        if self.among is not None and self.among.bounds is not None:
            learn_from(self.among.bounds, pick, solved, self.limit)
        if solved.objective is None or solved.solution is None:
            self.failed = self.failed or chooser.candidates[pick].outcome == "unsolved"
            self._in_vain += branching is not None
            return
        if solved.objective > self.limit:
            chooser.note(pick, solved.objective, "bounded out")
            return
        done = chooser.finish(pick, solved.solution.x, above=self.limit)
        objective = chooser.candidates[pick].objective
        if done is not None and not done.bounded_out and objective is not None:
            space = solved.exchange.space
            self.solved[pick] = (objective, arm_of(space, done.x, pick.materials))

    def _most_promising(self) -> Iterator[tuple[Combination, int]]:
        """Combinations that could be near ties, the most promising first, each with how many more there are."""
        chooser = self.chooser
        if self.among is not None:
            if self.among.branching is not None:
                yield from self.among.branching.within(self.limit)
            if self.among.bounds is not None:
                yield from self._by_bounds(self.among.bounds)
            return
        near = [
            (candidate.objective, number, pick)
            for number, (pick, candidate) in enumerate(chooser.candidates.items())
            if candidate.objective is not None and candidate.objective <= self.limit
        ]
        for number, (_, _, pick) in enumerate(sorted(near, key=lambda item: item[:2])):
            yield pick, len(near) - 1 - number

    def _by_bounds(self, bounds: CombinationBounds) -> Iterator[tuple[Combination, int]]:
        """Those that a bound for each leaves; what is solved meanwhile raises the bounds of the others."""
        seen = np.zeros(bounds.bounds.shape, dtype=bool)
        while True:
            could = ~seen & ~bounds.impossible & ~bounds.unsolved & (bounds.bounds <= self.limit)
            if not could.any():
                return
            place = np.unravel_index(int(np.argmin(np.where(could, bounds.bounds, np.inf))), could.shape)
            seen[place] = True
            yield bounds.options.combination([int(k) for k in place]), int(could.sum()) - 1
