"""An arm at its worst pose with what its joints carry, and the shape that the loads bend it to, enlarged."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.effects import Twist
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.tip import active_effects, motions
from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.arm.limits.joint_loads import JointLoad
from linkwright.core.arm.worst.search import WorstPose
from linkwright.core.sections.numeric import Array
from linkwright.report.pictures.arm import (
    Point,
    Skeleton,
    Window,
    arm_picture,
    numbered,
    page_of,
    shared_window,
    skeleton,
)
from linkwright.report.pictures.svg import Box, element, free, label, line, text, width_of
from linkwright.results.figures_in_words import figure, pose

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
        moved, turned = _link_displacement(twists, index)
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


def _link_displacement(twists: Sequence[Twist], index: int) -> tuple[Array, Array]:
    """What a link's effects do to its far end."""
    twists_here = [twist for twist in twists if twist.node == "link" and twist.index == index]
    moved = sum((_numbers(twist.translation) for twist in twists_here), np.zeros(3))
    turned = sum((_numbers(twist.rotation) for twist in twists_here), np.zeros(3))
    return moved, turned


def _numbers(vector: Sequence[Any]) -> Array:
    return np.array([float(part) for part in vector])


_SIZE = 0.03


def loads_picture(evaluation: Evaluation) -> str:
    """The picture, with what is said of it below; nothing where a mass is not known."""
    loads = evaluation.joint_loads
    if loads is None:
        return ""
    arm, top = evaluation.arm, evaluation.worst.poses[0]
    drawn = skeleton(evaluation)
    window = shared_window([drawn])
    words = f"{pose(arm, top.q)}: number, force and moment of each joint"
    bent, course = "", [drawn.tip]
    if evaluation.relative_to is None and "compliance" not in evaluation.unknown:
        bent = bent_line(arm, evaluation.load_cases[top.load_case], top, window)
        course = bent_points(arm, evaluation.load_cases[top.load_case], top, window)
        larger = figure(window.exaggeration)
        words += f"; the dashed line is the shape under load (without play) and the arrow the tip's error, {larger} "
        words += "times their size"
    notes, all_of_them = _notes(drawn, loads, window, course)
    if not all_of_them:
        words += "; where there is no room for them, the table has them"
    picture = arm_picture(arm, drawn, window, "pale", about=f"{arm.name} at its worst pose with its joints' loads")
    whole = picture.removesuffix("</svg>") + bent + notes + numbered(drawn, window) + "</svg>"
    return element("div", element("figure", whole, element("figcaption", text(f"{words}."))), class_="dimensioned")


def _notes(drawn: Skeleton, loads: tuple[JointLoad, ...], window: Window, course: Sequence[Point]) -> tuple[str, bool]:
    """Force and moment beside their joints, wherever there is room, and whether there was room for all."""
    size = _SIZE * window.width
    taken = [
        *_along([*_lines(drawn, window), *_through(course)], size),
        *((x - size, y - size, x + size, y + size) for (x, y), _ in drawn.joints),
    ]
    parts: list[str] = []
    for number, ((place, _), load) in enumerate(zip(drawn.joints, loads, strict=True), start=1):
        texts = [f"{number}: {figure(math.hypot(*load.force), 3)} N", f"{figure(math.hypot(*load.moment), 3)} N·m"]
        wide = max(width_of(item, size) for item in texts)
        box = next((box for box in _around(place, wide, size) if free(box, taken) and _inside(box, window)), None)
        if box is None:
            continue
        taken.append(box)
        corner = (min(max(place[0], box[0]), box[2]), min(max(place[1], box[1]), box[3]))
        parts.append(line(place, corner, "rule", 0.002 * window.width))
        middle = 0.5 * (box[0] + box[2])
        parts += [
            label(middle, box[1] + (1.0 + 1.25 * k) * size, size, item, class_="figures")
            for k, item in enumerate(texts)
        ]
    return "".join(parts), len(parts) == 3 * len(loads)


def _around(place: Point, wide: float, size: float) -> list[Box]:
    """Where words may stand by a place: under it and over it first, ever further off."""
    boxes: list[Box] = []
    tall = 2.6 * size
    for far in (1.6, 3.0, 4.5, 6.5, 9.0):
        for side in (0.0, -0.6, 0.6, -1.2, 1.2):
            for down in (True, False):
                left = place[0] + side * wide - 0.5 * wide
                top = place[1] + far * size if down else place[1] - far * size - tall
                boxes.append((left, top, left + wide, top + tall))
    return boxes


def _lines(drawn: Skeleton, window: Window) -> list[tuple[Point, Point, float]]:
    """Links, offsets and the tip's arrow: from where to where, how thick."""
    thin = 0.01 * window.width
    (x, y), (dx, dy) = drawn.tip, drawn.error
    end = (x + window.exaggeration * dx, y + window.exaggeration * dy)
    links = [(link.start, link.end, link.thickness) for link in drawn.links]
    return [*((a, b, thin) for a, b in drawn.leads), *links, (drawn.tip, end, 2.0 * thin)]


def _through(course: Sequence[Point]) -> list[tuple[Point, Point, float]]:
    return [(a, b, 0.0) for a, b in pairwise(course)]


def _along(lines: Sequence[tuple[Point, Point, float]], size: float) -> list[Box]:
    """Boxes that cover lines."""
    boxes: list[Box] = []
    for (x, y), (u, v), thickness in lines:
        count = max(2, math.ceil(math.hypot(u - x, v - y) / (0.5 * size)))
        for k in range(count + 1):
            a, b, half = x + (u - x) * k / count, y + (v - y) * k / count, 0.5 * thickness
            boxes.append((a - half, b - half, a + half, b + half))
    return boxes


def _inside(box: Box, window: Window) -> bool:
    foot = window.top + window.height - 0.09 * window.width
    return window.left < box[0] and box[2] < window.left + window.width and window.top < box[1] and box[3] < foot
