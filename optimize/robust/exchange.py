"""The robust optimum: scenarios enter a separate exchange, round the exchange of poses.

The design for the scenarios so far; the worst scenario for that design, and for each limit on the error of a load case
or point; added, until none is worse. For a share of all scenarios a seeded sample stands for them: the best design for
the share of it that the design before found easiest, and again with the share that this one does, as long as that helps
(a sample average, and a local optimum).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.figures import PoseFamily
from linkwright.core.arm.figures.error import SingleError
from linkwright.core.optimize.choice.combinations import Choice, Progress, choose
from linkwright.core.optimize.exchange.design import arm_of, numeric_beams
from linkwright.core.optimize.exchange.exchange import Context, context_of
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import Iteration
from linkwright.core.sections.numeric import Array

from .search import ScenarioSearch, rank
from .single import ErrorInScenarios

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
    was held for; `settled` where no scenario was worse, or broke a limit of a load case or point."""

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
        held = [self.search.uncertain.scenario(share) for share in shares]
        families: list[tuple[PoseFamily[Any], Any]] = []
        for family, prepared in self.context.families:
            if isinstance(family, SingleError):
                in_scenarios = ErrorInScenarios(family, self.search.singles[family.name].held(held))
                families.append((in_scenarios, in_scenarios.prepare(self.problem)))
            else:
                families.append((family, prepared))
        return replace(self.context, scenarios=self.search.held(held), families=tuple(families))

    def _designed(self, shares: list[Array]) -> RobustDesign | None:
        self.rounds += 1
        context = self.context_for(shares)
        choice = choose(context, progress=self.progress, log=self.log)
        if choice is None:
            return None
        arm = arm_of(choice.space, choice.exchanged.x, choice.combination.materials)
        worst = choice.exchanged.worst
        if worst is None:
            worst = context.worst(arm, numeric_beams(arm, self.problem.load_cases), certify=False)
        return RobustDesign(context, choice, arm, worst.error, self.rounds, False)

    def worst(self) -> RobustDesign | Context:
        """The design with the least worst error over all scenarios; the context where the last ones leave none."""
        shares = [self.search.uncertain.pessimistic()]
        while True:
            design = self._designed(shares)
            if design is None:
                return self.context_for(shares)
            if design.choice.interrupted:
                return design
            worse = self._worse(design, shares)
            if not worse:
                return replace(design, settled=True)
            if len(shares) >= _ROUNDS:
                return design
            shares += worse

    def _worse(self, design: RobustDesign, known: list[Array]) -> list[Array]:
        """The scenarios, beside those known, in which a design errs more than it was made for, or most beyond a limit
        of a load case or point."""
        searches = [(self.search, design.claimed)] if self.context.uses_error else []
        limits = (limit for limit in self.problem.limits if limit.name in self.search.singles)
        searches += [(self.search.singles[limit.name], limit.value) for limit in limits]
        worse: list[Array] = []
        for search, allowed in searches:
            scenario, case, _ = search.worst(design.arm, _SEED, known)
            if case.error > allowed * (1.0 + _WITHIN) and not any(
                np.array_equal(scenario, share) for share in (*known, *worse)
            ):
                worse.append(scenario)
        return worse

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
