"""Products of all columns and the torque left, by log, joint and block of time: all that fits and tests go by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array


@dataclass(frozen=True)
class JointRows:
    """A joint's rows of all logs: `columns` (K,) are the model's columns that move it, `design` (M, K) their filtered
    values, `target` (M,) the filtered torque that the model as given leaves. `block` (M,) numbers blocks of time over
    all logs, `log` (M,) the logs; `moving` and `near` (M,) say which rows count (see `PreparedLog`)."""

    columns: NDArray[np.int64]
    design: Array
    target: Array
    block: NDArray[np.int64]
    log: NDArray[np.int64]
    moving: NDArray[np.bool_]
    near: NDArray[np.bool_]


@dataclass(frozen=True)
class Products:
    """Products of each joint's columns and target, by block.

    Args:
        columns: For each joint, the model's columns that move it.
        gram: For each joint (B, K + 1, K + 1), target last.
        rows: (B, n) rows of each joint in each block.
        log: (B,) the log of each block.
        width: How many columns the model has.
    """

    columns: tuple[NDArray[np.int64], ...]
    gram: tuple[Array, ...]
    rows: NDArray[np.int64]
    log: NDArray[np.int64]
    width: int

    @property
    def blocks(self) -> int:
        """The number of blocks."""
        return len(self.rows)

    @property
    def joints(self) -> int:
        """The number of joints."""
        return len(self.gram)

    @cached_property
    def rms(self) -> Array:
        """RMS (n, W) at each joint of each of the model's columns, of size one."""
        rms = np.zeros((self.joints, self.width))
        for joint, at in enumerate(self.columns):
            squares = np.diagonal(self.of_joint(joint))[:-1]
            rms[joint, at] = np.sqrt(squares / max(int(self.rows[:, joint].sum()), 1))
        return rms

    def of_joint(self, joint: int, blocks: NDArray[np.bool_] | None = None) -> Array:
        """A joint's products summed over some blocks (all by default), (K + 1, K + 1)."""
        gram = self.gram[joint]
        return np.asarray((gram if blocks is None else gram[blocks]).sum(axis=0))

    def of_log(self, number: int) -> Products:
        """The products of one log."""
        here = self.log == number
        return replace(self, gram=tuple(item[here] for item in self.gram), rows=self.rows[here], log=self.log[here])

    def by_log(self) -> Products:
        """The products with one block a log."""
        starts = np.flatnonzero(np.diff(self.log, prepend=-1))
        gram = tuple(np.add.reduceat(item, starts) for item in self.gram)
        return replace(self, gram=gram, rows=np.add.reduceat(self.rows, starts), log=self.log[starts])

    def with_more(self, sizes: Array) -> Products:
        """The products where the target holds so much (W,) of the model's columns more."""
        gram: list[Array] = []
        for at, item in zip(self.columns, self.gram, strict=True):
            turned = np.eye(item.shape[1])
            turned[:-1, -1] = sizes[at]
            gram.append(turned.T @ item @ turned)
        return replace(self, gram=tuple(gram))

    def whole(self, weights: Array, blocks: NDArray[np.bool_] | None = None) -> tuple[Array, Array, float]:
        """Products of the whole model with joints weighed by `weights` (n,): Gram matrix (W, W), products with the
        target (W,), and the target's own."""
        gram, against, square = np.zeros((self.width, self.width)), np.zeros(self.width), 0.0
        for joint, at in enumerate(self.columns):
            part = weights[joint] * self.of_joint(joint, blocks)
            gram[np.ix_(at, at)] += part[:-1, :-1]
            against[at] += part[:-1, -1]
            square += float(part[-1, -1])
        return gram, against, square

    def explained(self, sizes: Array) -> Array:
        """RMS (n,) of what sizes (W,) of the model's columns add at each joint."""
        total = np.zeros(self.joints)
        for joint, at in enumerate(self.columns):
            total[joint] = float(sizes[at] @ self.of_joint(joint)[:-1, :-1] @ sizes[at])
        return np.asarray(np.sqrt(np.maximum(total, 0.0) / np.maximum(self.rows.sum(axis=0), 1)))

    def left(self, sizes: Array) -> Array:
        """Sums of squares (B, n) that sizes (W,) of the model's columns leave."""
        rss = np.zeros((self.blocks, self.joints))
        for joint, at in enumerate(self.columns):
            vector = np.append(-sizes[at], 1.0)
            rss[:, joint] = np.maximum((self.gram[joint] @ vector) @ vector, 0.0)
        return rss

    def scores(self, sizes: Array, weights: Array) -> Array:
        """Products (B, W) of the model's columns with what sizes (W,) leave, by block, joints weighed."""
        scores = np.zeros((self.blocks, self.width))
        for joint, at in enumerate(self.columns):
            vector = np.append(-sizes[at], 1.0)
            scores[:, at] += weights[joint] * (self.gram[joint][:, :-1] @ vector)
        return scores


def products(rows: Sequence[JointRows], width: int, *, near: bool) -> Products:
    """Products of joints' rows: those where joints move steadily, or with `near` reversals too."""
    blocks = 1 + max(int(row.block.max()) for row in rows)
    log = np.zeros(blocks, dtype=np.int64)
    log[rows[0].block] = rows[0].log
    counts = np.zeros((blocks, len(rows)), dtype=np.int64)
    grams: list[Array] = []
    for joint, item in enumerate(rows):
        count = item.near if near else item.moving
        size = item.design.shape[1] + 1
        gram = np.zeros((blocks, size, size))
        table = np.column_stack((item.design, item.target))[count]
        number = item.block[count]
        counts[:, joint] = np.bincount(number, minlength=blocks)
        edges = np.searchsorted(number, np.arange(blocks + 1))
        for block in range(blocks):
            part = table[edges[block] : edges[block + 1]]
            gram[block] = part.T @ part
        grams.append(gram)
    return Products(tuple(row.columns for row in rows), tuple(grams), counts, log, width)
