"""Links that keep clear of one another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from linkwright.core.arm.chain.vectors import Scalar, dot, minus, subtract
from linkwright.core.sections.numeric import Array, sqrt

from .obstacle import Obstacle, Piece


@dataclass(frozen=True)
class OtherLinks(Obstacle):
    """The links themselves: two that share no joint keep clear, each a cylinder with round ends."""

    def asks(self, parts: Sequence[Piece]) -> list[tuple[int, ...]]:
        """Every two links, the tool among them, that share no joint."""
        pairs = combinations([number for number, part in enumerate(parts) if not part.offset], 2)
        return [pair for pair in pairs if not _joined(*(parts[number] for number in pair))]

    def gap(self, parts: Sequence[Piece], shares: Sequence[Scalar]) -> Scalar:
        """The distance between two points of the axes, less both radii."""
        (one, other), (share, other_share) = parts, shares
        apart = subtract(one.at(share), other.at(other_share))
        return minus(minus(sqrt(dot(apart, apart)), one.radius), other.radius)

    def closest(self, parts: Sequence[Piece], count: int) -> tuple[Array, Array]:
        """The least distance of two line segments (C. Ericson, Real-Time Collision Detection, 2005, 5.1.9), less both
        radii."""
        (start, along), (other_start, other_along) = (part.arrays(count) for part in parts)
        apart = start - other_start
        a, e, b = (_dot(*pair) for pair in ((along, along), (other_along, other_along), (along, other_along)))
        c, f = _dot(along, apart), _dot(other_along, apart)
        a, e = np.maximum(a, _POINT), np.maximum(e, _POINT)
        across = a * e - b * b
        share = np.clip(np.where(across > _PARALLEL * a * e, b * f - c * e, 0.0) / np.maximum(across, _POINT**2), 0, 1)
        other_share = np.clip((b * share + f) / e, 0.0, 1.0)
        share = np.clip((b * other_share - c) / a, 0.0, 1.0)
        lines = apart + share[:, None] * along - other_share[:, None] * other_along
        gaps = np.linalg.norm(lines, axis=1) - float(parts[0].radius) - float(parts[1].radius)
        return gaps, np.stack([share, other_share], axis=1)

    @property
    def words(self) -> str:
        """What people call it."""
        return "one another"


_POINT, _PARALLEL = 1e-18, 1e-12
"""The square of a length (m^2) of none; the sine's square below which two lines are parallel."""


def _dot(a: Array, b: Array) -> Array:
    return np.einsum("ij,ij->i", a, b)


def _joined(one: Piece, other: Piece) -> bool:
    """Whether two pieces share a joint, or are one piece on the ways to two tips."""
    return one.joint in (other.joint, other.before) or one.before in (other.joint, other.before)
