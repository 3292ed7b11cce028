"""Pictures for the pages, made of the reports' own: an arm at a pose, its worst poses bent, designs to click on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import AfterValidator, TypeAdapter, ValidationError
from typing_extensions import TypedDict

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.arm.worst.search import WorstPose
from linkwright.core.units.quantities import InputError
from linkwright.face.design import Optimization
from linkwright.face.tradeoff import Tradeoff
from linkwright.output.files import DESIGN
from linkwright.output.tradeoff_folder import point_file
from linkwright.report.charts.fronts import front_figure
from linkwright.report.pictures.arm import (
    arm_caption,
    arm_picture,
    shared_window,
    skeleton_at,
)
from linkwright.report.pictures.loads import bent_line
from linkwright.results.combinations import names_words
from linkwright.results.design import poses_that_differ
from linkwright.results.figures_in_words import figure, mm, section_words

_MOST_POSES = 4
_SHOWN = ("max_error", "mass", "cost")
"""The figures that every design shows."""
_AS_GOOD = 0.005
"""Percent by which a near tie is worse that nobody can tell from nothing."""
TIES = "near-ties"
"""The folder of the near ties' arm files."""


def _without_script(svg: str) -> str:
    if "</script" in svg.lower():
        raise ValueError
    return svg


Picture = Annotated[str, AfterValidator(_without_script)]
"""An SVG; none that this program drew holds a script."""


class Pose(TypedDict):
    """A pose as it is shown: a picture, and what is to be said of it."""

    words: str
    svg: Picture


class Figure(TypedDict):
    """A figure of a design."""

    figure: str
    value: str


class Link(TypedDict):
    """A link of a design."""

    link: int
    length: str
    section: str
    material: str


class Design(TypedDict):
    """A design of a front: its figures, its links, a picture, the name of its arm file."""

    figures: list[Figure]
    links: list[Link]
    svg: Picture
    file: str


class Plot(TypedDict):
    """What plotly draws."""

    data: list[dict[str, Any]]
    layout: dict[str, Any]


class Front(TypedDict):
    """A front to click on: what plotly draws, and the designs by number."""

    figure: Plot
    designs: dict[int, Design]


def middle(arm: Arm) -> tuple[float, ...]:
    """The middle of every joint's range."""
    return tuple(0.5 * (low + high) for low, high in (joint.range for joint in arm.joints))


def at_pose(arm: Arm, q: Sequence[float]) -> str:
    """The arm to scale at a pose."""
    still = WorstPose(tuple(q), 0, 0.0, (0.0, 0.0, 0.0), (), ())
    drawn = skeleton_at(arm, still)
    return arm_picture(arm, drawn, shared_window([drawn]), "after", about=f"{arm.name}, to scale")


def worst_poses(result: Evaluation) -> list[Pose]:
    """The worst poses, worst first: words and a picture with the bent shape and the error, to one scale."""
    poses = poses_that_differ(result)[:_MOST_POSES]
    skeletons = [skeleton_at(result.arm, pose) for pose in poses]
    window = shared_window(skeletons)
    shown: list[Pose] = []
    for pose, drawn in zip(poses, skeletons, strict=True):
        about = f"{result.arm.name} at a pose where the error is {mm(pose.error)}, bent by its loads"
        picture = arm_picture(result.arm, drawn, window, "after", about=about)
        bent = bent_line(result.arm, result.load_cases[pose.load_case], pose, window)
        words = arm_caption(result.arm, drawn, window)
        if bent:
            words += "; the dashed line is the bent shape, as much enlarged (without play)"
        shown.append({"words": words, "svg": picture.removesuffix("</svg>") + bent + "</svg>"})
    return shown


def front_to_click(front: Tradeoff) -> Front:
    """The front as plotly draws it, each point with its design's number, and the designs by number."""
    result = front.found
    drawn = front_figure(result, brief=True)
    numbers = {
        (result.asked.x.factor * point.x, result.asked.y.factor * point.y): point.number for point in result.points
    }
    for trace in drawn["data"]:
        trace["customdata"] = [numbers.get(place) for place in zip(trace["x"], trace["y"], strict=True)]
    files = {point.number: point_file(result, point) for point in result.points}
    known = result.asked.given.figures.values()
    designs: dict[int, Design] = {}
    for design in front.designs:
        figures = [(item.title, item.shown(design.values[item.name]), item.unit) for item in known]
        designs[design.number] = _design(design.arm.model, figures, files[design.number])
    return {"figure": {"data": drawn["data"], "layout": drawn["layout"]}, "designs": designs}


def choices_to_click(result: Optimization) -> tuple[dict[str, Design], dict[str, Arm]]:
    """The best design and its near ties, by what is said of them; and the arms of the near ties by the names of their
    files."""
    optimum = result.found
    minimised = optimum.minimised
    objective, after = optimum.objective, optimum.after
    if optimum.rounded is not None:
        objective, after = optimum.rounded.objective, optimum.rounded.evaluation
    best = (optimum.built, objective, after.worst.error, after.mass, after.cost)
    ties = [(tie.arm, tie.objective, tie.max_error, tie.mass, tie.cost) for tie in optimum.near_ties]
    designs: dict[str, Design] = {}
    arms: dict[str, Arm] = {}
    for number, (arm, objective, error, mass, cost) in enumerate((best, *ties)):
        file, name = DESIGN, "best"
        if number:
            file = f"{TIES}/{number:02d}.yaml"
            arms[file] = arm
            worse = 100.0 * abs(objective / optimum.objective - 1.0) if optimum.objective else 0.0
            name = f"near tie {number}, " + (f"{worse:.2f} % worse" if worse >= _AS_GOOD else "as good")
        figures = [("worst error", 1e3 * error, "mm"), ("mass of the links", mass, "kg"), ("cost", cost, "EUR")]
        if minimised.name not in _SHOWN:
            figures.insert(0, (minimised.title, minimised.factor * objective, minimised.unit))
        options = (
            [None if link.section is None else link.section.shape for link in arm.links],
            [None if link.material is None else link.material.name for link in arm.links],
            [None if joint.actuator is None else joint.actuator.name for joint in arm.joints] if optimum.drives else [],
        )
        words = "; ".join(names_words(names) for names in options if names)
        designs[f"{name}: {words}"] = _design(arm, figures, file)
    return designs, arms


def poses_from(content: bytes) -> list[Pose]:
    """The poses that a file keeps. Raises `InputError`, as the next, where it is none of this program's."""
    try:
        return TypeAdapter(list[Pose]).validate_json(content)
    except ValidationError:
        raise InputError("", "poses.json", "is damaged; the worst poses cannot be shown") from None


def front_from(content: bytes) -> Front:
    """The front that a file keeps."""
    try:
        front = TypeAdapter(Front).validate_json(content)
    except ValidationError:
        front = None
    if front is None or not front["designs"]:
        raise InputError("", "front.json", "is damaged; the front cannot be shown")
    return front


def choices_from(content: bytes) -> dict[str, Design]:
    """The near ties that a file keeps, with the best design."""
    try:
        return TypeAdapter(dict[str, Design]).validate_json(content)
    except ValidationError:
        raise InputError("", "choices.json", "is damaged; the near ties cannot be shown") from None


def _design(model: Arm, figures: Sequence[tuple[str, float | None, str]], file: str) -> Design:
    links: list[Link] = [
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
        "file": file,
    }
