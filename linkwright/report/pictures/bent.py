"""The shape that an arm is bent to by its loads, drawn larger than it is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.effects import Twist
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.tip import active_effects, motions
from linkwright.core.arm.worst.search import WorstPose
from linkwright.core.sections.numeric import Array

from .arm import Point, Window, page_of
from .svg import element

_PIECES = 12


def bent_line(arm: Arm, case: LoadCase, pose: WorstPose, window: Window) -> str:
    """The bent shape at a pose as a dashed line, as many times enlarged as the window enlarges errors."""
    points = bent_points(arm, case, pose, window)
    course = "M" + "L".join(f"{x:.6g},{y:.6g}" for x, y in points)
    width = 0.006 * window.width
    return element("path", d=course, class_="bent", stroke_width=width, stroke_dasharray=f"{2 * width:.4g}")


def bent_points(arm: Arm, case: LoadCase, pose: WorstPose, window: Window) -> list[Point]:
    """Where that line runs on the page."""
    state = solve(arm, list(pose.q), beams_of(arm, (case,)), case)
    places, shifts = bent_shape(arm, state)
    project = page_of(arm, np.array([float(x) for x in state.tip()]))
    return [project(place + window.exaggeration * shift) for place, shift in zip(places, shifts, strict=True)]


def bent_shape(arm: Arm, state: PoseState) -> tuple[Array, Array]:
    """Places along the arm (N, 3) from the base to the tip, m, and how far each is moved, to first order and without
    play. Within a link the shape is the cubic that its ends' displacements and slopes give."""
    twists = [twist for active in active_effects(arm) for twist in active.effect.twists(state, active.settings)]
    ends = [(_numbers(shift), _numbers(turn)) for shift, turn in motions(state, twists)]
    here = np.zeros(3)
    places: list[Array] = []
    shifts: list[Array] = []
    for index, link in enumerate(state.links):
        vector = _numbers(link.vector)
        start = here + _numbers(state.leads[index])
        moved, turned = _own(twists, index)
        end_shift, end_turn = ends[index]
        root_turn = end_turn - turned
        root_shift = end_shift - moved - np.cross(root_turn, vector)
        for s in np.linspace(0.0, 1.0, _PIECES + 1):
            bending = moved * s**2 * (3.0 - 2.0 * s) + np.cross(turned, vector) * s**2 * (s - 1.0)
            places.append(start + s * vector)
            shifts.append(root_shift + s * np.cross(root_turn, vector) + bending)
        here = start + vector
    places.append(here + _numbers(state.tool))
    shifts.append(ends[-1][0])
    return np.array(places), np.array(shifts)


def _own(twists: Sequence[Twist], index: int) -> tuple[Array, Array]:
    """What a link's own effects do to its far end."""
    own = [twist for twist in twists if twist.node == "link" and twist.index == index]
    moved = sum((_numbers(twist.translation) for twist in own), np.zeros(3))
    turned = sum((_numbers(twist.rotation) for twist in own), np.zeros(3))
    return moved, turned


def _numbers(vector: Sequence[Any]) -> Array:
    return np.array([float(part) for part in vector])
