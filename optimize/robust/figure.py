"""The robust figure of an arm, from scenarios that no design was made with."""

from __future__ import annotations

import numpy as np
from scipy.special import bdtr

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.optimize.problem import Problem

from .result import RobustFigure
from .search import ScenarioSearch, rank

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
        value = max(case.error, nominal)
        return RobustFigure(1.0, value, nominal, uncertain.scenario(shares), compared, None, uncertain.widths)
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
