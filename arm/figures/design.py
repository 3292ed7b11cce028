"""What a figure sees of designs: one as numbers or as expressions, its sums over the links, many as numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.materials.material import MaterialValues
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.section import Section

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm, LoadCase
    from linkwright.core.arm.limits.wall_modes import Mode
    from linkwright.core.arm.worst.search import WorstSearch

POSES = 2048
"""Poses from which the worst ones are climbed to."""


@dataclass(frozen=True)
class DesignValues:
    """A design of known masses as a figure with a value at every pose is evaluated on it: the arm with its beam values
    p, the load cases, and the search of its workspace. `scan` poses are spread over that, beside those `known` (N, n)
    to be bad."""

    arm: Arm
    load_cases: tuple[LoadCase, ...]
    search: WorstSearch
    p: Array
    scan: int = POSES
    known: tuple[tuple[float, ...], ...] = field(default=())

    @cached_property
    def beams(self) -> tuple[Beam, ...]:
        """The links as beams."""
        return beams_of(self.arm, self.load_cases)

    @cached_property
    def poses(self) -> Array:
        """Poses (N, n) from which the worst are climbed to."""
        spread = self.search.poses(self.p, self.scan)
        return np.vstack([spread, self.known]) if self.known else spread


@dataclass(frozen=True)
class ChosenMaterial(MaterialValues):
    """The values of a material that may be chosen for a link, and the stress (Pa) that a safety factor of one allows
    there: the yield strength, over what is asked of the link beyond the others."""

    allowed_stress: float = 0.0


@dataclass(frozen=True)
class DesignExpressions:
    """A design's figures as expressions of the optimiser's numbers, or of what each link brings, and the materials'
    parameters (SI); sections are None where rows are not to see them."""

    sections: tuple[Section | None, ...]
    materials: tuple[ChosenMaterial | None, ...]
    modes: tuple[tuple[Mode, ...], ...]
    """How the walls of each link buckle."""
    beams: tuple[Beam, ...]
    beam_column: Any
    strength_column: Any
    mass: Any
    cost: Any
    reach: Any
    radii: tuple[Any, ...]
    """How far each link's section reaches from its axis at most, m, where a limit asks for it."""
    hung: Any = 0.0
    """By how much counterweights (kg) are heavier than those of the arm as given."""


@dataclass(frozen=True)
class Totals:
    """The sums over a design: the links' mass (kg), the cost (EUR), the reach (m), the mass of joints and payload
    (kg), and the heaviest payload alone (kg); floats, arrays over many designs, or symbols."""

    mass: Any
    cost: Any
    reach: Any
    carried: Any
    payload: float = 0.0


@dataclass(frozen=True)
class Designs:
    """N designs that differ in sections, materials and lengths: beam values (N, 9 n), section values (N, 4 n), the
    stresses (N, n) in Pa that a safety factor of one allows, NaN where unknown, and how walls buckle: from a link the
    fields of its modes (N, K, F), zeros where a design has fewer."""

    p: Array
    sections: Array
    allowed_stresses: Array
    walls: Callable[[int], Array]
