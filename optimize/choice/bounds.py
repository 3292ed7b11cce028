"""Bounds from below for every combination at once, from the multipliers of the combinations that were solved.

The multipliers of a solved combination make one sum of its objective, its binding poses and its limits that no design
of any combination can have above its objective (Lagrange). Taken apart link by link (`optimize.choice.products`) it
bounds each combination by a sum of one number a link and option.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.figures import Cut
from linkwright.core.optimize.exchange.binding_poses import ErrorCut, Pool
from linkwright.core.optimize.exchange.design import MATERIAL_FIELDS, arm_of, numeric_beams
from linkwright.core.optimize.exchange.exchange import Context, Exchange
from linkwright.core.optimize.exchange.program import Solution, carried_mass, fixed_error, unchosen_cost
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections.numeric import Array

from .at_once.feasibility import Feasibility
from .at_once.pose_rows import bends_askew, strength_products
from .link_options import LinkOptions
from .picks import Combination, OptionTable, option_table
from .pose_products import (
    error_products,
    features_of,
    inertia_products,
)
from .products import Products, minorant, total

MOST_AT_ONCE = 3_000_000
"""Combinations for which a bound each is kept."""
_FELT = 1e-9
"""A multiplier below this (per cent for per cent) is left out."""


@dataclass
class CombinationBounds:
    """A bound from below (SI) for every combination: `bounds` has an axis for each elastic link, with its options."""

    context: Context
    options: OptionTable
    tables: tuple[LinkOptions, ...]
    bounds: Array
    impossible: NDArray[np.bool_]
    closed: NDArray[np.bool_]
    """Those that were solved or cannot be: nothing more is to be learnt about them."""
    unsolved: NDArray[np.bool_]
    """Those on which the solver failed: nothing is known of them but what bounds others."""
    feasibility: Feasibility | None
    """What rules out others where one cannot keep the limits."""

    def rule_out(self, exchange: Exchange, solution: Solution, pick: Combination, pool: Pool) -> None:
        """Tell what cannot keep the limits from a combination that cannot, and the solution in which they give way as
        little as they can."""
        self.impossible[self.options.place(pick)] = True
        if self.feasibility is not None:
            self.feasibility.learn(exchange, solution, pick, pool)
            self.impossible |= self.feasibility.impossible
        self.closed |= self.impossible

    def learn(
        self,
        exchange: Exchange,
        solution: Solution,
        materials: Array,
        pick: Combination,
        pool: Pool,
        enough: float = np.inf,
    ) -> bool:
        """Raise the bounds by a solution for the pool, of those that are below `enough` (SI) and not closed; False
        where the model is no sum of products."""
        lagrangian = _lagrangian(self.context, exchange, solution, materials, pick, pool)
        if lagrangian is None:
            return False
        products, per_cost, at = lagrangian
        constant, parts = minorant(products, at)
        lengths = self.context.problem.arm.lengths
        bound = np.array(constant)
        low = ~self.closed & (self.bounds < enough)
        for axis, (link, table) in enumerate(zip(self.options.links, self.tables, strict=True)):
            # An option that is in none of those need not be looked at.
            undecided = np.asarray(low.any(axis=tuple(k for k in range(low.ndim) if k != axis)))
            least = table.least(parts[link], per_cost * float(lengths[link]), undecided)
            shape = [1] * len(self.tables)
            shape[axis] = len(least)
            bound = bound + least.reshape(shape)
        np.maximum(self.bounds, bound, out=self.bounds)
        return True


def combination_bounds(context: Context, feasibility: Feasibility | None) -> CombinationBounds | None:
    """Bounds for all combinations of a problem, none known yet; `feasibility` rules out some. None where there can be
    none: too many combinations, lengths to be chosen, scenarios, or play that depends on the design."""
    problem = context.problem
    if problem.free_lengths or context.scenarios is not None or (problem.arm.play != "worst" and context.uses_error):
        return None
    options = option_table(problem)
    if math.prod(options.shape) > MOST_AT_ONCE:
        return None
    # Links that can be the same share what that can be.
    first = options.first_alike(problem)
    made = {k: LinkOptions(problem, options.links[k], options.options[k]) for k in dict.fromkeys(first)}
    tables = tuple(made[k] for k in first)
    out = ~_agreeing(problem, options)
    if feasibility is not None:
        out |= feasibility.impossible
    least, unsolved = np.full(options.shape, -np.inf), np.zeros(options.shape, dtype=bool)
    return CombinationBounds(context, options, tables, least, out, out.copy(), unsolved, feasibility)


def _agreeing(problem: Problem, options: OptionTable) -> NDArray[np.bool_]:
    """Which combinations agree in what must be the same."""
    agreeing = np.ones(options.shape, dtype=bool)
    sames: list[int] = []
    if "section" in problem.same or "size" in problem.same:
        sames.append(0)
    if "material" in problem.same:
        sames.append(1)
    for part in sames:
        names: dict[object, int] = {}
        first: Array | None = None
        for axis, link_options in enumerate(options.options):
            kinds = [entry[0] if part == 0 else entry[1].name for entry in link_options]
            shape = [1] * len(options.options)
            shape[axis] = len(link_options)
            codes = np.array([names.setdefault(kind, len(names)) for kind in kinds], dtype=float).reshape(shape)
            if first is None:
                first = codes
            else:
                agreeing &= codes == first
    return agreeing


def _lagrangian(
    context: Context,
    exchange: Exchange,
    solution: Solution,
    materials: Array,
    pick: Combination,
    pool: Pool,
) -> tuple[Products, float, Array] | None:
    """The sum of objective, poses and limits with their multipliers; what each EUR of the links' cost adds to it; and
    the links' features at the solution."""
    problem = context.problem
    program = exchange.program(pool, spare=False)
    errors, held = program.slotted(pool)
    arm = arm_of(exchange.space, solution.x, pick.materials)
    p = numeric_beams(arm, problem.load_cases)
    _, strength = program.figures(solution.x, materials)
    features = features_of(p, arm.size, _strengths(strength, materials, arm.size))
    mass = Products({((k, 0),): float(link.length) for k, link in enumerate(arm.links) if link.section is not None})
    rigid = sum(link.mass or 0.0 for link in arm.links if link.section is None)
    own_mass, cost, _ = program.mass_cost_reach(solution.x, materials)
    rest = {"mass": rigid, "total_mass": rigid + carried_mass(problem)}
    sums: list[Products] = []
    per_cost = 0.0
    fixed = fixed_error(context.model)
    if problem.minimize in rest:
        worth = own_mass + rest[problem.minimize] - rigid
        sums += [mass, Products({(): rest[problem.minimize]})]
    elif problem.minimize == "cost":
        worth, per_cost = cost, 1.0
        sums.append(Products({(): unchosen_cost(problem)}))
    elif problem.minimize == "max_error":
        worth = solution.error - fixed
        sums.append(Products({(): fixed}))
    else:
        return None
    weights = np.maximum(2.0 * solution.multipliers["errors"], 0.0)
    of_errors = _of_errors(context, _merged(errors, weights), worth, features, p)
    if of_errors is None:
        return None
    of_sums, price = _of_sums(problem, solution.limit_prices, worth, mass, rest)
    sums += [*of_errors, *of_sums]
    for family, prepared in context.families:
        multipliers = solution.multipliers[family.name]
        sums += _of_family(context, family.name, prepared, held[family.name], multipliers * worth, arm, p)
    return total(sums), per_cost + price, features


def _of_errors(
    context: Context, cuts: Sequence[tuple[ErrorCut, float]], worth: float, features: Array, p: Array
) -> list[Products] | None:
    """The errors at poses with their multipliers: shares of one where the error is minimised, else what each would add
    to the objective; None where an error is no sum of products."""
    problem = context.problem
    minimised = problem.minimize == "max_error"
    limit = min((item.value for item in problem.limit("max_error")), default=math.inf)
    whole, allowed = 1.0, limit - fixed_error(context.model)
    if minimised:
        whole, allowed = sum(weight for _, weight in cuts), 0.0
        if whole <= 0.0:
            return None
    products: list[Products] = []
    for cut, weight in cuts:
        if weight / whole <= _FELT or not (minimised or math.isfinite(limit)):
            continue
        error = error_products(context.model, cut, p)
        if error is None:
            return None
        scale = weight / whole if minimised else worth * weight / error.value(features)
        products += [error.scaled(scale), Products({(): -scale * allowed})]
    return products


def _of_sums(
    problem: Problem, prices: Sequence[float], worth: float, mass: Products, rest: Mapping[str, float]
) -> tuple[list[Products], float]:
    """The limits on masses and cost with their multipliers, and what each EUR of the links' cost adds."""
    products: list[Products] = []
    per_cost = 0.0
    for price, limit in zip(prices, problem.limits, strict=True):
        if limit.name not in ("mass", "total_mass", "cost") or abs(price) <= _FELT:
            continue
        scale = worth * price * (-1.0 if limit.relation == ">=" else 1.0)
        if limit.name == "cost":
            per_cost += scale / limit.value
            products.append(Products({(): scale * (unchosen_cost(problem) / limit.value - 1.0)}))
        else:
            products.append(mass.scaled(scale / limit.value))
            products.append(Products({(): scale * (rest[limit.name] / limit.value - 1.0)}))
    return products, per_cost


def _merged(cuts: Sequence[ErrorCut], weights: Array) -> list[tuple[ErrorCut, float]]:
    """Each pose once: spare slots repeat one."""
    merged: dict[ErrorCut, float] = {}
    for cut, weight in zip(cuts, weights.tolist(), strict=True):
        merged[cut] = merged.get(cut, 0.0) + weight
    return list(merged.items())


def _strengths(strength: Array, materials: Array, size: int) -> Array:
    """The links' features of stress (n, 3); 1 where the yield strength is not known."""
    yields = materials.reshape(size, -1)[:, MATERIAL_FIELDS.index("allowed_stress")]
    moduli = strength.reshape(size, -1)[:, :3]
    return np.where(yields[:, None] > 0.0, 1.0 / np.maximum(moduli * yields[:, None], 1e-300), 1.0)


def _of_family(
    context: Context, name: str, prepared: object, cuts: Sequence[Cut], multipliers: Array, arm: object, p: Array
) -> list[Products]:
    """The rows of a family's poses with their multipliers; of a family that is not known here, nothing: the bound is
    then lower than it could be."""
    problem = context.problem
    products: list[Products] = []
    if not len(cuts):
        return products
    merged: dict[Cut, Array] = {}
    for cut, own in zip(cuts, multipliers.reshape(len(cuts), -1), strict=True):
        merged[cut] = merged.get(cut, 0.0) + own
    for cut, own in merged.items():
        if own.max(initial=0.0) <= _FELT:
            continue
        if name == "strengths" and bends_askew(problem.arm):
            continue
        if name == "strengths":
            rows = strength_products(problem, prepared[cut.group], cut, p)  # type: ignore[index]
            weighed = zip(rows, own.tolist(), strict=False)
            products += [row.scaled(weight) for (_, row), weight in weighed if weight > _FELT]
        elif name == "modes":
            beams = beams_of(arm, problem.load_cases)  # type: ignore[arg-type]
            limits = [limit for limit in problem.limits if limit.name == "first_frequency"]
            for limit, multiplier in zip(limits, own.tolist(), strict=True):
                sums = inertia_products(prepared[0], prepared[1], cut, beams, p, limit.value)  # type: ignore[index]
                if sums is not None and multiplier > _FELT:
                    products.append(sums[0].scaled(multiplier / sums[1]))
    return products
