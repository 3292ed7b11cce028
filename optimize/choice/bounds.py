"""Bounds from below for every combination, a combination solved at a time.

The multipliers of a solved combination, those of its relaxation about its solution (`at_once.relaxation`), make one
sum of its objective, its binding poses and its limits that no design of any combination can have above its objective
(Lagrange). Its least over the cells of each link's options bounds each combination by a sum of one number a link.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.exchange import Exchange
from linkwright.core.optimize.exchange.program import Solution
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections.numeric import Array

from .agreement import table
from .at_once.feasibility import Feasibility
from .picks import Combination, OptionTable, agreeing, option_table


@dataclass
class CombinationBounds:
    """A bound from below (SI) for every combination: `bounds` has an axis for each elastic link, with its options."""

    options: OptionTable
    bounds: Array
    impossible: NDArray[np.bool_]
    closed: NDArray[np.bool_]
    """Those that were solved or cannot be: nothing more is to be learnt about them."""
    unsolved: NDArray[np.bool_]
    """Those on which the solver failed: nothing is known of them but what bounds others."""
    feasibility: Feasibility
    """What relaxes the problem, and rules out others where one cannot keep the limits."""

    def rule_out(self, exchange: Exchange, solution: Solution, pick: Combination, pool: Pool) -> None:
        """Tell what cannot keep the limits from a combination that cannot, and the solution in which they give way as
        little as they can."""
        self.impossible[self.options.place(pick)] = True
        self.feasibility.learn(exchange, solution, pick, pool)
        self.impossible |= self.feasibility.impossible
        self.closed |= self.impossible

    def learn(
        self, exchange: Exchange, solution: Solution, pick: Combination, objective: float, enough: float = np.inf
    ) -> bool:
        """Raise the bounds by a solution, of those that are below `enough` (SI); `objective` (SI) is its own. False
        where the model is no sum of products."""
        bounds = self.feasibility.bounds_by(exchange, solution, pick, objective, enough)
        if bounds is None:
            return False
        np.maximum(self.bounds, bounds, out=self.bounds)
        return True


def combination_bounds(problem: Problem, feasibility: Feasibility | None) -> CombinationBounds | None:
    """Bounds for all combinations of a problem, none known yet; None where nothing relaxes it: too many combinations,
    lengths to be chosen, scenarios, or play that depends on the design."""
    if feasibility is None:
        return None
    options = option_table(problem)
    out = feasibility.impossible.copy()
    for codes, most in agreeing(problem, options):
        out |= ~table(codes, most)
    least, unsolved = np.full(options.shape, -np.inf), np.zeros(options.shape, dtype=bool)
    return CombinationBounds(options, least, out, out.copy(), unsolved, feasibility)
