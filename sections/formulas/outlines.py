"""Properties of a section by its outline: exact integrals, and boundary elements for torsion and shear.

A solution costs from hundredths of a second (walls of a tenth of the size) to seconds (a hundredth). It is kept by the
ratios of dimensions, of which alone it depends but for powers of the size.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np

from linkwright.core.sections.formulas.plastic import polygon_modulus
from linkwright.core.sections.formulas.saint_venant import Moments, SaintVenant, moments, solve
from linkwright.core.sections.numeric import Array, Number, exp, log, polynomial
from linkwright.core.sections.properties import POWERS, SectionProperties

_THIN = 0.05
"""Share of the polar moment below which J is that of an open section with thin walls."""
_FINE = 2.2
"""How much finer the elements of such a section are."""
_NODES = 14
"""Ratios at which a fit is solved: the points of Chebyshev's polynomial of that degree in the ratio's logarithm."""
_ROUNDING = 1e-9
"""What is smaller, of a figure of size one, is zero."""


def about_centroid(loops: Sequence[Array]) -> list[Array]:
    """Open loops (N, 2) about their common centroid, m: the first, the outer edge, anticlockwise, holes clockwise."""
    turned: list[Array] = []
    for number, loop in enumerate(loops):
        anticlockwise = moments([loop - loop[0]]).area > 0.0
        turned.append(loop if anticlockwise == (number == 0) else loop[::-1])
    corner = turned[0][0]
    m = moments([loop - corner for loop in turned])
    centroid = corner + np.array([m.first_y, m.first_z]) / m.area
    return [loop - centroid for loop in turned]


@dataclass(frozen=True)
class Outlined:
    """What does not depend on a material of the region within loops about their centroid.

    Attributes:
        loops: as `about_centroid` gives them.
    """

    loops: Sequence[Array]

    @cached_property
    def _moments(self) -> Moments:
        return moments(self.loops)

    @cached_property
    def _saint_venant(self) -> SaintVenant:
        result = solve(self.loops)
        if result.torsion_constant > _THIN * (self._moments.yy + self._moments.zz):
            return result
        # J is the small difference of two large integrals here: at the usual fineness it can be wrong by 2 %.
        return solve(self.loops, _FINE)

    @cached_property
    def figures(self) -> Mapping[str, float]:
        """All of `SectionProperties` but shear areas by name, in SI, and A / A_s as (a, c) of a + c (nu / (1 + nu))^2:
        `shear_y`, `poisson_y`, `shear_z`, `poisson_z`."""
        m, numeric, loops = self._moments, self._saint_venant, self.loops
        low, high = loops[0].min(axis=0), loops[0].max(axis=0)
        fibre_y, fibre_z = float(max(high[1], -low[1])), float(max(high[0], -low[0]))
        return MappingProxyType(
            {
                "area": m.area,
                "second_moment_y": m.zz,
                "second_moment_z": m.yy,
                "torsion_constant": numeric.torsion_constant,
                "section_modulus_y": m.zz / fibre_y,
                "section_modulus_z": m.yy / fibre_z,
                "plastic_modulus_y": polygon_modulus(loops, 1),
                "plastic_modulus_z": polygon_modulus(loops, 0),
                "extreme_fibre_y": fibre_y,
                "extreme_fibre_z": fibre_z,
                "torsion_modulus": numeric.torsion_modulus,
                "width": float(high[0] - low[0]),
                "height": float(high[1] - low[1]),
                "centroid_y": float(-low[0]),
                "centroid_z": float(-low[1]),
                "product_moment_yz": m.yz,
                "shear_stress_area_y": m.yy * _cut(loops, 0) / _first_moment(loops, 0),
                "shear_stress_area_z": m.zz * _cut(loops, 1) / _first_moment(loops, 1),
                "shear_centre_y": numeric.shear_centre[0],
                "shear_centre_z": numeric.shear_centre[1],
                "warping_constant": numeric.warping_constant,
                "shear_y": numeric.shear_y[0],
                "poisson_y": numeric.shear_y[1],
                "shear_z": numeric.shear_z[0],
                "poisson_z": numeric.shear_z[1],
            }
        )


def with_shear(figures: Mapping[str, Number], square: Number, size: Number = 1.0) -> SectionProperties:
    """Properties of a section `size` (m) as large as that of the figures; `square` is (nu / (1 + nu))^2."""
    values = {name: value * size ** POWERS[name] for name, value in figures.items() if name in POWERS}
    shear = {
        f"shear_area_{side}": values["area"] / (figures[f"shear_{side}"] + square * figures[f"poisson_{side}"])
        for side in ("y", "z")
    }
    return SectionProperties(**values, **shear)


@dataclass(frozen=True)
class Fit:
    """Figures of a section of size one as functions of one ratio: of its logarithm where they are positive, the
    exponentials of polynomials, else polynomials.

    Attributes:
        low: the least ratio at which it was solved.
        high: the greatest.
        coefficients: by figure, of powers of a variable from -1 to 1; one number where a figure is zero throughout.
        positive: the figures whose logarithm the polynomial gives.
    """

    low: float
    high: float
    coefficients: Mapping[str, Sequence[float]]
    positive: frozenset[str]

    def at(self, ratio: Number) -> Mapping[str, Number]:
        """The figures at ratios within its range."""
        middle, half = 0.5 * math.log(self.low * self.high), 0.5 * math.log(self.high / self.low)
        place = (log(ratio) - middle) / half
        values = {name: polynomial(powers, (place,)) for name, powers in self.coefficients.items()}
        return {name: exp(value) if name in self.positive else value for name, value in values.items()}


def fit(figures_at: Callable[[float], Mapping[str, float]], low: float, high: float) -> Fit:
    """The figures between two ratios by their values at some of them."""
    nodes = np.cos(math.pi * (np.arange(_NODES) + 0.5) / _NODES)
    ratios = np.exp(0.5 * (math.log(low * high) + math.log(high / low) * nodes))
    rows = [figures_at(float(ratio)) for ratio in ratios]
    coefficients: dict[str, Sequence[float]] = {}
    positive: set[str] = set()
    for name in rows[0]:
        values = np.array([row[name] for row in rows])
        if np.abs(values).max() < _ROUNDING:
            coefficients[name] = (0.0,)
            continue
        if values.min() > 0.0:
            positive.add(name)
            values = np.log(values)
        series = np.polynomial.chebyshev.chebfit(nodes, values, _NODES - 1)
        coefficients[name] = tuple(np.polynomial.chebyshev.cheb2poly(series).tolist())
    return Fit(low, high, MappingProxyType(coefficients), frozenset(positive))


def _cut(loops: Sequence[Array], axis: int) -> float:
    """Width (m) of what a line through the centroid cuts, where y (axis 0) or z (axis 1) is zero."""
    places: list[float] = []
    for loop in loops:
        ends = np.roll(loop, -1, axis=0)
        across = (loop[:, axis] > 0.0) != (ends[:, axis] > 0.0)
        share = loop[across, axis] / (loop[across, axis] - ends[across, axis])
        along = loop[across, 1 - axis] + share * (ends[across, 1 - axis] - loop[across, 1 - axis])
        places += along.tolist()
    places.sort()
    return float(sum(places[1::2]) - sum(places[::2]))


def _first_moment(loops: Sequence[Array], axis: int) -> float:
    """First moment (m^3) about that line of what lies on its positive side, by Green's theorem edge by edge."""
    total = 0.0
    for loop in loops:
        low, high = loop, np.roll(loop, -1, axis=0)
        before, after = low[:, axis], high[:, axis]
        step = high[:, 1 - axis] - low[:, 1 - axis]
        change = np.where(before == after, 1.0, after - before)
        start, end = np.maximum(before, 0.0), np.maximum(after, 0.0)
        # Of an edge that crosses the line only the part beyond it counts.
        beyond = np.where(before == after, (before > 0.0).astype(float), (end - start) / change)
        total += float(np.sum(step * beyond * (start**2 + start * end + end**2))) / 6.0
    return abs(total)
