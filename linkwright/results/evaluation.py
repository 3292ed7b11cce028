"""An evaluation described: worst error, its parts, figures, links, strength, compliance; errors at given poses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.at_pose import PoseError
from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.arm.figures import FIGURES, Figure
from linkwright.core.arm.motion.dynamics import OfDrive
from linkwright.core.optimize.robust.result import RobustFigure
from linkwright.report.charts import designs
from linkwright.report.charts.space import beside
from linkwright.report.pictures.loads import loads_picture
from linkwright.report.pictures.plots import field_of
from linkwright.report.pictures.sections import sections_grid
from linkwright.report.pictures.side_view import side_view
from linkwright.results import design
from linkwright.results.document import (
    Cell,
    Column,
    Description,
    Fact,
    Facts,
    Item,
    Lines,
    Paragraph,
    Picture,
    Value,
    amount,
    count,
    length,
    section,
    share,
    table,
)
from linkwright.results.figures_in_words import (
    effect_title,
    figure,
    mm,
    pose,
    robust_words,
    unless_nothing,
    workspace_words,
)

LOADS = (
    "Statics of the undeformed arm at its worst pose, without acceleration. A joint's bearings hold it across and "
    "along its axis and against tilting. Its drive holds the rest."
)
_ASKED = "What the motion asks of each drive at most"
_SCALE = "Drawn to scale, each link as it stands in this pose."


def describe(
    evaluation: Evaluation,
    robust: RobustFigure | None = None,
    motion: Sequence[OfDrive] | None = None,
    at: Sequence[PoseError] = (),
    known: Mapping[str, Figure] = FIGURES,
) -> Description:
    """All that is known of an arm as given; `robust`: over what is uncertain of it, `motion`: what one asks of its
    drives, `at`: the errors at poses that were asked for; `known` are the figures to tell."""
    arm, named = evaluation.arm, (("", evaluation),)
    side = Picture(lambda: beside(side_view(arm, evaluation.load_cases), evaluation))
    over = Picture(lambda: designs.maps(named, (field_of(evaluation),)))
    loads = Picture(lambda: loads_picture(evaluation))
    links = Picture(lambda: sections_grid((("", arm),)))
    drives = design.drives(evaluation)
    unknown = tuple(f"{name.replace('_', ' ')} is not known: {reason}" for name, reason in evaluation.unknown.items())
    given = design.settings(design.asked(evaluation))
    poses = design.worst_poses(evaluation)
    facts = Facts(tuple(Fact(*item) for item in design.figures(evaluation, known)))
    items: list[Item] = [
        Paragraph(design.as_sentence(design.bound_words(evaluation)), "under"),
        Paragraph(design.first_order_words(evaluation), "under"),
        Paragraph(f"Over {workspace_words(arm, evaluation.workspace, evaluation.load_cases)}", "under"),
        *design.seam_words(evaluation),
        *([] if robust is None else [Paragraph(robust_words(robust), "under")]),
        *design.relative_words(evaluation),
        *design.rigid_links_words(evaluation),
        *design.notes(evaluation),
        *design.warnings(evaluation),
        *at_poses(arm, at),
        section("The arm at its worst pose", Picture(lambda: designs.arms(named)), lead=_SCALE, detail=True),
        section("Side view", side, detail=True),
        section("What the joints carry", loads, design.joint_loads(evaluation), lead=LOADS, detail=True),
        section("Error over the workspace", over, poses),
        section("What each effect adds", design.effects(named)),
        facts,
        section("Links", links, design.links(named)),
        section("Strength", design.strength(named)),
        *([section("Drives", drives)] if drives is not None else []),
        *([] if motion is None else [section(_ASKED, design.in_motion(evaluation.arm, motion))]),
        _compliance(evaluation),
        *([section("What is not known", Lines(unknown))] if unknown else []),
        section("What was asked", given, design.joints(evaluation), detail=True),
    ]
    part = evaluation.workspace.error
    what = "position error" if part == "whole" else f"error {part} the path"
    brief = f"worst {what} {mm(evaluation.max_error)}"
    headline = f"Worst {what}  {mm(evaluation.max_error, 5)}"
    name = f"{arm.name}, tip of {arm.tip}" if arm.tip and not arm.every_tip else arm.name
    return Description(name, headline, tuple(items), brief, f"{name}\n")


def _compliance(evaluation: Evaluation) -> Item:
    """The compliance matrix, and the ellipse that the tip draws under a turning force."""
    if "compliance" in evaluation.unknown:
        return section("Compliance", Paragraph(f"not known: {evaluation.unknown['compliance']}"))
    compliance = evaluation.compliance
    axes = "xyz"[: len(compliance.matrix)]
    largest = max(compliance.principal, default=0.0)

    def entry(value: float) -> str:
        return figure(1e3 * unless_nothing(value, largest))

    rows = [
        [f"tip moves along {axis}", *(Value(entry(x)) for x in row)]
        for axis, row in zip(axes, compliance.matrix, strict=True)
    ]
    at = pose(evaluation.arm, compliance.q)
    matrix = table((f"mm/N at {at}", *(f"F{axis}" for axis in axes)), rows)
    ellipse: list[Item] = []
    for size, direction in zip(compliance.principal, compliance.directions, strict=True):
        along = ", ".join(figure(unless_nothing(x, 1.0), 3) for x in direction)
        ellipse.append(Paragraph(f"error ellipse: {entry(size)} mm per newton along ({along})", "under"))
    return section("Compliance", matrix, *ellipse)


_SHOWN = 12
"""Poses that a screen shows."""
_LEAD = "Displacement and rotation of the tip in the base frame, with play where the arm's `play` puts it."


def at_poses(arm: Arm, errors: Sequence[PoseError]) -> list[Item]:
    """The section; none where no pose was asked for."""
    if not errors:
        return []
    several = len({error.load_case for error in errors}) > 1
    headings = ["pose", *(["load case"] if several else []), "error", "x", "y", "z", "rotation"]
    details = [Column(f"about {axis}", detail=True) for axis in "xyz"]
    rows = [_row(arm, error, several=several) for error in errors]
    items: list[Item] = [table((*headings, *details), rows, first=_SHOWN, rest=f"{len(rows) - _SHOWN} more")]
    items += [_effects(arm, error, alone=len(errors) == 1, several=several) for error in errors]
    items += [Paragraph(line, "warning") for line in _beyond_range(arm, errors)]
    largest = [error.beyond for error in errors if error.beyond is not None]
    if largest:
        items.append(Paragraph(f"Linearisation error at most {mm(max(largest), 2)} at these poses.", "under"))
    return [section("Error at the pose" if len(errors) == 1 else "Error at the poses", *items, lead=_LEAD)]


def _row(arm: Arm, error: PoseError, *, several: bool) -> list[Cell]:
    case = [count(error.load_case + 1)] if several else []
    shift = [length(unless_nothing(x, error.error)) for x in error.vector]
    turn = [amount(1e3 * unless_nothing(x, error.orientation), "mrad") for x in error.rotation]
    whole = [length(error.error), *shift, amount(1e3 * error.orientation, "mrad")]
    return [pose(arm, error.q), *case, *whole, *turn]


def _effects(arm: Arm, error: PoseError, *, alone: bool, several: bool) -> Item:
    """What each effect has of the error at a pose; of several poses for page and Markdown alone."""
    rows: list[list[Cell]] = [
        [
            effect_title(part.effect),
            share(part.share) if part.share is not None else "",
            *(length(unless_nothing(x, error.error)) for x in part.vector),
            *(amount(1e3 * unless_nothing(x, error.orientation), "mrad") for x in part.rotation),
        ]
        for part in error.by_effect
    ]
    turns = [Column(f"about {axis}", detail=True) for axis in "xyz"]
    case = f", load case {error.load_case + 1}" if several else ""
    title = "" if alone else f"at {pose(arm, error.q)}{case}"
    return table(("effect", "share", "x", "y", "z", *turns), rows, title=title, detail=not alone, folded=not alone)


def _beyond_range(arm: Arm, errors: Sequence[PoseError]) -> list[str]:
    """A line for each pose that a joint's range does not hold."""
    lines = (
        f"At {pose(arm, error.q)} joint {', '.join(map(str, error.outside))} is outside its range."
        for error in errors
        if error.outside
    )
    return list(dict.fromkeys(lines))
