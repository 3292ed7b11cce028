"""An evaluation on the screen: short tables, the parts of the error as bars, and warnings first of all."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from arm.evaluation import Evaluation
from linkwright.words import (
    cost_name,
    effect_title,
    figure,
    load_case_words,
    material_words,
    mm,
    percent,
    pose,
    section_words,
    with_unit,
    workspace_words,
)

from .console import table

MOST_POSES = 6
_BAR = 30


def bound_words(evaluation: Evaluation) -> str:
    """What is known of poses that were not looked at."""
    worst = evaluation.worst
    if worst.upper_bound is None:
        return "the worst of all poses searched; no bound is known for this model"
    bound = f"no pose is worse than {mm(worst.upper_bound, 6)}"
    return f"certified: {bound}" if worst.certified else f"{bound}; the gap is not closed"


def show_evaluation(out: Console, evaluation: Evaluation) -> None:
    """Print an evaluation."""
    out.print(evaluation.arm.name, style="bold")
    out.print(f"over {workspace_words(evaluation.arm, evaluation.workspace)}")
    show_warnings(out, evaluation)
    out.print()
    out.print(f"Worst position error  {mm(evaluation.max_error, 5)}", style="bold")
    out.print(f"  {bound_words(evaluation)}")
    out.print()
    parts = (worst_poses, effects, figures, links, strength)
    for part in (make(evaluation) for make in parts):
        out.print(part)
        out.print()
    if evaluation.drives is not None:
        out.print(drives(evaluation))
        out.print()
    show_compliance(out, evaluation)
    for name, reason in evaluation.unknown.items():
        out.print(f"{name.replace('_', ' ')} is not known: {reason}")


def show_warnings(out: Console, evaluation: Evaluation, which: str = "") -> None:
    """Print each warning on lines of its own."""
    for warning in evaluation.warnings:
        out.print(f"WARNING{which}: {warning}", style="bold red")


def worst_poses(evaluation: Evaluation) -> Table:
    """The poses of the greatest errors, with the load case where there are several."""
    cases = evaluation.load_cases
    headings = ["worst poses", "error"] + (["load case"] if len(cases) > 1 else [])
    shown = table(*headings, numbers=(1,))
    for each in evaluation.worst.poses[:MOST_POSES]:
        row = [pose(evaluation.arm, each.q), mm(each.error, 5)]
        if len(cases) > 1:
            row.append(f"{each.load_case + 1}: {load_case_words(cases[each.load_case])}")
        shown.add_row(*row)
    return shown


def effects(evaluation: Evaluation) -> Table:
    """What each effect alone adds at the worst pose, as bars to the scale of the largest."""
    shown = table("each effect alone, at the worst pose", "error", "", numbers=(1,))
    largest = max(evaluation.by_effect.values(), default=0.0)
    for effect, value in sorted(evaluation.by_effect.items(), key=lambda item: -item[1]):
        small = largest <= 0.0 or value < 1e-9 * largest
        length = 0 if small else round(_BAR * value / largest)
        bar = "" if small else "█" * length or "▏"
        shown.add_row(effect_title(effect), mm(0.0 if small else value), bar)
    return shown


def figures(evaluation: Evaluation) -> Table:
    """Mass, cost, reach, and the least factors."""
    strength, frequency, arm = evaluation.strength, evaluation.frequency, evaluation.arm
    shown = table("figure", "value", "", numbers=(1,))
    shown.add_row("mass of the links", with_unit(evaluation.mass, "kg"), "")
    shown.add_row("total mass", with_unit(evaluation.total_mass, "kg"), "with joints and the heaviest payload")
    shown.add_row(cost_name(arm), with_unit(evaluation.cost, "EUR"), "")
    shown.add_row("reach", mm(evaluation.reach), "sum of the link lengths")
    shown.add_row("safety factor", figure(strength.least_safety_factor), "least, against yield")
    shown.add_row("buckling", figure(strength.least_buckling), "least, Euler's load over the compression")
    where = "" if frequency is None else f"least, at {pose(arm, frequency.q)}"
    shown.add_row("first frequency", with_unit(None if frequency is None else frequency.value, "Hz"), where)
    return shown


def links(evaluation: Evaluation) -> Table:
    """What the links are."""
    shown = table("link", "length", "section", "material", "mass", numbers=(0, 1, 4))
    for index, link in enumerate(evaluation.arm.links):
        mass = with_unit(evaluation.link_masses[index], "kg")
        shown.add_row(str(index + 1), mm(link.length), section_words(link), material_words(link), mass)
    return shown


def strength(evaluation: Evaluation) -> Table:
    """How near each link is to yielding, buckling or bending too far."""
    found = evaluation.strength
    headings = ("link", "greatest stress", "safety factor", "buckling", "bends by, of its length")
    shown = table(*headings, numbers=(0, 1, 2, 3, 4))
    for at, link in enumerate(found.links):
        stress = with_unit(found.stress[at] / 1e6, "MPa", 3)
        factors = (figure(found.safety_factor[at], 3), figure(found.buckling[at], 4))
        shown.add_row(str(link + 1), stress, *factors, percent(found.deflection[at]))
    return shown


def drives(evaluation: Evaluation) -> Table:
    """What each drive holds at most, against its actuator's rated torque."""
    shown = table("joint", "actuator", "holds up to", "rated", "", "at", numbers=(0, 2, 3, 4))
    found = evaluation.drives
    assert found is not None
    for index, joint in enumerate(evaluation.arm.joints):
        use, (q, _) = found.use[index], found.poses[index]
        held = with_unit(found.greatest[index], "N·m" if joint.revolute else "N")
        rated = "–" if joint.actuator is None else with_unit(joint.actuator.rated_torque, "N·m")
        share = "–" if use is None else percent(use, 3)
        name = "–" if joint.actuator is None else joint.actuator.name
        shown.add_row(str(index + 1), name, held, rated, share, pose(evaluation.arm, q))
    return shown


def show_compliance(out: Console, evaluation: Evaluation) -> None:
    """Print the compliance matrix and the ellipse that the tip draws under a turning force."""
    compliance = evaluation.compliance
    axes = "xyz"[: len(compliance.matrix)]
    shown = table(f"mm/N at {pose(evaluation.arm, compliance.q)}", *(f"F{axis}" for axis in axes), numbers=(1, 2, 3))
    largest = max(compliance.principal, default=0.0)

    def entry(value: float) -> str:
        return figure(0.0 if abs(value) < 1e-12 * largest else 1e3 * value)

    for axis, row in zip(axes, compliance.matrix, strict=True):
        shown.add_row(f"tip moves along {axis}", *(entry(value) for value in row))
    out.print(shown)
    for size, direction in zip(compliance.principal, compliance.directions, strict=True):
        along = ", ".join(figure(0.0 if abs(x) < 1e-9 else x, 3) for x in direction)
        out.print(f"  error ellipse: {entry(size)} mm per newton along ({along})")
    out.print()
