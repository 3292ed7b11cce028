"""Joints that follow others: parallelograms, gear couplings, drives at the base.

A joint that follows turns by sum_j w_j q_j + constant, over the coordinates of joints nearer the base (and, where it
has a separate drive that does not stand at it, its coordinate with w = 1). By virtual work drive j then holds its
joint's load and w_j times the follower's, and whatever turns joint j beside its reading turns the follower w_j
times. Where the axes are parallel a rod or belt runs along the link between: it takes its share of the follower's
moment off that link, and what the link's bending turns, the follower turns back.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from linkwright.core.sections.numeric import Array

from .vectors import Scalar, plus, times

if TYPE_CHECKING:
    from .chain import Arm


@dataclass(frozen=True)
class Tie:
    """One coordinate (joint, from 0) that a follower follows, `weight` times; `along` whether the axes are parallel at
    every pose, so that the coupling runs along the links between."""

    joint: int
    weight: float
    along: bool = False


@dataclass(frozen=True)
class Following:
    """What a joint follows: the ties, a `constant` (rad, m), and whether its coordinate counts too (`driven`)."""

    ties: tuple[Tie, ...]
    constant: float = 0.0
    driven: bool = False

    def at(self, joint_value: Scalar, q: Sequence[Scalar]) -> Scalar:
        """The joint's turn or shift at coordinates q of all joints, `joint_value` among them its own."""
        total: Scalar = joint_value if self.driven else 0.0
        for tie in self.ties:
            total = plus(total, times(tie.weight, q[tie.joint]))
        return plus(total, self.constant)

    def moved(self, joints: Mapping[int, int]) -> Following:
        """The same with joints numbered otherwise."""
        ties = tuple(Tie(joints[tie.joint], tie.weight, tie.along) for tie in self.ties)
        return Following(ties, self.constant, self.driven)


def turns(arm: Arm, q: Sequence[Scalar]) -> list[Scalar]:
    """How far each joint turns (rad) or slides (m) at coordinates q; what q holds of joints without a separate
    drive does not count."""
    return [
        item if joint.follows is None else joint.follows.at(item, q) for joint, item in zip(arm.joints, q, strict=True)
    ]


def coordinates(arm: Arm, q: Sequence[Scalar]) -> list[Scalar]:
    """The coordinates q with those of joints that only follow filled in."""
    whole = turns(arm, q)
    return [item if joint.driven else turn for joint, item, turn in zip(arm.joints, q, whole, strict=True)]


def completed(arm: Arm, q: Array) -> Array:
    """Poses (N, n) or one (n,) with the coordinates of joints that only follow filled in."""
    if all(joint.driven for joint in arm.joints):
        return q
    rows = np.atleast_2d(q)
    filled = np.stack([np.broadcast_to(coordinate, len(rows)) for coordinate in coordinates(arm, list(rows.T))], axis=1)
    return filled.reshape(q.shape)


def turns_by_coordinates(arm: Arm) -> Array:
    """The matrix from coordinates to turns of the joints."""
    matrix = np.diag([float(joint.driven) for joint in arm.joints])
    for index, joint in enumerate(arm.joints):
        for tie in () if joint.follows is None else joint.follows.ties:
            matrix[index, tie.joint] = tie.weight
    return matrix


def turn_range(arm: Arm, index: int) -> tuple[float, float]:
    """Where a joint (from 0) can turn or slide to against the link before it, whatever those that it follows do."""
    joint = arm.joints[index]
    if joint.follows is None or not joint.driven:
        return joint.range
    ends = [sorted(tie.weight * end for end in arm.joints[tie.joint].range) for tie in joint.follows.ties]
    low, high = joint.range
    constant = joint.follows.constant
    return constant + low + sum(least for least, _ in ends), constant + high + sum(most for _, most in ends)


def ties_to(arm: Arm) -> dict[int, list[tuple[int, Tie]]]:
    """For each joint that some follow: the followers (from 0) with their ties."""
    ties: dict[int, list[tuple[int, Tie]]] = {}
    for index, joint in enumerate(arm.joints):
        for tie in () if joint.follows is None else joint.follows.ties:
            ties.setdefault(tie.joint, []).append((index, tie))
    return ties
