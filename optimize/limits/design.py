"""What a limit sees of designs: one as expressions, its sums over the links, many as numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.materials.material import MaterialValues
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import Section


@dataclass(frozen=True)
class DesignExpressions:
    """A design's figures as expressions of the optimiser's numbers and the materials' parameters (SI)."""

    sections: tuple[Section | None, ...]
    materials: tuple[MaterialValues | None, ...]
    properties: tuple[SectionProperties | None, ...]
    beams: tuple[Beam, ...]
    beam_column: Any
    strength_column: Any
    mass: Any
    cost: Any
    reach: Any
    hung: Any = 0.0
    """By how much counterweights (kg) are heavier than those of the arm as given."""


@dataclass(frozen=True)
class Totals:
    """The sums over a design: the links' mass (kg), the cost (EUR), the reach (m), and the mass of joints and payload
    (kg); floats, arrays over many designs, or symbols."""

    mass: Any
    cost: Any
    reach: Any
    carried: Any


@dataclass(frozen=True)
class Designs:
    """N designs that differ in sections, materials and lengths: beam values (N, 9 n), section values (N, 4 n), the
    links' yield strengths (N, n) in Pa, NaN where unknown, and how their walls buckle: from a link the fields of its
    modes (N, K, F), noughts where a design has fewer."""

    p: Array
    sections: Array
    yield_strengths: Array
    walls: Callable[[int], Array]
