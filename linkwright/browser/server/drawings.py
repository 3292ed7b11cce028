"""Pictures for the pages, made of the reports' own: an arm at a pose, its worst poses bent, the designs of a front."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from arm.chain.chain import Arm, LoadCase
from arm.chain.statics import PoseState, solve
from arm.effects import Twist
from arm.errors.model import beams_of
from arm.errors.tip import active_effects, motions
from arm.evaluation import Evaluation
from arm.worst.search import WorstPose
from linkwright.face.tradeoff import Tradeoff, TradeoffDesign
from linkwright.json.tradeoff import point_file
from linkwright.report.pages.tradeoff import front_figure
from linkwright.report.pictures.arm import (
    Point,
    Window,
    arm_caption,
    arm_picture,
    page_of,
    shared_window,
    skeleton_at,
)
from linkwright.report.pictures.svg import element
from linkwright.results.figures_in_words import figure, mm, section_words
from sections.numeric import Array

_PIECES = 12
_MOST_POSES = 4


def middle(arm: Arm) -> tuple[float, ...]:
    """The middle of every joint's range."""
    return tuple(0.5 * (low + high) for low, high in (joint.range for joint in arm.joints))


def at_pose(arm: Arm, q: Sequence[float]) -> str:
    """The arm to scale at a pose."""
    still = WorstPose(tuple(q), 0, 0.0, (0.0, 0.0, 0.0), (), ())
    drawn = skeleton_at(arm, still)
    return arm_picture(arm, drawn, shared_window([drawn]), "after", about=f"{arm.name}, to scale")


def worst_poses(found: Evaluation) -> list[dict[str, str]]:
    """The worst poses, worst first: words and a picture with the bent shape and the error, to one scale."""
    poses = found.worst.poses[:_MOST_POSES]
    skeletons = [skeleton_at(found.arm, pose) for pose in poses]
    window = shared_window(skeletons)
    told: list[dict[str, str]] = []
    for pose, drawn in zip(poses, skeletons, strict=True):
        about = f"{found.arm.name} at a pose where the error is {mm(pose.error)}, bent by its loads"
        picture = arm_picture(found.arm, drawn, window, "after", about=about)
        bent = _bent(found.arm, found.load_cases[pose.load_case], pose, window)
        words = arm_caption(found.arm, drawn, window)
        if bent:
            words += "; the dashed line is the bent shape, as much enlarged (without play)"
        told.append({"words": words, "svg": picture.removesuffix("</svg>") + bent + "</svg>"})
    return told


def _bent(arm: Arm, case: LoadCase, pose: WorstPose, window: Window) -> str:
    state = solve(arm, list(pose.q), beams_of(arm, (case,)), case)
    places, shifts = bent_shape(arm, state)
    project = page_of(arm, np.array([float(x) for x in state.tip()]))
    points: list[Point] = []
    for place, shift in zip(places, window.exaggeration * shifts, strict=True):
        points.append(project(place + shift))
    course = "M" + "L".join(f"{x:.6g},{y:.6g}" for x, y in points)
    width = 0.006 * window.width
    return element("path", d=course, class_="bent", stroke_width=width, stroke_dasharray=f"{2 * width:.4g}")


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


def front_to_click(front: Tradeoff) -> dict[str, Any]:
    """The front as plotly draws it, each point with its design's number, and the designs by number."""
    found = front.found
    drawn = front_figure(found)
    numbers = {(found.asked.x.factor * point.x, found.asked.y.factor * point.y): point.number for point in found.points}
    for trace in drawn["data"]:
        trace["customdata"] = [numbers.get(place) for place in zip(trace["x"], trace["y"], strict=True)]
    drawn["layout"]["legend"] = {"orientation": "h", "y": -0.22}
    files = {point.number: point_file(found, point) for point in found.points}
    designs = {str(each.number): {**_design(front, each), "file": files[each.number]} for each in front.designs}
    return {"figure": drawn, "designs": designs}


def _design(front: Tradeoff, design: TradeoffDesign) -> dict[str, Any]:
    model = design.arm.model
    known = front.found.asked.given.figures.values()
    figures = [(each.title, each.shown(design.figures[each.name]), each.unit) for each in known]
    links = [
        {
            "link": number,
            "length": f"{figure(1e3 * link.length)} mm",
            "section": section_words(link),
            "material": "" if link.material is None else link.material.name,
        }
        for number, link in enumerate(model.links, start=1)
    ]
    return {
        "figures": [
            {"figure": title, "value": f"{figure(v)} {unit}".strip()} for title, v, unit in figures if v is not None
        ],
        "links": links,
        "svg": at_pose(model, middle(model)),
    }
