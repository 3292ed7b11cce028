"""What an arm keeps clear of, and the straight pieces that it is made of at a pose; floats, arrays or symbols."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.chain.arrays import columns
from linkwright.core.arm.chain.branches import Way, ways
from linkwright.core.arm.chain.chain import Arm, Link
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.chain.vectors import ZERO, Scalar, Vector, add, scale
from linkwright.core.sections.numeric import Array, maximum, minimum

TOUCHES = 1e-9
"""m; what touches is clear."""
_OF_BASE = 0.1
"""The share of the first link that is the base's, on which it stands."""


@dataclass(frozen=True)
class Piece:
    """A cylinder about the line from `start` by `vector` (m; `along` it is its unit vector), with a `radius` (m).

    It begins at a joint (from 0; a tool at a number of its own), and the piece before it at the joint `before` (-1 of
    the first). Joints that stand in one point, as those of a wrist, count as the first of them. `offset`: it only
    leads from a link's end to a joint.
    """

    name: str
    joint: int
    before: int
    start: Vector
    vector: Vector
    radius: Scalar = 0.0
    along: Vector = ZERO
    offset: bool = False

    def at(self, share: Scalar) -> Vector:
        """The point of its axis at a share of its length, m."""
        return add(self.start, scale(share, self.vector))

    def arrays(self, count: int) -> tuple[Array, Array]:
        """Start and vector (P, 3) of a piece that is known at P poses."""
        return columns(self.start, count), columns(self.vector, count)


class Obstacle(ABC):
    """Something that an arm keeps clear of."""

    @abstractmethod
    def asks(self, parts: Sequence[Piece]) -> list[tuple[int, ...]]:
        """The pieces (by number) that it asks of together: one, or two that keep clear of each other."""

    @abstractmethod
    def gap(self, parts: Sequence[Piece], shares: Sequence[Scalar]) -> Scalar:
        """By how much such pieces are clear (m) at shares of their lengths; negative where they are not."""

    @abstractmethod
    def closest(self, parts: Sequence[Piece], count: int) -> tuple[Array, Array]:
        """The least of that (P,) over such pieces at P poses, and the shares (P, 2) at which it is."""

    @property
    @abstractmethod
    def words(self) -> str:
        """What people call it."""


def pieces(
    arm: Arm,
    q: Sequence[Scalar],
    lengths: Sequence[Scalar] | None = None,
    radii: Sequence[Scalar] | None = None,
    *,
    everything: bool = False,
) -> Iterator[Piece]:
    """The straight pieces of an arm at coordinates q (rad, m), links as long and as thick as the arm's own by default.

    What stands still, the base up to the first joint and the rail of a slide there, comes only with `everything`. Of
    the link that stands on it, the first tenth, and no less than its radius, is the base's.
    """
    for way in ways(arm):
        yield from _of_way(way, q, lengths, radii, everything=everything)


def _of_way(
    way: Way,
    q: Sequence[Scalar],
    lengths: Sequence[Scalar] | None,
    radii: Sequence[Scalar] | None,
    *,
    everything: bool,
) -> Iterator[Piece]:
    given = way.arm.lengths if lengths is None else [lengths[joint] for joint in way.joints]
    frames = place(way.arm, [q[joint] for joint in way.joints], given)
    point, start, before = ZERO, -1, -1
    for index, (frame, link) in enumerate(zip(frames.joints, frames.links, strict=True)):
        joint, own = way.joints[index], way.arm.joints[index]
        leads = any(own.origin_translation) or not own.revolute
        if everything or (index and leads):
            yield Piece(f"offset of joint {joint + 1}", joint, start, point, frame.lead, offset=True)
        if leads or index == 0 or way.arm.lengths[index - 1] > 0.0:
            start, before = joint, start
        point = add(point, frame.lead)
        radius = half_size(way.arm.links[index]) if radii is None else radii[joint]
        piece = Piece(f"link {joint + 1}", start, before, point, link.vector, radius, link.along)
        point = add(point, link.vector)
        if index == 0 and not everything and way.arm.lengths[index] > 0.0:
            share = minimum(maximum(radius / given[index], _OF_BASE), 1.0)
            piece = replace(piece, start=piece.at(share), vector=scale(1.0 - share, link.vector))
        yield piece
    if everything or any(way.arm.tool):
        if way.arm.lengths[-1] > 0.0:
            start, before = len(q) + way.joints[-1], start
        yield Piece("the tool", start, before, point, frames.tool)


def half_size(link: Link) -> float:
    """How far a link's section reaches from its axis at most, m; 0 where the section is not known."""
    return 0.0 if link.section is None else float(link.section.greatest_radius)


def frames_and_tips(arm: Arm, q: Array) -> Array:
    """Where the frames of all joints and the tips are at poses q (P, n): (P, F, 3), m."""
    ends = [columns(piece.at(1.0), len(q)) for piece in pieces(arm, list(q.T), everything=True)]
    return np.stack(ends, axis=1)
