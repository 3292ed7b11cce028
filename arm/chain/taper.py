"""A link whose section changes along it, as a beam: quadrature of the beam integrals, once, to plain factors.

With s the distance to the far end (in lengths) and W(s) the moment of the weight beyond (of a weight 1 on a length 1),
the far end of a cantilever moves and turns by

    deflection: F L^3 int s^2/EI + M L^2 int s/EI + w L^4 int W s/EI
    slope:      F L^2 int s/EI   + M L int 1/EI   + w L^3 int W/EI

(unit load theorem: Gere & Goodno, Mechanics of Materials, beams of varying section). The beam's rigidities are the
effective ones, for which a uniform beam gives the same under a force at its end; `Taper` has what the rest is against a
uniform beam of those, so that every formula stays that of the uniform beam times a factor that is 1 there. Factors do
not depend on the link's length. Left out: the shear that a normal stress along a slanted side makes, small for slopes
up to some 10 degrees (B. A. Boley, On the accuracy of the Bernoulli-Euler theory for beams of variable section, J.
Appl. Mech. 30 (1963) 373-378).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial
from numpy.polynomial.legendre import leggauss

from linkwright.core.materials.material import MaterialValues
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.taper import Tapered, size_ratio

from .beam import QUARTERS, STATIONS, Beam, BendingFactors, Part, Station, Taper, elastic_beam

_NODES = 12
"""Gauss points in each quarter of a link: integrals of the shapes' smooth functions to some 1e-12."""
_DEGREE = 10
"""Of the polynomial that stands for the area along a link; it is quadratic for most shapes, and then exact."""
_MODES = 10
"""Trial functions for the Euler load."""


@dataclass(frozen=True)
class _Cut:
    """Quadrature over a stretch of a link: `share` and `weight` (N,) run over the stretch as 0 to 1, `mass` is the mass
    per length against its mean."""

    share: Array
    weight: Array
    mass: Polynomial

    def integral(self, values: Array) -> float:
        return float(self.weight @ values)


def tapered_beam(length: float, section: Tapered, material: MaterialValues, *, shear: bool = True) -> Beam:
    """The beam that a tapered section makes of a material at its temperature; `shear` as in `elastic_beam`.

    Raises `materials.material.MissingProperty`.
    """
    poisson_ratio = 0.3 if material.poisson_ratio is None else material.poisson_ratio
    points, weights = leggauss(_NODES)
    quarter = 0.5 * (points + 1.0)
    share = np.concatenate([(k + quarter) / QUARTERS for k in range(QUARTERS)])
    properties = section.along(share, poisson_ratio)
    area = _column(properties.area, share)
    fitted = Chebyshev.fit(share, area, _DEGREE, domain=[0.0, 1.0]).convert(kind=Polynomial)
    mean = float(np.sum(np.tile(0.5 * weights, QUARTERS) * area)) / QUARTERS
    whole = _Cut(share, np.tile(0.5 * weights, QUARTERS) / QUARTERS, fitted / mean)
    # The beam at every node at once, as arrays; what comes out of it are effective rigidities, plain numbers.
    local = elastic_beam(length, properties, material, shear=shear)
    beam, taper = _effective(local, whole, share, length)
    parts: list[Part] = []
    for k in range(QUARTERS):
        rows = slice(k * _NODES, (k + 1) * _NODES)
        cut = _Cut(quarter, 0.5 * weights, fitted / mean)  # its weight is never asked for (see `arm.limits.modes`)
        piece, factors = _effective(_rows(local, rows, len(share)), cut, quarter, length)
        ratios = {name: getattr(piece, name) / getattr(beam, name) for name in _OF_PARTS if getattr(beam, name)}
        parts.append(Part(ratios, factors))
    at = section.along(np.array(STATIONS), poisson_ratio)
    taper = replace(
        taper,
        column_height=_column_factor(np.asarray(local.flexural_rigidity_height), whole, beam.flexural_rigidity_height),
        column_width=_column_factor(np.asarray(local.flexural_rigidity_width), whole, beam.flexural_rigidity_width),
        parts=tuple(parts),
        density=tuple(float(fitted(k / QUARTERS)) / mean for k in range(QUARTERS + 1)),
        stations=_stations(at, section.properties(poisson_ratio), whole.mass),
    )
    ratio = size_ratio(section)
    log_taper = 0.0 if ratio is None else math.log(ratio)
    return _with(beam, mass_per_length=material.need("density") * mean, taper=taper, log_taper=log_taper)


_RIGIDITIES = (
    "axial_rigidity",
    "flexural_rigidity_height",
    "flexural_rigidity_width",
    "torsional_rigidity",
    "shear_rigidity_height",
    "shear_rigidity_width",
)


_OF_PARTS = (*_RIGIDITIES, "shear_centre_height", "shear_centre_width")


def _column(values: object, like: Array) -> Array:
    return np.broadcast_to(np.asarray(values, dtype=float), like.shape)


def _with(beam: Beam, **changes: object) -> Beam:
    return replace(beam, **changes)  # pyright: ignore[reportArgumentType]


def _rows(local: Beam, rows: slice, count: int) -> Beam:
    changes = {
        name: np.broadcast_to(np.asarray(value, dtype=float), (count,))[rows]
        for name in _OF_PARTS
        if (value := getattr(local, name)) is not None
    }
    return _with(local, **changes)


def _effective(local: Beam, cut: _Cut, share: Array, length: float) -> tuple[Beam, Taper]:
    """The uniform beam of the same stiffness against forces at its end, and the factors for everything else."""
    s = 1.0 - share
    beyond = cut.mass.integ(lbnd=1.0) * -1.0  # the weight beyond a place, of a weight 1
    moment = (beyond.integ(lbnd=1.0) * -1.0)(share)
    force = beyond(share)
    changes: dict[str, float] = {}
    bending: list[BendingFactors] = []
    for name in ("flexural_rigidity_height", "flexural_rigidity_width"):
        flexibility = 1.0 / _column(getattr(local, name), share)
        rigidity = 1.0 / (3.0 * cut.integral(s**2 * flexibility))
        changes[name] = rigidity
        bending.append(
            BendingFactors(
                weight_deflection=8.0 * rigidity * cut.integral(moment * s * flexibility),
                moment_deflection=2.0 * rigidity * cut.integral(s * flexibility),
                moment_slope=rigidity * cut.integral(flexibility),
                weight_slope=6.0 * rigidity * cut.integral(moment * flexibility),
            )
        )
    by_weight: dict[str, float] = {}
    for name in ("axial_rigidity", "shear_rigidity_height", "shear_rigidity_width", "torsional_rigidity"):
        by_weight[name] = 1.0
        if getattr(local, name) is not None:
            flexibility = 1.0 / _column(getattr(local, name), share)
            changes[name] = 1.0 / cut.integral(flexibility)
            by_weight[name] = 2.0 * changes[name] * cut.integral(force * flexibility)
    centre = (cut.mass * Polynomial([0.0, 1.0])).integ()(1.0)
    eccentric, square = _shear_centres(local, cut, share, force)
    # Warping is taken as free along a tapered link.
    changes.update(eccentric, flexural_rigidity_coupling=0.0)
    beam = _with(local, length=length, **changes)
    return beam, Taper(
        balance=float(centre),
        height=bending[0],
        width=bending[1],
        axial_weight=by_weight["axial_rigidity"],
        shear_height_weight=by_weight["shear_rigidity_height"],
        shear_width_weight=by_weight["shear_rigidity_width"],
        offset_square=square,
    )


def _shear_centres(local: Beam, cut: _Cut, share: Array, force: Array) -> tuple[dict[str, float], float]:
    """What a beam's shear centre is on the mean, by the flexibility of torsion, with how much more its weight
    (`force` beyond each place) twists it; and the mean of its square over the square of the mean."""
    means = {"shear_centre_height": 0.0, "shear_centre_width": 0.0, "torsion_by_weight": 1.0}
    if local.torsional_rigidity is None:
        return means, 1.0
    flexibility = 1.0 / _column(local.torsional_rigidity, share)
    flexibility = flexibility / cut.integral(flexibility)
    square = 1.0
    for name in ("shear_centre_height", "shear_centre_width"):
        offset = _column(getattr(local, name), share)
        means[name] = mean = cut.integral(offset * flexibility)
        if mean != 0.0:
            square = cut.integral(offset**2 * flexibility) / mean**2
            means["torsion_by_weight"] = 2.0 * cut.integral(offset * force * flexibility) / mean
    return means, square


def _column_factor(rigidity: Array, cut: _Cut, effective: object) -> float:
    """Euler's load of the tapered column, fixed at its joint and free, over that of the effective uniform one.

    Rayleigh and Ritz with slopes s^k: int EI w'^2 = P int w^2, w the slope, 0 at the joint.
    """
    import scipy.linalg  # here, for only a taper's buckling needs it

    powers = np.arange(1, _MODES + 1)
    slope = np.array([Chebyshev.basis(int(k), domain=[0.0, 1.0])(cut.share) for k in powers]) - np.array(
        [[Chebyshev.basis(int(k), domain=[0.0, 1.0])(0.0)] for k in powers]
    )
    curvature = np.array([Chebyshev.basis(int(k), domain=[0.0, 1.0]).deriv()(cut.share) for k in powers])
    stiffness = (curvature * (cut.weight * _column(rigidity, cut.share))) @ curvature.T
    pressed = (slope * cut.weight) @ slope.T
    least = float(scipy.linalg.eigh(stiffness, pressed, eigvals_only=True, subset_by_index=[0, 0])[0])
    return least / (np.pi**2 / 4.0) / float(effective)  # type: ignore[arg-type]


def _stations(at: SectionProperties, near: SectionProperties, mass: Polynomial) -> tuple[Station, ...]:
    beyond = mass.integ(lbnd=1.0) * -1.0
    moment = beyond.integ(lbnd=1.0) * -1.0
    names: Sequence[str] = ("area", "section_modulus_y", "section_modulus_z", "torsion_modulus")
    ratios = [_column(getattr(at, name), np.array(STATIONS)) / float(getattr(near, name)) for name in names]
    return tuple(
        Station(share, float(beyond(share)), float(moment(share)), *(float(ratio[k]) for ratio in ratios))
        for k, share in enumerate(STATIONS)
    )
