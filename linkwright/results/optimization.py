"""An optimisation described: before and after, how sure it is, what binds and its price, and how it was found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import PurePath

from arm.evaluation import Evaluation
from linkwright.json.design import objective_unit
from optimize.result import BindingLimit, Iteration, KeptLimit, OptimizationResult, Rounded
from optimize.worse import MUCH_LESS, Worse, softened_links, worse_figures
from units.quantities import format_quantity

from . import design
from .document import (
    Cell,
    Column,
    Description,
    Fact,
    Facts,
    Item,
    Paragraph,
    Picture,
    Section,
    Table,
    Value,
    amount,
    count,
    section,
    share,
    table,
)
from .figures_in_words import factor_words, figure, mm, percent, with_unit

MOST_CANDIDATES = 8
_ROUNDING = 1e-8
_BESIDE = frozenset({"max_error", "mass"})
"""The figures that a headline gives anyway."""
_SCALE = "Both to one scale; links as thick as their sections are high."
_COLOURS = "One colour scale for both; the numbered circles are the worst poses."


def describe(result: OptimizationResult) -> Description:
    """The new design beside the arm as given."""
    named = (("before", result.before), ("after", result.after))
    bound = design.bound_words(result.after)
    poses = design.worst_poses(result.after, detail=True)
    effects = design.effects(named, detail=True)
    alone = "Each effect alone; together they add as vectors."
    items: list[Item] = [
        Paragraph(status_words(result), "under"),
        Paragraph(f"worst case of the new design: {bound}", "under"),
        Paragraph(bound_sentence(result), "under"),
        *design.warnings(result.before, "arm as given"),
        *design.warnings(result.after, "new design"),
        *_sideways(result, result.after, "new design"),
        *_not_judged(result),
        _facts(result),
        section("Before and after, each at its worst pose", Picture("arms"), lead=_SCALE, detail=True),
        section("Cross-sections", Picture("sections"), design.links(named), lead="All drawn to one scale."),
        section("Error over the workspace", Picture("map"), poses, lead=_COLOURS, detail=True),
        section("What each effect adds at the worst pose", effects, lead=alone, detail=True),
        section("What binds, and its price", _binding(result), lead="Limits that hold the design where it is."),
        *_drives(result),
        _search(result),
        section("Strength, frequency and buckling", design.strength(named), design.stiffness(named), detail=True),
        section("The problem as solved", _problem(result), design.joints(result.before), detail=True),
        *([] if result.rounded is None else [_rounded(result, result.rounded)]),
    ]
    name = result.after.arm.name
    return Description(f"{name}: the new design", headline(result), tuple(items), headline(result), f"{name}: ")


def _sideways(result: OptimizationResult, evaluation: Evaluation, which: str) -> list[Paragraph]:
    """What a planar model does not see of a design: how much more it gives across its plane, and by which links."""
    before, after = result.before.sideways, evaluation.sideways
    if before is None or after is None or after.value >= MUCH_LESS * before.value:
        return []
    softer = figure(before.value / after.value, 3)
    links = softened_links(result.before, evaluation)
    shares = (f"link {link + 1} has {percent(kept)}" for link, kept in links)
    weak = f"; of the bending stiffness that it had that way, {', '.join(shares)}" if links else ""
    return [
        Paragraph(
            f"{which}: across its plane, which a planar model does not count, the tip gives {softer} times as much as "
            f"that of the arm as given{weak}; sideways_stiffness limits it",
            "warning",
        )
    ]


def _not_judged(result: OptimizationResult) -> list[Paragraph]:
    """Limits that could not be judged of the new design, and why: what is not known is not taken for kept."""
    limited = {text.split(" ")[0] for text in result.limits}
    unknown = [(name, reason) for name, reason in result.after.unknown.items() if name in limited]
    return [
        Paragraph(f"new design: {result.figures[name].title} is not known: {why}", "warning") for name, why in unknown
    ]


def _facts(result: OptimizationResult) -> Facts:
    """The arm's figures before and after, each with how many times smaller or larger it became."""
    facts: list[Fact] = []
    both = (result.before, result.after)
    for each in result.figures.values():
        if not any(each.told(evaluation) for evaluation in both):
            continue
        one, other = (each.shown(each.value(evaluation)) for evaluation in both)
        before, after = (amount(value, each.unit, each.digits) for value in (one, other))
        note = "" if one is None or other is None else factor_words(one, other)
        facts.append(Fact(each.title_for(result.after.arm), after, note, before))
    return Facts(tuple(facts))


def _binding(result: OptimizationResult) -> Item:
    """What holds the optimum back, and what one unit more of it would buy."""
    if not result.binding:
        return Paragraph("No limit holds the design back.")
    rows = [
        (
            limit.text,
            amount(limit.value, limit.unit, 5),
            price_words(limit),
        )
        for limit in result.binding
    ]
    return table(("what binds", "has", "price"), rows)


def _objective(result: OptimizationResult, value: float | None, digits: int = 5, mark: str = "") -> Value:
    factor, unit = objective_unit(result.minimize, result.figures)
    return Value("–" if value is None else f"{mark}{with_unit(factor * value, unit, digits)}")


def _candidates(result: OptimizationResult) -> Table | None:
    """The combinations tried, best first."""
    if len(result.candidates) < 2:
        return None
    ranked = sorted(result.candidates, key=lambda each: float("inf") if each.objective is None else each.objective)
    some = "" if result.exhaustive else ", not all of them tried"
    if result.combinations > len(ranked):
        some = f" solved of {result.combinations:,}; {_others(result)}"
    rows = [
        (
            names_words(each.shapes),
            names_words(each.materials),
            _objective(result, each.objective, mark="≥ " if each.outcome == "bounded out" else ""),
            each.outcome,
        )
        for each in ranked
    ]
    title = f"{len(ranked)} combinations of shape and material{some}"
    rest = f"and {len(ranked) - MOST_CANDIDATES} more, in result.json and the report"
    headings = ("shapes", "materials", "objective", "outcome")
    return table(headings, rows, first=MOST_CANDIDATES, title=title, rest=rest)


def _others(result: OptimizationResult) -> str:
    """What is known of the combinations that were not solved."""
    if result.exhaustive:
        return "bounds leave out the others"
    if result.gap is None:
        return "nothing is known of the others"
    return f"none of the others is more than {percent(result.gap)} better"


def _drives(result: OptimizationResult) -> list[Section]:
    """What the drives of the new design hold, and the choices of actuators, best first."""
    if result.after.drives is None:
        return []
    choices = None
    if len(result.drives) > 1:
        some = "" if result.drives_exhaustive else ", not all of them tried"
        rows = [
            (names_words(each.actuators), _objective(result, each.objective), each.outcome) for each in result.drives
        ]
        title = f"{len(rows)} choices of actuators{some}"
        rest = f"and {len(rows) - MOST_CANDIDATES} more, in result.json and the report"
        headings = ("actuators", "objective", "outcome")
        choices = table(headings, rows, first=MOST_CANDIDATES, title=title, rest=rest)
    held = design.drives(result.after, detail=True)
    lead = "Static loads over the whole workspace, against the rated torque."
    return [section("Drives", design.joints(result.after), held, choices, lead=lead, detail=choices is None)]


def _search(result: OptimizationResult) -> Section:
    """The log of the exchange, and the combinations tried."""
    rows: list[tuple[Cell, ...]] = [
        (
            count(each.number),
            _objective(result, each.objective, 6),
            share(each.design_change),
            count(each.poses),
            Value(violation_words(each)),
            "certified" if each.certified else "",
        )
        for each in result.iterations
    ]
    headings = ("iteration", "objective", "design change", "poses", "worst violation", "")
    log = table(headings, rows, detail=True)
    lead = f"{status_words(result).capitalize()}."
    effort = Paragraph(effort_words(result))
    return section("How the design was found", Picture("exchange"), log, _candidates(result), effort, lead=lead)


def _problem(result: OptimizationResult) -> Table:
    after = result.after
    rows = [
        ("problem file", PurePath(result.problem_file).name),
        ("minimise", f"the {result.minimised.title}"),
        *design.asked(after),
        *(("subject to" if at == 0 else "", limit) for at, limit in enumerate(result.limits)),
        *(("choose" if at == 0 else "", choice) for at, choice in enumerate(result.choices)),
        ("play counts as", after.arm.play),
    ]
    if after.arm.leave_out:
        rows.append(("left out of the model", ", ".join(sorted(after.arm.leave_out))))
    return design.settings(rows)


def _rounded(result: OptimizationResult, rounded: Rounded) -> Section:
    """The design of sizes that can be had, and what rounding cost."""
    told = rounding_words(rounded)
    limits = [
        (each.text, limit_figure(each, each.before), limit_figure(each, each.after), share(each.room, 3), "kept")
        for each in rounded.limits
    ]
    headings = ("limit", "optimum", "rounded", Column("to spare", detail=True), "")
    return section(
        f"Rounded to {told}",
        Paragraph(f"rounded to {told}: {rounding_headline(result, rounded)}", "strong"),
        Paragraph(f"worst case of the rounded design: {design.bound_words(rounded.evaluation)}", "under"),
        Paragraph(compared_words(rounded), "under"),
        _worse_paragraph(result, rounded),
        *design.warnings(rounded.evaluation, "rounded design"),
        *_sideways(result, rounded.evaluation, "rounded design"),
        Picture("rounded"),
        design.links((("", rounded.evaluation),), 6),
        table(headings, limits) if limits else None,
        lead="Before and after rounding; arm.yaml holds the rounded design.",
    )


def _worse_paragraph(result: OptimizationResult, rounded: Rounded) -> Paragraph | None:
    words = worse_words(worse_figures(result.figures, result.before, rounded.evaluation))
    return Paragraph(f"than the arm as given {words}", "under") if words else None


def worse_words(found: Sequence[Worse]) -> str:
    """What a design does worse than the arm as given, as a phrase; error and mass stand beside it, better or worse."""
    parts: list[str] = []
    for each in found:
        if each.figure.name not in _BESIDE:
            before, after = (figure(each.figure.shown(value)) for value in (each.before, each.after))
            parts.append(f"{each.figure.title} from {before} to {after} {each.figure.unit}".rstrip())
    return f"worse: {', '.join(parts)}" if parts else ""


def violation_words(iteration: Iteration) -> str:
    """How much the worst pose found afterwards exceeds the objective; rounding counts as nothing."""
    return percent(iteration.worst_violation if iteration.worst_violation > _ROUNDING else 0.0)


def iteration_line(iteration: Iteration, minimize: str) -> str:
    """One round of the exchange as a line of a log."""
    factor, unit = objective_unit(minimize)
    mark = "  certified" if iteration.certified else ""
    return (
        f"{iteration.number:4d}  {figure(factor * iteration.objective, 6):>10} {unit}"
        f"  design {percent(iteration.design_change):>9}  poses {iteration.poses:3d}"
        f"  violation {violation_words(iteration):>9}{mark}"
    )


def status_words(result: OptimizationResult) -> str:
    """How sure the answer is."""
    return {
        "certified": "certified: no pose of the workspace is worse, within the gap",
        "converged": "converged: no worse pose was found; there is no proof that none exists",
        "searched": "searched: too many combinations to try every one, so a better one may exist",
        "stopped": "stopped at the limit of iterations: a better design may exist",
        "doubtful": f"doubtful: {'; '.join(result.doubts)}",
    }[result.status]


def bound_sentence(result: OptimizationResult) -> str:
    """What the lower bound says."""
    factor, unit = objective_unit(result.minimize, result.figures)
    bound = with_unit(factor * result.lower_bound, unit, 6)
    reach = "no design does better" if result.optimum == "global" else "no design near this one does better"
    return f"lower bound {bound}: the optimum over the binding poses alone; {reach}"


def price_words(limit: BindingLimit) -> str:
    """A limit's price as a sentence: what one unit more of it would buy."""
    one = f"one {_unit_name(limit.unit)} more" if limit.unit else "one more"
    # The price of one unit more is in the unit of the objective: 0.004 mm/kg is 0.004 mm for one kilogram.
    size = with_unit(abs(limit.price), limit.price_unit.removesuffix(f"/{limit.unit}"), 3)
    if limit.price == 0.0:
        return f"{one} would buy nothing"
    return f"{one} would buy {size}" if limit.price < 0.0 else f"{one} would cost {size}"


def _unit_name(unit: str) -> str:
    names = (("kg", "kilogram"), ("mm", "millimetre"), ("EUR", "euro"), ("Hz", "hertz"), ("m", "metre"))
    return dict(names).get(unit, unit)


def rounding_words(rounded: Rounded) -> str:
    """What a design was rounded to, as a phrase."""
    sizes = "stock sizes" if rounded.to == "stock" else f"sizes in steps of {rounded.to}"
    if rounded.length_step is None:
        return sizes
    return f"{sizes} and lengths in steps of {format_quantity(rounded.length_step, 'length')}"


def rounding_headline(result: OptimizationResult, rounded: Rounded) -> str:
    """What rounding cost, as a phrase."""
    factor, unit = objective_unit(result.minimize, result.figures)
    named = "links" if result.minimize == "mass" else result.minimised.title
    before, after = (with_unit(factor * value, unit, 5) for value in (rounded.before, rounded.objective))
    change = rounded.objective / rounded.before - 1.0
    words = f"{percent(abs(change), 3)} {'more' if change >= 0.0 else 'less'}"
    mass = f"; links {with_unit(result.after.mass, 'kg')} before, {with_unit(rounded.evaluation.mass, 'kg')} after"
    return f"{named} {before} before, {after} after ({words}){'' if result.minimize == 'mass' else mass}"


def compared_words(rounded: Rounded) -> str:
    """How the rounded design was found, as a phrase."""
    told = f"{'every' if rounded.exhaustive else 'not every'} combination of the nearest sizes"
    seconds = with_unit(rounded.seconds, "s", 3)
    return f"the best of {rounded.compared} designs compared, {told} among them, in {seconds}"


def limit_figure(limit: KeptLimit, value: float) -> Value:
    """A figure (SI) that is limited, with its unit."""
    known = not math.isnan(value)
    return Value(format_quantity(value, limit.figure.kind, limit.figure.unit or None, digits=5) if known else "–")


def effort_words(result: OptimizationResult) -> str:
    """How many iterations it took, and how long."""
    rounds = len(result.iterations)
    return f"{rounds} iteration{'' if rounds == 1 else 's'} in {with_unit(result.seconds, 's', 3)}"


def headline(result: OptimizationResult) -> str:
    """The result in one sentence: error and mass, and all that the new design does worse than the arm as given."""
    before, after = result.before, result.after
    words = factor_words(before.max_error, after.max_error)
    error = f"worst error {mm(before.max_error)} before, {mm(after.max_error)} after ({words})"
    mass = f"links {with_unit(before.mass, 'kg')} before, {with_unit(after.mass, 'kg')} after"
    better = f"{mass}; {error}" if result.minimize in ("mass", "total_mass") else f"{error}; {mass}"
    return "; ".join(part for part in (better, worse_words(result.worse)) if part)


def names_words(names: Sequence[str | None]) -> str:
    """Shapes or materials from the base out; one name where all links have the same."""
    shown = [name or "–" for name in names]
    return f"all {shown[0]}" if len(shown) > 1 and len(set(shown)) == 1 else ", ".join(shown)
