"""The least that each option of a link can bring to a sum over links: every shape with every material, all its sizes.

A shape has one to four sizes. Its part of the sum is looked at on a grid over all of them; from the best there, and
the best far from it, a descent with exact derivatives ends at the least.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.errors.model import needs_shear_modulus
from linkwright.core.arm.figures import ChosenMaterial
from linkwright.core.materials.material import Material
from linkwright.core.optimize.exchange.design import MATERIAL_FIELDS, material_row, material_values, symbolic_properties
from linkwright.core.optimize.exchange.program import ipopt_options
from linkwright.core.optimize.exchange.rows import symbol
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections import SHAPES
from linkwright.core.sections.numeric import Array

from .at_once.cells import features, section_rows, twisted
from .products import EXPANSION, OfLink

_GRID = MappingProxyType({1: 129, 2: 40, 3: 14, 4: 8})
"""Steps of the grid for each size, by how many sizes there are."""
_ON_GRID = 1e-9
_FAR = 0.25
"""How far from the best on the grid (as a share of a size's range) the second start is, at least."""
_GIVES = 1e-7
"""By how much a section may break its own limits and still count."""
_MOST_FEATURE = 1e30
"""A rigidity of nothing has no reciprocal; this will do, as no least is there."""


@dataclass(frozen=True)
class _Group:
    """The options of one shape: their places in the link's list, their materials' figures (M, 7), and on the grid
    (N, v) the logarithms of their features (M, N, K) and which of them are allowed (M, N)."""

    shape: str
    places: NDArray[np.intp]
    rows: Array
    grid: Array
    logarithms: Array
    allowed: NDArray[np.bool_]


class LinkOptions:
    """What one link can be, ready to be searched again and again."""

    def __init__(self, problem: Problem, link: int, options: Sequence[tuple[str, Material]]) -> None:
        """`link` (from 0) is the one, or the first of those alike."""
        self.problem, self.link, self.options, self.ranges = problem, link, tuple(options), problem.ranges[link]
        self._shear = needs_shear_modulus(problem.arm, problem.load_cases)
        self._twisted = twisted(problem, link)
        self._limits = problem.limits_on_link(link)
        self._groups = tuple(self._group(shape) for shape in dict.fromkeys(shape for shape, _ in self.options))
        self._solvers: dict[tuple[str, int], Any] = {}

    def least(self, part: OfLink, per_price: float = 0.0, asked: NDArray[np.bool_] | None = None) -> Array:
        """The least of a link's part over each option's sizes; -inf where no least was found, or none was `asked` for.

        `per_price` is what each (EUR/kg)(kg/m) adds.
        """
        minimum = np.full(len(self.options), -np.inf)
        for group in self._groups:
            wanted = np.ones(len(group.places), dtype=bool) if asked is None else asked[group.places]
            if wanted.any():
                minimum[group.places] = self._least(group, part, per_price, wanted)
        return minimum

    def _group(self, shape: str) -> _Group:
        places = np.array([k for k, (item, _) in enumerate(self.options) if item == shape])
        rows = np.array([material_row((self.options[k][1],), self.problem, self.link) for k in places])
        materials = material_values(rows.T[:, :, None], 0)
        kind = SHAPES[shape]
        steps = np.linspace(0.0, 1.0, _GRID.get(len(kind.variables), 5))
        grid = np.stack(np.meshgrid(*[steps] * len(kind.variables), indexing="ij"), axis=-1)
        grid = grid.reshape(-1, len(kind.variables))
        with np.errstate(all="ignore"):
            section = kind.from_variables([*self._sizes(shape, grid.T[:, None])])
            properties = section.properties(materials.poisson_ratio)
            columns = features(properties, materials, shear=self._shear, twisted=self._twisted)
            size = (len(places), len(grid))
            logarithms = np.log(np.stack([np.broadcast_to(column, size) for column in columns], axis=-1))
            allowed = np.ones(size, dtype=bool)
            for value in section_rows(section, materials, self.ranges, self._limits):
                allowed &= np.asarray(value) <= _ON_GRID
        allowed &= np.isfinite(logarithms[..., :4]).all(axis=-1)
        # A feature that is not known (a yield strength nobody asks for) is in no sum.
        return _Group(shape, places, rows, grid, np.where(np.isfinite(logarithms), logarithms, 0.0), allowed)

    def _sizes(self, shape: str, at: Any) -> list[Any]:
        """The values of a shape's variables (SI) for shares of the ranges of their logarithms."""
        bounds = SHAPES[shape].variable_bounds(*self.ranges.sizes)
        return [low * (high / low) ** at[k] for k, (low, high) in enumerate(bounds)]

    def _least(self, group: _Group, part: OfLink, per_price: float, wanted: NDArray[np.bool_]) -> Array:
        growth = group.rows[:, MATERIAL_FIELDS.index("thermal_expansion"), None]
        prices = group.rows[:, MATERIAL_FIELDS.index("cost"), None]
        values = part.values(group.logarithms, growth) + per_price * prices * np.exp(group.logarithms[..., 0])
        values = np.where(group.allowed, values, np.inf)
        minimum = np.full(len(values), -np.inf)
        scale = float(np.median(np.abs(values[np.isfinite(values)]))) if np.isfinite(values).any() else 1.0
        solver, numbers = self._solver(group.shape, part, per_price, scale or 1.0)
        for k, link_values in enumerate(values):
            if not wanted[k] or not np.isfinite(link_values).any():
                continue
            first = int(link_values.argmin())
            far = np.abs(group.grid - group.grid[first]).max(axis=1) >= _FAR
            second = int(np.where(far, link_values, np.inf).argmin())
            ends = [solver(group.grid[start], group.rows[k], numbers) for start in dict.fromkeys((first, second))]
            ended = [end for end in ends if end is not None]
            if ended:
                minimum[k] = min(float(link_values[first]), *ended)
        return minimum

    def _solver(self, shape: str, part: OfLink, per_price: float, scale: float) -> tuple[Any, list[float]]:
        """A descent from a start for a material's figures, and the numbers that say what is to be least."""
        count = 2 ** int(np.ceil(np.log2(max(len(part.coefficients), 1))))
        key = (shape, count)
        if key not in self._solvers:
            self._solvers[key] = self._compiled(shape, count)
        solver, rows = self._solvers[key]
        spare = count - len(part.coefficients)
        powers = np.vstack([part.powers, np.zeros((spare, part.powers.shape[1]))])
        coefficients = np.concatenate([part.coefficients, np.zeros(spare)])
        numbers = [*(coefficients / scale), *powers.ravel(), *(part.logs / scale), per_price / scale]

        def descend(start: Array, row: Array, numbers: list[float]) -> float | None:
            # A start on a bound leaves no interior.
            result = solver(
                x0=np.clip(start, 1e-3, 1.0 - 1e-3),
                p=[*row, *numbers],
                lbx=0.0,
                ubx=1.0,
                lbg=-np.inf,
                ubg=np.full(rows, _GIVES),
            )
            return scale * float(result["f"]) if solver.stats()["success"] else None

        return descend, numbers

    def _compiled(self, shape: str, count: int) -> tuple[Any, int]:
        kind = SHAPES[shape]
        at = symbol("at", len(kind.variables))
        row, price = symbol("row", len(MATERIAL_FIELDS)), symbol("price")
        width = EXPANSION + 1
        coefficients, logs = symbol("c", count), symbol("logs", width)
        powers = symbol("powers", count * width)
        materials = _with_strength(row)
        sizes = self._sizes(shape, [at[k] for k in range(len(kind.variables))])
        properties = symbolic_properties(shape, sizes, materials.poisson_ratio)
        columns = features(properties, materials, shear=self._shear, twisted=self._twisted)
        logarithms = ca.log(ca.vertcat(*[ca.fmin(column, _MOST_FEATURE) for column in columns]))
        growth = row[MATERIAL_FIELDS.index("thermal_expansion")]
        table = ca.reshape(powers, width, count).T
        products = ca.exp(ca.mtimes(table[:, :EXPANSION], logarithms))
        # Expansion may be nought or below: it enters as it is.
        products = products * ca.if_else(table[:, EXPANSION] > 0.0, growth, 1.0)
        least = ca.dot(coefficients, products) + ca.dot(logs[:EXPANSION], logarithms)
        least = least + price * row[MATERIAL_FIELDS.index("cost")] * columns[0]
        rows = self._symbolic_rows(shape, at, materials)
        program = {
            "x": at,
            "p": ca.vertcat(row, coefficients, powers, logs, price),
            "f": least,
            "g": ca.vertcat(*rows) if rows else ca.SX(0, 1),
        }
        return ca.nlpsol("least", "ipopt", program, ipopt_options()), len(rows)

    def _symbolic_rows(self, shape: str, at: Any, materials: ChosenMaterial) -> list[Any]:
        """What must not be above zero, in symbols for shares of the ranges."""
        kind = SHAPES[shape]
        sizes = self._sizes(shape, [at[k] for k in range(len(kind.variables))])
        held = section_rows(kind.from_variables(sizes), materials, self.ranges, self._limits)
        rows = [ca.SX(value) for value in held]
        return [value for value in rows if not value.is_constant()]


def _with_strength(row: Any) -> ChosenMaterial:
    """A material's figures in symbols; a yield strength that is not known is nought, which has no reciprocal."""
    materials = material_values(row, 0)
    strong: Any = materials.allowed_stress
    return replace(materials, allowed_stress=ca.fmax(strong, 1.0))
