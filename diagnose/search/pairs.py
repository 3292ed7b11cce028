"""What all pairs of groups explain, from one Gram matrix: block elimination of many pairs at once.

Beside a group with orthonormal columns F another one, with orthonormal columns G and P = F'G, explains what is left of
it: |d|^2 + (P d)'(I - P P')^-1 (P d), where d = G'v - P'F'v (H. V. Henderson & S. R. Searle, SIAM Review 23 (1981) 53,
doi:10.1137/1023004). Only matrices of the smaller group's rank are inverted, and sums over groups' columns make them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.patterns.pool import GONE
from linkwright.core.sections.numeric import Array

_RIDGE = 1e-8
"""Added to matrices of unit scale, so that directions which others have taken wholly count nothing."""
_AT_ONCE = 4_000_000
"""Numbers that are held at once."""
_SMALL = 4
"""Matrices of no more rows cost more to hand to a library than to multiply."""


@dataclass(frozen=True)
class Blocks:
    """Groups with their columns one after the other, ranks ascending: the Gram matrix (M, M), the products with a
    vector (M,), and the ranks (G,)."""

    gram: Array
    against: Array
    ranks: NDArray[np.int64]

    @property
    def starts(self) -> NDArray[np.int64]:
        """Where each group's columns begin."""
        return np.concatenate([[0], np.cumsum(self.ranks)[:-1]]).astype(np.int64)

    def without(self, count: int) -> Blocks:
        """The groups behind the first `count`."""
        at = int(self.ranks[:count].sum())
        return Blocks(self.gram[at:, at:], self.against[at:], self.ranks[count:])

    def beside(self, group: int) -> Blocks:
        """What is left of all groups beside one of them, orthonormal within each again: directions that are gone are
        zero."""
        columns = slice(int(self.starts[group]), int(self.starts[group] + self.ranks[group]))
        mixed = self.gram[:, columns]
        left = Blocks(self.gram - mixed @ mixed.T, self.against - mixed @ self.against[columns], self.ranks)
        return left.orthonormal()

    def of_rank(self) -> Iterator[tuple[slice, slice]]:
        """The groups of each rank, and their columns."""
        ranks, counts = np.unique(self.ranks, return_counts=True)
        group = column = 0
        for rank, count in zip(ranks.tolist(), counts.tolist(), strict=True):
            yield slice(group, group + count), slice(column, column + count * rank)
            group, column = group + count, column + count * rank

    def orthonormal(self) -> Blocks:
        """The same groups, orthonormal within each again."""
        gram, against = self.gram.copy(), self.against.copy()
        turns: list[tuple[slice, Array]] = []
        for which, span in self.of_rank():
            rank = int(self.ranks[which.start])
            at = self.starts[which][:, None] + np.arange(rank)
            values, vectors = np.linalg.eigh(gram[at[:, :, None], at[:, None, :]])
            root = vectors * np.where(values > GONE, 1.0 / np.sqrt(np.maximum(values, GONE)), 0.0)[:, None, :]
            turns.append((span, root.transpose(0, 2, 1)))
        for span, turn in turns:
            against[span] = (turn @ against[span].reshape(len(turn), -1, 1)).reshape(-1)
        for side in (gram, gram.T):
            for span, turn in turns:
                side[span] = (turn @ side[span].reshape(*turn.shape[:2], -1)).reshape(-1, len(gram))
        return Blocks(gram, against, self.ranks)

    def alone(self) -> Array:
        """What each group explains alone (G,), in sum of squares."""
        return np.add.reduceat(self.against**2, self.starts)

    def of_two(self) -> Array:
        """What each two groups explain together (G, G), in sum of squares."""
        gains, alone = np.zeros((len(self.ranks), len(self.ranks))), self.alone()
        for rank in np.unique(self.ranks).tolist():
            which = np.flatnonzero(self.ranks == rank)
            step = max(1, _AT_ONCE // (rank * rank * len(self.gram)))
            for some in (which[k : k + step] for k in range(0, len(which), step)):
                behind = self.without(int(some[0]))
                gained = alone[some][:, None] + self._beside(some - some[0], behind)
                gains[some, some[0] :], gains[some[0] :, some] = gained, gained.T
        return gains

    def _beside(self, firsts: NDArray[np.int64], behind: Blocks) -> Array:
        """What each of the groups `behind` (the first of which the `firsts` (F,) are numbered from) explains beside
        each of those, which have one rank, (F, G)."""
        rank, groups = int(behind.ranks[firsts[0]]), len(behind.ranks)
        at = behind.starts[firsts][:, None] + np.arange(rank)
        rows, target = behind.gram[at], behind.against[at]
        shared = np.empty((len(firsts), groups, rank))
        squares = np.empty((len(firsts), groups, rank, rank))
        for which, span in behind.of_rank():
            # P of these groups with each of those, one after the other: F'G as (F, G, rank, rank of G).
            mixed = rows[:, :, span].reshape(len(firsts), rank, which.stop - which.start, -1).transpose(0, 2, 1, 3)
            if rank <= _SMALL:
                squares[:, which] = np.einsum("fgir,fgjr->fgij", mixed, mixed)
            else:
                squares[:, which] = mixed @ mixed.transpose(0, 1, 3, 2)
            shared[:, which] = np.einsum("fgir,gr->fgi", mixed, behind.against[span].reshape(mixed.shape[1], -1))
        taken = np.einsum("fgij,fj->fgi", squares, target)
        left = behind.alone() - 2.0 * np.einsum("fgi,fi->fg", shared, target) + np.einsum("fgi,fi->fg", taken, target)
        along = shared - taken
        if rank == 1:
            rest = 1.0 - squares[:, :, 0, 0]
            return left + np.where(rest > GONE, along[:, :, 0] ** 2 / np.where(rest > GONE, rest, 1.0), 0.0)
        inner = (1.0 + _RIDGE) * np.eye(rank) - squares
        return left + np.einsum("fgi,fgi->fg", along, np.linalg.solve(inner, along[..., None])[..., 0])


def blocks_of(gram: Array, against: Array, columns: Sequence[NDArray[np.int64]]) -> Blocks:
    """Groups by their columns in a Gram matrix, which ascend in number."""
    at = np.concatenate([*columns])
    return Blocks(gram[np.ix_(at, at)], against[at], np.array([len(column) for column in columns], dtype=np.int64))
