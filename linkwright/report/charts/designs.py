"""Pictures of arms where they err most, and maps of the error, that pages share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.error_map import ErrorMap
from linkwright.core.arm.worst.search import WorstPose
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.optimize.result import OptimizationResult
from linkwright.report.page import figure_place, only_on_paper, separate_place, side_by_side
from linkwright.report.pictures.arm import arm_caption, arm_picture, numbered, shared_window, skeleton, skeleton_at
from linkwright.report.pictures.plots import (
    Figure,
    colour_range,
    error_map_figure,
    error_map_words,
    exchange_figure,
    separate_colours,
    shared_spans,
)
from linkwright.report.pictures.svg import element, nice_below, text
from linkwright.results.design import Named
from linkwright.results.diagnoses.words import listed, row_words
from linkwright.results.document import Drawn
from linkwright.results.figures_in_words import figure, mm, pose

_EXCHANGE = "The exchange ends where no pose is worse than those it has already designed for."


def arms(named: Named) -> str:
    """The arms at their worst poses, to one scale; those that move in space from the side and from above."""
    in_space = any(not evaluation.arm.flat for _, evaluation in named)
    rows = [_arms(named, above=above) for above in (False, True)[: 1 + in_space]]
    rows = [[figure for row in rows for figure in row]] if len(named) == 1 else rows
    return "".join(side_by_side(*row) for row in rows)


def _arms(named: Named, *, above: bool) -> list[str]:
    drawn = [skeleton(evaluation, above=above) for _, evaluation in named]
    others = [skeleton(evaluation, above=not above) for _, evaluation in named if not evaluation.arm.flat]
    window = shared_window(drawn, beside=others)
    figures: list[str] = []
    for (when, evaluation), item in zip(named, drawn, strict=True):
        heading = element("h3", text(when.capitalize())) if when and not above else ""
        caption = element("figcaption", text(arm_caption(evaluation.arm, item, window, above=above)))
        picture = arm_picture(evaluation.arm, item, window, when or "after").removesuffix("</svg>")
        figures.append(element("figure", heading, picture + numbered(item, window) + "</svg>", caption))
    return figures


def maps(named: Named, fields: Sequence[ErrorMap]) -> Drawn:
    """The error maps with one colour scale, and for paper each in its own: where they go, and the figures by name."""
    colours = colour_range(fields, [evaluation for _, evaluation in named])
    spans = shared_spans(fields)
    places: list[str] = []
    on_paper: list[str] = []
    figures: dict[str, Figure] = {}
    for (when, evaluation), field in zip(named, fields, strict=True):
        name = f"map-{when or 'arm'}"
        figures[name] = error_map_figure(field, evaluation, colours, spans)
        words = error_map_words(field, evaluation)
        heading = element("h3", text(when.capitalize())) if when else ""
        places.append(element("div", heading, figure_place(name, words, text(words))))
        alone = colour_range([field], [evaluation])
        if alone != colours:
            figures[f"{name}-own"] = separate_colours(name, *alone)
            on_paper.append(separate_place(name, when, words))
    return Drawn(side_by_side(*places) + only_on_paper(on_paper), figures)


def exchange(result: OptimizationResult, words: str) -> Drawn | str:
    """The objective over the iterations; nothing where there was but one."""
    if len(result.iterations) < 2:
        return ""
    figures = {"exchange": exchange_figure(result.iterations, result.minimised)}
    return Drawn(figure_place("exchange", words, text(_EXCHANGE)), figures)


def _joints_at_fault(diagnosis: Diagnosis) -> list[int]:
    """The joints of what is named and not small beside it; where nothing is, the one in which the mismatch sits."""
    main = (item for item in diagnosis.findings if not item.small)
    at_joints = [item for item in main if item.effect in EFFECTS and EFFECTS[item.effect].place == "joint"]
    named = sorted({joint for item in at_joints for joint in item.at})
    return named or ([] if diagnosis.where.joint is None else [diagnosis.where.joint])


def arm_at_mismatch(diagnosis: Diagnosis) -> str:
    """The arm at the reading where the mismatch is largest, the joints at fault ringed."""
    recording, arm = diagnosis.recording, diagnosis.arm
    length = np.linalg.norm(diagnosis.residual_before, axis=1)
    worst = int(np.argmax(length))
    vector = [*diagnosis.in_space(diagnosis.residual_before)[worst].tolist(), 0.0][:3]
    shown = (vector[0], vector[1], vector[2])
    at = WorstPose(tuple(recording.q[worst].tolist()), 0, float(length[worst]), shown, (), ())
    drawn = skeleton_at(arm, at)
    window = shared_window([drawn])
    if at.error > 0.0:
        # Seen from the side the arrow may point at the reader; it must not be drawn longer for that.
        longest = nice_below(0.2e-3 * window.width / at.error)
        window = replace(window, exaggeration=min(window.exaggeration, longest))
    joints = _joints_at_fault(diagnosis)
    numbers = listed([str(joint) for joint in joints])
    ring = (
        "" if not joints else f"; joint {numbers} is ringed" if len(joints) == 1 else f"; joints {numbers} are ringed"
    )
    row = row_words(recording, int(recording.row[worst]))
    about = f"{arm.name} at {row}, where the mismatch is largest: {mm(at.error, 3)}{ring}"
    view = "" if arm.planar() else "; seen from the side, in the upright plane through the tip"
    arrow = f"The arrow is the mismatch, {figure(window.exaggeration)} times its size{view}."
    words = f"{about} ({pose(arm, at.q)}). {arrow}"
    picture = arm_picture(arm, drawn, window, "before", marked=[joint - 1 for joint in joints], about=about)
    return element("figure", picture, element("figcaption", text(words)), class_="bounded small")
