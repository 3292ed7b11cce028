"""Sums of products of what a design gives its links, and bounds from below on them that fall apart link by link.

At a pose the error is a sum of terms, each a coefficient times a product of links' weights and flexibilities (see
`optimize.choice.signs`); stress, compression and a trial shape's inertia are sums of the same kind. About one design
every product of several links has a bound from below that is a sum over links and touches it there: with a positive
coefficient by e^x >= 1 + x, with a negative one by the arithmetic mean over the geometric one. A sum over links is
least where each link's own part is least, whatever the others are: a table a link bounds every combination.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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


def total(sums: Sequence[Products]) -> Products:
    """The sum of sums: terms with the same factors meet, so that what cancels does."""
    terms: dict[Power, float] = {}
    for item in sums:
        for power, c in item.terms.items():
            terms[power] = terms.get(power, 0.0) + c
    return Products(terms)


@dataclass(frozen=True)
class OfLink:
    """One link's part: sum of `coefficients` (T,) times products of its features to `powers` (T, K), and `logs` (K,)
    times their logarithms."""

    coefficients: Array
    powers: Array
    logs: Array

    def values(self, logarithms: Array, expansion: Array) -> Array:
        """Its values for the logarithms (..., K) of features (the last, which may have either sign, as it is)."""
        plain = logarithms[..., :EXPANSION]
        values = plain @ self.logs[:EXPANSION]
        for c, power in zip(self.coefficients, self.powers, strict=True):
            if power[EXPANSION]:
                values = values + c * expansion
            else:
                used = np.flatnonzero(power)
                values = values + c * np.exp(plain[..., used] @ power[used])
        return values


def minorant(products: Products, at: Array) -> tuple[float, list[OfLink]]:
    """A constant and each link's part, whose sum nowhere exceeds the products and equals them at features `at`
    (n, K)."""
    count, width = at.shape
    constant = 0.0
    logs = np.zeros((count, width))
    parts: list[dict[tuple[float, ...], float]] = [{} for _ in range(count)]
    for power, c in products.terms.items():
        links = sorted({link for link, _ in power})
        if not links:
            constant += c
            continue
        linear = {link: np.bincount([k for item, k in power if item == link], minlength=width) for link in links}
        if len(links) == 1:
            key = tuple(float(x) for x in linear[links[0]])
            parts[links[0]][key] = parts[links[0]].get(key, 0.0) + c
            continue
        size = c * float(np.prod([at[place] for place in power]))
        if size >= 0.0:
            constant += size
            for link in links:
                logs[link] += size * linear[link]
                constant -= size * float(linear[link][:EXPANSION] @ np.log(at[link, :EXPANSION]))
            continue
        for link in links:
            key = tuple(len(links) * float(x) for x in linear[link])
            there = float(np.prod(at[link] ** np.array(key)))
            parts[link][key] = parts[link].get(key, 0.0) + size / len(links) / there
    parts_of_links = [
        OfLink(np.array(list(part.values())), np.array(list(part)).reshape(-1, width), link_log)
        for part, link_log in zip(parts, logs, strict=True)
    ]
    return constant, parts_of_links
