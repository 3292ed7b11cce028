"""Parts that the reports of an evaluation and of an optimisation share."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import zip_longest

from arm.evaluation import ErrorMap, Evaluation
from linkwright.words import figure, load_case_words, material_words, mm, percent, pose, section_words, with_unit

from .arm_picture import arm_caption, arm_picture, shared_window, skeleton
from .figures import Figure, colour_range, error_map_figure, error_map_words, shared_spans
from .page import figure_place, side_by_side, table
from .svg import element, text

MOST_POSES = 6
Named = Sequence[tuple[str, Evaluation]]
"""Evaluations to be shown beside each other, each with `before`, `after` or an empty name."""


def arms(named: Named) -> str:
    """The arms at their worst poses, to one scale."""
    drawn = [skeleton(evaluation) for _, evaluation in named]
    window = shared_window(drawn)
    figures: list[str] = []
    for (when, evaluation), each in zip(named, drawn, strict=True):
        heading = element("h3", text(when.capitalize())) if when else ""
        caption = element("figcaption", text(arm_caption(evaluation.arm, each, window)))
        figures.append(element("figure", heading, arm_picture(evaluation.arm, each, window, when or "after"), caption))
    return side_by_side(*figures)


def maps(named: Named, fields: Sequence[ErrorMap]) -> tuple[str, Mapping[str, Figure]]:
    """The error maps with one colour scale: where they go, and the figures by name."""
    colours = colour_range(fields, [evaluation for _, evaluation in named])
    spans = shared_spans(fields)
    places: list[str] = []
    figures: dict[str, Figure] = {}
    for (when, evaluation), field in zip(named, fields, strict=True):
        name = f"map-{when or 'arm'}"
        figures[name] = error_map_figure(field, evaluation, colours, spans)
        words = error_map_words(field, evaluation)
        heading = element("h3", text(when.capitalize())) if when else ""
        places.append(element("div", heading, figure_place(name, words, text(words))))
    return side_by_side(*places), figures


def worst_poses(evaluation: Evaluation) -> str:
    """The worst poses as a table."""
    cases = evaluation.load_cases
    rows = [
        [str(number), pose(evaluation.arm, each.q), mm(each.error, 5), load_case_words(cases[each.load_case])]
        for number, each in enumerate(evaluation.worst.poses[:MOST_POSES], start=1)
    ]
    return table(("", "joint coordinates", "error", "load case"), rows, numbers=(2,))


def strength(named: Named) -> str:
    """How near each link is to yielding, buckling or bending too far."""
    rows: list[list[str]] = []
    for link in range(max(evaluation.arm.size for _, evaluation in named)):
        for when, evaluation in named:
            found = evaluation.strength
            if link not in found.links:
                continue
            at = found.links.index(link)
            row = [f"link {link + 1}{' ' + when if when else ''}", with_unit(found.stress[at] / 1e6, "MPa", 3)]
            row += [figure(found.safety_factor[at], 3), figure(found.buckling[at], 4), percent(found.deflection[at])]
            rows.append(row)
    if not rows:
        return element("p", text("No link has a section, so there is no stress to tell."))
    headings = ("link", "greatest stress", "safety factor", "buckling factor", "bends by, of its length")
    return table(headings, rows, numbers=(1, 2, 3, 4))


def frequencies(named: Named) -> str:
    """The least first frequencies, and the compliance at the worst poses."""
    rows: list[list[str]] = []
    for when, evaluation in named:
        found, compliance = evaluation.frequency, evaluation.compliance
        least = "–" if found is None else f"{with_unit(found.value, 'Hz')} at {pose(evaluation.arm, found.q)}"
        largest = 1e3 * max(compliance.principal)
        rows.append([when or "this arm", least, f"{figure(largest)} mm/N at {pose(evaluation.arm, compliance.q)}"])
    return table(("", "least first frequency", "most compliant direction"), rows)


def links(named: Named) -> str:
    """What the links are."""
    rows: list[list[str]] = []
    for number, row in enumerate(zip_longest(*(evaluation.arm.links for _, evaluation in named)), start=1):
        for (when, evaluation), link in zip(named, row, strict=True):
            if link is not None:
                name = f"link {number}{' ' + when if when else ''}"
                mass = with_unit(evaluation.link_masses[number - 1], "kg")
                rows.append([name, mm(link.length, 5), section_words(link), material_words(link), mass])
    return table(("link", "length", "section", "material", "mass"), rows, numbers=(1, 4))


def joints(evaluation: Evaluation) -> str:
    """The joints as given."""
    arm = evaluation.arm
    rows: list[list[str]] = []
    for index, joint in enumerate(arm.joints):
        low, high = pose(arm, [joint.range[0]] * arm.size), pose(arm, [joint.range[1]] * arm.size)
        span = f"{low.split(', ')[index]} to {high.split(', ')[index]}"
        angle = joint.revolute
        backlash = with_unit(math.degrees(joint.backlash) * 60.0, "arcmin") if angle else mm(joint.backlash)
        stiffness = "rigid"
        if joint.stiffness is not None:
            stiffness = with_unit(joint.stiffness / 1e3, "kN·m/rad" if angle else "kN/m")
        mass = with_unit(joint.mass, "kg")
        rows.append([f"joint {index + 1}", joint.type, span, mm(joint.clearance), backlash, stiffness, mass])
    return table(("joint", "type", "range", "clearance", "backlash", "drive", "mass"), rows, numbers=(3, 4, 5, 6))


def drives(evaluation: Evaluation) -> str:
    """What each drive holds at most, against its actuator's rated torque."""
    found = evaluation.drives
    if found is None:
        return ""
    rows: list[list[str]] = []
    for index, joint in enumerate(evaluation.arm.joints):
        rated = "–" if joint.actuator is None else with_unit(joint.actuator.rated_torque, "N·m")
        use = found.use[index]
        held = with_unit(found.greatest[index], "N·m" if joint.revolute else "N")
        name = "–" if joint.actuator is None else joint.actuator.name
        at = pose(evaluation.arm, found.poses[index][0])
        rows.append([f"joint {index + 1}", name, held, rated, "–" if use is None else percent(use, 3), at])
    return table(("joint", "actuator", "holds up to", "rated", "share", "at"), rows, numbers=(2, 3, 4))


def warnings(named: Named) -> str:
    """Each warning, plainly."""
    lines = [
        element("p", text(f"{when.capitalize() + ': ' if when else ''}{warning}"), class_="warning")
        for when, evaluation in named
        for warning in evaluation.warnings
    ]
    return "".join(lines)


def tiles(entries: Sequence[tuple[str, str, str]]) -> str:
    """Headline figures: (name, value, note)."""

    def tile(name: str, value: str, note: str) -> str:
        figures = element("dd", text(value), element("small", text(note)))
        return element("div", element("dt", text(name)), figures, class_="tile")

    made = [tile(*entry) for entry in entries]
    return element("dl", *made, class_="tiles")
