"""One set of unknown weights under all that gives: products of compliance and weight that are of rank one together.

Each drive that sags under links nobody has weighed has a column for each unknown weight; but the weights are the same
for all of them, so the coefficients are c_i w_j with one w. The steps of a fit are taken in c and w (Gauss-Newton), the
factor between the two being fixed by making the largest of w one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from linkwright.core.sections.numeric import Array

_TURNS = 100
_SETTLED = 1e-3
"""Turns that lower the sum of squares by so small a share go no further: the fit goes on from there."""


@dataclass(frozen=True)
class Products:
    """Coefficients of several terms, (m, K), as `compliance` (m,) times `weight` (K,), the largest of which is 1."""

    compliance: Array
    weight: Array

    @property
    def largest(self) -> int:
        """Where the largest weight is."""
        return int(np.argmax(np.abs(self.weight)))


@dataclass(frozen=True)
class Shared:
    """Parts of a model that give under one set of weights: by the part's number the sizes (K + 1,) of a fit to all
    readings, and how strongly weights, the largest of which is one, are held to zero (K,)."""

    sizes: Mapping[int, Array]
    hold: Array

    def steps(self, count: int, starts: Mapping[int, int]) -> Steps:
        """The coordinates for `count` sizes, those of each part where it `starts`."""
        begun = np.stack([self.sizes[part] for part in starts])
        spans = [slice(start, start + begun.shape[1]) for start in starts.values()]
        return steps(count, spans, factors(begun[:, :-1]))


def factors(coefficients: Array) -> Products:
    """The products of rank one that come nearest to coefficients (m, K)."""
    left, singular, right = np.linalg.svd(coefficients, full_matrices=False)
    weight = right[0]
    largest = float(weight[np.argmax(np.abs(weight))])
    compliance = left[:, 0] * singular[0] * (largest or 1.0)
    weight = weight / (largest or 1.0)
    if compliance[np.argmax(np.abs(compliance))] < 0.0:
        # What gives yields to its load: it is the weights that point the other way.
        compliance, weight = -compliance, -weight
    return Products(compliance, weight)


def under_one(design: Array, target: Array, begun: Array, how: Array, *, bounded: bool = False) -> Array:
    """The sizes under one set of weights that come nearest to a target, as a start for a fit: compliances and weights
    solved for in turn, from the weights of each term, as sums of products have several valleys. Where they are
    `bounded` no compliance is negative, and opposite weights are a start too.

    Args:
        design: What a unit of each product (K) of each term, and last of its size under known loads, moves,
            (n, m, K + 1).
        target: What they are to explain, (n,).
        begun: Sizes of terms with weights of their own, (m, K + 1).
        how: How strongly weights, the largest of which is one, are held to zero, (K,).

    Returns:
        Sizes, (m, K + 1).
    """
    products, known, count = design[:, :, :-1], design[:, :, -1], len(begun)
    least = np.inf
    best: Array = begun
    beside = np.linalg.qr(known[:, known.any(axis=0)])[0]
    aim = target - beside @ (beside.T @ target)
    for weight in (*begun[:, :-1], *(-begun[:, :-1] if bounded and count > 1 else ())):
        value = np.inf
        for _ in range(_TURNS):
            weight = weight / (np.max(np.abs(weight)) or 1.0)
            giving = products @ weight
            if bounded:
                compliance = nnls(giving - beside @ (beside.T @ giving), aim)[0]
                of_known = np.linalg.lstsq(known, target - giving @ compliance, rcond=None)[0]
                solution = np.concatenate([compliance, of_known])
            else:
                solution = np.linalg.lstsq(np.hstack([giving, known]), target, rcond=None)[0]
            left = target - known @ solution[count:]
            held = float(np.sum((how * weight) ** 2))
            before, value = value, float(np.sum((left - products @ weight @ solution[:count]) ** 2)) + held
            if value < least:
                least = value
                best = np.zeros(begun.shape)
                best[:, :-1], best[:, -1] = np.outer(solution[:count], weight), solution[count:]
            if value > before * (1.0 - _SETTLED):
                break
            rows = np.vstack([np.einsum("nmk,m->nk", products, solution[:count]), np.diag(how)])
            weight = np.linalg.lstsq(rows, np.concatenate([left, np.zeros(len(how))]), rcond=None)[0]
    return best


@dataclass(frozen=True)
class Steps:
    """The coordinates in which a fit takes its steps: `slopes` (P, Q) turns a step of theirs into one of all sizes to
    first order, `groups` and `common` are where the compliances and the weights are among them. `spans` are where the
    shared terms' sizes are among the P (the products first, then one under known loads)."""

    slopes: Array
    products: Products
    groups: tuple[int, ...]
    common: slice
    spans: tuple[slice, ...]

    @property
    def begun(self) -> Array:
        """The sizes (P,) of the products where steps begin; those of all else are zero."""
        sizes = np.zeros(len(self.slopes))
        for span, compliance in zip(self.spans, self.products.compliance.tolist(), strict=True):
            sizes[span.start : span.stop - 1] = compliance * self.products.weight
        return sizes

    def held(self, how: Array) -> tuple[Array, Array]:
        """Rows (K, Q) that hold the weights but the largest where data do not show them, by `how` strongly (K,), and
        what they ask for (K,)."""
        how = np.where(np.arange(len(how)) == self.products.largest, 0.0, how)
        rows = np.zeros((len(self.products.weight), self.slopes.shape[1]))
        rows[:, self.common] = np.diag(how)
        return rows, -how * self.products.weight

    def at_zero(self, step: Array) -> set[int]:
        """The places of compliances that stand at zero and a step (Q,) would take below."""
        places = zip(self.groups, self.products.compliance.tolist(), strict=True)
        return {place for place, compliance in places if compliance <= 0.0 and step[place] < 0.0}

    def taken(self, step: Array, share: float, *, bounded: bool = False) -> Array:
        """What a share of a step (Q,) adds to all sizes (P,); it takes none that is `bounded` below zero."""
        added = share * (self.slopes @ step)
        change = np.where(np.arange(len(self.products.weight)) == self.products.largest, 0.0, step[self.common])
        weight = self.products.weight + share * change
        for place, span, compliance in zip(self.groups, self.spans, self.products.compliance.tolist(), strict=True):
            after = compliance + share * float(step[place])
            product = (max(after, 0.0) if bounded else after) * weight
            added[span.start : span.stop - 1] = product - compliance * self.products.weight
        return added


def steps(count: int, spans: Sequence[slice], products: Products) -> Steps:
    """The coordinates for `count` sizes in all, those at `spans` shared: the others' own, for each shared term its
    compliance and its size under known loads, and last the weights."""
    number = len(products.weight)
    shared = {index for span in spans for index in range(span.start, span.stop)}
    plain = [index for index in range(count) if index not in shared]
    width = len(plain) + 2 * len(spans) + number
    slopes = np.zeros((count, width))
    slopes[plain, np.arange(len(plain))] = 1.0
    common = slice(width - number, width)
    free = np.eye(number)
    # The largest weight stays what it is: else compliances could grow as weights fall, and steps go nowhere.
    free[products.largest, products.largest] = 0.0
    names: list[int] = []
    for place, (span, compliance) in enumerate(zip(spans, products.compliance.tolist(), strict=True)):
        at = len(plain) + 2 * place
        names.append(at)
        rows = np.arange(span.start, span.stop - 1)
        slopes[rows, at] = products.weight
        slopes[rows[:, None], np.arange(common.start, common.stop)[None, :]] = compliance * free
        slopes[span.stop - 1, at + 1] = 1.0
    return Steps(slopes, products, tuple(names), common, tuple(spans))
