"""What chance would name: evidence of the best candidate where the signs of whole blocks of noise are drawn anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array

from .evidence import Member, System, offered
from .noise import Noise
from .products import Products

DRAWS = 199
"""Draws of signs, and of circular shifts, for each test."""


@dataclass(frozen=True)
class Chance:
    """Products (M, D) of all groups' numbers with what chance draws."""

    drawn: Array

    def best(self, system: System, members: Sequence[Member]) -> Array:
        """(G, D) the evidence of each group beside a set, in draws where nothing is missing."""
        against = self.drawn
        gram = system.gram
        at = system.places(members)
        if len(at):
            inner = gram[np.ix_(at, at)] + np.diag(system.precision(members))
            pull = np.linalg.solve(inner, gram[at])
            against = against - pull.T @ against[at]
            gram = gram - gram[:, at] @ pull
        return offered(system, gram, against, system.prior).evidence

    def p_value(
        self, system: System, members: Sequence[Member], evidence: float, among: NDArray[np.bool_] | None = None
    ) -> float:
        """How often chance alone would make some group (of those `among` (G,)) as evident beside a set."""
        each = self.best(system, members)
        drawn = (each if among is None else each[among]).max(axis=0)
        return float((1 + np.sum(drawn >= evidence)) / (len(drawn) + 1))


def chance(system: System, products: Products, noise: Noise, discrepancy: Array, seed: int) -> Chance:
    """Draws for a system: what the whole library leaves, each block's sign drawn anew, and each column's size without a
    cause, of standard deviation `discrepancy` (W,)."""
    scores = products.scores(noise.sizes, noise.weights * np.sqrt(noise.taken))
    rng = np.random.default_rng(seed)
    signs = rng.choice((-1.0, 1.0), size=(products.blocks, DRAWS))
    trifles = discrepancy[:, None] * rng.standard_normal((len(discrepancy), DRAWS))
    gram, _, _ = products.whole(noise.weights)
    return Chance(system.seen.T @ (scores.T @ signs + gram @ trifles))
