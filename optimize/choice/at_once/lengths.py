"""Rows with free lengths: each coefficient is a polynomial in the lengths, read off at lengths between their bounds.

To first order forces and deflections of straight links are polynomials in lengths: a force bends with the third power
of its link's and lever arms of others, a weight has one power more. Only errors at poses of the joints, masses,
cost and reach are rows here; other limits are left out, which can only lower a bound.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.prices import price_by_length
from linkwright.core.arm.errors.model import BEAM_FIELDS
from linkwright.core.optimize.choice.pose_products import error_vectors, features_of
from linkwright.core.optimize.choice.products import Power
from linkwright.core.optimize.exchange.binding_poses import ErrorCut, Pool
from linkwright.core.optimize.exchange.exchange import Context
from linkwright.core.optimize.exchange.totals import carried_mass, drives_cost, fixed_error
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections.numeric import Array

from .cells import LENGTH, PRICE
from .pose_rows import PoseRow, error_rows, sums_rows

_DEGREE = 4
"""Forces of weights (one power) bend (three more)."""
_AGREE = 1e-7
"""How well the polynomials must be right where they were not read off, relative to the greatest error there."""
_NOTHING = 1e-10
"""A monomial that adds less than this share of the greatest error is left out."""


def log_spans(problem: Problem, links: Sequence[int]) -> Array:
    """The logarithms (n, 2) of the least and the greatest length (m) of some links."""
    return np.log([problem.length_spans[link] for link in links])


class LengthRows:
    """The rows of a problem with free lengths between their bounds; poses read off are kept."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self._known: dict[ErrorCut, dict[Power, Array] | None] = {}
        self._links = [k for k, link in enumerate(context.problem.arm.links) if link.section is not None]
        powers = itertools.product(range(_DEGREE + 1), repeat=len(self._links))
        self._monomials = np.array([power for power in powers if sum(power) <= _DEGREE])
        generator = np.random.default_rng(7)
        count = len(self._monomials)
        low, high = np.exp(log_spans(context.problem, self._links)).T
        self._scale = np.sqrt(low * high)
        self._samples = generator.uniform(low, high, (2 * count + 8, len(self._links)))
        self._read = 2 * count

    def rows_of(self, pool: Pool, arm: Arm, p: Array, worth: float) -> list[PoseRow] | None:
        """The rows for a pool, read off about a design; None where the error is no such sum."""
        problem = self.context.problem
        size = arm.size
        fixed = fixed_error(self.context.model)
        rigid = sum(link.mass or 0.0 for link in arm.links if link.section is None)
        stays = sum(link.length for link in arm.links if link.section is None)
        mass: dict[Power, Array] = {((k, 0), (k, LENGTH)): np.ones(1) for k in self._links}
        cost: dict[Power, Array] = {((k, PRICE), (k, LENGTH)): np.ones(1) for k in self._links}
        if (by_length := price_by_length(problem.arm)) > 0.0:
            cost |= {((k, LENGTH),): np.array([by_length]) for k in self._links}
        reach: dict[Power, Array] = {((k, LENGTH),): np.ones(1) for k in self._links}
        sums = {"mass": mass, "total_mass": mass, "cost": cost, "reach": reach}
        carried = rigid + carried_mass(problem)
        rest = {"mass": rigid, "total_mass": carried, "cost": drives_cost(problem), "reach": stays}
        rows = sums_rows(problem, sums, rest, size, worth)
        for cut in dict.fromkeys(pool.errors):
            if cut not in self._known:
                self._known[cut] = self._terms(cut, p)
            terms = self._known[cut]
            if terms is None:
                return None
            rows += error_rows(problem, terms, size, worth, fixed)
        return rows

    def _terms(self, cut: ErrorCut, p: Array) -> dict[Power, Array] | None:
        """The error at a pose, each product with powers of lengths; None where it is no such sum."""
        model = self.context.model
        if not model.planar and any(link.asymmetry.warps for link in model.arm.links):
            return None  # how stiff a link is against twisting goes with its length
        array = p.reshape(model.arm.size, len(BEAM_FIELDS))
        read: list[Mapping[Power, Array]] = []
        for lengths in self._samples:
            design = array.copy()
            design[self._links, BEAM_FIELDS.index("length")] = lengths
            vectors = error_vectors(model, cut, design.ravel())
            if vectors is None:
                return None
            read.append(vectors.terms)
        table = np.prod((self._samples / self._scale)[:, None, :] ** self._monomials, axis=2)
        sizes = {power: max(_size(item.get(power), power, p, array) for item in read) for power in _powers(read)}
        largest = max(sizes.values(), default=0.0)
        terms: dict[Power, Array] = {}
        for power, size in sizes.items():
            values = np.array([item.get(power, np.zeros(3)) for item in read])
            fitted, *_ = np.linalg.lstsq(table[: self._read], values[: self._read], rcond=None)
            worth = size / max(float(np.linalg.norm(values, axis=1).max()), 1e-300)
            wrong = np.abs(table[self._read :] @ fitted - values[self._read :]).max()
            if wrong * worth > _AGREE * largest:
                return None
            for monomial, c in zip(self._monomials.tolist(), fitted, strict=True):
                if np.linalg.norm(c) * worth <= _NOTHING * largest:
                    continue
                lengths = [(link, LENGTH) for link, n in zip(self._links, monomial, strict=True) for _ in range(n)]
                terms[tuple(sorted((*power, *lengths)))] = c / float(np.prod(self._scale ** np.array(monomial)))
        return terms


def _powers(read: list[Mapping[Power, Array]]) -> dict[Power, None]:
    return dict.fromkeys(power for item in read for power in item)


def _size(c: Array | None, power: Power, p: Array, values: Array) -> float:
    """What a term adds to the error of the design that it was read off about (m)."""
    if c is None:
        return 0.0
    features = features_of(p, len(values))
    return float(np.linalg.norm(c)) * float(np.prod([abs(features[place]) for place in power]))
