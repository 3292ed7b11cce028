"""The rows of the finite problem as tables: what each option of each link adds to each of them.

A row (`optimize.choice.at_once.pose_rows`) is the length of a sum of products. Those of one link alone are a number for
each of its options; only those of several links are left as products.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.optimize.choice.at_once.cells import COLUMNS
from linkwright.core.optimize.choice.at_once.pose_rows import PoseRow
from linkwright.core.sections.numeric import Array

from .options import LinkList

Integers = NDArray[np.intp]

_WIDTH = len(COLUMNS)


@dataclass(frozen=True)
class TableRow:
    """A row over options: `of_each_link` of each link (N, D), and products of several links with `coefficients` (T, D),
    their `powers` of each link's columns (T, K), and each option's `factors` (N, T)."""

    constant: Array
    of_each_link: tuple[Array, ...]
    coefficients: Array
    powers: tuple[Array, ...]
    factors: tuple[Array, ...]
    objective: bool
    shift: float

    def values(self, picks: Integers) -> Array:
        """What must not be above t (or zero) for designs: rows of picks are an option of each link."""
        vectors = np.broadcast_to(self.constant, (len(picks), len(self.constant))).copy()
        products: Array | None = None
        for k, link_part in enumerate(self.of_each_link):
            vectors += link_part[picks[:, k]]
            if len(self.coefficients):
                factor = self.factors[k][picks[:, k]]
                products = factor if products is None else products * factor
        if products is not None:
            vectors += products @ self.coefficients
        length = vectors[:, 0] if vectors.shape[1] == 1 else np.sqrt(np.einsum("nd,nd->n", vectors, vectors))
        return self.shift + length


def table_row(row: PoseRow, lists: Sequence[LinkList]) -> TableRow:
    """A row over the options of links."""
    powers = [row.powers[:, _WIDTH * link_list.link : _WIDTH * (link_list.link + 1)] for link_list in lists]
    used = np.array([link_powers.any(axis=1) for link_powers in powers]).reshape(len(lists), -1)
    several = used.sum(axis=0) > 1
    constant = row.constant + row.coefficients[used.sum(axis=0) == 0].sum(axis=0)
    by_link: list[Array] = []
    for k, item in enumerate(lists):
        alone = used[k] & ~several
        linear = row.linear[_WIDTH * item.link : _WIDTH * (item.link + 1)]
        by_link.append(np.exp(item.columns @ powers[k][alone].T) @ row.coefficients[alone] + item.columns @ linear)
    left = tuple(powers_here[several] for powers_here in powers)
    factors = tuple(
        np.exp(link_list.columns @ powers_here.T) for link_list, powers_here in zip(lists, left, strict=True)
    )
    return TableRow(constant, tuple(by_link), row.coefficients[several], left, factors, row.objective, row.shift)


def product(options: Sequence[Sequence[int] | Integers]) -> Integers:
    """Every combination (N, lists) of the entries of lists."""
    axes = np.meshgrid(*[np.array(option, dtype=np.intp) for option in options], indexing="ij")
    return np.stack([axis.ravel() for axis in axes], axis=1)


def greatest(rows: Sequence[TableRow], picks: Integers, enough: float) -> tuple[Array, Integers]:
    """The greatest of the objective's rows for designs that keep all others, and which of `picks` these are; designs
    that come to `enough` or break a row are left out."""
    left = np.arange(len(picks))
    worst = np.zeros(len(picks))
    for row in sorted(rows, key=lambda item: not item.objective):
        values = row.values(picks[left])
        if row.objective:
            worst[left] = np.maximum(worst[left], values)
            left = left[worst[left] < enough]
        else:
            left = left[values <= _KEPT]
    return worst[left], left


_KEPT = 1e-9
