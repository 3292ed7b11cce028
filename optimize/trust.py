"""Consistency checks of an optimum, and whether it is a global or a local one.

An optimum that fails a check is reported as `doubtful` with the reason, never as certified.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.arm.figures import Limit, OfLinks, broken, excess
from linkwright.core.optimize.choice.combinations import Choice
from linkwright.core.optimize.choice.initial_arm import given_design
from linkwright.core.optimize.exchange.design import arm_of
from linkwright.core.optimize.exchange.exchange import Context
from linkwright.core.sections import SHAPES, Section
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import format_quantity

from .problem import Problem

Optimum = Literal["global", "local"]
"""`global`: no design of any shape and size allowed does better, within the gap; `local`: none near it, from several
starts, and none that the search came across."""

GAP = 2e-4
"""The exchange's tolerance and both certificates' gaps together, relative."""
NOTHING = 1e-9
"""Errors (m) that differ by less are the same."""
_ONE_SIDED = frozenset({"max_error", "mass", "total_mass", "cost"})
_BENDING = ("area", "second_moment_y", "second_moment_z", "shear_area_y", "shear_area_z")


def doubts_of(
    context: Context, choice: Choice, before: Evaluation, after: Evaluation, lower_bound: float
) -> tuple[str, ...]:
    """What is not as it must be in an answer, one line each; `before` and `after` are the evaluations of the arm as
    given and of the design."""
    problem = context.problem
    among = before.arm.joints == problem.arm.joints and _as_given(before.arm, problem.arm)
    among = among and given_design(problem) is not None
    return doubts(problem, choice.objective, before, after, lower_bound, given_allowed=among)


def _as_given(arm: Arm, changed: Arm) -> bool:
    """Whether no motor stands elsewhere, and no taper of the arm as given was replaced (see `with_chosen_links`)."""
    pairs = zip(arm.links, changed.links, strict=True)
    return all(
        old.masses == new.masses and (not isinstance(old.section, Tapered) or _ends(old.section) == _ends(new.section))
        for old, new in pairs
    )


def _ends(section: Section | None) -> tuple[Section | None, Section | None]:
    return (section.near, section.far) if isinstance(section, Tapered) else (section, section)


def doubts(
    problem: Problem, claimed: float, before: Evaluation, after: Evaluation, lower_bound: float, *, given_allowed: bool
) -> tuple[str, ...]:
    """The same of a design that was found with an objective of the badness `claimed`, none less than `lower_bound`;
    `given_allowed`: the arm as given is one of the designs to choose from."""
    figure = problem.objective
    reached = figure.value(after)
    assert reached is not None
    objective = figure.badness(reached)
    room = GAP * abs(objective) + (NOTHING if problem.minimize == "max_error" else 0.0)

    def shown(value: float) -> str:
        return format_quantity(figure.badness(value), figure.kind, digits=6)

    results: list[str] = []
    if not abs(objective - claimed) <= room:
        results.append(f"the design does {shown(objective)}, not the {shown(claimed)} that it was found with")
    if not lower_bound <= objective + room:
        results.append(f"the design does {shown(objective)}, better than its own bound {shown(lower_bound)}")
    worst = after.worst
    if worst.upper_bound is not None and not worst.error <= worst.upper_bound * (1.0 + 1e-9) + NOTHING:
        results.append("the error is above its own upper bound")
    for limit in problem.limits:
        value = limit.of(after)
        if excess(limit, value) > GAP:
            results.append(f"{limit.text} is not kept: {format_quantity(value, limit.figure.kind, digits=6)}")
    less, more = (0.0 if item.unreached is None else item.unreached.share for item in (before, after))
    if problem.must_reach and after.unreached is not None:
        results.append(after.unreached.where(problem.workspace.kind))
    elif more > less:
        kind, shares = problem.workspace.kind, (f"{100.0 * share:.2g} %" for share in (more, less))
        results.append(f"the design leaves {next(shares)} of the {kind} unreached, the arm as given {next(shares)}")
    before_value = figure.value(before)
    was = math.inf if not before_value else figure.badness(before_value)
    if given_allowed and was < objective - room and keeps_limits(problem, before):
        results.append(f"the arm as given keeps all limits and does {shown(was)}")
    return tuple(results)


def keeps_limits(problem: Problem, evaluation: Evaluation) -> bool:
    """Whether an evaluated arm keeps all limits of a problem; a figure that is not known breaks none."""
    return not broken(problem.limits, evaluation)


def optimum_of(context: Context, choice: Choice) -> Optimum:
    """How far "the best" reaches: `global` only where the finite problem is a geometric program.

    Sections whose properties are products of powers of their dimensions, fixed lengths and tapers, limits from above on
    masses, cost and error, no terms of the error that cancel at any pose it was held against (Boyd et al. 2007), and
    every combination looked at.
    """
    problem = context.problem
    arm = arm_of(choice.space, choice.exchanged.x, choice.combination.materials)
    plain = all(_from_above(limit, arm) for limit in problem.limits)
    shapes = {shape for candidate in choice.candidates for shape in candidate.shapes if shape is not None}
    shapes |= set(problem.shapes or ())  # of many combinations few are candidates
    sound = all(candidate.outcome != "unsolved" for candidate in choice.candidates)
    if not (plain and sound and choice.exhaustive and choice.one_signed and not choice.space.free_lengths):
        return "local"
    # A weight's moment about a cut is no product of powers of ends' sizes, and balance cancels loads.
    if problem.free_tapers or problem.balances:
        return "local"
    return "global" if all(_product_of_powers(shape, context.model.planar) for shape in shapes) else "local"


def _from_above(limit: Limit, arm: Arm) -> bool:
    """Whether a limit bounds a mass, the cost or the error from above, or says nothing of the arm: one on walls of
    solid links."""
    if not limit.aim and isinstance(limit.figure.follows, OfLinks) and limit.figure.of_links(arm) == 0.0:
        return True
    return limit.name in _ONE_SIDED and limit.relation == "<="


def _product_of_powers(shape: str, planar: bool) -> bool:
    """Whether each property of a shape is a product of powers of its design variables, by values of random sizes."""
    kind = SHAPES[shape]
    if not all(variable.logarithmic for variable in kind.variables):
        return False
    names = _BENDING if planar else (*_BENDING, "torsion_constant")
    generator = np.random.default_rng(5)
    size = len(kind.variables)
    logs = generator.uniform(math.log(0.02), math.log(0.2), (2 * size + 4, size))
    rows = [kind.from_variables(row.tolist()).properties(0.3) for row in np.exp(logs)]
    properties = np.array([[float(getattr(row, name)) for name in names] for row in rows])
    if not (properties > 0).all():
        return False
    columns = np.log(properties)
    fitted = np.column_stack([logs, np.ones(len(logs))])
    rest = columns - fitted @ np.linalg.lstsq(fitted, columns, rcond=None)[0]
    return bool(np.abs(rest).max() < 1e-9)
