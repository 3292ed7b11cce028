"""Noise of the torques, seeded from what the whole library leaves: its size by joint, and how far rows repeat."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwright.core.sections.numeric import Array

from .candidates import Candidates
from .products import Products

_PASSES = 3
"""Fits of the whole library, each with the noise of the one before."""


@dataclass(frozen=True)
class Noise:
    """What the whole library leaves: `sigma` (n,) RMS by joint, N*m; `repeats` (n,) how many rows tell what one
    independent row would; `sizes` (W,) of the model's columns in that fit, which leaves one part in `taken` (n,) of the
    scatter between blocks."""

    sigma: Array
    repeats: Array
    sizes: Array
    taken: Array

    @property
    def weights(self) -> Array:
        """(n,) the weight of each joint's rows."""
        return np.asarray(1.0 / (self.sigma**2 * self.repeats))


def noise(pool: Candidates, products: Products) -> Noise:
    """The noise by a fit of all columns at once, their sizes held to what is usual."""
    usual = usual_sizes(pool)
    rows = np.maximum(products.rows.sum(axis=0), 1)
    powers = np.array([products.of_joint(joint)[-1, -1] for joint in range(products.joints)])
    sigma, repeats = np.sqrt(np.maximum(powers / rows, 1e-12)) * 0.1, np.full(products.joints, 10.0)
    floor = 1e-4 * sigma
    sizes, taken = np.zeros(pool.width), np.ones(products.joints)
    for _ in range(_PASSES):
        weights = 1.0 / (sigma**2 * repeats)
        gram, against, _ = products.whole(weights)
        inverse = covariance(gram, usual)
        fitted = usual * (inverse @ (against * usual))
        left = products.left(fitted)
        if left.sum(axis=0) @ weights > powers @ weights:  # worse than no sizes, as only rounding makes it: no noise
            break
        sizes, used = fitted, _used(products, inverse, usual, weights)
        sigma = np.maximum(np.sqrt(left.sum(axis=0) / np.maximum(rows - used, 0.5 * rows)), floor)
        taken = products.blocks / np.maximum(products.blocks - used / 10.0, 0.3 * products.blocks)
        repeats = np.maximum(taken * _scatter(products, sizes, sigma), 1.0)
    return Noise(sigma, repeats, sizes, taken)


def usual_sizes(pool: Candidates) -> Array:
    """The usual size (W,) of each of the model's columns, of what may act at one place alone."""
    usual = np.zeros(pool.width)
    for group in pool.groups:
        if not group.tied:
            usual[group.columns] = np.maximum(usual[group.columns], group.usual)
    return usual


def covariance(gram: Array, usual: Array) -> Array:
    """Covariance (W, W) of all columns' sizes over their usual ones, by a Gram matrix in units of the noise."""
    scaled = gram * usual[:, None] * usual + np.eye(len(usual))
    # One joint's noise may be a ten-thousandth of another's: what is alike large is inverted exactly enough.
    size = 1.0 / np.sqrt(np.diagonal(scaled))
    return np.asarray(np.linalg.inv(scaled * size[:, None] * size), dtype=float) * size[:, None] * size


def _used(products: Products, inverse: Array, usual: Array, weights: Array) -> Array:
    """How many numbers of the fit each joint's rows pay for (n,)."""
    used = np.zeros(products.joints)
    for joint, at in enumerate(products.columns):
        gram = weights[joint] * products.of_joint(joint)[:-1, :-1] * usual[at][:, None] * usual[at]
        used[joint] = float(np.sum(gram * inverse[np.ix_(at, at)]))
    return used


def _scatter(products: Products, sizes: Array, sigma: Array) -> Array:
    """The scatter of columns' products between blocks over that of independent rows (n,)."""
    inflation = np.ones(products.joints)
    for joint, at in enumerate(products.columns):
        gram = products.gram[joint]
        size = np.sqrt(np.einsum("kii->i", gram)[:-1])
        seen = size > 1e-9 * size.max()
        if not seen.any():
            continue  # its drive was not logged, or never moves
        scores = gram[:, :-1] @ np.append(-sizes[at], 1.0)
        scatter = (scores[:, seen] ** 2).sum(axis=0) / (sigma[joint] * size[seen]) ** 2
        inflation[joint] = float(np.quantile(scatter, 0.75))
    return inflation
