"""Sums of products of what a design gives its links.

At a pose the error is a sum of terms, each a coefficient times a product of links' weights and flexibilities (see
`optimize.choice.pose_products`); stress, compression and a trial shape's inertia are sums of the same kind.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkwright.core.sections.numeric import Array

FEATURES = (
    "weight",
    "stretching",
    "bending_height",
    "bending_width",
    "twisting",
    "shear_height",
    "shear_width",
    "stress_axial",
    "stress_height",
    "stress_width",
    "expansion",
)
"""What a link brings: mass per length (kg/m), the reciprocals of its rigidities (1/N, 1/(N*m^2)), those of the axial
force (1/N) and moments (1/(N*m)) at which it yields, thermal expansion (1/K). All but the last are positive."""
EXPANSION = FEATURES.index("expansion")

Power = tuple[tuple[int, int], ...]
"""A product's factors: (link, feature) in order, repeated where squared."""


@dataclass(frozen=True)
class Products:
    """A sum of products: coefficients by their factors; the constant has none."""

    terms: Mapping[Power, float]

    def value(self, features: Array) -> float:
        """Its value for the links' features (n, K)."""
        return sum(c * float(np.prod([features[place] for place in power])) for power, c in self.terms.items())

    def scaled(self, factor: float) -> Products:
        """The sum times a factor."""
        return Products({power: factor * c for power, c in self.terms.items()})
