"""The report page of a single arm."""

from __future__ import annotations

from arm.evaluation import ErrorMap, Evaluation
from linkwright.screen.evaluation import bound_words
from linkwright.words import cost_name, figure, load_case_words, mm, with_unit, workspace_words

from . import parts
from .bars import effect_bars
from .page import page, section, table
from .section_picture import sections_grid

_SCALE = "Drawn to scale; links as thick as their sections are high."


def evaluation_page(evaluation: Evaluation, field: ErrorMap) -> str:
    """The page as one HTML file that loads nothing."""
    arm = evaluation.arm
    named = (("", evaluation),)
    places, figures = parts.maps(named, (field,))
    summary = f"The worst position error over the workspace is {mm(evaluation.max_error)}; {bound_words(evaluation)}."
    strength = evaluation.strength
    priced = evaluation.unknown.get("cost", "without machining")
    tiles = (
        ("worst error", mm(evaluation.max_error), "over the workspace"),
        ("mass of the links", with_unit(evaluation.mass, "kg"), f"{with_unit(evaluation.total_mass, 'kg')} in all"),
        ("reach", mm(evaluation.reach), "sum of the link lengths"),
        (cost_name(evaluation.arm), with_unit(evaluation.cost, "EUR"), priced),
        ("safety factor", figure(strength.least_safety_factor), "least, against yield"),
    )
    body = [
        parts.tiles(tiles),
        parts.warnings(named),
        section("The arm at its worst pose", parts.arms(named), lead=_SCALE),
        section("Error over the workspace", places, parts.worst_poses(evaluation)),
        section("What each effect adds", effect_bars((("", evaluation.by_effect),))),
        section("Links", sections_grid((("", arm),)), parts.links(named), lead="Cross-sections, all to one scale."),
        section("Strength and stiffness", parts.strength(named), parts.frequencies(named)),
        section("Drives", parts.drives(evaluation)) if evaluation.drives is not None else "",
        section("What was asked", table(("", ""), _asked(evaluation)), parts.joints(evaluation)),
    ]
    return page(arm.name, summary, body, figures)


def _asked(evaluation: Evaluation) -> list[list[str]]:
    cases = [
        [f"load case {number}", load_case_words(case)] for number, case in enumerate(evaluation.load_cases, start=1)
    ]
    return [["workspace", workspace_words(evaluation.arm, evaluation.workspace)], *cases]
