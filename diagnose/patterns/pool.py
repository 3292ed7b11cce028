"""Candidates as subspaces: nuisances projected out, each an orthonormal basis, all their products in one Gram matrix.

With the Gram matrix in hand, what any subset of candidates explains is small linear algebra, however many readings. It
is worked out when it is first asked for: a few of its rows are all that a rough model needs.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.rules.pattern_rules import PatternRules
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array

from .library import Candidate

VISIBLE = 1e-5
"""Of a pattern: where the nuisances leave less, it cannot be seen at all."""
_RANK = 1e-7
"""Directions of a candidate below this share of its largest are rounding."""


@dataclass(frozen=True)
class Group:
    """A candidate's place in the pool: its columns `start:stop`, and `back` (d, r), which turns coefficients of the
    orthonormal basis into sizes. `length` is the norm of its columns (d,), `visible` the share of the pattern that the
    nuisances leave."""

    candidate: Candidate
    start: int
    stop: int
    back: Array
    length: Array
    visible: float

    @property
    def rank(self) -> int:
        """How many independent directions the candidate has."""
        return self.stop - self.start


@dataclass(frozen=True)
class Layout:
    """Where the columns of a pool's groups are: those of rank 1 (`single_groups` and their column), and for each higher
    rank the groups' numbers with their columns (g, rank)."""

    groups: int
    single_groups: NDArray[np.int64]
    single_columns: NDArray[np.int64]
    wide: tuple[tuple[NDArray[np.int64], NDArray[np.int64]], ...]


class Room:
    """Where the columns of pools stand that come from each other: an array (n, ...) of which the first `used` columns
    hold something. A pool with a few more candidates than another has its columns there behind the other's; in a long
    recording a copy would be hundreds of megabytes."""

    def __init__(self, array: Array, used: int) -> None:
        self._array, self._used = array, used

    def behind(self, at: int, columns: Array) -> Array | None:
        """The first `at` columns with these (n, r) behind them; None where that place is taken or there is none."""
        end = at + columns.shape[1]
        if at != self._used or end > self._array.shape[1]:
            return None
        self._array[:, at:end], self._used = columns, end
        return self._array[:, :end]

    def __reduce__(self) -> tuple[type[Room], tuple[Array, int]]:
        """Sent to another process without the array: the pool there has what is in use, and copies."""
        return Room, (np.zeros((0, 0)), 0)


@dataclass(frozen=True)
class Pool:
    """All candidates that can be seen. `basis` (n, M) is orthogonal to `nuisance` (n, b, orthonormal), orthonormal
    within each group; columns that no group has count nothing. `invisible` are those that the nuisances swallow,
    `rules` those of the whole diagnosis, `room` is where the basis stands."""

    nuisance: Array
    groups: tuple[Group, ...]
    basis: Array
    invisible: tuple[Candidate, ...]
    rules: Rules = RULES
    room: Room | None = None

    @cached_property
    def layout(self) -> Layout:
        """Where the groups' columns are."""
        starts, ranks = self.starts, self.ranks
        single = np.flatnonzero(ranks == 1)
        wide: list[tuple[NDArray[np.int64], NDArray[np.int64]]] = []
        for rank in np.unique(ranks[ranks > 1]).tolist():
            which = np.flatnonzero(ranks == rank)
            wide.append((which, starts[which][:, None] + np.arange(rank)))
        return Layout(len(self.groups), single, starts[single], tuple(wide))

    @cached_property
    def gram(self) -> Array:
        """The products (M, M) of all columns of the basis."""
        return self.basis.T @ self.basis

    @cached_property
    def own(self) -> tuple[Array, tuple[Array, ...]]:
        """What the Gram matrix holds of each group alone: its diagonal (M,), and blocks (g, r, r) as `layout.wide`."""
        blocks: list[Array] = []
        for _, at in self.layout.wide:
            part = self.basis.T[at]
            blocks.append(part @ part.transpose(0, 2, 1))
        return np.einsum("ij,ij->j", self.basis, self.basis), tuple(blocks)

    def rows(self, columns: NDArray[np.int64]) -> Array:
        """The products (k, M) of some columns with all."""
        return self.gram[columns] if "gram" in vars(self) else self.basis[:, columns].T @ self.basis

    def among(self, columns: NDArray[np.int64]) -> Array:
        """The products (k, k) of some columns with each other."""
        if "gram" in vars(self):
            return self.gram[np.ix_(columns, columns)]
        part = self.basis[:, columns]
        return part.T @ part

    def on_this_basis(self, groups: tuple[Group, ...], invisible: tuple[Candidate, ...]) -> Pool:
        """A pool of other groups of the same columns, whose products are not worked out again."""
        pool = replace(self, groups=groups, invisible=invisible)
        if "gram" in vars(self):
            vars(pool)["gram"] = self.gram
        return pool

    @property
    def starts(self) -> NDArray[np.int64]:
        """Where each group's columns begin."""
        return np.array([group.start for group in self.groups], dtype=np.int64)

    @property
    def ranks(self) -> NDArray[np.int64]:
        """The rank of each group."""
        return np.array([group.rank for group in self.groups], dtype=np.int64)

    def columns(self, members: Sequence[int]) -> NDArray[np.int64]:
        """The columns of some groups."""
        spans = [np.arange(self.groups[m].start, self.groups[m].stop) for m in members]
        return np.concatenate(spans) if spans else np.zeros(0, dtype=np.int64)

    def projected(self, vectors: Array) -> Array:
        """Vectors (n, ...) less what the nuisances explain."""
        return vectors - self.nuisance @ (self.nuisance.T @ vectors)


def orthonormal(columns: Array, tolerance: float = 1e-10) -> Array:
    """An orthonormal basis (n, r) of columns (n, d), scaled alike first."""
    if columns.shape[1] == 0:
        return columns
    size = np.linalg.norm(columns, axis=0)
    u, s, _ = np.linalg.svd(columns[:, size > 0.0] / size[size > 0.0], full_matrices=False)
    return u[:, s > tolerance * s[0]] if len(s) else columns[:, :0]


def length_along(columns: Array, vector: Array, tolerance: float = 1e-10) -> float:
    """How long a vector (n,) is within the span of columns (n, d), by their triangle: `orthonormal` without a basis."""
    if not columns.any():
        return 0.0
    size = np.linalg.norm(columns, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    _, s, vt = np.linalg.svd(np.linalg.qr(columns, mode="r") / size, full_matrices=False)
    seen = s > tolerance * s[0]
    return float(np.linalg.norm((vt[seen] @ (columns.T @ vector / size)) / s[seen]))


def _group(
    candidate: Candidate, columns: Array, limits: Array | None, beside: Array, at: int, rules: PatternRules
) -> tuple[Group, Array] | None:
    """A candidate with whitened columns (n, d) as a group whose basis begins at column `at`; None where nothing is
    seen of it beside the nuisances.

    `limits` (d,) is how large each size may be: a direction that would not be seen even there is not kept.
    """
    length = np.linalg.norm(columns, axis=0)
    if not (length > 0.0).any():
        return None
    unit = np.where(length > 0.0, length, 1.0) if limits is None else 1.0 / limits
    scaled = columns / unit
    left = scaled - beside @ (beside.T @ scaled)
    left -= beside @ (beside.T @ left)  # once more: rounding of a pattern that nearly vanishes
    u, s, vt = _singular(left)
    whole = float(np.sqrt(np.linalg.eigvalsh(scaled.T @ scaled)[-1]))
    tolerance = rules.weight if len(candidate.sizes) < columns.shape[1] else _RANK
    keep = (s > tolerance * s[0]) & (s > VISIBLE * whole)
    if limits is not None:
        keep &= s > rules.seen
    if not keep.any():
        return None
    back = (vt[keep].T / s[keep]) / unit[:, None]
    return Group(candidate, at, at + int(keep.sum()), back, length, float(s[0] / whole)), u[:, keep]


def _singular(columns: Array) -> tuple[Array, Array, Array]:
    """The singular value decomposition of a tall narrow matrix, largest first, from its Gram matrix: good to 1e-8 of
    the largest, which is all that is asked of it here, and many times faster."""
    values, vectors = np.linalg.eigh(columns.T @ columns)
    s = np.sqrt(np.maximum(values[::-1], 0.0))
    vectors = vectors[:, ::-1]
    unit = np.where(s > 0.0, s, 1.0)
    u = (columns @ vectors) / unit
    # Once more, for the orthogonality that squaring has cost.
    size = np.linalg.norm(u, axis=0)
    return u / np.where(size > 0.0, size, 1.0), s, vectors.T


def with_group(pool: Pool, candidate: Candidate, columns: Array, limits: Array | None) -> Pool:
    """The pool with one more candidate, its whitened columns (n, d); the same pool where nothing is seen of it."""
    made = _group(candidate, columns, limits, pool.nuisance, pool.basis.shape[1], pool.rules.patterns)
    if made is None:
        return pool
    return _wider(pool, [made[0]], made[1])


def exchanged(pool: Pool, kept: Sequence[int], patterns: Iterable[tuple[Candidate, Array, Array | None]]) -> Pool:
    """The pool with some of its groups (their numbers) alone, and behind them candidates with whitened columns (n, d)
    and limits of their sizes; `invisible` are those of which nothing is seen."""
    groups: list[Group] = []
    bases: list[Array] = []
    unseen: list[Candidate] = []
    at = pool.basis.shape[1]
    for candidate, columns, limits in patterns:
        made = _group(candidate, columns, limits, pool.nuisance, at, pool.rules.patterns)
        if made is None:
            unseen.append(candidate)
            continue
        groups.append(made[0])
        bases.append(made[1])
        at = made[0].stop
    few = pool.on_this_basis(tuple(pool.groups[k] for k in kept), tuple(unseen))
    return _wider(few, groups, np.concatenate(bases, axis=1)) if bases else few


def _wider(pool: Pool, groups: Sequence[Group], basis: Array) -> Pool:
    """The pool with more groups, and their columns (n, r) behind its own."""
    at = pool.basis.shape[1]
    wider = None if pool.room is None else pool.room.behind(at, basis)
    room = pool.room
    if wider is None:
        room, wider = _room_for(pool.basis, basis)
    wider_pool = replace(pool, groups=(*pool.groups, *groups), basis=wider, room=room)
    if "gram" in vars(pool):
        mixed = pool.basis.T @ basis
        vars(wider_pool)["gram"] = np.block([[pool.gram, mixed], [mixed.T, basis.T @ basis]])
    return wider_pool


def _room_for(basis: Array, more: Array) -> tuple[Room, Array]:
    """A room with a basis and more columns behind it, and place for as many again: what is not used is not touched."""
    at = basis.shape[1]
    end = at + more.shape[1]
    array = np.empty((len(basis), 2 * end), order="F")
    array[:, :at], array[:, at:end] = basis, more
    return Room(array, end), array[:, :end]


def make_pool(
    nuisance: Array,
    patterns: Iterable[tuple[Candidate, Array, Array | None]],
    *,
    widest: int | None = None,
    rules: Rules = RULES,
) -> Pool:
    """The pool of candidates with whitened columns (n, d) and limits of their sizes, beside nuisance columns (n, b).

    `widest` is how many columns all patterns have together, at most (None: they are counted, and held at once for it).
    """
    if widest is None:
        patterns = list(patterns)
        widest = sum(columns.shape[1] for _, columns, _ in patterns)
    beside = orthonormal(nuisance)
    groups: list[Group] = []
    # Column by column, so that those in use are one piece of memory, and the rest is never touched.
    basis = np.empty((len(nuisance), 2 * widest), order="F")
    invisible: list[Candidate] = []
    at = 0
    for candidate, columns, limits in patterns:
        made = _group(candidate, columns, limits, beside, at, rules.patterns)
        if made is None:
            invisible.append(candidate)
            continue
        groups.append(made[0])
        basis[:, at : made[0].stop] = made[1]
        at = made[0].stop
    used = basis[:, :at]
    return Pool(beside, tuple(groups), used, tuple(invisible), rules, Room(basis, at))
