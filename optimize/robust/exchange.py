"""The robust optimum: scenarios enter a separate exchange, round the exchange of poses.

The design for the scenarios so far; the worst scenario for that design; added, until none is worse. For a share of all
scenarios a seeded sample stands for them: the best design for the share of it that the design before found easiest, and
again with the share that this one does, as long as that helps (a sample average, and a local optimum).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.optimize.choice.combinations import Choice, Progress, choose
from linkwright.core.optimize.exchange.design import arm_of
from linkwright.core.optimize.exchange.exchange import Context, context_of
from linkwright.core.optimize.exchange.scenarios import Scenarios
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import Iteration
from linkwright.core.sections.numeric import Array

from .search import ScenarioSearch, rank

Log = Callable[[Iteration], None]

SAMPLES = 500
"""Scenarios that stand for all of them where a share is asked for."""
_SEED, _SAMPLE_SEED = 3, 5
_WITHIN = 1e-4
"""A scenario that is worse by less than this share adds nothing."""
_ROUNDS, _SHARES = 12, 4


@dataclass(frozen=True)
class RobustDesign:
    """The end of the exchange of scenarios: the context with them, the choice, its arm and the error (m) over what it
    was held for; `settled` where no scenario of that was worse."""

    context: Context
    choice: Choice
    arm: Arm
    claimed: float
    rounds: int
    settled: bool


class RobustExchange:
    """Designs for scenarios, with one model for all of them."""

    def __init__(self, problem: Problem, progress: Progress | None, log: Log | None) -> None:
        self.problem, self.progress, self.log = problem, progress, log
        self.context = context_of(problem)
        self.search = ScenarioSearch(problem)
        self.rounds = 0

    def context_for(self, shares: list[Array]) -> Context:
        """The context of designs for some scenarios."""
        held = tuple(self.search.uncertain.scenario(share) for share in shares)
        return replace(self.context, scenarios=Scenarios(self.search.model, self.search.search, held))

    def _designed(self, shares: list[Array]) -> RobustDesign | None:
        self.rounds += 1
        context = self.context_for(shares)
        choice = choose(context, progress=self.progress, log=self.log)
        if choice is None:
            return None
        arm = arm_of(choice.space, choice.exchanged.x, choice.combination.materials)
        worst = choice.exchanged.worst
        claimed = choice.objective if worst is None else worst.error
        return RobustDesign(context, choice, arm, claimed, self.rounds, False)

    def worst(self) -> RobustDesign | Context:
        """The design with the least worst error over all scenarios; the context where the last ones leave none."""
        shares = [self.search.uncertain.pessimistic()]
        while True:
            design = self._designed(shares)
            if design is None:
                return self.context_for(shares)
            if design.choice.interrupted:
                return design
            scenario, case, _ = self.search.worst(design.arm, _SEED, shares)
            if case.error <= design.claimed * (1.0 + _WITHIN) or any(
                np.array_equal(scenario, share) for share in shares
            ):
                return replace(design, settled=True)
            if len(shares) == _ROUNDS:
                return design
            shares.append(scenario)

    def share(self, start: Arm) -> RobustDesign | Context:
        """The design with the least error that a share of the sample does not exceed, from that of an arm."""
        samples = self.search.samples(SAMPLES, _SAMPLE_SEED)
        size = rank(self.search.uncertain.share, SAMPLES)
        order = np.argsort(self.search.sampled(start, samples, _SEED), kind="stable")
        best: tuple[float, RobustDesign] | None = None
        for _ in range(_SHARES):
            design = self._for_set(samples, order[:size])
            if isinstance(design, Context):
                return design if best is None else best[1]
            errors = self.search.sampled(design.arm, samples, _SEED)
            order = np.argsort(errors, kind="stable")
            value = float(errors[order[size - 1]])
            if best is not None and value >= best[0] * (1.0 - _WITHIN):
                break
            best = (value, replace(design, claimed=value))
            if design.choice.interrupted:
                break
        assert best is not None
        return best[1]

    def _for_set(self, samples: Array, chosen: NDArray[np.intp]) -> RobustDesign | Context:
        """The design with the least worst error over a set of samples (their numbers, the worst last)."""
        held = [int(chosen[-1])]
        while True:
            shares = [samples[k] for k in held]
            design = self._designed(shares)
            if design is None:
                return self.context_for(shares)
            errors = self.search.sampled(design.arm, samples[chosen], _SEED)
            worst = int(chosen[int(np.argmax(errors))])
            done = float(errors.max()) <= design.claimed * (1.0 + _WITHIN)
            if done or worst in held or design.choice.interrupted:
                return replace(design, settled=True)
            if len(held) == _ROUNDS:
                return design
            held.append(worst)
