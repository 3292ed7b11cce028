"""Poses that keep an arm out of some regions, or within one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.following import completed
from linkwright.core.sections.numeric import Array

from .obstacle import TOUCHES, Obstacle, frames_and_tips, pieces
from .regions import Region, around


class NoRoom(Exception):
    """What is to be avoided leaves too few poses, or none; the text is a clause that says so."""


Draw = Callable[[Array, Array], Array]
Allowed = Callable[[Array], Array]

_RUN, _MOST_RUN = (0.0873, 0.01), 0.05
"""From how far a joint comes (5 deg, a slide 10 mm), beyond any play, and at most of its range."""
_DRAWS = 16
"""Of poses, where some must be kept clear of."""


@dataclass(frozen=True)
class Room:
    """Where poses may put an arm: clear of what is to `avoid`, and with all joints' frames and tips `within` one
    (None: anywhere), its joints within `spans` (rad, m; least and greatest; none: the whole of their ranges)."""

    avoid: tuple[Obstacle, ...] = ()
    within: Region | None = None
    spans: tuple[tuple[float, float], ...] = ()

    @property
    def everywhere(self) -> bool:
        """Whether any pose will do."""
        return not self.avoid and self.within is None

    def of_box(self, low: Array, high: Array) -> tuple[Array, Array]:
        """What of a box of joint coordinates (n,), rad and m, lies in `spans`; where nothing does, their nearest."""
        if not self.spans:
            return low, high
        least, most = np.array(self.spans).T
        return np.clip(low, least, most), np.clip(high, least, most)

    def allows(self, arm: Arm, q: Array) -> NDArray[np.bool_]:
        """Which of some whole poses q (P, n), rad and m, put nothing of an arm where it may not be, whatever their
        joint coordinates."""
        if self.everywhere:
            return np.ones(len(q), dtype=np.bool_)
        allowed = ~meets(arm, q, self.avoid) if self.avoid else np.ones(len(q), dtype=np.bool_)
        if self.within is not None:
            allowed &= self.within.holds(frames_and_tips(arm, q)).all(axis=1)
        return allowed

    def kept(self, arm: Arm, q: Array, run: Array) -> Array:
        """Those of some whole poses q (P, n) that are allowed, and so is where the arm comes to them from, on either
        side by `run` (n,), rad and m."""
        keep = self.allows(arm, q)
        for way in () if self.everywhere else (run, -run):
            keep &= self.allows(arm, completed(arm, q + way))
        return q[keep]


def room_of(arm: Arm, recorded: Array | None, avoid: Sequence[Obstacle] = ()) -> Room:
    """Where proposed poses may put an arm: out of what its file and others say is to be avoided; where nobody says
    anything, within the boxes of the joint coordinates and of all joints' frames and tips at the poses that were
    `recorded` (N, n). Both are asked: a frame gets back into its box by a turn that was never recorded."""
    regions = tuple(dict.fromkeys((*arm.avoid, *avoid)))
    if regions or recorded is None:
        return Room(regions)
    spans = tuple(zip(recorded.min(axis=0).tolist(), recorded.max(axis=0).tolist(), strict=True))
    return Room(within=around(frames_and_tips(arm, recorded)), spans=spans)


def drawn(room: Room, box: tuple[Array, Array], draw: Draw, allowed: Allowed, count: int) -> Array:
    """The first `count` poses (P, n) that are allowed, fewer where sixteen draws bring no more.

    A draw gives points in what of a `box` of joint coordinates, its least and greatest (n,), is in the room. `allowed`
    gives whole poses of those points, less those that may not be.
    """
    low, high = room.of_box(*box)
    drawn_poses: list[Array] = []
    for _ in range(1 if room.everywhere else _DRAWS):
        drawn_poses.append(allowed(draw(low, high)))
        if sum(map(len, drawn_poses)) >= count:
            break
    return np.concatenate(drawn_poses)[:count]


def approach(arm: Arm) -> Array:
    """From how far before a pose each joint comes (n,), rad and m."""
    far = np.array([_RUN[0 if joint.revolute else 1] for joint in arm.joints])
    span = np.array([joint.range[1] - joint.range[0] for joint in arm.joints])
    return np.minimum(far, _MOST_RUN * span)


def meets(arm: Arm, q: Array, obstacles: Sequence[Obstacle]) -> NDArray[np.bool_]:
    """Whether a link or a tip is not clear of some obstacles at poses q (P, n). A link is a cylinder about the line
    from joint to joint, as thick as its section is in any direction; of unknown section it is the line."""
    hit = np.zeros(len(q), dtype=np.bool_)
    parts = list(pieces(arm, list(q.T)))
    for obstacle in obstacles:
        for numbers in obstacle.asks(parts):
            hit |= obstacle.closest([parts[number] for number in numbers], len(q))[0] < -TOUCHES
    return hit
