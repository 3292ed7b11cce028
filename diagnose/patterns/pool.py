"""Candidates as subspaces: nuisances projected out, each an orthonormal basis, all their products in one Gram matrix.

With the Gram matrix in hand, what any subset of candidates explains is small linear algebra, however many readings. It
is worked out when it is first asked for: a few of its rows are all that a rough model needs.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import get_lapack_funcs

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.rules.pattern_rules import PatternRules
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array

from .library import Candidate, parameter_of

VISIBLE = 1e-5
"""Of a pattern: where the nuisances leave less, it cannot be seen at all."""
_RANK = 1e-7
"""Directions of a candidate below this share of its largest are rounding."""
_AT_ONCE = 1 << 19
"""Numbers of patterns that are decomposed at once: fewer than a cache of some megabytes holds."""
_BLOCK = 8
"""Rows of a block, for each column, of which a triangle is made."""
GONE = 1e-9
"""A direction of a pool's columns whose squared norm falls below this beside others is what rounding leaves of it."""
_NEARLY = 1e-8
"""The same where a triangle of the columns is still as good as their eigenvectors."""
_TOLD = 1e-6
"""By how much a size may be mixed with others, of rounding, that the columns tell from them."""


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

    @cached_property
    def usual(self) -> Array:
        """The largest usual value (SI) of each of a library's sizes."""
        parameters = (parameter_of(EFFECTS[self.candidate.effect], name) for name in self.candidate.sizes)
        return np.array([max(map(abs, parameter.typical)) for parameter in parameters])

    @cached_property
    def determined(self) -> NDArray[np.bool_]:
        """Which sizes (d,) the columns tell from the others."""
        return np.einsum("ij,ji->i", self.back, self.forward) > 1.0 - _TOLD

    @cached_property
    def forward(self) -> Array:
        """What turns sizes into coefficients of the orthonormal basis (r, d)."""
        return np.asarray(np.linalg.pinv(self.back), dtype=np.float64)


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
        return self._layout(self.starts, np.arange(len(self.groups)))

    def layout_of(self, groups: NDArray[np.bool_]) -> Layout:
        """Where the columns of some groups are, if these stand one after the other."""
        among = np.flatnonzero(groups)
        return self._layout(np.cumsum(self.ranks[among]) - self.ranks[among], among)

    def _layout(self, starts: NDArray[np.int64], among: NDArray[np.int64]) -> Layout:
        """Where the columns of groups, which begin at `starts`, are."""
        ranks = self.ranks[among]
        wide: list[tuple[NDArray[np.int64], NDArray[np.int64]]] = []
        for rank in np.unique(ranks[ranks > 1]).tolist():
            which = ranks == rank
            wide.append((among[which], starts[which][:, None] + np.arange(rank)))
        return Layout(len(self.groups), among[ranks == 1], starts[ranks == 1], tuple(wide))

    @cached_property
    def gram(self) -> Array:
        """The products (M, M) of all columns of the basis."""
        return self.basis.T @ self.basis

    @cached_property
    def blocks(self) -> tuple[Array, tuple[Array, ...]]:
        """What the Gram matrix holds of each group alone: its diagonal (M,), and blocks (g, r, r) as `layout.wide`."""
        blocks: list[Array] = []
        for _, at in self.layout.wide:
            part = self.basis.T[at]
            blocks.append(part @ part.transpose(0, 2, 1))
        return np.einsum("ij,ij->j", self.basis, self.basis), tuple(blocks)

    def rows(self, columns: NDArray[np.int64], at: NDArray[np.int64]) -> Array:
        """The products (k, m) of some columns with those `at`."""
        rows = self.gram[columns] if "gram" in vars(self) else self.basis[:, columns].T @ self.basis
        return rows if len(at) == rows.shape[1] else rows[:, at]

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

    @cached_property
    def starts(self) -> NDArray[np.int64]:
        """Where each group's columns begin."""
        return np.array([group.start for group in self.groups], dtype=np.int64)

    @cached_property
    def ranks(self) -> NDArray[np.int64]:
        """The rank of each group."""
        return np.array([group.rank for group in self.groups], dtype=np.int64)

    @cached_property
    def family(self) -> NDArray[np.int64]:
        """Which family each group is a variant of, numbered from 0 as they come."""
        numbers: dict[object, int] = {}
        return np.array([numbers.setdefault(g.candidate.family, len(numbers)) for g in self.groups], dtype=np.int64)

    def columns(self, members: Sequence[int]) -> NDArray[np.int64]:
        """The columns of some groups."""
        spans = [np.arange(self.groups[m].start, self.groups[m].stop) for m in members]
        return np.concatenate(spans) if spans else np.zeros(0, dtype=np.int64)

    def projected(self, vectors: Array) -> Array:
        """Vectors (n, ...) less what the nuisances explain."""
        return vectors - self.nuisance @ (self.nuisance.T @ vectors)


def inverse_root(gram: Array) -> Array:
    """A root (k, r) of the inverse of a Gram matrix (k, k) of a pool's columns, without directions that are gone."""
    if not len(gram):
        return gram
    factored, condition, inverted = get_lapack_funcs(("potrf", "pocon", "trtri"), (gram,))
    factor, failed = factored(gram, lower=True)
    size = np.linalg.norm(gram, 1)
    # Where no direction is nearly gone, a triangle says the same in a tenth of the time.
    if not failed and condition(factor, size, uplo="L")[0] * size > _NEARLY:
        return inverted(factor, lower=True)[0].T
    values, vectors = np.linalg.eigh(gram)
    good = values > GONE
    return vectors[:, good] / np.sqrt(values[good])


def orthonormal(columns: Array, tolerance: float = 1e-10) -> Array:
    """An orthonormal basis (n, r) of columns (n, d), scaled alike first."""
    if columns.shape[1] == 0:
        return columns
    size = np.linalg.norm(columns, axis=0)
    u, s, _ = np.linalg.svd(columns[:, size > 0.0] / size[size > 0.0], full_matrices=False)
    return u[:, s > tolerance * s[0]] if len(s) else columns[:, :0]


def triangle(columns: Array) -> Array:
    """The triangle (d, d) of columns (n, d), block after block of their rows: a block stays in the cache, and so do
    their triangles, which are taken together in the same way (J. Demmel et al., SIAM J. Sci. Comput. 34 (2012) A206,
    doi:10.1137/080731992)."""
    rows = _BLOCK * columns.shape[1]
    if len(columns) > rows > 0:
        columns = np.vstack([np.linalg.qr(columns[k : k + rows], mode="r") for k in range(0, len(columns), rows)])
        return triangle(columns)
    return np.asarray(np.linalg.qr(columns, mode="r"), dtype=np.float64)


def length_along(columns: Array, vector: Array) -> float:
    """How long a vector (n,) is within the span of columns (n, d), by their triangle: `orthonormal` without a basis."""
    if not columns.any():
        return 0.0
    whole = triangle(columns)
    size = np.linalg.norm(whole, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    _, s, vt = np.linalg.svd(whole / size, full_matrices=False)
    seen = s > 1e-10 * s[0]
    return float(np.linalg.norm((vt[seen] @ (columns.T @ vector / size)) / s[seen]))


Whitened = tuple[Candidate, Array, Array | None]
"""A candidate with its whitened columns (n, d), and how large each size may be (d,): a direction that would not be seen
even there is not kept. None: nobody can say."""
_Seen = tuple[NDArray[np.bool_], Array, Array, Array, Array, Array, float]


def _grouped(
    patterns: Iterable[Whitened], beside: Array, at: int, rules: PatternRules
) -> Iterator[tuple[Candidate, Group | None, Array]]:
    """Each pattern as a group and its basis (r, n), the first of which begins at column `at`; no group where nothing is
    seen of it beside the nuisances."""
    for block in _blocks(patterns):
        for (candidate, _, _), seen in zip(block, _seen(block, beside, rules), strict=True):
            kept, basis, s, directions, unit, length, whole = seen
            if not kept.any():
                yield candidate, None, basis[:0]
                continue
            stop = at + int(kept.sum())
            back = (directions[:, kept] / s[kept]) / unit[:, None]
            yield candidate, Group(candidate, at, stop, back, length, float(s[0] / whole)), basis[kept]
            at = stop


def _blocks(patterns: Iterable[Whitened]) -> Iterator[list[Whitened]]:
    """Patterns in blocks of some megabytes."""
    block, numbers = list[Whitened](), 0
    for pattern in patterns:
        block.append(pattern)
        numbers += pattern[1].size
        if numbers > _AT_ONCE:
            yield block
            block, numbers = [], 0
    if block:
        yield block


def _seen(block: Sequence[Whitened], beside: Array, rules: PatternRules) -> list[_Seen]:
    """What is seen of each of some patterns: which directions are kept (d,), all of them as an orthonormal basis (d, n)
    with their singular values (d,), largest first, and as sizes (d, d), the unit of each size and the norm of its
    columns (d,), and the largest singular value before the nuisances are taken off. All of one width go together."""
    seen: dict[int, _Seen] = {}
    widths = np.array([columns.shape[1] for _, columns, _ in block])
    for width in np.unique(widths).tolist():
        which = np.flatnonzero(widths == width).tolist()
        stacked = np.stack([block[number][1].T for number in which])
        limits = [block[number][2] for number in which]
        length = np.sqrt(np.einsum("gdn,gdn->gd", stacked, stacked))
        unit = np.where(length > 0.0, length, 1.0)
        for row, limit in enumerate(limits):
            unit[row] = unit[row] if limit is None else 1.0 / limit
        stacked /= unit[:, :, None]
        whole = np.sqrt(np.linalg.eigvalsh(stacked @ stacked.transpose(0, 2, 1))[:, -1])
        left = stacked.reshape(-1, stacked.shape[2])
        for _ in range(2):  # once more: rounding of a pattern that nearly vanishes
            left = left - (left @ beside) @ beside.T
        basis, s, directions = _singular(left.reshape(stacked.shape))
        ranks = [rules.weight if len(block[number][0].sizes) < width else _RANK for number in which]
        least = np.maximum(np.array(ranks) * s[:, 0], VISIBLE * whole)
        least = np.maximum(least, [0.0 if limit is None else rules.seen for limit in limits])
        kept = s > least[:, None]
        seen.update(zip(which, zip(kept, basis, s, directions, unit, length, whole, strict=True), strict=True))
    return [seen[number] for number in range(len(block))]


def _singular(rows: Array) -> tuple[Array, Array, Array]:
    """The singular value decompositions of matrices (g, d, n) of a few long rows, largest first, from their Gram
    matrices: good to 1e-8 of the largest, which is all that is asked of it here, and many times faster. Right vectors
    (g, d, n), values (g, d), left vectors (g, d, d)."""
    values, vectors = np.linalg.eigh(rows @ rows.transpose(0, 2, 1))
    s = np.sqrt(np.maximum(values[:, ::-1], 0.0))
    vectors = vectors[:, :, ::-1]
    basis = vectors.transpose(0, 2, 1) @ rows
    # By their length, for the orthogonality that squaring has cost.
    size = np.sqrt(np.einsum("gdn,gdn->gd", basis, basis))
    basis /= np.where(size > 0.0, size, 1.0)[:, :, None]
    return basis, s, vectors


def with_group(pool: Pool, candidate: Candidate, columns: Array, limits: Array | None) -> Pool:
    """The pool with one more candidate, its whitened columns (n, d); the same pool where nothing is seen of it."""
    pattern = [(candidate, columns, limits)]
    ((_, group, rows),) = _grouped(pattern, pool.nuisance, pool.basis.shape[1], pool.rules.patterns)
    return pool if group is None else _wider(pool, [group], rows.T)


def exchanged(pool: Pool, kept: Sequence[int], patterns: Iterable[Whitened]) -> Pool:
    """The pool with some of its groups (their numbers) alone, and behind them candidates with whitened columns (n, d)
    and limits of their sizes; `invisible` are those of which nothing is seen."""
    seen = list(_grouped(patterns, pool.nuisance, pool.basis.shape[1], pool.rules.patterns))
    groups = [group for _, group, _ in seen if group is not None]
    unseen = tuple(candidate for candidate, group, _ in seen if group is None)
    few = pool.on_this_basis(tuple(pool.groups[k] for k in kept), unseen)
    return _wider(few, groups, np.concatenate([basis for _, _, basis in seen]).T) if groups else few


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
    nuisance: Array, patterns: Iterable[Whitened], *, widest: int | None = None, rules: Rules = RULES
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
    for candidate, group, rows in _grouped(patterns, beside, at, rules.patterns):
        if group is None:
            invisible.append(candidate)
            continue
        groups.append(group)
        at = group.stop
        basis[:, group.start : at] = rows.T
    used = basis[:, :at]
    return Pool(beside, tuple(groups), used, tuple(invisible), rules, Room(basis, at))
