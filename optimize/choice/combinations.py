"""Which shape and material each link should have: every combination of few, else those that bounds leave."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.executors import Executor
from linkwright.core.optimize.exchange.design import DesignSpace
from linkwright.core.optimize.exchange.exchange import Context, Exchange, Exchanged
from linkwright.core.optimize.result import Candidate, Iteration

from .at_once.feasibility import Feasibility
from .chooser import Best, Chooser, Progress
from .initial_arm import given_design
from .large_choice import CLOSE, Among, among_many, possible
from .near_ties import Ties, near_ties
from .picks import Combination, combinations, count
from .polish import hold_against_uniform, no_worse_than, polish, try_other_lengths
from .solution_cache import Solutions

Array = NDArray[np.float64]

MOST_COMBINATIONS = 1000
"""Up to this many combinations every one is tried where none that is solved bounds the others."""
MOST_EACH = 200
"""Up to this many all are solved for the binding poses; of more, those that the others' bounds leave."""
_FEW = 24
"""Up to this many it is not asked first whether any can keep the limits."""


@dataclass(frozen=True)
class Choice:
    """The best combination, its finished exchange and objective (SI), and what became of the others.

    `one_signed`: no terms of the error cancel at the poses that designs were held against (`optimize.choice.products`).
    """

    combination: Combination
    space: DesignSpace
    materials: Array
    exchange: Exchange
    exchanged: Exchanged
    objective: float
    candidates: tuple[Candidate, ...]
    exhaustive: bool
    history: tuple[Iteration, ...]
    one_signed: bool = True
    interrupted: bool = False
    """Whether an interrupt ended the search."""
    gap: float | None = 0.0
    """How much better (relative) a combination that was not solved could be at most, but for those of the candidates on
    which the solver failed; None where nothing tells."""
    bound: float | None = None
    """What no design of any combination goes below (SI), where all were bounded at once."""
    ties: Ties = field(default_factory=Ties)
    """The combinations within a few per cent of the best, solved to the end."""


@dataclass(frozen=True)
class NoChoice:
    """What became of the combinations where none has a solution."""

    candidates: tuple[Candidate, ...]
    feasibility: Feasibility | None = None
    """What is known of how far all of them break the limits."""

    def bound(self, combinations: int) -> float:
        """What no design of so many combinations goes below (SI), where each of them was bounded or cannot be; minus
        infinity where nothing tells."""
        decided = [item for item in self.candidates if item.outcome in ("bounded out", "infeasible")]
        values = (math.inf if item.objective is None else item.objective for item in decided)
        return min(values) if len(decided) == combinations else -math.inf

    @property
    def unsolved(self) -> int:
        """On how many of them the solver failed, which proves nothing."""
        return sum(candidate.outcome == "unsolved" for candidate in self.candidates)


def choose(
    context: Context,
    *,
    progress: Progress | None = None,
    log: Callable[[Iteration], None] | None = None,
    known: float = math.inf,
    executor: Executor | None = None,
    ties: bool = True,
) -> Choice | None:
    """The best combination of shapes and materials; None where none has a solution (better than `known`, SI). With
    `ties` those that come near it are solved to the end as well.

    See `chosen`, which also says what became of the combinations then.
    """
    result = chosen(context, progress=progress, log=log, known=known, executor=executor, ties=ties)
    return result if isinstance(result, Choice) else None


def chosen(
    context: Context,
    *,
    progress: Progress | None = None,
    log: Callable[[Iteration], None] | None = None,
    known: float = math.inf,
    executor: Executor | None = None,
    solutions: Solutions | None = None,
    ties: bool = True,
) -> Choice | NoChoice:
    """The best combination of shapes and materials, where any has a solution (better than `known`, SI). With `ties`
    those that come near it are solved to the end as well.

    `executor` does what falls apart into steps; without one this process does all. `solutions` answers what it
    knows of an earlier search, and notes what is found.
    A `KeyboardInterrupt` that `progress` or `log` raises ends the search with the best so far, and goes on where there
    is none yet.
    """
    shared = executor if executor is not None and executor.shares else None
    search = _Search(Chooser(context, progress, log, known, shared, solutions), ties)
    try:
        search.run()
    except KeyboardInterrupt:
        if search.chooser.best is None:
            raise
        search.interrupted = True
    if search.chooser.best is None:
        return NoChoice(tuple(search.chooser.candidates.values()), search.chooser.feasibility)
    return search.choice(search.chooser.best)


@dataclass
class _Search:
    """A chooser at work, and how far it has come: whether every combination was looked at, what bounds those that were
    not, and what comes near the best."""

    chooser: Chooser
    ties: bool
    exhaustive: bool = False
    interrupted: bool = False
    gap: float | None = None
    among: Among | None = None
    near: Ties = field(default_factory=Ties)

    def run(self) -> None:
        """Look at the combinations, then more closely at the best."""
        self._look()
        self.gap = 0.0 if self.exhaustive else self.gap
        self._polish()
        bounded = self.among is None or self.among.bounded
        if self.ties and bounded and self.chooser.best is not None and count(self.chooser.context.problem) > 1:
            self._look_near(self.chooser.best[0])
        if self.among is not None:
            self.exhaustive = self.gap is not None and self.gap <= CLOSE
        self.exhaustive = self.exhaustive and not self.chooser.undecided

    def _look(self) -> None:
        """Every combination of few; of more, those that bounds leave."""
        chooser, problem = self.chooser, self.chooser.context.problem
        # With lengths to choose all are bounded at once, which leaves much open and points at few of them.
        if count(problem) <= (MOST_COMBINATIONS if problem.free_lengths else MOST_EACH):
            picks = combinations(problem)
            chooser.try_all(possible(chooser, picks) if len(picks) > _FEW else picks)
            self.exhaustive = True
        else:
            self.among = among_many(chooser)
            self.gap = self.among.gap
            if self.gap is None and count(problem) <= MOST_COMBINATIONS:
                # Nothing bounds them.
                chooser.try_all(combinations(problem))
                self.among, self.exhaustive = None, True

    def _polish(self) -> None:
        """Other local optima of the best combination, and the arm as given."""
        chooser, problem = self.chooser, self.chooser.context.problem
        polish(chooser)
        try_other_lengths(chooser)
        given = given_design(problem)
        if given is not None:
            no_worse_than(chooser, given.combination, given.x)
        if problem.free_tapers:
            hold_against_uniform(chooser)

    def _look_near(self, first: Combination) -> None:
        """What comes near the best, which may turn out better."""
        self.near = near_ties(self.chooser, self.among)
        self.interrupted = self.near.interrupted
        best = self.chooser.best
        if best is not None and best[0] != first and not self.interrupted:
            polish(self.chooser)
        if self.among is not None:
            self.gap = 0.0 if self.near.all_solved else self.among.gap_of(self.chooser.objective)

    def choice(self, best: Best) -> Choice:
        """The best of all, and what became of the others."""
        chooser = self.chooser
        pick, space, materials, exchange, exchanged, objective = best
        noted = [
            replace(candidate, objective=objective, outcome="best") if other == pick else candidate
            for other, candidate in chooser.candidates.items()
        ]
        return Choice(
            pick,
            space,
            materials,
            exchange,
            exchanged,
            objective,
            tuple(sorted(noted, key=_rank)),
            self.exhaustive and not self.interrupted,
            tuple(chooser.history),
            chooser.one_signed() and chooser.one_signed(everywhere=True),
            self.interrupted,
            None if self.interrupted else self.gap,
            None if self.among is None or self.among.proof is None else self.among.proof.bound,
            self.near,
        )


def _rank(candidate: Candidate) -> float:
    return math.inf if candidate.objective is None else candidate.objective


__all__ = [
    "MOST_COMBINATIONS",
    "MOST_EACH",
    "Choice",
    "Chooser",
    "Combination",
    "NoChoice",
    "Progress",
    "choose",
    "chosen",
    "combinations",
    "count",
]
