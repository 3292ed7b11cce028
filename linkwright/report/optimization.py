"""The report page of an optimisation: before and after, what binds, and how the design was found."""

from __future__ import annotations

from pathlib import PurePath

from linkwright.as_json import objective_unit
from linkwright.screen.evaluation import bound_words
from linkwright.screen.optimization import (
    bound_sentence,
    effort_words,
    names_words,
    price_words,
    rounding_words,
    status_words,
    violation_words,
)
from linkwright.words import (
    cost_name,
    factor_words,
    figure,
    load_case_words,
    mm,
    percent,
    with_unit,
    workspace_words,
)
from optimize.result import OptimizationResult

from . import parts
from .bars import effect_bars
from .figures import exchange_figure
from .page import figure_place, page, section, table
from .rounded import rounded_section
from .section_picture import sections_grid
from .svg import element, text

MOST_CANDIDATES = 12
_LISTED_CANDIDATES = 500


def optimization_page(result: OptimizationResult) -> str:
    """The page as one HTML file that loads nothing."""
    named = (("before", result.before), ("after", result.after))
    places, figures = parts.maps(named, (result.before_map, result.after_map))
    if len(result.iterations) > 1:
        figures = {**figures, "exchange": exchange_figure(result.iterations, result.minimize)}
    scale = "Both to one scale; links as thick as their sections are high."
    colours = "One colour scale for both; the numbered circles are the worst poses."
    alone = "Each effect alone; together they add as vectors."
    body = [
        parts.tiles(_tiles(result)),
        parts.warnings(named),
        "" if result.rounded is None else rounded_section(result, result.rounded),
        section("Before and after, each at its worst pose", parts.arms(named), lead=scale),
        section("Cross-sections", _sections(result), parts.links(named), lead="All drawn to one scale."),
        section("Error over the workspace", places, _poses(result), lead=colours),
        section("What each effect adds at the worst pose", _effects(result), lead=alone),
        section("What binds, and its price", _binding(result), lead="Limits that hold the design where it is."),
        section("How the design was found", *_search(result), lead=status_words(result).capitalize() + "."),
        section("Strength, frequency and buckling", parts.strength(named), parts.frequencies(named)),
        section("The problem as solved", table(("", ""), _problem(result)), parts.joints(result.before)),
        _drives(result),
    ]
    return page(f"{result.after.arm.name}: the new design", headline(result), body, figures)


def headline(result: OptimizationResult) -> str:
    """The result in one or two sentences."""
    before, after = result.before, result.after
    words = factor_words(before.max_error, after.max_error)
    error = f"The worst position error goes from {mm(before.max_error)} to {mm(after.max_error)} ({words})"
    mass = f"the mass of the links from {with_unit(before.mass, 'kg')} to {with_unit(after.mass, 'kg')}"
    reach = f"at a reach of {mm(after.reach, 5)}"
    if abs(after.reach - before.reach) > 1e-6:
        reach = f"the reach from {mm(before.reach, 5)} to {mm(after.reach, 5)}"
    words = f"{error}, {mass}, {reach}. {bound_words(after).capitalize()}."
    if result.rounded is None:
        return words
    return f"{words} Rounded to {rounding_words(result.rounded)}: {mm(result.rounded.evaluation.max_error)}."


def _tiles(result: OptimizationResult) -> list[tuple[str, str, str]]:
    before, after = result.before, result.after
    factor, unit = objective_unit(result.minimize)
    entries = [
        ("worst error", mm(after.max_error), f"before {mm(before.max_error)}"),
        ("mass of the links", with_unit(after.mass, "kg"), f"before {with_unit(before.mass, 'kg')}"),
        ("reach", mm(after.reach, 5), f"before {mm(before.reach, 5)}"),
        ("lower bound", with_unit(factor * result.lower_bound, unit), "over the binding poses alone"),
    ]
    if before.cost is not None or after.cost is not None:
        note = f"before {with_unit(before.cost, 'EUR')}"
        entries.insert(3, (cost_name(after.arm), with_unit(after.cost, "EUR"), note))
    return entries


def _sections(result: OptimizationResult) -> str:
    return sections_grid((("before", result.before.arm), ("after", result.after.arm)))


def _poses(result: OptimizationResult) -> str:
    heading = element("h3", text("Worst poses of the new design"))
    return heading + parts.worst_poses(result.after)


def _effects(result: OptimizationResult) -> str:
    return effect_bars((("before", result.before.by_effect), ("after", result.after.by_effect)))


def _binding(result: OptimizationResult) -> str:
    if not result.binding:
        return element("p", text("No limit holds the design back: more of anything that is limited would buy nothing."))
    lines = [
        element("li", element("strong", text(limit.text)), text(f": {price_words(limit)}.")) for limit in result.binding
    ]
    return element("ul", *lines, class_="binding")


def _search(result: OptimizationResult) -> list[str]:
    factor, unit = objective_unit(result.minimize)
    rows = [
        [
            str(each.number),
            with_unit(factor * each.objective, unit, 6),
            percent(each.design_change),
            str(each.poses),
            violation_words(each),
            "certified" if each.certified else "",
        ]
        for each in result.iterations
    ]
    headings = ("iteration", "objective", "design change", "poses", "worst violation", "")
    log = table(headings, rows, numbers=(1, 2, 3, 4))
    words = f"{effort_words(result)}; {bound_sentence(result)}."
    caption = "The exchange ends where no pose is worse than those it has already designed for."
    place = figure_place("exchange", f"Objective over the iterations: {words}", text(caption))
    drawn = [place] if len(result.iterations) > 1 else []
    return [*drawn, element("p", text(words)), log, *_candidates(result)]


def _candidates(result: OptimizationResult) -> list[str]:
    if len(result.candidates) < 2:
        return []
    factor, unit = objective_unit(result.minimize)
    ranked = sorted(result.candidates, key=lambda each: float("inf") if each.objective is None else each.objective)
    rows = [
        [
            names_words(each.shapes),
            names_words(each.materials),
            "–"
            if each.objective is None
            else f"{'≥ ' if each.outcome == 'bounded out' else ''}{figure(factor * each.objective, 5)} {unit}",
            each.outcome,
        ]
        for each in ranked
    ]
    heading = element("h3", text(f"{len(rows)} combinations of shape and material"))
    told = "every combination was solved or bounded out" if result.exhaustive else "not every combination was tried"
    headings = ("shapes", "materials", "objective", "outcome")
    shown = [heading, element("p", text(told.capitalize() + "."), class_="lead")]
    shown.append(table(headings, rows[:MOST_CANDIDATES], numbers=(2,)))
    if len(rows) > MOST_CANDIDATES:
        rest = rows[MOST_CANDIDATES:_LISTED_CANDIDATES]
        summary = element("summary", text(f"{len(rest)} more (all of them are in result.json)"))
        shown.append(element("details", summary, table(headings, rest, numbers=(2,))))
    return shown


def _drives(result: OptimizationResult) -> str:
    """What the drives of the new design hold, and which choices of actuators were looked at."""
    if result.after.drives is None:
        return ""
    content = [parts.joints(result.after), parts.drives(result.after)]
    if len(result.drives) > 1:
        factor, unit = objective_unit(result.minimize)
        rows: list[list[str]] = []
        for each in result.drives[:_LISTED_CANDIDATES]:
            objective = "–" if each.objective is None else with_unit(factor * each.objective, unit, 5)
            rows.append([names_words(each.actuators), objective, each.outcome])
        some = "" if result.drives_exhaustive else ", not all of them tried"
        content.append(element("h3", text(f"{len(result.drives)} choices of actuators{some}")))
        content.append(table(("actuators", "objective", "outcome"), rows, numbers=(1,)))
    return section("Drives", *content, lead="Static loads over the whole workspace, against the rated torque.")


def _problem(result: OptimizationResult) -> list[list[str]]:
    after = result.after
    asked = {"max_error": "the worst position error", "mass": "the mass of the links", "total_mass": "the total mass"}
    rows = [
        ["problem file", PurePath(result.problem_file).name],
        ["minimise", asked.get(result.minimize, "the material cost")],
        ["workspace", workspace_words(after.arm, after.workspace)],
    ]
    rows += [[f"load case {number}", load_case_words(case)] for number, case in enumerate(after.load_cases, start=1)]
    rows += [["subject to" if number == 0 else "", limit] for number, limit in enumerate(result.limits)]
    rows += [["choose" if number == 0 else "", choice] for number, choice in enumerate(result.choices)]
    rows.append(["play counts as", after.arm.play])
    if after.arm.leave_out:
        rows.append(["left out of the model", ", ".join(sorted(after.arm.leave_out))])
    return rows
