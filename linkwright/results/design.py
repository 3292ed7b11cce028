"""Tables that an evaluation and an optimisation share: links, joints, drives, strength, effects, what was asked.

`Named` are evaluations beside each other, each called `before`, `after` or nothing at all.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import zip_longest

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.arm.figures import FIGURES, Figure
from linkwright.core.arm.figures.frequency import FIRST_FREQUENCY
from linkwright.core.arm.figures.local_buckling import LinkBuckling
from linkwright.core.arm.figures.tip_stiffness import SIDEWAYS_STIFFNESS
from linkwright.core.arm.motion.dynamics import OfDrive
from linkwright.core.arm.placed.heights import heights
from linkwright.core.arm.worst.search import WorstPose
from linkwright.core.optimize.worse import MUCH_LESS, Worse, softened_links

from .document import Bars, Cell, Paragraph, Table, Value, amount, count, length, number, share, table
from .figures_in_words import (
    calibrated_words,
    coordinate,
    effect_title,
    figure,
    load_case_words,
    material_words,
    mm,
    percent,
    pose,
    section_words,
    unless_nothing,
    workspace_words,
)

MOST_POSES = 6
_APART = math.radians(10.0)
"""Poses of which no joint differs by so much are shown as one."""
_SLIDE = 0.05
"""The same for a slide, of its range."""
_SAME_ERROR = 1e-4
"""Poses that differ in the first joint alone and whose errors differ by less are one pose, moved with its base."""
_BESIDE = frozenset({"max_error", "mass"})
"""The figures that a headline gives anyway."""
Named = Sequence[tuple[str, Evaluation]]


_TOLD_OF_RIGID_LINKS = 0.05
"""From this share of the worst error on it is said what rigid, weightless links would leave of it."""


def bound_words(evaluation: Evaluation) -> str:
    """What is known of poses that were not looked at: to first order, for that is all that is certified."""
    known = evaluation.worst.upper_bound
    if known is None:
        return "the worst of all poses searched; no bound is known for this model"
    bound = f"no pose is worse than {mm(known, 6)} to first order"
    if evaluation.unreached is not None:
        part = percent(evaluation.unreached.share)
        bound += f", of the part of the {evaluation.workspace.kind} that is reached (all but {part})"
    gap = percent(known / evaluation.max_error - 1.0) if evaluation.max_error else ""
    bound = bound if evaluation.worst.certified else f"{bound}, {gap} above it"
    if evaluation.growth is not None:
        bound += ", thermal expansion not counted"
    proved = "certified" if evaluation.unreached is None else "certified over the part reached"
    return f"{proved}: {bound}" if evaluation.worst.certified else f"{bound}; the gap is not closed"


def as_sentence(words: str) -> str:
    """A phrase as a separate sentence."""
    return f"{words[:1].upper()}{words[1:]}."


def first_order_words(evaluation: Evaluation) -> str:
    """How far the error, which is to first order, is from finite motions and loads on the deformed shape; the bound
    with what samples show of that, which no certificate covers."""
    beyond, bound = evaluation.beyond, evaluation.upper_bound
    if beyond.at_worst is None:
        return "Linearised only. With finite motions the arm has no shape that carries its loads."
    size, where = (
        (beyond.at_worst, "at the worst pose")
        if beyond.largest is None
        else (beyond.largest, f"{beyond.poses} poses checked")
    )
    with_it = "" if bound is None else f" Bound including it {mm(bound, 6)}."
    return f"Linearisation error {mm(size, 2)} ({where}).{with_it}"


def seam_words(evaluation: Evaluation) -> list[Paragraph]:
    """The parts of the error on a path: how far off the path at most, and how far along it."""
    seam = evaluation.seam
    if seam is None:
        return []
    across, along, whole = (mm(item.error, 5) for item in (seam.across, seam.along, seam.whole))
    text = f"On the path at most {across} across it, {along} along it, {whole} in all"
    counted = evaluation.workspace.error
    return [Paragraph(text if counted == "whole" else f"{text}; only the error {counted} it counts", "under")]


def rigid_links_words(evaluation: Evaluation) -> list[Paragraph]:
    """What of the error no better link takes away, where that is more than a twentieth of it, and what links can win at
    best. Where the links' weight balances a spring, and where it is more than all of the error, it is no part of it."""
    rest = evaluation.rigid_links_error
    if any(joint.counterbalance is not None for joint in evaluation.arm.joints):
        return []
    if rest is None or not _TOLD_OF_RIGID_LINKS * evaluation.max_error < rest <= evaluation.max_error:
        return []
    share, gain = percent(rest / evaluation.max_error), mm(evaluation.max_error - rest, 3)
    text = f"Even with perfect links {mm(rest, 3)} ({share}) would remain."
    return [Paragraph(f"{text} Better links can save at most {gain}.", "under")]


def relative_words(evaluation: Evaluation) -> list[Paragraph]:
    """What the error counts from, where that is a calibrated state."""
    state = evaluation.relative_to
    return (
        [] if state is None else [Paragraph(f"only what changes from calibration: {calibrated_words(state)}", "under")]
    )


def warnings(evaluation: Evaluation, which: str = "") -> list[Paragraph]:
    """Each warning as a separate paragraph; `which` says of what design."""
    prefix = f"{which}: " if which else ""
    return [Paragraph(f"{prefix}{warning}", "warning") for warning in evaluation.warnings]


def notes(*evaluations: Evaluation) -> list[Paragraph]:
    """What is taken for granted, each once."""
    distinct = dict.fromkeys(note for evaluation in evaluations for note in evaluation.notes)
    return [Paragraph(f"note: {item}", "under") for item in distinct]


def figures(evaluation: Evaluation, known: Mapping[str, Figure] = FIGURES) -> list[tuple[str, Value, str]]:
    """All that can be limited but the error, which stands above: (name, value, what it counts)."""
    rows: list[tuple[str, Value, str]] = []
    for item in known.values():
        value = item.shown(item.value(evaluation))
        if item.name == "max_error" or not item.is_reported(evaluation):
            continue
        at = None if item.where is None else item.pose(evaluation)
        note = item.note_for(evaluation.arm)
        note = note if at is None else f"{note}, at {pose(evaluation.arm, at)}"
        rows.append((item.title_for(evaluation.arm), amount(value, item.unit), note))
        if item.name == FIRST_FREQUENCY.name and evaluation.frequency_of_drives is not None:
            drives = amount(evaluation.frequency_of_drives.value, item.unit)
            rows.append(("first frequency with rigid links", drives, "least, of drives and bearings alone"))
    return rows


def poses_that_differ(evaluation: Evaluation) -> tuple[WorstPose, ...]:
    """The worst poses, worst first, without those that a reader would take for a repeat of one before them."""
    distinct: list[WorstPose] = []
    for item in evaluation.worst.poses:
        if not any(_alike(evaluation, item, other) for other in distinct):
            distinct.append(item)
    return tuple(distinct)


def _alike(evaluation: Evaluation, one: WorstPose, other: WorstPose) -> bool:
    if one.load_case != other.load_case:
        return False
    apart = [
        abs(math.remainder(a - b, math.tau)) >= _APART
        if joint.revolute
        else abs(a - b) >= _SLIDE * (joint.range[1] - joint.range[0])
        for a, b, joint in zip(one.q, other.q, evaluation.arm.joints, strict=True)
    ]
    moved = abs(one.error - other.error) <= _SAME_ERROR * other.error
    return not any(apart[1:] if moved else apart)


def worst_poses(evaluation: Evaluation, *, detail: bool = False) -> Table:
    """The poses of the greatest errors, with the load case where there are several."""
    cases = evaluation.load_cases
    several = len(cases) > 1
    rows: list[list[Cell]] = []
    for item in poses_that_differ(evaluation)[:MOST_POSES]:
        row: list[Cell] = [pose(evaluation.arm, item.q), length(item.error, 5)]
        if several:
            row.append(f"{item.load_case + 1}: {load_case_words(cases[item.load_case])}")
        rows.append(row)
    return table(["worst poses", "error", *(["load case"] if several else [])], rows, detail=detail)


def effects(named: Named, *, detail: bool = False) -> Table:
    """What each effect alone adds at the worst pose, with bars to one scale."""
    parts = [(when or "error", evaluation.by_effect) for when, evaluation in named]
    largest = max((value for _, by_effect in parts for value in by_effect.values()), default=0.0)
    names = {name for _, by_effect in parts for name in by_effect}
    largest_first = sorted(names, key=lambda item: -max(by_effect.get(item, 0.0) for _, by_effect in parts))
    colours = ["before" if when == "before" else "after" for when, _ in parts]
    rows: list[list[Cell]] = []
    for name in largest_first:
        known = [None if (x := by_effect.get(name)) is None else unless_nothing(x, largest) for _, by_effect in parts]
        cells = [Value("not in the model") if x is None else length(x) for x in known]
        shares = [(x or 0.0) / (largest or 1.0) for x in known]
        rows.append([effect_title(name), *cells, Bars(tuple(zip(colours, shares, strict=True)))])
    return table(["each effect alone, at the worst pose", *(when for when, _ in parts), ""], rows, detail=detail)


def _label(number_: int, when: str, *, again: bool) -> list[Cell]:
    """The first cells of a row about a link: its number, said once, and which design is meant."""
    label = Value("" if again else str(number_))
    return [label, when] if when else [label]


def links(named: Named, digits: int = 5) -> Table:
    """What the links are, and where their sections' heights point with all joints at zero."""
    rows: list[list[Cell]] = []
    points = {when: heights(evaluation.arm) for when, evaluation in named}
    with_heights = any(item is not None for values in points.values() for item in values)
    for at, row in enumerate(zip_longest(*(evaluation.arm.links for _, evaluation in named)), start=1):
        shown = [(when, evaluation, link) for (when, evaluation), link in zip(named, row, strict=True) if link]
        for k, (when, evaluation, link) in enumerate(shown):
            mass = amount(evaluation.link_masses[at - 1], "kg")
            point = points[when][at - 1]
            height: list[Cell] = ["–" if point is None else point.words] if with_heights else []
            cells: list[Cell] = [length(link.length, digits), section_words(link), *height, material_words(link), mass]
            rows.append(_label(at, when, again=k > 0) + cells)
    height_head = ["height points"] if with_heights else []
    return table((*_link_heads(named), "length", "section", *height_head, "material", "mass"), rows)


def _link_heads(named: Named) -> list[str]:
    return ["link", ""] if named[0][0] else ["link"]


def strength(named: Named) -> Table | Paragraph:
    """How near each link is to yielding, buckling or bending too far."""
    rows: list[list[Cell]] = []
    for link in range(max(evaluation.arm.size for _, evaluation in named)):
        shown = [(when, evaluation) for when, evaluation in named if link in evaluation.strength.links]
        for k, (when, evaluation) in enumerate(shown):
            result = evaluation.strength
            at = result.links.index(link)
            stress = amount(result.stress[at] / 1e6, "MPa", 3)
            (walls,) = [item for item in evaluation.local_buckling.links if item.link == link]
            factors = [number(result.safety_factor[at], 3), number(result.buckling[at], 4), _walls(walls)]
            rows.append([*_label(link + 1, when, again=k > 0), stress, *factors, share(result.deflection[at])])
    if not rows:
        return Paragraph("No link has a section, so there is no stress to tell.")
    headings = ("greatest stress", "safety factor", "buckling", "local buckling", "bends by, of its length")
    return table((*_link_heads(named), *headings), rows)


def _walls(buckling: LinkBuckling) -> Cell:
    """The factor of the wall that is nearest to buckling, and which it is."""
    if buckling.factor is None:
        return "not known"
    if buckling.wall is None:
        return "–"
    return f"{figure(buckling.factor, 3)} ({buckling.wall})"


def stiffness(named: Named) -> Table:
    """The least first frequencies, and the compliance at the worst poses."""
    rows: list[list[Cell]] = []
    for when, evaluation in named:
        result, compliance = evaluation.frequency, evaluation.compliance
        frequency = amount(None if result is None else result.value, "Hz")
        at = "" if result is None else pose(evaluation.arm, result.q)
        largest = amount(1e3 * max(compliance.principal), "mm/N")
        rows.append([when, frequency, at, largest, pose(evaluation.arm, compliance.q)])
    headings = ("", "least first frequency", "at", "most compliant direction", "at")
    return table(headings, rows, detail=True)


def joints(evaluation: Evaluation) -> Table:
    """The joints as given."""
    arm = evaluation.arm
    rows: list[list[Cell]] = []
    for index, joint in enumerate(arm.joints):
        low, high = (coordinate(arm, index, end) for end in joint.range)
        span = f"{low} to {high}"
        angle = joint.revolute
        backlash = amount(math.degrees(joint.backlash) * 60.0, "arcmin") if angle else length(joint.backlash)
        unit = "kN·m/rad" if angle else "kN/m"
        stiffness_ = Value("rigid") if joint.stiffness is None else amount(joint.stiffness / 1e3, unit)
        cells = [count(index + 1), joint.type, span, length(joint.clearance), backlash, stiffness_]
        rows.append([*cells, amount(joint.mass, "kg")])
    headings = ("joint", "type", "range", "clearance", "backlash", "drive", "mass")
    return table(headings, rows, detail=True)


def joint_loads(evaluation: Evaluation) -> Table | Paragraph:
    """What each joint carries at the worst pose: for its bearings across its axis, along it, and for its drive."""
    loads = evaluation.joint_loads
    if loads is None:
        return Paragraph(f"Not known: {evaluation.unknown['mass']}.")
    forces, moments = ([math.hypot(*getattr(load, kind)) for load in loads] for kind in ("force", "moment"))

    def with_size(value: float, unit: str) -> Value:
        return amount(unless_nothing(abs(value), max(forces if unit == "N" else moments)), unit)

    rows: list[list[Cell]] = []
    for number_, (item, force, moment) in enumerate(zip(loads, forces, moments, strict=True), start=1):
        held = with_size(item.drive, "N·m" if item.revolute else "N")
        bearing = [with_size(item.radial, "N"), with_size(item.along, "N"), with_size(item.tilting, "N·m")]
        rows.append([count(number_), with_size(force, "N"), with_size(moment, "N·m"), *bearing, held])
    headings = ("joint", "force", "moment", "radial", "along the axis", "tilting moment", "drive holds")
    return table(headings, rows, detail=True)


def drives(evaluation: Evaluation, *, detail: bool = False) -> Table | None:
    """What each drive holds at most, against its rated torque; None where no drive is known."""
    loads = evaluation.drives
    if loads is None:
        return None
    rows: list[list[Cell]] = []
    for index, joint in enumerate(evaluation.arm.joints):
        use, (q, _) = loads.use[index], loads.poses[index]
        load = unless_nothing(loads.greatest[index], max(loads.greatest))
        held = amount(load, "N·m" if joint.revolute else "N")
        actuator = joint.actuator
        rated = amount(joint.greatest_static_load, "N·m" if joint.revolute else "N")
        used = share(math.nan if use is None else use if load else 0.0, 3)
        name = "–" if actuator is None else actuator.name
        rows.append([count(index + 1), name, held, rated, used, pose(evaluation.arm, q) if load else "–"])
    headings = ("joint", "actuator", "holds up to", "rated", "", "at")
    return table(headings, rows, detail=detail)


def in_motion(arm: Arm, motion: Sequence[OfDrive]) -> Table:
    """Torque, speed, power and energy of each drive, and what shares of its peak and rated torques that takes."""
    rated = any(rating is not None for joint in arm.joints for rating in joint.rating)
    rows: list[list[Cell]] = [
        [
            count(number_),
            amount(item.torque, "N·m" if joint.revolute else "N"),
            amount(item.rms_torque, "N·m" if joint.revolute else "N"),
            amount(item.speed, "rad/s" if joint.revolute else "m/s"),
            amount(item.power, "W"),
            amount(item.energy, "J"),
            amount(item.braked, "J"),
            *((share(math.nan if use is None else use, 3) for use in item.uses(joint)) if rated else ()),
        ]
        for number_, (joint, item) in enumerate(zip(arm.joints, motion, strict=True), start=1)
    ]
    headings = ("joint", "greatest torque", "RMS torque", "greatest speed", "greatest power", "energy", "braked off")
    return table((*headings, "of peak", "RMS of rated") if rated else headings, rows)


def asked(evaluation: Evaluation) -> list[tuple[str, str]]:
    """Workspace and load cases in words."""
    cases = [
        (f"load case {number_}", load_case_words(case)) for number_, case in enumerate(evaluation.load_cases, start=1)
    ]
    state = evaluation.relative_to
    since = [] if state is None else [("error relative to", calibrated_words(state))]
    return [("workspace", workspace_words(evaluation.arm, evaluation.workspace, evaluation.load_cases)), *cases, *since]


def settings(rows: Sequence[tuple[str, str]]) -> Table:
    """What was given, line by line, without headings."""
    return table(("", ""), rows, detail=True)


def worse_words(result: Sequence[Worse]) -> str:
    """What a design does worse than the arm as given, as a sentence without its full stop; error and mass stand beside
    it, better or worse."""
    parts: list[str] = []
    for item in result:
        if item.figure.name not in _BESIDE:
            before, after = (figure(item.figure.shown(value)) for value in (item.before, item.after))
            parts.append(f"{item.figure.title} from {before} to {after} {item.figure.unit}".rstrip())
    return f"Worse than the original arm: {', '.join(parts)}" if parts else ""


def sideways(before: Evaluation, after: Evaluation, limits: Sequence[str], which: str) -> list[Paragraph]:
    """What a planar model does not see of a design: how much more it gives across its plane, and by which links.

    Nothing where one of the `limits` is on it, so that somebody thought of it.
    """
    one, other = before.sideways, after.sideways
    limited = any(text.split(" ")[0] == SIDEWAYS_STIFFNESS.name for text in limits)
    if limited or one is None or other is None or other.value >= MUCH_LESS * one.value:
        return []
    softer = figure(one.value / other.value, 3)
    shares = [f"link {link + 1} has {percent(kept)}" for link, kept in softened_links(before, after)]
    weak = f" (of the bending stiffness that it had that way, {', '.join(shares)})" if shares else ""
    return [
        Paragraph(
            f"{which}: across its plane the tip gives {softer} times as much as that of the original arm{weak}. A "
            f"planar model does not count this. {SIDEWAYS_STIFFNESS.name} in subject_to limits it",
            "warning",
        )
    ]
