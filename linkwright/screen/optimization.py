"""An optimisation on the screen: a line per iteration, before and after, what binds and its price."""

from __future__ import annotations

import math
from collections.abc import Sequence
from types import MappingProxyType

from rich.console import Console
from rich.table import Table

from linkwright.as_json import objective_unit
from linkwright.words import cost_name, factor_words, figure, material_words, mm, percent, section_words, with_unit
from materials.quantities import format_quantity
from optimize.problem import LIMIT_KINDS
from optimize.result import BindingLimit, Iteration, KeptLimit, OptimizationResult, Rounded

from .console import table
from .evaluation import bound_words, show_warnings

MOST_CANDIDATES = 8
_ROUNDING = 1e-8
_SHOWN_IN = MappingProxyType({"max_error": "mm", "reach": "mm"})


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
        "stopped": "stopped at the limit of iterations: a better design may exist",
    }[result.status]


def bound_sentence(result: OptimizationResult) -> str:
    """What the lower bound says."""
    factor, unit = objective_unit(result.minimize)
    bound = with_unit(factor * result.lower_bound, unit, 6)
    return f"lower bound {bound}: the optimum over the binding poses alone"


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


def show_optimization(out: Console, result: OptimizationResult) -> None:
    """Print an optimisation's result."""
    out.print()
    out.print(f"{result.after.arm.name}: {headline(result)}", style="bold")
    out.print(f"  {status_words(result)}")
    out.print(f"  worst case of the new design: {bound_words(result.after)}")
    out.print(f"  {bound_sentence(result)}")
    show_warnings(out, result.before, " (arm as given)")
    show_warnings(out, result.after, " (new design)")
    out.print()
    for part in (before_after(result), links(result)):
        out.print(part)
        out.print()
    show_binding(out, result)
    if len(result.candidates) > 1:
        out.print()
        out.print(candidates(result))
    if len(result.drives) > 1:
        out.print()
        out.print(drive_choices(result))
    out.print()
    out.print(effort_words(result))
    if result.rounded is not None:
        show_rounded(out, result, result.rounded)


def show_rounded(out: Console, result: OptimizationResult, rounded: Rounded) -> None:
    """Print the design of sizes that can be had, and what rounding cost."""
    out.print()
    out.print(f"rounded to {rounding_words(rounded)}: {rounding_headline(result, rounded)}", style="bold")
    out.print(f"  worst case of the rounded design: {bound_words(rounded.evaluation)}")
    out.print(f"  {compared_words(rounded)}")
    show_warnings(out, rounded.evaluation, " (rounded design)")
    out.print()
    shown = table("link", "length", "section", "material", "mass", numbers=(0, 1, 4))
    for number, (link, mass) in enumerate(zip(rounded.arm.links, rounded.evaluation.link_masses, strict=True), start=1):
        row = (mm(link.length, 6), section_words(link), material_words(link), with_unit(mass, "kg"))
        shown.add_row(str(number), *row)
    out.print(shown)
    if rounded.limits:
        out.print()
        shown = table("limit", "optimum", "rounded", "", numbers=(1, 2))
        for limit in rounded.limits:
            shown.add_row(limit.text, limit_figure(limit, limit.before), limit_figure(limit, limit.after), "kept")
        out.print(shown)


def rounding_words(rounded: Rounded) -> str:
    """What a design was rounded to, as a phrase."""
    sizes = "stock sizes" if rounded.to == "stock" else f"sizes in steps of {rounded.to}"
    if rounded.length_step is None:
        return sizes
    return f"{sizes} and lengths in steps of {format_quantity(rounded.length_step, 'length')}"


def rounding_headline(result: OptimizationResult, rounded: Rounded) -> str:
    """What rounding cost, as a phrase."""
    factor, unit = objective_unit(result.minimize)
    named = {"max_error": "worst error", "mass": "links", "total_mass": "total mass", "cost": "cost"}[result.minimize]
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


def limit_figure(limit: KeptLimit, value: float) -> str:
    """A figure (SI) that is limited, with its unit."""
    kind, unit = LIMIT_KINDS[limit.name], _SHOWN_IN.get(limit.name)
    return "–" if math.isnan(value) else format_quantity(value, kind, unit, digits=5)


def drive_choices(result: OptimizationResult) -> Table:
    """The choices of actuators, best first."""
    factor, unit = objective_unit(result.minimize)
    some = "" if result.drives_exhaustive else ", not all of them tried"
    title = f"{len(result.drives)} choices of actuators{some}"
    shown = table("actuators", "objective", "outcome", numbers=(1,), title=title)
    for each in result.drives[:MOST_CANDIDATES]:
        objective = "–" if each.objective is None else with_unit(factor * each.objective, unit, 5)
        shown.add_row(names_words(each.actuators), objective, each.outcome)
    if len(result.drives) > MOST_CANDIDATES:
        shown.caption = f"and {len(result.drives) - MOST_CANDIDATES} more, in result.json and the report"
        shown.caption_justify = "left"
    return shown


def effort_words(result: OptimizationResult) -> str:
    """How many iterations it took, and how long."""
    rounds = len(result.iterations)
    return f"{rounds} iteration{'' if rounds == 1 else 's'} in {with_unit(result.seconds, 's', 3)}"


def headline(result: OptimizationResult) -> str:
    """The result in one sentence."""
    before, after = result.before, result.after
    words = factor_words(before.max_error, after.max_error)
    error = f"worst error {mm(before.max_error)} before, {mm(after.max_error)} after ({words})"
    mass = f"links {with_unit(before.mass, 'kg')} before, {with_unit(after.mass, 'kg')} after"
    return f"{mass}; {error}" if result.minimize in ("mass", "total_mass") else f"{error}; {mass}"


def before_after(result: OptimizationResult) -> Table:
    """The arm's figures before and after."""
    shown = table("", "before", "after", "", numbers=(1, 2))
    before, after = result.before, result.after

    def row(name: str, one: float | None, other: float | None, unit: str, digits: int = 4) -> None:
        note = factor_words(one, other) if one is not None and other is not None else ""
        shown.add_row(name, with_unit(one, unit, digits).strip(), with_unit(other, unit, digits).strip(), note)

    row("worst error", 1e3 * before.max_error, 1e3 * after.max_error, "mm", 5)
    row("mass of the links", before.mass, after.mass, "kg")
    row("total mass", before.total_mass, after.total_mass, "kg")
    row(cost_name(after.arm), before.cost, after.cost, "EUR")
    row("reach", 1e3 * before.reach, 1e3 * after.reach, "mm")
    row("least safety factor", before.strength.least_safety_factor, after.strength.least_safety_factor, "")
    row("least buckling factor", before.strength.least_buckling, after.strength.least_buckling, "")
    frequencies = [None if each is None else each.value for each in (before.frequency, after.frequency)]
    row("first frequency", frequencies[0], frequencies[1], "Hz")
    return shown


def links(result: OptimizationResult) -> Table:
    """Each link before and after."""
    shown = table("link", "", "length", "section", "material", "mass", numbers=(0, 2, 5))
    for index in range(result.after.arm.size):
        for when, evaluation in (("before", result.before), ("after", result.after)):
            link = evaluation.arm.links[index]
            number = str(index + 1) if when == "before" else ""
            mass = with_unit(evaluation.link_masses[index], "kg")
            shown.add_row(number, when, mm(link.length, 5), section_words(link), material_words(link), mass)
    return shown


def names_words(names: Sequence[str | None]) -> str:
    """Shapes or materials from the base out; one name where all links have the same."""
    shown = [name or "–" for name in names]
    return f"all {shown[0]}" if len(shown) > 1 and len(set(shown)) == 1 else ", ".join(shown)


def show_binding(out: Console, result: OptimizationResult) -> None:
    """Print what holds the optimum back, and what one unit more of it would buy."""
    if not result.binding:
        out.print("No limit holds the design back.")
        return
    shown = table("what binds", "has", "price")
    for limit in result.binding:
        shown.add_row(limit.text, with_unit(limit.value, limit.unit, 5).strip(), price_words(limit))
    out.print(shown)


def candidates(result: OptimizationResult) -> Table:
    """The best of the combinations tried, and how many there were."""
    factor, unit = objective_unit(result.minimize)
    ranked = sorted(result.candidates, key=lambda each: float("inf") if each.objective is None else each.objective)
    some = "" if result.exhaustive else ", not all of them tried"
    title = f"{len(ranked)} combinations of shape and material{some}"
    shown = table("shapes", "materials", "objective", "outcome", numbers=(2,), title=title)
    for each in ranked[:MOST_CANDIDATES]:
        objective = "–" if each.objective is None else with_unit(factor * each.objective, unit, 5)
        if each.outcome == "bounded out":
            objective = f"≥ {objective}"
        shown.add_row(names_words(each.shapes), names_words(each.materials), objective, each.outcome)
    if len(ranked) > MOST_CANDIDATES:
        shown.caption = f"and {len(ranked) - MOST_CANDIDATES} more, in result.json and the report"
        shown.caption_justify = "left"
    return shown
