"""An optimisation described: before and after, how sure it is, what binds and its price, and how it was found."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from linkwright.core.optimize.infeasible.answer import Infeasibility, changed
from linkwright.core.optimize.result import BindingLimit, Iteration, OptimizationResult
from linkwright.core.units.quantities import format_quantity
from linkwright.json.design import objective_unit
from linkwright.report.charts import designs
from linkwright.report.pictures.loads import loads_picture
from linkwright.report.pictures.sections import sections_grid
from linkwright.report.pictures.side_view import side_view

from . import design, rounding
from .document import (
    Cell,
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
from .evaluation import LOADS
from .figures_in_words import factor_words, figure, lasted, mm, percent, robust_words, with_unit

MOST_CANDIDATES = 8
_ROUNDING = 1e-8
_SCALE = "Both to one scale, each link as it stands in its pose."
_NONE = "no value does"
_UNDECIDED = "not decided"
_COLOURS = "One colour scale for both; the numbered circles are the worst poses."


def describe(result: OptimizationResult) -> Description:
    """The new design beside the arm as given."""
    named = (("before", result.before), ("after", result.after))
    bound = design.bound_words(result.after)
    poses = design.worst_poses(result.after, detail=True)
    effects = design.effects(named, detail=True)
    alone = "Each effect alone; together they add as vectors."
    arms = Picture(lambda: designs.arms(named))
    side = Picture(lambda: side_view(result.after.arm, result.after.load_cases))
    loads = Picture(lambda: loads_picture(result.after))
    shapes = Picture(lambda: sections_grid((("before", result.before.arm), ("after", result.after.arm))))
    over = Picture(lambda: designs.maps(named, (result.before_map, result.after_map)))
    items: list[Item] = [
        Paragraph(status_words(result), "under"),
        Paragraph(f"worst case of the new design: {bound}", "under"),
        Paragraph(bound_sentence(result), "under"),
        *design.seam_words(result.after),
        *design.relative_words(result.after),
        *design.rigid_links_words(result.after),
        *design.notes(result.before, result.after),
        *_robust(result),
        *([] if result.start is None else [Paragraph(result.start, "warning")]),
        *design.warnings(result.before, "arm as given"),
        *design.warnings(result.after, "new design"),
        *design.sideways(result.before, result.after, result.limits, "new design"),
        *_not_judged(result),
        *_not_asked_for(result),
        *_dropped(result),
        *rounding.warnings(result),
        _facts(result),
        section("Before and after, each at its worst pose", arms, lead=_SCALE, detail=True),
        section("Side view of the new design", side, detail=True),
        section("What its joints carry", loads, design.joint_loads(result.after), lead=LOADS, detail=True),
        section("Cross-sections", shapes, design.links(named), lead="All drawn to one scale."),
        section("Error over the workspace", over, poses, lead=_COLOURS, detail=True),
        section("What each effect adds at the worst pose", effects, lead=alone, detail=True),
        section("What binds, and its price", _binding(result), lead="Limits that hold the design where it is."),
        *_balance(result),
        *_motors(result),
        *_drives(result),
        *_near_ties(result),
        _search(result),
        section("Strength, frequency and buckling", design.strength(named), design.stiffness(named), detail=True),
        section("The problem as solved", _problem(result), design.joints(result.before), detail=True),
        *rounding.sections(result),
    ]
    name = result.after.arm.name
    return Description(f"{name}: the new design", headline(result), tuple(items), better_words(result), f"{name}: ")


def _robust(result: OptimizationResult) -> list[Item]:
    """The design and the nominal optimum over what is uncertain, and what the nominal one loses."""
    if result.robust is None:
        return []
    found = result.robust
    lost = percent(found.loses / found.design.value) if found.design.value > 0.0 else percent(0.0)
    told = f"the nominal optimum has {mm(found.nominal_design.value)} there: it loses {mm(found.loses)} ({lost})"
    if found.kept_nominal:
        told = "no design was found that is better there than the nominal optimum, which stays"
    one = len(found.scenarios) == 1, found.rounds == 1
    how = f"{len(found.scenarios)} scenario{'' if one[0] else 's'} bind{'s' if one[0] else ''} it"
    how = f"{how}, found in {found.rounds} round{'' if one[1] else 's'}"
    sampled = f", of {found.samples} samples" if found.samples else ""
    rest = f"{how}{sampled}; judged by scenarios that it was not made with"
    return [Paragraph(robust_words(found.design), "strong"), Paragraph(f"{told}; {rest}", "under")]


def _not_judged(result: OptimizationResult) -> list[Paragraph]:
    """Limits that could not be judged of the new design, and why: what is not known is not taken for kept."""
    limited = {text.split(" ")[0] for text in result.limits}
    unknown = [(name, reason) for name, reason in result.after.unknown.items() if name in limited]
    return [
        Paragraph(f"new design: {result.figures[name].title} is not known: {why}", "warning") for name, why in unknown
    ]


def _not_asked_for(result: OptimizationResult) -> list[Paragraph]:
    """What limits that hold without being asked for cost where they bind."""
    binding = [limit for limit in result.binding if limit.assumed]
    return [
        Paragraph(
            f"{each.text} was not asked for and binds: {price_words(each)}; {each.name}: off leaves it out", "under"
        )
        for each in binding
    ]


def _dropped(result: OptimizationResult) -> list[Paragraph]:
    """What nothing could be made of, and what stands in its way."""
    kinds = {"material": "material", "section": "shape"}
    told = [(f"the {kinds[each.kind]} {each.name} drops out", " and ".join(each.limits)) for each in result.dropped]
    return [Paragraph(f"{out}: what comes nearest of it breaks {broken}", "under") for out, broken in told]


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
    if result.listed:
        return Paragraph("Sections come from lists: between one and the next no limit has a price.")
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
    some = "" if result.exhaustive else _failed(result) or ", not all of them tried"
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
    rest = f"and {len(ranked) - MOST_CANDIDATES} more, in result.json, the best of them in the report"
    headings = ("shapes", "materials", "objective", "outcome")
    return table(headings, rows, first=MOST_CANDIDATES, title=title, rest=rest)


def _near_ties(result: OptimizationResult) -> list[Section]:
    """The combinations that come within a few per cent of the best."""
    if not result.near_ties and not result.near_ties_left:
        return []
    rows = [
        (
            names_words(each.shapes),
            names_words(each.materials),
            *((names_words(each.actuators),) if result.drives else ()),
            _objective(result, each.objective),
            share(each.objective / result.objective - 1.0 if result.objective else 0.0),
            Value(mm(each.max_error)),
            amount(each.mass, "kg", 4),
            amount(each.cost, "EUR", 4),
            amount(each.first_frequency, "Hz", 4),
        )
        for each in result.near_ties
    ]
    drives = ("actuators",) if result.drives else ()
    headings = ("shapes", "materials", *drives, "objective", "worse by", "error", "mass", "cost", "first frequency")
    rest = f"and {len(rows) - MOST_CANDIDATES} more, in result.json, the best of them in the report"
    found = table(headings, rows, first=MOST_CANDIDATES, rest=rest) if rows else None
    told = None
    if result.near_ties_left:
        told = Paragraph(
            f"Up to {result.near_ties_left:,} more combinations could come within 3 % by their bounds; "
            "these were not solved."
        )
    return [section("Near ties", found, told, lead="Combinations within 3 % of the best, each solved to the end.")]


def _others(result: OptimizationResult) -> str:
    """What is known of the combinations that were not solved."""
    if result.exhaustive:
        return "bounds leave out the others"
    if result.gap is None:
        return f"nothing is known of the others{_failed(result)}"
    if not result.gap:
        return f"bounds leave out the others{_failed(result)}"
    return f"none of the others is more than {percent(result.gap)} better{_failed(result)}"


def _failed(result: OptimizationResult) -> str:
    """On how many of the combinations the solver failed."""
    return f", but for {len(result.unsolved):,} on which the solver failed" if result.unsolved else ""


def _balance(result: OptimizationResult) -> list[Section]:
    """What was chosen of counterweights and counterbalances."""
    if not result.balance:
        return []
    rows = [
        (
            each.words,
            Value(format_quantity(each.before, each.kind, digits=4)),
            Value(format_quantity(each.value, each.kind, digits=4)),
            "" if each.bound is None else f"the {each.bound} allowed",
        )
        for each in result.balance
    ]
    return [section("What balances the arm", table(("", "before", "after", ""), rows))]


def _motors(result: OptimizationResult) -> list[Section]:
    """The combinations of places for motors, best first."""
    if not result.motor_places:
        return []
    rows = [(", ".join(each.places), _objective(result, each.objective), each.outcome) for each in result.motor_places]
    rest = f"and {len(rows) - MOST_CANDIDATES} more, in result.json, the best of them in the report"
    found = table(("motor", "objective", "outcome"), rows, first=MOST_CANDIDATES, rest=rest)
    return [section("Where motors stand", found)]


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
        rest = f"and {len(rows) - MOST_CANDIDATES} more, in result.json, the best of them in the report"
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
    chart = Picture(lambda: designs.exchange(result, f"Objective over the iterations: {effort_words(result)}."))
    effort = Paragraph(effort_words(result))
    return section("How the design was found", chart, log, _candidates(result), effort, lead=lead)


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
    # Few sections may have any lengths: what was not compared need not be many combinations.
    bounded = result.listed and result.gap is not None
    why = "bounded, not compared one by one" if bounded else "too many combinations to try every one"
    return {
        "certified": "certified: no pose of the workspace is worse, within the gap",
        "certified_where_reached": f"certified over the part reached{_reached(result)}: no pose there is worse, within "
        "the gap",
        "converged": "converged: no worse pose was found; there is no proof that none exists",
        "searched": f"searched: {why}; {_others(result)}",
        "stopped": "stopped at the limit of iterations: a better design may exist",
        "interrupted": f"interrupted: the best design so far, {_rests_on(result)}; a better one may exist",
        "doubtful": f"doubtful: {'; '.join(result.doubts)}",
    }[result.status]


def _reached(result: OptimizationResult) -> str:
    """What share of a box or path the new design does not reach, in brackets; nothing where it reaches all."""
    missed = result.after.unreached
    return "" if missed is None else f" (all but {percent(missed.share)} of the {result.after.workspace.kind})"


def _rests_on(result: OptimizationResult) -> str:
    """What an interrupted search had done, as a phrase."""
    looked, rounds = len(result.candidates), len(result.iterations)
    tried = f"the best of {looked:,} of {result.combinations:,} combinations" if result.combinations > 1 else "found"
    proof = "its own worst case certified" if result.after.worst.certified else "its own worst case searched for"
    return f"{tried} in {rounds} iteration{'' if rounds == 1 else 's'}, {proof}"


def bound_sentence(result: OptimizationResult) -> str:
    """What the lower bound says."""
    factor, unit = objective_unit(result.minimize, result.figures)
    if result.robust is not None and result.robust.design.share < 1.0 and result.minimize == "max_error":
        return "no lower bound is known: what a share does not exceed is sampled, and its optimum a local one"
    bound = with_unit(factor * result.lower_bound, unit, 6)
    if result.bound_of == "all_designs":
        sizes = "" if result.listed else " and all sizes"
        whose = f"all {result.combinations:,} combinations{sizes}" if result.combinations > 1 else "all sizes"
        gap = percent(result.lower_bound_gap)
        return f"lower bound {bound}: of {whose}, bounded at once; no design is more than {gap} better"
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


def effort_words(result: OptimizationResult) -> str:
    """How many iterations it took, and how long."""
    rounds = len(result.iterations)
    return f"{rounds} iteration{'' if rounds == 1 else 's'}{lasted(result.seconds)}"


def headline(result: OptimizationResult) -> str:
    """The result in one sentence: error and mass, and all that the new design does worse than the arm as given."""
    return "; ".join(part for part in (better_words(result), design.worse_words(result.worse)) if part)


def better_words(result: OptimizationResult) -> str:
    """Error and mass before and after, as a phrase."""
    before, after = result.before, result.after
    words = factor_words(before.max_error, after.max_error)
    error = f"worst error {mm(before.max_error)} before, {mm(after.max_error)} after ({words})"
    mass = f"links {with_unit(before.mass, 'kg')} before, {with_unit(after.mass, 'kg')} after"
    return f"{mass}; {error}" if result.minimize in ("mass", "total_mass") else f"{error}; {mass}"


def names_words(names: Sequence[str | None]) -> str:
    """Shapes or materials from the base out; one name where all links have the same."""
    shown = [name or "–" for name in names]
    return f"all {shown[0]}" if len(shown) > 1 and len(set(shown)) == 1 else ", ".join(shown)


def describe_infeasible(found: Infeasibility) -> Description:
    """What stands in the way, limit by limit."""
    joint = {each.limit.text: changed(each.limit, each.needed) for each in found.joint}
    rows = [
        (
            each.limit.text,
            Value(
                changed(each.limit, each.needed)
                if each.needed is not None
                else _NONE
                if each.outcome == "none"
                else _UNDECIDED
            ),
            Value(joint.get(each.limit.text, "kept" if joint else "")),
        )
        for each in found.limits
    ]
    items: list[Item] = [Paragraph(each.text, "warning") for each in found.out_of_reach]
    items += [Paragraph(f"{found.rests_on}; {found.kept} kept", "under")]
    if rows:
        items.append(table(("limit", "alone would have to be", "in the smallest joint change"), rows))
    if found.joint_sum is not None:
        told = f"the joint change is {with_unit(100.0 * found.joint_sum, '%', 3)} in sum (logarithms of the ratios)"
        items.append(Paragraph(told, "under"))
    head = "No design keeps all limits" if found.verdict == "infeasible" else "Could not be decided"
    return Description(head, head, tuple(items), head)
