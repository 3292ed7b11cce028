"""What plies make of a thin wall: classical laminate theory in the wall's plane.

A tube whose wall is thin against its diameter strains evenly through the wall under bending, pull and torsion, so the
laminate acts by its in-plane stiffnesses (matrix A). Only where a wall buckles does it bend by itself: by its matrix D,
less what B couples, D - B A^-1 B, so that the order of the plies counts there. The laminate must be
balanced (as much at +angle as at -angle), or pull would twist the link. Source: R. M. Jones, Mechanics of Composite
Materials, 2nd ed., Taylor & Francis, 1999, sections 2.6 (transformed reduced stiffnesses) and 4.2 (matrices A, B and
D).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .walls import Orthotropic

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
