"""An arm drawn to scale at its worst pose, with the error at its tip exaggerated."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from linkwright.core.arm.chain.chain import Arm, Joint
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.arm.placed.views import Stand, View, from_above, view_of, walked
from linkwright.core.arm.worst.search import WorstPose
from linkwright.core.sections.section import Section
from linkwright.results.figures_in_words import figure, mm, pose

from .svg import drawing, element, label, line, nice_below, path, scale_bar

Point = tuple[float, float]
_ARROW = 0.16
_WIDEST, _NARROWEST = 0.34, 1.4
"""Least height of a window by its width, and least width by its height: letters are sized by the width, and what is
tall is drawn small."""


@dataclass(frozen=True)
class Silhouette:
    """What a link covers of the page (mm, y down): its axis from `start` to `end`, and the corners around it."""

    start: Point
    end: Point
    corners: tuple[Point, ...]

    @property
    def thickness(self) -> float:
        """Twice as far as a corner is off the axis, mm."""
        (x, y), (u, v) = self.start, self.end
        length = math.hypot(u - x, v - y)
        if length < 1e-9:
            return 2.0 * max(math.hypot(a - x, b - y) for a, b in self.corners)
        return 2.0 * max(abs((u - x) * (b - y) - (v - y) * (a - x)) / length for a, b in self.corners)


@dataclass(frozen=True)
class Skeleton:
    """An arm at a pose, projected on the page (mm, y down): thin leads, the links' silhouettes, and the tip.

    `error` is the tip's error on the same page, mm.
    """

    leads: tuple[tuple[Point, Point], ...]
    links: tuple[Silhouette, ...]
    joints: tuple[tuple[Point, Joint], ...]
    tip: Point
    error: Point
    pose: WorstPose

    @property
    def points(self) -> list[Point]:
        """What must be within the picture."""
        return [
            (0.0, 0.0),
            self.tip,
            *(place for place, _ in self.joints),
            *(end for lead in self.leads for end in lead),
            *(corner for link in self.links for corner in link.corners),
        ]


@dataclass(frozen=True)
class Window:
    """The part of the plane (mm) that pictures share, and how many times errors are drawn larger."""

    left: float
    top: float
    width: float
    height: float
    exaggeration: float


def skeleton(evaluation: Evaluation, *, above: bool = False) -> Skeleton:
    """The arm of an evaluation at its worst pose, as `skeleton_at` shows it."""
    worst = evaluation.worst.poses[0]
    return skeleton_at(evaluation.arm.on(evaluation.load_cases[worst.load_case].tip), worst, above=above)


def skeleton_at(arm: Arm, worst: WorstPose, *, above: bool = False) -> Skeleton:
    """An arm at a pose with the error there: in the x-y plane, or in the upright plane through the tip; from `above`,
    down along gravity."""
    tip = np.array(place(arm, worst.q).tip(), dtype=float)
    project = page_of(arm, tip, from_above if above else view_of)
    bodies, tools = walked(arm, worst.q)
    leads: list[tuple[Point, Point]] = []
    links: list[Silhouette] = []
    joints: list[tuple[Point, Joint]] = []
    for body, joint, link in zip(bodies, arm.joints, arm.links, strict=True):
        start, end = project(body.joint), project(body.end)
        if np.abs(body.joint - body.before).max() > 1e-9:
            leads.append((project(body.before), start))
        joints.append((start, joint))
        if link.section is None:
            leads.append((start, end))
        else:
            links.append(Silhouette(start, end, _corners(link.section, body, project)))
    leads += [(project(start), project(end)) for start, end in tools if (start != end).any()]
    error = project(np.array(worst.vector, dtype=float))
    return Skeleton(tuple(leads), tuple(links), tuple(joints), project(tip), error, worst)


def page_of(
    arm: Arm, tip: np.ndarray, seen: Callable[[Arm, np.ndarray], View] = view_of
) -> Callable[[np.ndarray], Point]:
    """From metres in space to millimetres on the page, y down, for an arm with its tip there."""
    view = seen(arm, tip)

    def project(point: np.ndarray) -> Point:
        across, up = 1e3 * view.project(point)
        return float(across), -float(up)

    return project


def _corners(section: Section, body: Stand, project: Callable[[np.ndarray], Point]) -> tuple[Point, ...]:
    """The corners of what a link covers of the page: the hull of the edges at its ends."""
    edges = [body.at(share, section.ends[-share].outline()[0]) for share in (0, 1)]
    places = np.array([project(point) for point in np.vstack(edges)])
    return tuple((float(x), float(y)) for x, y in places[ConvexHull(places).vertices])


def shared_window(skeletons: Sequence[Skeleton], *, beside: Sequence[Skeleton] = ()) -> Window:
    """One window for pictures that are to be compared, and one exaggeration for them and those `beside` them."""
    points = [point for item in skeletons for point in item.points]
    reach = max(math.hypot(*point) for point in points)
    everywhere = (*skeletons, *beside)
    farthest = max(math.hypot(*point) for item in everywhere for point in item.points)
    largest = max(math.hypot(*item.error) for item in everywhere)
    exaggeration = nice_below(_ARROW * farthest / largest) if largest > 0.0 else 1.0
    points += [(x.tip[0] + exaggeration * x.error[0], x.tip[1] + exaggeration * x.error[1]) for x in skeletons]
    xs, ys = [x for x, _ in points], [y for _, y in points]
    margin = 0.09 * reach
    width, height = max(xs) - min(xs) + 2 * margin, max(ys) - min(ys) + 2 * margin
    wider, missing = max(0.0, _NARROWEST * height - width), max(0.0, _WIDEST * width - height)
    left, top = min(xs) - margin - wider / 2, min(ys) - margin - missing / 2
    width += wider
    return Window(left, top, width, height + missing + 0.07 * width, exaggeration)


def arm_picture(
    arm: Arm, drawn: Skeleton, window: Window, when: str, *, marked: Sequence[int] = (), about: str = ""
) -> str:
    """The picture, with a scale bar; `when` is the class of its colours (before, after).

    `marked` are joints (from 0) to draw rings around, `about` what the picture shows where not the worst pose.
    """
    size = 0.031 * window.width
    joint_radius = 0.012 * window.width
    parts = [_ground(joint_radius)]
    parts += [line(start, end, "lead", 0.006 * window.width) for start, end in drawn.leads]
    parts += [path([link.corners], f"link {when}") for link in drawn.links]
    parts += [_joint(point, joint, joint_radius) for point, joint in drawn.joints]
    for joint in marked:
        x, y = drawn.joints[joint][0]
        ring = {"r": 2.6 * joint_radius, "class_": "mark", "stroke_width": 0.7 * joint_radius}
        parts.append(element("circle", cx=x, cy=y, **ring))
    parts.append(_arrow(drawn.tip, drawn.error, window))
    length = nice_below(0.3 * window.width)
    y = window.top + window.height - 0.02 * window.width
    words = f"{figure(length)} mm"
    parts.append(scale_bar(window.left + 0.03 * window.width, y, length, 0.006 * window.width, size, words))
    if not about:
        where = f"({pose(arm, drawn.pose.q)})"
        about = f"{arm.name} {when} at its worst pose {where}; error at the tip {mm(drawn.pose.error)}"
    return drawing(window.left, window.top, window.width, window.height, about, *parts)


def numbered(drawn: Skeleton, window: Window) -> str:
    """The joints' numbers in circles, those that would lie on each other side by side."""
    size = 0.024 * window.width
    parts: list[str] = []
    taken: list[Point] = []
    for number, ((x, y), _) in enumerate(drawn.joints, start=1):
        while any(math.hypot(x - u, y - v) < 1.7 * size for u, v in taken):
            x += 1.8 * size
        taken.append((x, y))
        parts.append(element("circle", cx=x, cy=y, r=0.85 * size, class_="joint", stroke_width=0.12 * size))
        parts.append(label(x, y + 0.4 * size, 1.15 * size, str(number), class_="figures"))
    return "".join(parts)


def _ground(size: float) -> str:
    return path([[(0.0, 0.0), (-2.2 * size, 3.0 * size), (2.2 * size, 3.0 * size)]], "ground")


def _joint(point: Point, joint: Joint, radius: float) -> str:
    if joint.revolute:
        return element("circle", cx=point[0], cy=point[1], r=radius, class_="joint", stroke_width=radius / 2.5)
    side = 2 * radius
    corner = {"x": point[0] - radius, "y": point[1] - radius, "width": side, "height": side}
    return element("rect", **corner, class_="joint", stroke_width=radius / 2.5)


def _arrow(tip: Point, error: Point, window: Window) -> str:
    """The tip's error, exaggerated, as an arrow from where the tip should be."""
    dx, dy = window.exaggeration * error[0], window.exaggeration * error[1]
    length = math.hypot(dx, dy)
    dot = element("circle", cx=tip[0], cy=tip[1], r=0.007 * window.width, class_="tip")
    if length < 1e-6 * window.width:
        return dot
    head = min(0.02 * window.width, length)
    x, y = dx / length, dy / length
    end = (tip[0] + dx, tip[1] + dy)
    neck = (end[0] - head * x, end[1] - head * y)
    aside = (-0.4 * head * y, 0.4 * head * x)
    wings = [end, (neck[0] + aside[0], neck[1] + aside[1]), (neck[0] - aside[0], neck[1] - aside[1])]
    return line(tip, neck, "error-line", 0.006 * window.width) + path([wings], "error-head") + dot


def arm_caption(arm: Arm, drawn: Skeleton, window: Window, *, above: bool = False) -> str:
    """What the picture shows, in words."""
    view = "" if arm.planar() else "; seen from the side, in the upright plane through the tip"
    if above:
        view = "; seen from above"
    arrow = f"the arrow is the tip's error, drawn {figure(window.exaggeration)} times its size"
    return f"{pose(arm, drawn.pose.q)}: {mm(drawn.pose.error)}; {arrow}{view}"
