"""The rows of the finite problem as sums of products of what links bring: objective, binding poses and limits.

Only rows that are such sums are here, and each is one that every design of every combination keeps: what they bound
from below is bounded for all. Limits that are not here (a torque) could only raise the bound.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import BEAM_FIELDS, beams_of
from linkwright.core.arm.figures import Cut
from linkwright.core.arm.figures.strength import STATIONS
from linkwright.core.arm.figures.tip_stiffness import PreparedStiffness
from linkwright.core.optimize.choice.pose_products import (
    SOFT,
    compression_products,
    designs_with,
    error_vectors,
    inertia_products,
    lopsided,
    stress_products,
)
from linkwright.core.optimize.choice.products import Power, Products
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.exchange import Context
from linkwright.core.optimize.exchange.totals import carried_mass, fixed_error, unchosen_cost
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections.numeric import Array

from .cells import COLUMNS, EXPANSION, PRICE

_CLOSE = 1e-6
"""How well the parts that links give must add up to the whole, relative."""


@dataclass(frozen=True)
class PoseRow:
    """The length of a vector (or a number) that is a sum of products, plus a shift: not above t (where `objective`) or
    not above zero. All are relative to what the best design does, or to the limit.

    `powers` (T, n K) are of the links' columns in logarithms, `linear` (n K, D) of columns as they are; `limit` is the
    number of the problem's limit that it holds, where it does.
    """

    constant: Array
    coefficients: Array
    powers: Array
    linear: Array
    objective: bool
    shift: float
    limit: int | None = None

    def vector(self, y: Array) -> Array:
        """Its vector for columns y (n K)."""
        return self.constant + self.linear.T @ y + self.coefficients.T @ np.exp(self.powers @ y)

    def value(self, y: Array) -> float:
        """What must not be above t, or zero."""
        vector = self.vector(y)
        return self.shift + (float(vector[0]) if len(vector) == 1 else float(np.linalg.norm(vector)))


def row_of(
    terms: dict[Power, Array],
    size: int,
    *,
    objective: bool,
    scale: float,
    shift: float = 0.0,
    limit: int | None = None,
) -> PoseRow:
    """The row of a sum of products with vector coefficients, each over `scale`; the shift as well."""
    dimension = len(next(iter(terms.values()))) if terms else 1
    width = len(COLUMNS)
    constant, linear = np.zeros(dimension), np.zeros((size * width, dimension))
    coefficients: list[Array] = []
    powers: list[Array] = []
    for power, c in terms.items():
        if not power:
            constant = constant + c / scale
            continue
        if any(k == EXPANSION for _, k in power):
            # Expansion stands alone in an error.
            link, k = power[0]
            linear[link * width + k] += c / scale
            continue
        values = np.zeros(size * width)
        for link, k in power:
            values[link * width + k] += 1.0
        coefficients.append(c / scale)
        powers.append(values)
    return PoseRow(
        constant,
        np.array(coefficients).reshape(-1, dimension),
        np.array(powers).reshape(-1, size * width),
        linear,
        objective,
        shift / scale,
        limit,
    )


def rows_of(context: Context, pool: Pool, arm: Arm, p: Array, worth: float) -> list[PoseRow] | None:
    """The rows of a problem for a pool, read off about a design whose objective is `worth`; None where the error is no
    sum of products."""
    problem = context.problem
    size = arm.size
    fixed = fixed_error(context.model)
    rows: list[PoseRow] = []
    sums, rest = _link_terms(problem, arm)
    if problem.minimize not in sums and problem.minimize != "max_error":
        return None
    rows += sums_rows(problem, sums, rest, size, worth)
    for cut in dict.fromkeys(pool.errors):
        vectors = error_vectors(context.model, cut, p)
        if vectors is None:
            return None
        rows += error_rows(problem, dict(vectors.terms), size, worth, fixed)
    for family, prepared in context.families:
        for cut in pool.of(family.name):
            rows += _family_rows(problem, family.name, prepared, cut, arm, p)
    return rows


def sums_rows(
    problem: Problem, by_links: Mapping[str, dict[Power, Array]], rest: Mapping[str, float], size: int, worth: float
) -> list[PoseRow]:
    """The rows of the figures that are sums over links whatever the pose (`by_links`; `rest` is what no choice
    changes): of the one to be least, over `worth`, and of every limit on one, over its value."""
    rows: list[PoseRow] = []
    if problem.minimize in by_links:
        terms = {**by_links[problem.minimize], (): np.array([rest[problem.minimize]])}
        rows.append(row_of(terms, size, objective=True, scale=worth))
    for number, limit in enumerate(problem.limits):
        if limit.name not in by_links:
            continue
        terms = {**by_links[limit.name], (): np.array([rest[limit.name] - limit.value])}
        if limit.relation != ">=":
            rows.append(row_of(terms, size, objective=False, scale=limit.value, limit=number))
        if limit.relation != "<=":
            terms = {power: -c for power, c in terms.items()}
            rows.append(row_of(terms, size, objective=False, scale=limit.value, limit=number))
    return rows


def error_rows(problem: Problem, terms: dict[Power, Array], size: int, worth: float, fixed: float) -> Iterator[PoseRow]:
    """The rows of the error at a pose: to be least, over `worth`, and within its tightest limit; `fixed` (m) adds to
    either."""
    limits = [(limit.value, k) for k, limit in enumerate(problem.limits) if limit.name == "max_error"]
    least, number = min(limits, default=(math.inf, None))
    if problem.minimize == "max_error":
        yield row_of(terms, size, objective=True, scale=worth, shift=fixed)
    if math.isfinite(least):
        yield row_of(terms, size, objective=False, scale=least, shift=fixed - least, limit=number)


def _link_terms(problem: Problem, arm: Arm) -> tuple[dict[str, dict[Power, Array]], dict[str, float]]:
    """Masses and cost: the products of each, and what no choice changes."""
    elastic = [(k, float(link.length)) for k, link in enumerate(arm.links) if link.section is not None]
    rigid = sum(link.mass or 0.0 for link in arm.links if link.section is None)
    mass: dict[Power, Array] = {((k, 0),): np.array([length]) for k, length in elastic}
    cost: dict[Power, Array] = {((k, PRICE),): np.array([length]) for k, length in elastic}
    rest = {"mass": rigid, "total_mass": rigid + carried_mass(problem), "cost": unchosen_cost(problem)}
    return {"mass": mass, "total_mass": mass, "cost": cost}, rest


def _family_rows(problem: Problem, name: str, prepared: Any, cut: Cut, arm: Arm, p: Array) -> list[PoseRow]:
    size = arm.size
    if name == "strengths" and bends_askew(arm):
        return []
    if name == "strengths":
        return [_scalar(item, size, limit) for limit, item in strength_products(problem, prepared[cut.group], cut, p)]
    if isinstance(prepared, PreparedStiffness):
        if lopsided(arm, planar=False):
            return []
        return _stiffness(problem, prepared, cut, p)
    if name != "modes":
        return []
    beams = beams_of(arm, problem.load_cases)
    rows: list[PoseRow] = []
    for number, limit in enumerate(problem.limits):
        if limit.name == "first_frequency":
            sums = inertia_products(prepared[0], prepared[1], cut, beams, p, limit.value)
            if sums is not None:
                rows.append(_scalar(sums[0].scaled(1.0 / sums[1]), size, number))
    return rows


def _stiffness(problem: Problem, prepared: PreparedStiffness, cut: Cut, p: Array) -> list[PoseRow]:
    """How far a unit force moves the tip at a pose, over what is allowed, less one: each link gives by itself."""
    size = len(p) // len(BEAM_FIELDS)
    values = p.reshape(size, -1)
    soft = [(link, k) for link in range(size) for k in SOFT if values[link, k] != 0.0]
    designs = designs_with(values, (), soft, [(), *((place,) for place in soft)])[:-1]
    moved = prepared.compliance.matrices(np.tile(cut.q, (len(designs), 1)), designs.reshape(len(designs), -1))
    moved = moved @ np.array(cut.more)
    if not np.linalg.norm(moved[0] + (moved[1:-1] - moved[0]).sum(axis=0) - moved[-1]) <= _CLOSE * np.abs(moved).max():
        return []
    number = prepared.limits[cut.group]
    limit = problem.limits[number].value
    terms: dict[Power, Array] = {(): limit * moved[0]}
    for (link, k), value in zip(soft, moved[1:-1], strict=True):
        terms[((link, SOFT[k]),)] = limit * (value - moved[0]) * abs(values[link, k])
    return [row_of(terms, size, objective=False, scale=1.0, shift=-1.0, limit=number)]


def bends_askew(arm: Arm) -> bool:
    """Whether a link may bend out of its load's plane: its stress is then no sum of products."""
    return any(link.asymmetry.askew for link in arm.links)


def _scalar(products: Products, size: int, limit: int) -> PoseRow:
    terms = {power: np.array([c]) for power, c in products.terms.items()}
    return row_of(terms, size, objective=False, scale=1.0, limit=limit)


def strength_products(problem: Problem, case: Any, cut: Cut, p: Array) -> list[tuple[int, Products]]:
    """Stresses and compressions of a pose that tell, over what is allowed, less one; each with its limit's number."""
    stresses = stress_products(case, cut, p)
    presses = compression_products(case, cut, p)
    products: list[tuple[int, Products]] = []
    for number, limit in enumerate(problem.limits):
        for entry in range(len(presses)):
            if limit.name == "buckling":
                sums: Sequence[Products] = [presses[entry]]
            elif limit.name == "safety_factor":
                sums = [stresses[entry, station] for station in range(len(STATIONS))]
            else:
                continue
            for item in sums:
                terms = {power: limit.value * c for power, c in item.terms.items() if c != 0.0}
                terms[()] = terms.get((), 0.0) - 1.0
                products.append((number, Products(terms)))
    return products
