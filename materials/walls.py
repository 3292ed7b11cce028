"""How a material resists the buckling of thin walls: by the stiffnesses of an orthotropic wall, of plies or not.

A wall of thickness t has D_ij = d_ij t^3 against bending and A_ij = a_ij t in its plane, x along the link:

- flat, long and simply held at both edges, evenly pressed: N = 2 pi^2/b^2 (sqrt(D11 D22) + D12 + 2 D66); held at one
  edge alone: N = 12 D66/b^2. R. M. Jones, Buckling of Bars, Plates, and Shells, Bull Ridge, 2006; both are those of
  EN 1993-1-5:2006, tables 4.1 and 4.2, where the wall is isotropic (k = 4.0 and 0.43);
- held at both edges and bent in its plane or sheared: N = pi^2/b^2 K with K a polynomial of beta = (D12 + 2
  D66)/sqrt(D11 D22), fitted to Rayleigh-Ritz solutions for beta from 0.1 to 3 (all that a wall can have), within 1 %.
  Where it is isotropic they are k = 23.9 and 5.34 of EN 1993-1-5, table 4.1 and A.3;
- round: N = 2/R min over x of sqrt(P/Q), P = D11 + 2 (D12 + 2 D66) x + D22 x^2, Q = a22 + (2 a12 + a66) x + a11 x^2
  with [a] the inverse of [A], x the square of the waves' ratio: Donnell's equations with any number of waves, E t^2/(R
  sqrt(3 (1 - nu^2))) where it is isotropic. Twisted: NASA SP-8007 (1968), 4.2, with its factor of 0.67.

What plies at an angle do to the coupling of bending and twist (D16, D26) is left out; an unsymmetric stack bends by
D - B A^-1 B.

Plies make a wall by classical laminate theory. A tube whose wall is thin against its diameter strains evenly through
the wall under bending, pull and torsion, so the laminate acts by its in-plane stiffnesses (matrix A). Only where a wall
buckles does it bend by itself: by its matrix D, less what B couples, so that the order of the plies counts there. The
laminate must be balanced (as much at +angle as at -angle), or pull would twist the link. Source: R. M. Jones, Mechanics
of Composite Materials, 2nd ed., Taylor & Francis, 1999, sections 2.6 (transformed reduced stiffnesses) and 4.2
(matrices A, B and D).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

Array = NDArray[np.float64]

_BALANCED_WITHIN = 1e-6
"""How large a coupling of pull and twist may be, as a share of the in-plane stiffness."""


@dataclass(frozen=True)
class Ply:
    """A ply with all fibres along one direction: moduli (Pa) along, across and in shear, the greater Poisson's ratio
    (contraction across under pull along), and expansions (1/K) along and across, None where not known."""

    along: float
    across: float
    shear: float
    poisson_ratio: float
    expansion_along: float | None = None
    expansion_across: float | None = None

    @property
    def stiffness(self) -> Array:
        """The reduced stiffnesses (3, 3) in the ply's directions, Pa."""
        minor = self.poisson_ratio * self.across / self.along
        whole = 1.0 - self.poisson_ratio * minor
        mixed = self.poisson_ratio * self.across / whole
        return np.array([[self.along / whole, mixed, 0.0], [mixed, self.across / whole, 0.0], [0.0, 0.0, self.shear]])


@dataclass(frozen=True)
class Wall:
    """What a balanced laminate is as one: moduli (Pa) along the link, around it and in shear, Poisson's ratio
    (contraction around under pull along), expansions (1/K) along and around, None where the plies' are not known, and
    how stiff it is against its bending."""

    along: float
    around: float
    shear: float
    poisson_ratio: float
    expansion_along: float | None
    expansion_around: float | None
    bending: Orthotropic


class Unbalanced(ValueError):
    """A laminate that twists under pull."""


def wall_of(ply: Ply, angles: Sequence[float], thicknesses: Sequence[float] | None = None) -> Wall:
    """The wall that plies make whose fibres lie at `angles` (rad, from the link's axis), equally thick or as
    `thicknesses` says (in any unit). Raises `Unbalanced`."""
    shares = np.full(len(angles), 1.0) if thicknesses is None else np.array(thicknesses, dtype=float)
    shares = shares / shares.sum()
    stiffness, coupling, bending, thermal = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3)), np.zeros(3)
    edges = np.concatenate([[0.0], np.cumsum(shares)]) - 0.5
    grows = ply.expansion_along is not None and ply.expansion_across is not None
    values = np.array([ply.expansion_along or 0.0, ply.expansion_across or 0.0, 0.0])
    for number, (angle, share) in enumerate(zip(angles, shares.tolist(), strict=True)):
        to_ply = _strains_turned(angle)
        turned = to_ply.T @ ply.stiffness @ to_ply
        stiffness += share * turned
        low, high = edges[number], edges[number + 1]
        coupling += 0.5 * (high**2 - low**2) * turned
        bending += 4.0 * (high**3 - low**3) * turned
        thermal += share * (to_ply.T @ ply.stiffness @ values)
    if np.abs(stiffness[:2, 2]).max() > _BALANCED_WITHIN * np.trace(stiffness):
        raise Unbalanced
    compliance = np.linalg.inv(stiffness)
    expansion: Array = compliance @ thermal
    bends: Array = bending - 12.0 * coupling @ compliance @ coupling
    return Wall(
        along=float(1.0 / compliance[0, 0]),
        around=float(1.0 / compliance[1, 1]),
        shear=float(1.0 / compliance[2, 2]),
        poisson_ratio=float(-compliance[0, 1] / compliance[0, 0]),
        expansion_along=float(expansion[0]) if grows else None,
        expansion_around=float(expansion[1]) if grows else None,
        bending=Orthotropic(float(bends[0, 0]), float(bends[0, 1]), float(bends[1, 1]), float(bends[2, 2])),
    )


def _strains_turned(angle: float) -> Array:
    """The matrix from strains (along, around, shear angle) of the link to those of a ply at an angle."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2.0 * c * s, 2.0 * c * s, c * c - s * s]])


BENT = (13.4, 10.4, 0.0)
"""K of a wall held at both edges and bent in its plane, over the powers of beta."""
SHEARED = (3.30, 2.20, -0.17)
"""K of the same wall under shear, over (D11 D22^3)^(1/4)."""
FREE_BENT = (4.7, 6.55, -0.75)
"""K for the difference of the stresses at the edges of a wall held at one edge: low enough that no edge stresses up to
four times as large and of the other sign at the held edge are taken for better than the strip's by more than 7 %."""
TWISTED = 0.67 * 21.75 / (2.0 * math.pi)
"""Of a round wall: shear flow over D22^(5/8) (E_x t)^(3/8) / (R^3 L^2)^(1/4)."""


@dataclass(frozen=True)
class WallCompliance:
    """One over the stresses (Pa) at which walls of a material buckle, for those of unit slenderness; in an optimiser's
    symbols too. Zero is a wall that does not buckle: what nobody knows limits nothing.

    Attributes:
        pressed: held at both edges, sigma (b/t)^2.
        bent: bent in its plane, sigma (b/t)^2 at its edges.
        sheared: tau (b/t)^2.
        free_pressed: held at one edge, sigma (b/t)^2.
        free_bent: the same, for the difference of the stresses at its edges.
        round_pressed: round, sigma R/t, without a knock-down factor.
        round_twisted: tau (R/t)^(5/4) (L/R)^(1/2), with its factor.
        round_depth: of a wall that is the same all through and has the same knock-down factor, its thickness over t:
            sqrt(12) (d11 d22/(a11 a22))^(1/4).
    """

    pressed: Any = 0.0
    bent: Any = 0.0
    sheared: Any = 0.0
    free_pressed: Any = 0.0
    free_bent: Any = 0.0
    round_pressed: Any = 0.0
    round_twisted: Any = 0.0
    round_depth: Any = 1.0

    @property
    def modulus(self) -> Any:
        """The elastic modulus (Pa) of an isotropic material (nu 0.3) whose flat walls, simply held at their edges,
        would buckle under the same compression. Round walls are held to it too, which a cylinder under bending keeps to
        within its knock-down."""
        return 3.0 * (1.0 - 0.3**2) / math.pi**2 / self.pressed


@dataclass(frozen=True)
class Orthotropic:
    """Stiffnesses (Pa) of a wall along the link (11), around it (22), of both (12) and in shear (66); no coupling of
    pull and twist."""

    along: float
    both: float
    around: float
    shear: float


def orthotropic(along: float, around: float, shear: float, poisson_ratio: float) -> Orthotropic:
    """The plane stiffnesses of moduli (Pa) along, around and in shear and the contraction around under pull along."""
    minor = poisson_ratio * around / along
    whole = 1.0 - poisson_ratio * minor
    return Orthotropic(along / whole, minor * along / whole, around / whole, shear)


@lru_cache(maxsize=64)
def wall_compliance(plane: Orthotropic, bending: Orthotropic | None = None) -> WallCompliance:
    """How walls of these stiffnesses buckle: A/t of `plane`, 12 D/t^3 of `bending` (that of a wall the same all
    through where it is left out)."""
    bending = bending or plane
    d11, d12, d22, d66 = (item / 12.0 for item in (bending.along, bending.both, bending.around, bending.shear))
    mean, mixed = math.sqrt(d11 * d22), d12 + 2.0 * d66
    beta = mixed / mean
    shared = (d11 * d22**3) ** 0.25
    whole = plane.along * plane.around - plane.both**2
    soft11, soft22, soft12 = plane.around / whole, plane.along / whole, -plane.both / whole
    bent = Polynomial([d11, 2.0 * mixed, d22])
    pulled = Polynomial([soft22, 2.0 * soft12 + 1.0 / plane.shear, soft11])
    square = math.pi**2
    twisted = TWISTED * d22**0.625 * (1.0 / soft11) ** 0.375
    return WallCompliance(
        pressed=1.0 / (2.0 * square * (mean + mixed)),
        bent=1.0 / (square * mean * _of(BENT, beta)),
        sheared=1.0 / (square * shared * _of(SHEARED, beta)),
        free_pressed=1.0 / (12.0 * d66),
        free_bent=1.0 / (square * mean * _of(FREE_BENT, beta)),
        round_pressed=1.0 / (2.0 * math.sqrt(_least_ratio(bent, pulled))),
        round_twisted=1.0 / twisted,
        round_depth=math.sqrt(12.0) * (d11 * d22 / (plane.along * plane.around)) ** 0.25,
    )


def _of(coefficients: tuple[float, ...], beta: float) -> float:
    return sum(c * beta**k for k, c in enumerate(coefficients))


def _least_ratio(above: Polynomial, below: Polynomial) -> float:
    """The least of the ratio of two quadratics over x from 0 to infinity."""
    turning = (above.deriv() * below - above * below.deriv()).roots()
    places = [0.0, *(float(x.real) for x in np.atleast_1d(turning) if abs(x.imag) < 1e-9 * abs(x) and x.real > 0.0)]
    return min([float(above(x) / below(x)) for x in places] + [float(above.coef[2] / below.coef[2])])
