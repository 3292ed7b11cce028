"""The constraints of the finite problem, family by family, as CasADi rows with the parameters they need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import casadi as ca

from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.effects.functions import wound_up
from linkwright.core.arm.errors.model import ErrorModel
from linkwright.core.arm.figures import (
    Cut,
    DesignExpressions,
    Held,
    Limit,
    OfKinds,
    OfLinks,
    PoseFamily,
    ThroughPoses,
    Totals,
    WorstError,
)
from linkwright.core.optimize.exchange.binding_poses import ErrorCut
from linkwright.core.optimize.exchange.expressions import LinkExpressions
from linkwright.core.optimize.reading.ranges import Ranges
from linkwright.core.sections import Section
from linkwright.core.sections.numeric import column_of_symbols
from linkwright.core.sections.section import Constraint

AnyCut = TypeVar("AnyCut", ErrorCut, Cut)

MM = 1e3
FLOOR_MM2 = 1e-14
"""Added to squared errors (mm^2) so that an error of zero has a logarithm."""


@dataclass
class Rows:
    """Constraint rows (each <= 0, or == 0) with the symbols that they bring along, in order."""

    rows: list[Any] = field(default_factory=list)
    parameters: list[Any] = field(default_factory=list)
    unknowns: list[Any] = field(default_factory=list)
    equalities: list[Any] = field(default_factory=list)
    sides: list[Any] = field(default_factory=list)
    labels: list[str] = field(default_factory=list)
    limits: list[int] = field(default_factory=list)
    """The number of the limit that each row holds, where it holds one."""


def symbol(name: str, size: int = 1) -> Any:
    """A column of CasADi symbols."""
    return column_of_symbols(name, size)


def error_rows(
    model: ErrorModel,
    design: DesignExpressions,
    columns: Sequence[Any],
    y: Any,
    slots: Sequence[int],
    floor: Any,
    *,
    rounding: Any,
    anchored: bool,
) -> Rows:
    """log (|e|^2 + floor) <= 2 y (in mm^2) at as many poses of each load case as `slots` says.

    `columns` are the rows p that the design is held against, each with all load cases: its own, or that of scenarios.

    The floor moves no optimum, as the logarithm only grows. One as large as the error keeps the row smooth where terms
    of either sign cancel and the error passes through zero. `rounding` is that of the corners between the zones of
    stiffness of drives (see `arm.effects.functions.saturated`).
    """
    out = Rows()
    size = model.arm.size
    pairs = [(column, case) for column in columns for case in model.cases]
    for number, (column, case) in enumerate(pairs):
        for slot in range(slots[number]):
            q = symbol(f"q{number}_{slot}", size)
            signs = symbol(f"s{number}_{slot}", len(case.error.intervals))
            shift = symbol(f"d{number}_{slot}", 3)
            out.parameters += [q, signs, shift]
            at = q
            if anchored:
                at = symbol(f"at{number}_{slot}", size)
                tip = symbol(f"tip{number}_{slot}", 3)
                stays = symbol(f"stays{number}_{slot}", size * size)
                out.unknowns.append(at)
                side = symbol(f"side{number}_{slot}")
                out.parameters += [tip, stays, side]
                held, same_side = _anchored(model, design, at, q, tip, stays, side)
                out.equalities += held
                out.sides.append(same_side)
            outputs = case.function(at, column)
            vector = MM * (outputs[0] + shift)
            for k, zones in enumerate(case.zones):
                load = outputs[-1][k]
                rounded = wound_up(load, zones, rounding) - wound_up(load, zones)
                vector = vector + MM * rounded * outputs[-2][3 * k : 3 * k + 3]
            for play in range(len(case.error.intervals)):
                vector = vector + MM * signs[play] * outputs[1][3 * play : 3 * play + 3]
            out.rows.append(ca.log(ca.dot(vector, vector) + floor) - 2.0 * y)
    return out


def _anchored(
    model: ErrorModel, design: DesignExpressions, at: Any, q: Any, tip: Any, stays: Any, side: Any
) -> tuple[list[Any], Any]:
    """The pose moves with the lengths so that its tip stays where it is, not along what holds its joints, and not over
    to the other side of a singular pose: the equalities, and what must not be above zero."""
    arm = model.arm
    reached = place(arm, [at[k] for k in range(arm.size)], [beam.length for beam in design.beams]).tip()
    axes = 2 if arm.flat else 3
    rows = [ca.SX(reached[axis]) - tip[axis] for axis in range(axes)]
    jacobian = ca.jacobian(ca.vertcat(*rows), at)
    matrix = ca.reshape(stays, arm.size, arm.size)
    free = max(arm.size - axes, 0)
    rows += [ca.dot(matrix[:, k], at - q) for k in range(free)]
    square = ca.vertcat(jacobian, matrix[:, :free].T)
    return rows, -side * ca.det(square) if arm.size >= axes else ca.SX(0.0)


def filled(cuts: Sequence[AnyCut], slots: Sequence[int]) -> list[AnyCut]:
    """The cut in each slot, group after group (load cases, for the error); spare slots repeat the group's last."""
    results: list[AnyCut] = []
    for group, count in enumerate(slots):
        members = [cut for cut in cuts if cut.group == group]
        results += [members[min(slot, len(members) - 1)] for slot in range(count)]
    return results


def error_parameters(model: ErrorModel, cuts: Sequence[ErrorCut], *, anchored: bool) -> tuple[list[float], list[float]]:
    """The values of the error rows' parameters for the cuts in their slots, and starting values of their unknowns."""
    values: list[float] = []
    unknowns: list[float] = []
    size = model.arm.size
    for cut in cuts:
        values += [*cut.q, *cut.signs, *cut.shift]
        if anchored:
            assert cut.anchor is not None
            flat = [value for row in cut.anchor.held for value in row]
            values += [*cut.anchor.tip, *flat, *([0.0] * (size * size - len(flat))), cut.anchor.side]
            unknowns += list(cut.q)
    return values, unknowns


def pose_rows(
    family: PoseFamily[Any], prepared: Any, size: int, held: Held, design: DesignExpressions, slots: Sequence[int]
) -> Rows:
    """A family's rows at as many poses of each group as `slots` says, for an arm of so many joints."""
    out = Rows()
    further = family.more(prepared)
    for group, count in enumerate(slots):
        for slot in range(count):
            q = symbol(f"{family.name}{group}_{slot}", size)
            more = symbol(f"{family.name}_more{group}_{slot}", further) if further else ca.SX(0, 1)
            out.parameters += [q, more] if further else [q]
            for number, row in family.rows(prepared, group, (q, more), design, held):
                out.rows.append(row)
                out.limits.append(number)
    return out


def limit_rows(held: Held, design: DesignExpressions, error: Any, carried: float) -> tuple[Rows, list[bool]]:
    """The limits on figures of all links together, as logarithms of ratios; and which of the rows are equalities.
    Numbers of kinds are no rows: combinations that have too many are not tried."""
    totals = Totals(design.mass, design.cost, design.reach, carried)
    out = Rows()
    equal: list[bool] = []
    for number, limit in enumerate(held.limits):
        follows = limit.figure.follows
        if isinstance(follows, OfLinks | ThroughPoses | OfKinds):
            continue
        value = error if isinstance(follows, WorstError) else follows.value(totals)
        ratio = ca.log(ca.SX(value) / limit.value)
        # Two one-sided rows would have no interior; an equality takes a slack of either sign.
        out.rows.append((-ratio if limit.relation == ">=" else ratio) - held.slack[number])
        out.limits.append(number)
        equal.append(limit.relation == "==")
    return out, equal


def link_rows(limit: Limit, slack: Any, link: int, design: LinkExpressions) -> list[Any]:
    """A row for each value that a limit holds of a link; what is not known of a link cannot be held."""
    section, material, follows = design.section, design.material, limit.figure.follows
    if section is None or material is None or not isinstance(follows, OfLinks):
        return []
    log_taper = design.beam.log_taper
    tapered = isinstance(log_taper, ca.SX) and not log_taper.is_constant()
    ends = (section, section.scaled(ca.exp(log_taper))) if tapered else (section,)
    rows: list[Any] = []
    # Not in logarithms: a wall may be as thick as it is wide, and its slenderness nothing.
    for value in (value for end in ends for value in follows.values(end, material) or ()):
        ratio = ca.SX(value) / (limit.value * limit.share(link))
        rows.append(ca.exp(-slack) - ratio if limit.relation == ">=" else ratio - ca.exp(slack))
    return rows


def shape_rows(design: LinkExpressions, ranges: Ranges) -> Rows:
    """What makes a link's section possible, and bounds on dimensions that are no variables."""
    out = Rows()
    section = design.section
    if section is None:
        return out
    for constraint in (*section.constraints(), *section.bound_constraints(*ranges.sizes)):
        value = ca.SX(constraint.value)
        if not value.is_constant():
            out.rows.append(value)
            out.labels.append(constraint.text)
    for constraint in far_constraints(section, design.beam.log_taper, ranges):
        out.rows.append(ca.SX(constraint.value))
        out.labels.append(constraint.text)
    return out


def far_constraints(near: Section, log_taper: Any, ranges: Ranges) -> list[Constraint]:
    """The bounds on a far end that those at the joint do not hold already, for floats or symbols.

    The lower ones where the far end can be smaller, the upper ones where it can be larger. What makes a section
    possible is on ratios of its dimensions, and so holds all along.
    """
    if ranges.taper is None:
        return []
    outer, walls = ranges.sizes
    smaller, larger = ranges.taper[0] < 1.0, ranges.taper[1] > 1.0
    constraints: list[Constraint] = []
    for variable in near.variables:
        if variable.kind == "area":
            continue  # bounded through the dimensions that it follows from
        low, high = outer if variable.kind == "outer" else walls
        size = ca.log(getattr(near, variable.name)) + log_taper
        if smaller:
            value = ca.log(low) - size
            constraints.append(Constraint(f"least_{variable.name}", f"{variable.name} at least, at the far end", value))
        if larger:
            value = size - ca.log(high)
            constraints.append(Constraint(f"most_{variable.name}", f"{variable.name} at most, at the far end", value))
    far = near.scaled(ca.exp(log_taper))
    for constraint in far.bound_constraints(outer, walls):
        lower, upper = ">=" in constraint.text, "<=" in constraint.text
        if (smaller and not upper) or (larger and not lower):
            constraints.append(Constraint(constraint.name, f"{constraint.text}, at the far end", constraint.value))
    return constraints
