"""The rows of the finite problem by what links bring, and each link by its section's sizes, as functions.

What a combination of shapes adds to the rows of a pool is a few functions of one link each. Functions and their
derivatives are compiled once, and put together by `optimize.exchange.assembled`.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca

from linkwright.core.arm.bodies.warping import warping_of
from linkwright.core.arm.errors.model import ErrorModel
from linkwright.core.arm.figures import Held, Limit, OfDesign, OfLinks, PoseFamily, Totals

from .binding_poses import Room
from .design import LENGTH, MATERIAL_FIELDS, DesignSpace
from .expressions import (
    LINK_FIELDS,
    expressions,
    expressions_of_links,
    link_expressions,
    link_fields,
)
from .rows import MM, Rows, error_rows, limit_rows, link_rows, pose_rows, shape_rows, symbol
from .scenarios import Scenarios, scenario_column
from .totals import anchored, carried_mass, drives_cost, fixed_error

_SMOOTH = 1e-7
"""What rounds the corner of a limit that may give way either way."""

_TOTALS = frozenset({"mass", "cost", "length"})
"""What a design is asked for whatever its rows depend on."""

Families = Sequence[tuple[PoseFamily[Any], Any]]


@dataclass(frozen=True)
class Core:
    """The objective and the rows that bind links together, for all combinations (or for one, whose rows see its
    sections): `objective` (f), `slope` (f and its gradient), `value` (g), `first` (g and its Jacobian) and `second`
    (the Hessian of the Lagrangian and its gradient), by the numbers that they depend on and the parameters. `blocks`
    are the rows, in order; then come `equalities`, so many. `equal` tells which of the block `design` are equalities
    too."""

    objective: Any
    slope: Any
    value: Any
    first: Any
    second: Any
    blocks: dict[str, Rows]
    equal: tuple[bool, ...]
    equalities: int
    parameters: int
    unknowns: int
    needed: frozenset[str]
    """Of `LINK_FIELDS`, what any row depends on; none where rows are by a combination's own numbers."""
    modes: int | None
    """In how many ways the walls of a link may buckle; None where rows are by a combination's own numbers."""


@dataclass(frozen=True)
class LinkFunctions:
    """A link of a shape: `value` (what it brings, its own rows), `first` (both, with their Jacobians) and `second` (the
    Hessian of both times multipliers), by its numbers with the limits' slacks, its material and the limits' values.
    `limits` are those that the first rows hold, `labels` say what the others are."""

    value: Any
    first: Any
    second: Any
    limits: tuple[int, ...]
    labels: tuple[str, ...]


def core_of(
    space: DesignSpace,
    model: ErrorModel,
    families: Families,
    room: Room,
    scenarios: Scenarios | None,
    modes: int | None,
) -> Core:
    """The rows for a room of poses. `modes`: in how many ways a link's walls buckle at most; None of rows by a
    combination's own numbers."""
    problem = space.problem
    size = problem.arm.size
    levels = symbol("level", len(problem.limits))
    limits = tuple(replace(limit, value=levels[k]) for k, limit in enumerate(problem.limits))
    y, slack = symbol("y"), symbol("slack", len(limits))
    materials, weights = symbol("material", len(MATERIAL_FIELDS) * size), symbol("weight", 2)
    pushed, elastic = symbol("pushed", len(limits)), symbol("elastic", len(limits))
    names = () if modes is None else link_fields(modes)
    if modes is None:
        numbers = symbol("x", len(space.variables))
        design = expressions(space, numbers, materials)
    else:
        numbers = symbol("links", len(names) * size)
        design = expressions_of_links(problem, modes, numbers, materials)
    design = replace(design, cost=design.cost + drives_cost(problem))
    floor, rounding = symbol("floor"), symbol("rounding")
    worst = fixed_error(model) + ca.exp(y) * ca.sqrt(ca.fmax(1.0 - floor * ca.exp(-2.0 * y), 1e-12)) / MM
    columns = [design.beam_column]
    if scenarios is not None:
        columns = [scenario_column(problem.arm, design, scenario) for scenario in scenarios.held]
    erring = model if scenarios is None else scenarios.model
    errors = error_rows(erring, design, columns, y, room.errors, floor, rounding=rounding, anchored=anchored(space))
    held = Held(limits, slack)
    by_pose = {
        family.name: pose_rows(family, prepared, size, held, design, room.slots(family.name, family.groups(problem)))
        for family, prepared in families
    }
    of_design, equal = limit_rows(held, design, worst, carried_mass(problem) + design.hung)
    blocks = {"errors": errors, **by_pose, "design": of_design, "sides": Rows(errors.sides)}
    follows, objective = problem.objective.follows, y
    if isinstance(follows, OfDesign):
        totals = Totals(design.mass, design.cost, design.reach, carried_mass(problem) + design.hung)
        objective = ca.log(ca.SX(follows.value(totals)))
    f = (
        weights[0] * objective
        + weights[1] * (ca.sumsqr(slack) + 1e-3 * ca.sum1(_sizes(limits, slack)))
        + ca.dot(pushed, slack)
        + ca.dot(elastic, _sizes(limits, slack))
    )
    rows = [*(row for block in blocks.values() for row in block.rows), *errors.equalities]
    g = ca.vertcat(*rows) if rows else ca.SX(0, 1)
    w = ca.vertcat(numbers, y, slack, *errors.unknowns)
    p = ca.vertcat(
        *(materials, weights, pushed, elastic, levels, floor, rounding, *errors.parameters),
        *(parameter for block in by_pose.values() for parameter in block.parameters),
    )
    of_f, of_g = ca.SX.sym("of_f"), ca.SX.sym("of_g", g.numel())
    hessian, gradient = ca.hessian(of_f * f + ca.dot(of_g, g), w)
    jacobian = ca.jacobian(ca.vertcat(f, g), w)
    moving = set(jacobian.sparsity().get_triplet()[1])
    return Core(
        ca.Function("objective", [w, p], [f]),
        ca.Function("slope", [w, p], [f, jacobian[0, :].T]),
        ca.Function("value", [w, p], [g]),
        ca.Function("first", [w, p], [g, jacobian[1:, :]]),
        ca.Function("second", [w, p, of_f, of_g], [hessian, gradient]),
        blocks,
        tuple(equal),
        len(errors.equalities),
        p.numel(),
        sum(item.numel() for item in errors.unknowns),
        frozenset(
            name
            for k, name in enumerate(LINK_FIELDS if names else ())
            if any(k + len(names) * link in moving for link in range(size))
        ),
        modes,
    )


def _sizes(limits: Sequence[Limit], slack: Any) -> Any:
    """How far each limit gives way, smooth where it may give either way."""
    sizes = [
        ca.sqrt(slack[k] ** 2 + _SMOOTH**2) if limit.relation == "==" else slack[k] for k, limit in enumerate(limits)
    ]
    return ca.vertcat(*sizes) if sizes else ca.SX(0, 1)


def numbers_of(space: DesignSpace, link: int) -> list[int]:
    """Which of a design's numbers settle a link: its own, and the sizes of the first of its shape that it shares."""
    first = space.shapes.index(space.shapes[link]) if "size" in space.problem.same else link
    shared = space.shapes[link] is not None and first != link
    return [
        k
        for k, variable in enumerate(space.variables)
        if variable.link == link or (shared and variable.link == first and variable.name != LENGTH)
    ]


def link_functions(known: dict[Hashable, LinkFunctions], space: DesignSpace, link: int, core: Core) -> LinkFunctions:
    """The functions of a link of a combination, zero for what no row of the core needs; those of the same shape, ranges
    and limits have the same, which are kept with those `known`."""
    problem = space.problem
    ranges = problem.ranges[link]
    numbers = numbers_of(space, link)
    given = problem.arm.links[link]
    variables = tuple(
        (item.name, item.logarithmic, item.scale) for item in (space.variables[number] for number in numbers)
    )
    shares = tuple(limit.share(link) for limit in problem.limits if isinstance(limit.figure.follows, OfLinks))
    length = given.length if ranges.link_length is None else None
    shape = space.shapes[link]
    key = (link, variables) if shape is None else (shape, variables, ranges.sizes, ranges.taper, length, shares)
    key = (*key, warping_of(problem.arm, link), core.needed)
    if key not in known:
        known[key] = _link_functions(space, link, numbers, core)
    return known[key]


def _link_functions(space: DesignSpace, link: int, numbers: Sequence[int], core: Core) -> LinkFunctions:
    problem = space.problem
    x, materials = symbol("x", len(space.variables)), symbol("material", len(MATERIAL_FIELDS) * problem.arm.size)
    levels, slack = symbol("level", len(problem.limits)), symbol("slack", len(problem.limits))
    # Only what is of this link is in its expressions.
    item = link_expressions(space, x, materials)[link]
    rows: list[Any] = []
    held: list[int] = []
    for number, limit in enumerate(problem.limits):
        more = link_rows(replace(limit, value=levels[number]), slack[number], link, item)
        rows += more
        held += [number] * len(more)
    shapes = shape_rows(item, problem.ranges[link])
    unneeded = {name for name in LINK_FIELDS if name not in core.needed | _TOTALS}
    column = ca.vertcat(*[0.0 if name in unneeded else entry for name, entry in item.column.items()])
    own = ca.vertcat(ca.SX(0, 1), *rows, *shapes.rows)
    u = ca.vertcat(*[x[number] for number in numbers], slack)
    fields = len(MATERIAL_FIELDS)
    given = [u, materials[fields * link : fields * (link + 1)], levels]
    of_column, of_own = ca.SX.sym("of_column", column.numel()), ca.SX.sym("of_own", own.numel())
    hessian, _ = ca.hessian(ca.dot(of_column, column) + ca.dot(of_own, own), u)
    return LinkFunctions(
        ca.Function("link", given, [column, own]),
        ca.Function("link_first", given, [column, own, ca.jacobian(column, u), ca.jacobian(own, u)]),
        ca.Function("link_second", [*given, of_column, of_own], [hessian]),
        tuple(held),
        tuple(shapes.labels),
    )
