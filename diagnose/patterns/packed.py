"""Columns of patterns without what is zero in them: a long recording has hundreds of megabytes of zeros.

What acts in one of several recordings moves nothing in the others, and what encoders, commands or a target on the base
see of most physics is nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array


@dataclass(frozen=True)
class Packed:
    """Columns of `shape` (N, C, d): `values` from the row `first` on, in some `channels`; zero elsewhere."""

    shape: tuple[int, int, int]
    first: int
    channels: NDArray[np.int64]
    values: Array

    def whole(self) -> Array:
        """The columns (N, C, d)."""
        if self.values.shape == self.shape:
            return self.values
        rows, channels, sizes = self.shape
        whole = np.moveaxis(np.zeros((sizes, rows, channels)), 0, 2)
        whole[self.first : self.first + len(self.values), self.channels] = self.values
        return whole

    def kept(self, keep: NDArray[np.bool_]) -> Packed:
        """With only the rows that `keep` (N,) marks."""
        return packed(self.whole()[keep])


def packed(columns: Array) -> Packed:
    """Columns (N, C, d) without the rows before and after all that moves, and the channels in which nothing does."""
    moving = np.asarray(columns.any(axis=2))
    rows, channels = np.flatnonzero(moving.any(axis=1)), np.flatnonzero(moving.any(axis=0))
    first, last = (int(rows[0]), int(rows[-1]) + 1) if len(rows) else (0, 0)
    values = columns
    if (last - first, len(channels)) != columns.shape[:2]:
        values = columns[first:last][:, channels]
    return Packed((columns.shape[0], columns.shape[1], columns.shape[2]), first, channels, values)


class Columns(Sequence[Array]):
    """The columns (N, C, d) of several patterns, one after the other, held packed."""

    def __init__(self, parts: Iterable[Packed] = ()) -> None:
        self.parts = tuple(parts)

    @overload
    def __getitem__(self, at: int) -> Array: ...

    @overload
    def __getitem__(self, at: slice) -> Columns: ...

    def __getitem__(self, at: int | slice) -> Array | Columns:
        """A pattern's columns, or some patterns."""
        return Columns(self.parts[at]) if isinstance(at, slice) else self.parts[at].whole()

    def __len__(self) -> int:
        """How many patterns."""
        return len(self.parts)

    def __iter__(self) -> Iterator[Array]:
        """Each pattern's columns, one at a time."""
        return (part.whole() for part in self.parts)

    def and_one(self, columns: Array) -> Columns:
        """These and one more."""
        return Columns((*self.parts, packed(columns)))
