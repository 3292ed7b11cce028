"""A taper whose ends are alike: every dimension of the far end is one ratio times that at the joint.

With D(s) = 1 - s + r s the size along the link over that at the joint, areas go with D^2, section moduli with D^3 and
second moments with D^4, whatever the shape, so that all that a taper does follows from r alone. Most of it is rational
in r (t is the distance to the far end, in lengths):

    1 / (3 int t^2/D^4) = r, 1 / int 1/D^2 = r, 1 / int 1/D^4 = 3 r^3/(1 + r + r^2), int D^2 = (1 + r + r^2)/3,
    int t/D^4 = (1 + 2 r)/(6 r^2), int D/D^4 = (1 + r)/(2 r^2), int D/D^4 int_s D^2 = (2 + r)/6

A quarter of such a link is one of its own. What the link's weight does, and Euler's load, is interpolated over log r
between values of `arm.chain.taper`. For floats and for an optimiser's symbols.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.polynomial import Chebyshev, chebyshev

from linkwright.core.materials.material import MaterialValues
from linkwright.core.sections import SHAPES
from linkwright.core.sections.taper import MOST_TAPER, Tapered

from .beam import QUARTERS, STATIONS, Beam, BendingFactors, Part, Station, Taper
from .taper import tapered_beam

_DEGREE = 18
"""Of the polynomials over log r: with ratios up to `MOST_TAPER` they are off by less than 1e-8 of the factor."""
_SPAN = math.log(MOST_TAPER)


def similar_beam(beam: Beam, log_taper: Any) -> Beam:
    """The beam of a link that tapers so from the section of which `beam` is the uniform beam."""
    ratio = ca.exp(log_taper)
    sums = 1.0 + ratio + ratio * ratio
    changes = {
        "axial_rigidity": ratio,
        "flexural_rigidity_height": ratio,
        "flexural_rigidity_width": ratio,
        "torsional_rigidity": 3.0 * ratio**3 / sums,
        "shear_rigidity_height": ratio,
        "shear_rigidity_width": ratio,
        "mass_per_length": sums / 3.0,
        **dict.fromkeys(_SHEAR_CENTRE, _offset(ratio)),
    }
    values: dict[str, Any] = {name: getattr(beam, name) for name in changes}
    changed: dict[str, Any] = {name: value * changes[name] for name, value in values.items() if value is not None}
    taper, by_weight = similar_taper(log_taper), 2.0 * ratio * ratio * (2.0 + ratio) / ((1.0 + ratio) * sums)
    if all(isinstance(values[name], float) and values[name] == 0.0 for name in _SHEAR_CENTRE):
        taper, by_weight = _about_centroid(taper), 1.0
    return replace(beam, **changed, torsion_by_weight=by_weight, taper=taper, log_taper=log_taper)


def _about_centroid(taper: Taper) -> Taper:
    """The same of a section that twists about its centroid: no eccentricity is spread along it."""
    parts = [
        Part(
            {name: value for name, value in part.rigidities.items() if name not in _SHEAR_CENTRE},
            replace(part.taper, offset_square=1.0),
        )
        for part in taper.parts
    ]
    return replace(taper, parts=tuple(parts), offset_square=1.0)


def similar_taper(log_taper: Any) -> Taper:
    """What such a taper is against a uniform link of the same effective rigidities and mean mass per length."""
    ratio = ca.exp(log_taper)
    sums = 1.0 + ratio + ratio * ratio
    weight_deflection, weight_slope, by_weight, column = _interpolated(log_taper)
    bending = replace(_by_moments(ratio), weight_deflection=weight_deflection, weight_slope=weight_slope)
    parts: list[Part] = []
    for k in range(QUARTERS):
        near, far = (1.0 + (item / QUARTERS) * (ratio - 1.0) for item in (k, k + 1))
        part_ratio = far / near
        area, second = near * near * part_ratio / ratio, near**4 * part_ratio / ratio
        part_torsion = 3.0 * part_ratio**3 / (1.0 + part_ratio + part_ratio * part_ratio)
        rigidities: dict[str, Any] = {
            "axial_rigidity": area,
            "flexural_rigidity_height": second,
            "flexural_rigidity_width": second,
            "torsional_rigidity": near**4 * part_torsion * sums / (3.0 * ratio**3),
            "shear_rigidity_height": area,
            "shear_rigidity_width": area,
            **dict.fromkeys(_SHEAR_CENTRE, near * _offset(part_ratio) / _offset(ratio)),
        }
        factors = _by_moments(part_ratio)
        parts.append(Part(rigidities, Taper(height=factors, width=factors, offset_square=_offset_square(part_ratio))))
    return Taper(
        balance=(0.25 + 0.5 * ratio + 0.75 * ratio * ratio) / sums,
        height=bending,
        width=bending,
        axial_weight=by_weight,
        shear_height_weight=by_weight,
        shear_width_weight=by_weight,
        column_height=column,
        column_width=column,
        offset_square=_offset_square(ratio),
        parts=tuple(parts),
        density=tuple(3.0 * (1.0 + (k / QUARTERS) * (ratio - 1.0)) ** 2 / sums for k in range(QUARTERS + 1)),
        stations=tuple(_station(share, ratio, sums) for share in STATIONS),
    )


_SHEAR_CENTRE = ("shear_centre_height", "shear_centre_width")


def _offset(ratio: Any) -> Any:
    """The shear centre's mean eccentricity, by the flexibility of torsion, over that at the joint."""
    return 1.5 * ratio * (1.0 + ratio) / (1.0 + ratio + ratio * ratio)


def _offset_square(ratio: Any) -> Any:
    """The mean of its square over the square of the mean."""
    return 4.0 * (1.0 + ratio + ratio * ratio) / (3.0 * (1.0 + ratio) * (1.0 + ratio))


def _by_moments(ratio: Any) -> BendingFactors:
    """The factors of a moment at the end; the weight's are left at those of a uniform link."""
    sums = 1.0 + ratio + ratio * ratio
    return BendingFactors(
        moment_deflection=(1.0 + 2.0 * ratio) / (3.0 * ratio), moment_slope=sums / (3.0 * ratio * ratio)
    )


def similar_station(share: Any, log_taper: Any) -> Station:
    """A cut of such a taper at a share of its length from its joint, in symbols too."""
    ratio = ca.exp(log_taper)
    return _station(share, ratio, 1.0 + ratio + ratio * ratio)


def _station(share: Any, ratio: Any, sums: Any) -> Station:
    t = 1.0 - share
    slope = 1.0 - ratio
    size = ratio + slope * t
    beyond = 3.0 * (ratio * ratio * t + ratio * slope * t**2 + slope * slope * (t**3 / 3.0)) / sums
    moment = 3.0 * (ratio * ratio * (t**2 / 2.0) + ratio * slope * (t**3 / 3.0) + slope * slope * (t**4 / 12.0)) / sums
    return Station(share, beyond, moment, size * size, size**3, size**3, size**3)


def _interpolated(log_taper: Any) -> list[Any]:
    """What follows from the weight under bending, its slope, along the link, and Euler's load, each 1 at ratio 1."""
    at = log_taper / _SPAN
    return [ca.exp(_clenshaw(row, at)) for row in _coefficients()]


def _clenshaw(coefficients: Sequence[float], at: Any) -> Any:
    last: Any = 0.0
    before: Any = 0.0
    for value in reversed(coefficients[1:]):
        last, before = 2.0 * at * last - before + value, last
    return at * last - before + coefficients[0]


@lru_cache(maxsize=1)
def _coefficients() -> tuple[tuple[float, ...], ...]:
    """Chebyshev coefficients of the logarithms of those factors, over log r / log `MOST_TAPER`."""
    nodes = chebyshev.chebpts1(_DEGREE + 1)
    plain = MaterialValues("", 0.0, elastic_modulus=1.0, shear_modulus=1.0, density=1.0, poisson_ratio=0.3)
    rows: list[list[float]] = []
    for node in nodes:
        near = SHAPES["circle"].from_variables([1.0])
        taper = tapered_beam(1.0, Tapered(near, near.scaled(math.exp(_SPAN * float(node)))), plain).taper
        bending = taper.height
        rows.append([bending.weight_deflection, bending.weight_slope, taper.axial_weight, taper.column_height])
    results: list[tuple[float, ...]] = []
    for values in np.log(np.array(rows, dtype=float)).T:
        fitted = Chebyshev.fit(nodes, values, _DEGREE, domain=[-1.0, 1.0])
        coefficients = [float(item) for item in fitted.coef]
        coefficients[0] -= float(fitted(0.0))  # a uniform link is exactly that
        results.append(tuple(coefficients))
    return tuple(results)
