"""The scenario at which a design errs most, and the error that a share of scenarios does not exceed.

At a pose the error is a sum of terms, each with factors one over a modulus or a stiffness, or a backlash: where they
agree in sign it grows with each of them, and a vertex of the box is the worst. So vertices are climbed to, from several
starts, by turning one factor at a time; inner points are looked at as well, for dimensions make links both stiffer and
heavier. Poses come from whole searches at the scenarios found so far.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from scipy.special import bdtr

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.errors.varied import as_it_is
from linkwright.core.arm.figures import families_of
from linkwright.core.arm.figures.error import SingleError
from linkwright.core.arm.worst.search import WorstCase, WorstSearch
from linkwright.core.optimize.exchange.design import with_chosen_links
from linkwright.core.optimize.exchange.exchange import CERTIFICATE_GAP
from linkwright.core.optimize.exchange.scenarios import Scenarios, scenario_values
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.robust.result import RobustFigure
from linkwright.core.optimize.uncertain import Scenario, Uncertain
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

_POSES = 192
_ENUMERATED = 8
"""Up to so many uncertain factors every vertex is looked at."""
_STARTS, _INNER = 6, 32
_CLOSER, _EXACT = 4, 3
"""Times that the workspace is searched whole, at so many of the worst scenarios so far."""
_CHUNK = 40_000


class ScenarioSearch:
    """Looks for the worst scenarios of designs, again and again as the design changes."""

    def __init__(self, problem: Problem, arm: Arm | None = None, single: SingleError | None = None) -> None:
        """For the arms of a problem; `arm` is one of another structure to be looked at instead, and `single` says of
        which load case or point alone the error counts."""
        assert problem.uncertain is not None
        self.uncertain: Uncertain = problem.uncertain
        self.loads = problem.load_cases
        base = with_chosen_links(problem).arm if arm is None else arm
        for name, k in self.uncertain.places:
            if name == "stiffness" and base.joints[k].zones:
                would_do = "leave its stiffness out of uncertain, or give the joint one stiffness"
                raise InputError(problem.file, "uncertain", f"joint {k + 1} has zones of stiffness; {would_do}")
        cases, workspace = self.loads, problem.workspace
        families = families_of({limit.name: limit.figure for limit in problem.limits})
        singles = [family for family in families if isinstance(family, SingleError)]
        if single is not None:
            (cases, workspace), singles = single.part(cases, workspace), []
        self.model = error_model(base, cases, drives=True, varied=self.uncertain.varied)
        self.search = WorstSearch(self.model, workspace, gap=CERTIFICATE_GAP)
        self.singles = {family.name: ScenarioSearch(problem, base, family) for family in singles}
        """The searches for the error of each load case and point with a limit, by the limit's name."""

    @property
    def size(self) -> int:
        """How many factors are uncertain."""
        return len(self.uncertain.places)

    def held(self, scenarios: Sequence[Scenario]) -> Scenarios:
        """Scenarios that a design is held for, with the error that counts here."""
        return Scenarios(self.model, self.search, tuple(scenarios))

    def exact(self, arm: Arm, shares: Array, extra: Array | None = None) -> WorstCase:
        """The worst case of an arm over its workspace in one scenario, without a certificate."""
        values = scenario_values(arm, self.loads, self.uncertain.scenario(shares))
        return self.search.worst(values, certify=False, extra=extra)

    def errors(self, arm: Arm, shares: Array, poses: Array) -> Array:
        """The worst error (M,) in each of the scenarios `shares` (M, d) over poses (N, n) and load cases."""
        return self._errors(self._rows(arm, shares), poses)

    def _rows(self, arm: Arm, shares: Array) -> Array:
        """The error model's row p of each scenario."""
        return np.array([scenario_values(arm, self.loads, self.uncertain.scenario(share)) for share in shares])

    def _errors(self, rows: Array, poses: Array) -> Array:
        step = max(1, _CHUNK // len(poses))
        errors: list[Array] = []
        for start in range(0, len(rows), step):
            block = rows[start : start + step]
            q, p = np.tile(poses, (len(block), 1)), np.repeat(block, len(poses), axis=0)
            cases = [self.search.errors(q, p, case).error for case in range(len(self.model.cases))]
            errors.append(np.max(cases, axis=0).reshape(len(block), len(poses)).max(axis=1))
        return np.concatenate(errors)

    def poses(self, arm: Arm, seed: int) -> Array:
        """Poses to compare scenarios at: the worst of the arm as it is and at the pessimistic vertex, and others spread
        over the workspace."""
        shares = (np.zeros(self.size), self.uncertain.pessimistic())
        worst = [pose.q for share in shares for pose in self.exact(arm, share).poses]
        p = scenario_values(arm, self.loads, self.uncertain.scenario(shares[0]))
        return np.vstack([np.array(worst), self.search.poses(p, _POSES, seed)])

    def worst(self, arm: Arm, seed: int, known: Sequence[Array] = ()) -> tuple[Array, WorstCase, int]:
        """The worst scenario of an arm as shares of the ways to the bounds, its worst case, and how many were compared;
        `known` are scenarios worth starting from."""
        generator = np.random.default_rng(seed)
        poses = self.poses(arm, seed)
        if self.size <= _ENUMERATED:
            vertices = np.array(list(itertools.product((-1.0, 1.0), repeat=self.size)))
        else:
            random = generator.choice((-1.0, 1.0), (_STARTS, self.size))
            vertices = np.vstack([self.uncertain.pessimistic(), -self.uncertain.pessimistic(), random])
        inner = generator.uniform(-1.0, 1.0, (_INNER, self.size))
        trials = np.vstack([vertices, inner, np.zeros(self.size), *known])
        compared = len(trials)
        best, case = trials[0], None
        for _ in range(_CLOSER):
            errors = self.errors(arm, trials, poses)
            starts = trials[np.argsort(-errors, kind="stable")[:_STARTS]]
            reached = [self._climbed(arm, start, poses) for start in starts]
            compared += sum(count for _, count in reached)
            ends = np.unique(np.array([end for end, _ in reached]), axis=0)
            # Those that are as bad at the poses so far differ by poses of their own.
            likely = ends[np.argsort(-self.errors(arm, ends, poses), kind="stable")[:_EXACT]]
            searched = [(self.exact(arm, end, poses), end) for end in likely]
            worst, end_worst = max(searched, key=lambda item: item[0].error)
            if case is not None and (worst.error <= case.error * (1.0 + 1e-7) or np.array_equal(end_worst, best)):
                break
            best, case = end_worst, worst
            poses = np.vstack([poses, np.array([pose.q for item, _ in searched for pose in item.poses])])
        assert case is not None
        return best, case, compared

    def _climbed(self, arm: Arm, start: Array, poses: Array) -> tuple[Array, int]:
        """From a scenario by turning one factor at a time to either bound, until none makes it worse."""
        here, value = start, float(self.errors(arm, start[None], poses)[0])
        compared = 0
        for _ in range(2 * self.size):
            trials = np.repeat(here[None], 2 * self.size, axis=0)
            for k in range(self.size):
                trials[2 * k, k], trials[2 * k + 1, k] = -1.0, 1.0
            errors = self.errors(arm, trials, poses)
            compared += len(trials)
            top = int(np.argmax(errors))
            if errors[top] <= value * (1.0 + 1e-9):
                break
            here, value = trials[top], float(errors[top])
        return here, compared

    def samples(self, count: int, seed: int) -> Array:
        """Scenarios (count, d), each factor uniform between its bounds, independently."""
        return np.random.default_rng(seed).uniform(-1.0, 1.0, (count, self.size))

    def sampled(self, arm: Arm, shares: Array, seed: int) -> Array:
        """The worst error (M,) over the workspace in each scenario, at poses found at those near the quantile."""
        poses, rows = self.poses(arm, seed), self._rows(arm, shares)
        for _ in range(2):
            errors = self._errors(rows, poses)
            near = np.argsort(errors, kind="stable")[rank(self.uncertain.share, len(shares)) - 1]
            poses = np.vstack([poses, np.array([pose.q for pose in self.exact(arm, shares[near], poses).poses])])
        return self._errors(rows, poses)

    def nominal(self, arm: Arm) -> float:
        """The worst error (m) of the arm as it is."""
        p = beam_values(beams_of(arm, self.loads))
        return self.search.worst(np.concatenate([p, as_it_is(arm.size)]), certify=False).error


def rank(share: float, count: int) -> int:
    """Which of so many values, from the smallest (1), the share of them does not exceed."""
    return min(count, max(1, int(np.ceil(share * count - 1e-9))))


FRESH = 1000
"""Samples of a share's check, none of them used for the design."""
_SEED = 20_011
_CONFIDENCE = 0.95


def robust_figure(arm: Arm, problem: Problem, search: ScenarioSearch | None = None) -> RobustFigure:
    """The error of an arm over what a problem calls uncertain: its worst, or that of a share of fresh samples.

    Raises `Unreachable` where the workspace holds points that the arm cannot reach.
    """
    scenarios = ScenarioSearch(problem, arm) if search is None else search
    uncertain = scenarios.uncertain
    nominal = scenarios.nominal(arm)
    if uncertain.worst:
        shares, case, compared = scenarios.worst(arm, _SEED)
        value, scenario = max(case.error, nominal), uncertain.scenario(shares)
        singles = {
            name: max(search.worst(arm, _SEED)[1].error, search.nominal(arm))
            for name, search in scenarios.singles.items()
        }
        return RobustFigure(1.0, value, nominal, scenario, compared, None, uncertain.widths, singles)
    samples = scenarios.samples(FRESH, _SEED)
    errors = scenarios.sampled(arm, samples, _SEED)
    order = np.argsort(errors, kind="stable")
    place = rank(uncertain.share, FRESH)
    upper = upper_rank(uncertain.share, FRESH)
    return RobustFigure(
        uncertain.share,
        float(errors[order[place - 1]]),
        nominal,
        uncertain.scenario(samples[order[place - 1]]),
        FRESH,
        None if upper is None else float(errors[order[upper - 1]]),
        uncertain.widths,
    )


def upper_rank(share: float, count: int) -> int | None:
    """Which of so many sorted samples, from the smallest (1), is above the quantile of a share with 95 % confidence
    (order statistics: W. J. Conover, Practical Nonparametric Statistics, 3rd ed., 1999, ch. 3.2); None where none is.
    """
    # The r-th value is above the quantile where at most r - 1 samples are below it.
    below = int(np.searchsorted(bdtr(np.arange(count), count, share), _CONFIDENCE))
    return below + 1 if below < count else None
