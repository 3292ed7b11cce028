"""Poses of the planar 3R arm by the equations (3) to (9) of the paper, both elbows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from linkwright.core.arm.worst.inverse import UnreachableInclined


@dataclass(frozen=True)
class PlanarPose:
    """A pose of the planar 3R arm. `absolute` are the links' angles from the x axis (the paper's theta), `relative`
    the joint angles as encoders read them, all in rad within (-pi, pi]. `elbow` says to which side of the line from
    the base to the third joint the second joint lies, seen along it. `free`: joint 1 may stand anywhere (both
    joints coincide).
    """

    absolute: tuple[float, float, float]
    elbow: Literal["left", "right", "straight"]
    free: bool = False

    @property
    def relative(self) -> tuple[float, float, float]:
        """The joint angles, each from the link before it, rad."""
        first, second, third = self.absolute
        return (first, _turned(second - first), _turned(third - second))


def _turned(angle: float) -> float:
    """The angle in (-pi, pi]."""
    rest = math.remainder(angle, 2.0 * math.pi)
    return math.pi if rest == -math.pi else rest


def planar_3r(lengths: Sequence[float], x: float, y: float, inclination: float) -> tuple[PlanarPose, ...]:
    """Both poses of a planar 3R arm with its tip at (x, y) and its last link inclined so, by the paper's equations.

    `lengths` and the point in m, `inclination` in rad from the x axis. The paper's (3) to (9): the third joint B is
    the tip less the last link; the law of cosines in the triangle of base, second joint and B gives the angle between
    links 1 and 2 up to its sign; (7) and (8) give the angle of link 1, and link 3 has the inclination. Both elbows
    are returned, one pose where they coincide. Raises `UnreachableInclined` with the distance missing (m).
    """
    first, second, third = (float(length) for length in lengths)
    if not (first > 0.0 and second > 0.0 and third >= 0.0):
        raise ValueError("link lengths are positive")
    joint_x, joint_y = x - third * math.cos(inclination), y - third * math.sin(inclination)
    reach = math.hypot(joint_x, joint_y)
    missing = max(reach - (first + second), abs(first - second) - reach, 0.0)
    if missing > 1e-12 * (first + second):
        words = f"with the last link at {math.degrees(inclination):.6g} deg"
        raise UnreachableInclined((x, y), missing, words)
    cosine = (reach * reach - first * first - second * second) / (2.0 * first * second)
    between = math.acos(min(1.0, max(-1.0, cosine)))
    inclined = _turned(inclination)
    if reach <= 1e-12 * (first + second):
        return (PlanarPose((0.0, math.pi, inclined), "straight", free=True),)
    straight = between == 0.0 or between == math.pi
    poses: list[PlanarPose] = []
    for turn in (between,) if straight else (between, -between):
        # (7) and (8) solved for link 1: B = R(theta_1) (l1 + l2 cos, l2 sin).
        along, across = first + second * math.cos(turn), second * math.sin(turn)
        angle = math.atan2(joint_y, joint_x) - math.atan2(across, along)
        side: Literal["left", "right", "straight"] = "straight" if straight else ("right" if turn > 0.0 else "left")
        poses.append(PlanarPose((_turned(angle), _turned(angle + turn), inclined), side))
    return tuple(poses)
