"""An optimisation described: before and after, how sure it is, what binds and its price, and how it was found."""

from __future__ import annotations

from pathlib import PurePath

from linkwright.core.arm.figures import Figure as Goal
from linkwright.core.optimize.choice.driven import stays_beside
from linkwright.core.optimize.infeasible.answer import Infeasibility, changed
from linkwright.core.optimize.result import Iteration, OptimizationResult
from linkwright.core.units.quantities import format_quantity
from linkwright.json.design import objective_unit
from linkwright.report.charts import designs
from linkwright.report.charts.space import beside
from linkwright.report.pictures.loads import loads_picture
from linkwright.report.pictures.sections import sections_grid
from linkwright.report.pictures.side_view import side_view

from . import design, rounding
from .combinations import (
    MOST_CANDIDATES,
    binding,
    candidates,
    costs,
    names_words,
    near_ties,
    objective_of,
    others,
    price_words,
)
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

_ROUNDING = 1e-8
_SCALE = "Both to one scale, each link as it stands in its pose."
_STRESS = "All drawn to one scale, each beside the greatest stress that it bears."
_NONE = "no value does"
_UNDECIDED = "not decided"
_COLOURS = "One colour scale for both. The numbered circles are the worst poses."


def describe(result: OptimizationResult) -> Description:
    """The new design beside the arm as given."""
    after = result.as_built
    named = (("before", result.before), ("after", after))
    computed = () if result.rounded is None else (("as computed", result.after),)
    said_of = "as computed, " if computed else ""
    bound = design.bound_words(after)
    worst_case = f"Worst case of the new design: {bound}."
    poses = design.worst_poses(after, detail=True)
    effects = design.effects(named, detail=True)
    alone = "Each effect alone. Together they add as vectors."
    arms = Picture(lambda: designs.arms(named))
    side = Picture(lambda: beside(side_view(after.arm, after.load_cases), after))
    loads = Picture(lambda: loads_picture(after))
    strengths = {when: evaluation.strength for when, evaluation in named}
    shapes = Picture(lambda: sections_grid([(when, evaluation.arm) for when, evaluation in named], strengths))
    over = Picture(lambda: designs.maps(named, (result.before_map, result.map_as_built)))
    items: list[Item] = [
        *rounding.first_words(result),
        Paragraph(design.as_sentence(f"{said_of}{status_words(result)}"), "under"),
        *([] if computed or bound == status_words(result) else [Paragraph(worst_case, "under")]),
        Paragraph(design.as_sentence(f"{said_of}{bound_sentence(result)}"), "under"),
        *design.seam_words(after),
        *design.relative_words(after),
        *design.rigid_links_words(after),
        *design.notes(result.before, after),
        *_beside_actuators(result),
        *_robust(result),
        *([] if result.start is None else [Paragraph(result.start, "warning")]),
        *design.warnings(result.before, "arm as given"),
        *design.warnings(after, "new design"),
        *design.sideways(result.before, after, result.limits, "new design"),
        *_not_judged(result),
        *_not_asked_for(result),
        *_dropped(result),
        *rounding.warnings(result),
        _facts(result),
        section("Before and after, each at its worst pose", arms, lead=_SCALE, detail=True),
        section("Side view of the new design", side, detail=True),
        section("What its joints carry", loads, design.joint_loads(after), lead=LOADS, detail=True),
        section(
            "Cross-sections",
            shapes,
            design.links((named[0], *computed, named[1]), 6 if computed else 5),
            lead=_STRESS,
        ),
        section("Error over the workspace", over, poses, lead=_COLOURS, detail=True),
        section("What each effect adds at the worst pose", effects, lead=alone, detail=True),
        _binding(result),
        *costs(result),
        *_balance(result),
        *_motors(result),
        *_base(result),
        *_drives(result),
        *near_ties(result),
        _search(result),
        section("Strength, frequency and buckling", design.strength(named), design.stiffness(named), detail=True),
        section("The problem as solved", _problem(result), design.joints(result.before), detail=True),
        *rounding.sections(result),
    ]
    name = after.arm.name
    return Description(f"{name}: the new design", headline(result), tuple(items), better_words(result), f"{name}: ")


def _binding(result: OptimizationResult) -> Section:
    if result.rounded is None:
        lead = "Limits that hold the design where it is."
        return section("What binds, and its price", binding(result), lead=lead)
    lead = "Limits that hold the optimum where it is. What the rounded design has to spare stands in the last section."
    return section("What binds before rounding, and its price", binding(result), lead=lead)


def _beside_actuators(result: OptimizationResult) -> list[Paragraph]:
    """What stays of the joints whose actuators were chosen."""
    chosen = {at for drive in result.drives for at, name in enumerate(drive.actuators) if name is not None}
    stays = stays_beside(result.before.arm.joints, chosen)
    return [] if stays is None else [Paragraph(f"note: {stays}", "under")]


def _robust(result: OptimizationResult) -> list[Item]:
    """The design and the nominal optimum over what is uncertain, and what the nominal one loses."""
    if result.robust is None:
        return []
    robust = result.robust
    lost = percent(robust.loses / robust.design.value) if robust.design.value > 0.0 else percent(0.0)
    text = f"the nominal optimum has {mm(robust.nominal_design.value)} there: it loses {mm(robust.loses)} ({lost})"
    factor, unit = objective_unit(result.minimize, result.figures)
    text += f"; as it is, robustness costs {with_unit(factor * robust.costs, unit)}"
    if robust.kept_nominal:
        text = "no design was found that is better there than the nominal optimum, which stays"
    one = len(robust.scenarios) == 1, robust.rounds == 1
    how = f"{len(robust.scenarios)} scenario{'' if one[0] else 's'} bind{'s' if one[0] else ''} it"
    how = f"{how}, found in {robust.rounds} round{'' if one[1] else 's'}"
    sampled = f", of {robust.samples} samples" if robust.samples else ""
    rest = f"{how}{sampled}; judged by scenarios that it was not made with"
    return [Paragraph(robust_words(robust.design), "strong"), Paragraph(f"{text}; {rest}", "under")]


def _not_judged(result: OptimizationResult) -> list[Paragraph]:
    """Limits that could not be judged of the new design, and why: what is not known is not taken for kept."""
    limited = {text.split(" ")[0] for text in result.limits}
    unknown = [(name, reason) for name, reason in result.as_built.unknown.items() if name in limited]
    return [
        Paragraph(f"new design: {result.figures[name].title} is not known: {why}", "warning") for name, why in unknown
    ]


def _not_asked_for(result: OptimizationResult) -> list[Paragraph]:
    """What limits that hold without being asked for cost where they bind."""
    binding = [limit for limit in result.binding if limit.assumed]
    return [
        Paragraph(
            f"{item.text} was not asked for and binds: {price_words(item)}; {item.name}: off leaves it out", "under"
        )
        for item in binding
    ]


def _dropped(result: OptimizationResult) -> list[Paragraph]:
    """What nothing could be made of, and what stands in its way."""
    kinds = {"material": "material", "section": "shape"}
    rows = [
        (
            f"the {kinds[item.kind]} {item.name} drops out",
            item.why or f"what comes nearest of it breaks {' and '.join(item.limits)}",
        )
        for item in result.dropped
    ]
    return [Paragraph(f"{out}: {why}", "under") for out, why in rows]


def _facts(result: OptimizationResult) -> Facts:
    """The arm's figures before and after, each with how many times smaller or larger it became, or why nobody knows."""
    facts: list[Fact] = []
    both = (result.before, result.as_built)
    for name, item in result.figures.items():
        if not any(item.is_reported(evaluation) for evaluation in both):
            continue
        one, other, computed = (item.shown(item.value(evaluation)) for evaluation in (*both, result.after))
        before, after, first = (amount(value, item.unit, item.digits) for value in (one, other, computed))
        why = result.as_built.unknown.get(name, "")
        note = f"not known: {why}" if why else "" if one is None or other is None else factor_words(one, other)
        note = "; ".join(part for part in (note, "" if first == after else f"{first.text} as computed") if part)
        facts.append(Fact(item.title_for(result.after.arm), after, note, before))
    return Facts(tuple(facts))


def _balance(result: OptimizationResult) -> list[Section]:
    if not result.balance:
        return []
    rows = [
        (
            item.words,
            Value(format_quantity(item.before, item.kind, digits=4)),
            Value(format_quantity(item.value, item.kind, digits=4)),
            "" if item.bound is None else f"the {item.bound} allowed",
        )
        for item in result.balance
    ]
    return [section("What balances the arm", table(("", "before", "after", ""), rows))]


def _motors(result: OptimizationResult) -> list[Section]:
    if not result.motor_places:
        return []
    rows = [
        (", ".join(place.places), objective_of(result, place.objective), place.outcome) for place in result.motor_places
    ]
    rest = f"and {len(rows) - MOST_CANDIDATES} more, in result.json, the best of them in the report"
    motors = table(("motor", "objective", "outcome"), rows, first=MOST_CANDIDATES, rest=rest)
    return [section("Where motors stand", motors)]


def _base(result: OptimizationResult) -> list[Section]:
    if result.base is None:
        return []
    rows = [(axis, Value(format_quantity(at, "length", digits=5))) for axis, at in zip("xyz", result.base, strict=True)]
    lead = "Against the frame of the arm file. The arm written has its first joint moved by so much."
    return [section("Where the base stands", table(("base", "stands at"), rows), lead=lead)]


def _drives(result: OptimizationResult) -> list[Section]:
    """What the drives of the new design hold, and the choices of actuators, best first."""
    after = result.as_built
    if after.drives is None:
        return []
    choices = None
    if len(result.drives) > 1:
        some = "" if result.drives_exhaustive else ", not all of them tried"
        rows = [
            (names_words(drive.actuators), objective_of(result, drive.objective), drive.outcome)
            for drive in result.drives
        ]
        title = f"{len(rows)} choices of actuators{some}"
        rest = f"and {len(rows) - MOST_CANDIDATES} more, in result.json, the best of them in the report"
        headings = ("actuators", "objective", "outcome")
        choices = table(headings, rows, first=MOST_CANDIDATES, title=title, rest=rest)
    held = design.drives(after, detail=True)
    lead = "Static loads over the whole workspace, against the rated torque."
    moved = after.in_motion
    cycle = None if moved is None else design.in_motion(after.arm, moved)
    return [section("Drives", design.joints(after), held, cycle, choices, lead=lead, detail=choices is None)]


def _search(result: OptimizationResult) -> Section:
    rows: list[tuple[Cell, ...]] = [
        (
            count(iteration.number),
            objective_of(result, iteration.objective, 6),
            share(iteration.design_change),
            count(iteration.poses),
            Value(violation_words(iteration)),
            "certified" if iteration.certified else "",
        )
        for iteration in result.iterations
    ]
    headings = ("iteration", "objective", "design change", "poses", "worst violation", "")
    log = table(headings, rows, detail=True)
    lead = design.as_sentence(status_words(result))
    chart = Picture(lambda: designs.exchange(result, f"Objective over the iterations: {effort_words(result)}."))
    effort = Paragraph(effort_words(result))
    return section("How the design was found", chart, log, candidates(result), effort, lead=lead)


def _problem(result: OptimizationResult) -> Table:
    after = result.after
    rows = [
        ("problem file", PurePath(result.problem_file).name),
        ("maximise" if result.minimised.more_is_better else "minimise", f"the {result.minimised.title}"),
        *design.asked(after),
        *(("subject to" if at == 0 else "", limit) for at, limit in enumerate(result.limits)),
        *(("choose" if at == 0 else "", choice) for at, choice in enumerate(result.choices)),
        ("play counts as", after.arm.play),
    ]
    if after.arm.leave_out:
        rows.append(("not in the model (`leave_out`)", ", ".join(sorted(after.arm.leave_out))))
    return design.settings(rows)


def violation_words(iteration: Iteration) -> str:
    """How much the worst pose found afterwards exceeds the objective; rounding counts as nothing."""
    return percent(iteration.worst_violation if iteration.worst_violation > _ROUNDING else 0.0)


def iteration_line(iteration: Iteration, objective: Goal) -> str:
    """One round of the exchange as a line of a log."""
    factor, unit = objective.factor, objective.unit
    if iteration.worst_violation > _ROUNDING:
        worst = f"another pose is {violation_words(iteration)} worse"
    else:
        worst = "no pose is worse (certified)" if iteration.certified else "no pose found is worse"
    value = f"{figure(factor * iteration.objective, 4)} {unit}".rstrip()
    return f"round {iteration.number}: {value}, poses designed for {iteration.poses}, {worst}"


def status_words(result: OptimizationResult) -> str:
    """How sure the answer is."""
    # Few sections may have any lengths: what was not compared need not be many combinations.
    bounded = result.listed and result.gap is not None
    why = "bounded, not compared one by one" if bounded else "too many combinations to try every one"
    certified = result.after.worst.certified
    return {
        "certified": design.bound_words(result.after) if certified else "certified: no pose is worse",
        "certified_where_reached": f"certified over the part reached{_reached(result)}: no pose there is worse",
        "converged": "converged: no worse pose was found; there is no proof that none exists",
        "searched": f"searched: {why}; {others(result)}",
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
    value = with_unit(factor * result.lower_bound, unit, 6)
    if result.bound_of == "all_designs":
        sizes = "" if result.listed else " and all sizes"
        whose = f"all {result.combinations:,} combinations{sizes}" if result.combinations > 1 else "all sizes"
        gap = result.lower_bound_gap
        # Where the bound is the design's figure to all digits told, a rest of the solver's is nothing to tell.
        better = "better" if figure(1.0 + gap, 6) == "1" else f"more than {percent(gap)} better"
        side = "upper" if result.minimised.more_is_better else "lower"
        return f"{side} bound {value}: of {whose}, bounded at once; no design is {better}"
    if result.optimum == "global":
        return f"no design is better than {value}"
    local = "locally optimal: " if result.status in ("certified", "certified_where_reached") else ""
    return f"{local}no nearby design is better than {value}"


def effort_words(result: OptimizationResult) -> str:
    """How many iterations it took, and how long."""
    rounds = len(result.iterations)
    return f"{rounds} iteration{'' if rounds == 1 else 's'}{lasted(result.seconds)}"


def headline(result: OptimizationResult) -> str:
    """The result in two sentences: error and mass, and all that the new design does worse than the arm as given."""
    return ". ".join(part for part in (better_words(result), design.worse_words(result.worse)) if part)


def better_words(result: OptimizationResult) -> str:
    """Error and mass before and after, and what else was made as good as it can be, as a phrase."""
    before, after = result.before, result.as_built
    words = factor_words(before.max_error, after.max_error)
    error = f"worst error {mm(before.max_error)} before, {mm(after.max_error)} after ({words})"
    mass = f"links {with_unit(before.mass, 'kg')} before, {with_unit(after.mass, 'kg')} after"
    figure = result.minimised
    if not figure.summed:
        was, new = (amount(figure.shown(figure.value(item)), figure.unit).text for item in (before, after))
        return f"{figure.title} {was} before, {new} after; {error}; {mass}"
    return f"{mass}; {error}" if result.minimize in ("mass", "total_mass") else f"{error}; {mass}"


def describe_infeasible(result: Infeasibility) -> Description:
    """What stands in the way, limit by limit."""
    joint = {item.limit.text: changed(item.limit, item.needed) for item in result.joint}
    rows = [
        (
            limit.limit.text,
            Value(
                changed(limit.limit, limit.needed)
                if limit.needed is not None
                else _NONE
                if limit.outcome == "none"
                else _UNDECIDED
            ),
            Value(joint.get(limit.limit.text, "kept" if joint else "")),
        )
        for limit in result.limits
    ]
    items: list[Item] = [Paragraph(item.text, "warning") for item in result.out_of_reach]
    items += [Paragraph(f"{result.rests_on}; {result.kept} kept", "under")]
    if rows:
        items.append(table(("limit", "alone would have to be", "in the smallest change, together"), rows))
    if result.joint_sum is not None:
        change = with_unit(100.0 * result.joint_sum, "%", 3)
        text = f"the smallest change of the limits, together, is {change} in sum (logarithms of the ratios)"
        items.append(Paragraph(text, "under"))
    head = "No design keeps all limits" if result.verdict == "infeasible" else "Could not be decided"
    return Description(head, head, tuple(items), head)
