"""What the finite problem is compiled of: its rows by what links bring, and each link by its section's sizes.

What a combination of shapes adds to the rows of a pool is a few functions of one link each. Functions and their
derivatives are compiled once; a combination puts them together by the chain rule, which takes a small part of the time
that its own derivatives would (A. Griewank and A. Walther, Evaluating Derivatives, SIAM 2008, ch. 2).
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import casadi as ca
import numpy as np

from linkwright.core.arm.bodies.warping import warping_of
from linkwright.core.arm.errors.model import ErrorModel
from linkwright.core.arm.figures import Held, Limit, OfDesign, OfLinks, PoseFamily, Totals
from linkwright.core.arm.figures.local_buckling import LOCAL_BUCKLING

from .binding_poses import Room
from .design import LENGTH, MATERIAL_FIELDS, DesignSpace
from .expressions import (
    LINK_FIELDS,
    expressions,
    expressions_of_links,
    link_expressions,
    link_fields,
    mode_count,
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


@dataclass
class Compiled:
    """The functions that a search has compiled so far, by what they depend on."""

    cores: dict[Hashable, Core] = field(default_factory=dict)
    links: dict[Hashable, LinkFunctions] = field(default_factory=dict)


def core_of(
    compiled: Compiled,
    space: DesignSpace,
    model: ErrorModel,
    families: Families,
    room: Room,
    scenarios: Scenarios | None,
) -> Core:
    """The rows for a room of poses."""
    if scenarios is not None:
        return _core(space, model, families, room, scenarios, None)
    problem = space.problem
    modes: int | None = None
    if not space.balance(np.zeros(len(space.variables))):
        shapes = [shape for shape in space.shapes if shape is not None and problem.limit(LOCAL_BUCKLING.name)]
        modes = max(map(mode_count, shapes), default=0)
    key = (room, space.shapes if modes is None else modes)
    if key not in compiled.cores:
        compiled.cores[key] = _core(space, model, families, room, None, modes)
    return compiled.cores[key]


def _core(
    space: DesignSpace,
    model: ErrorModel,
    families: Families,
    room: Room,
    scenarios: Scenarios | None,
    modes: int | None,
) -> Core:
    """`modes`: in how many ways a link's walls buckle at most; None of rows by a combination's own numbers."""
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


def link_functions(compiled: Compiled, space: DesignSpace, link: int, core: Core) -> LinkFunctions:
    """The functions of a link of a combination, zero for what no row of the core needs; those of the same shape, ranges
    and limits have the same."""
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
    if key not in compiled.links:
        compiled.links[key] = _link_functions(space, link, numbers, core)
    return compiled.links[key]


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


@dataclass(frozen=True)
class Assembled:
    """A combination's finite problem: `program` for the solver, with the derivatives `given` to it (by their names)."""

    program: dict[str, Any]
    given: dict[str, Any]


def assembled(space: DesignSpace, core: Core, links: Sequence[LinkFunctions]) -> Assembled:
    """The finite problem of a combination by x, y, the slacks and the unknown poses. The rows of the links come after
    those of the core."""
    problem, own = space.problem, core.modes is None
    width = len(link_fields(core.modes or 0))
    count, slacks, size = len(space.variables), len(problem.limits), problem.arm.size
    x = ca.MX.sym("x", count + 1 + slacks + core.unknowns)
    p = ca.MX.sym("p", core.parameters)
    first = len(MATERIAL_FIELDS) * size + 2 + 2 * slacks
    levels = p[first : first + slacks]
    rest = x[count:]
    every = [[*numbers_of(space, link), *range(count + 1, count + 1 + slacks)] for link in range(size)]
    given = [
        (x[places], p[len(MATERIAL_FIELDS) * link : len(MATERIAL_FIELDS) * (link + 1)], levels)
        for link, places in enumerate(every)
    ]
    values = [functions.value(*of_link) for functions, of_link in zip(links, given, strict=True)]
    slopes = [functions.first(*of_link) for functions, of_link in zip(links, given, strict=True)]
    picked = _picking(itertools.chain(*every), x.numel())

    def padded(column: Any) -> Any:
        # A section of fewer walls than others has zeros for theirs.
        return ca.vertcat(column, ca.MX(width - column.size1(), column.size2())) if column.size1() < width else column

    def brought(of_links: Sequence[Any]) -> Any:
        return x if own else ca.vertcat(*[padded(item[0]) for item in of_links], rest)

    w, by_x = brought(slopes), ca.DM.eye(x.numel())
    if not own:
        by_x = ca.mtimes(ca.diagcat(*[padded(item[2]) for item in slopes]), picked)
        by_x = ca.vertcat(by_x, _picking(range(count, x.numel()), x.numel()))
    f, (f_, by_f) = core.objective(w, p), core.slope(w, p)
    g, (g_, jacobian) = core.value(brought(values), p), core.first(w, p)
    slope = ca.mtimes(by_x.T, by_f)
    ahead = core.slope.size1_out(1) - rest.numel()
    if not own and min(core.slope.sparsity_out(1).get_triplet()[0], default=ahead) >= ahead:
        # An error that is least is a number of its own: no link moves it.
        alone = ca.vertcat(ca.MX(ahead, 1), rest)
        f, (f_, by_f) = core.objective(alone, p), core.slope(alone, p)
        slope = ca.vertcat(ca.MX(count, 1), by_f[ahead:])
    rows = ca.vertcat(g, *[item[1] for item in values])
    by_rows = ca.vertcat(ca.mtimes(jacobian, by_x), ca.mtimes(ca.diagcat(*[item[3] for item in slopes]), picked))
    of_f, of_g = ca.MX.sym("of_f"), ca.MX.sym("of_g", rows.numel())
    hessian, by_w = core.second(w, p, of_f, of_g[: g.numel()])
    curved: list[Any] = []
    start = g.numel()
    for link, functions in enumerate(links):
        brings, holds = functions.value.size1_out(0), functions.value.size1_out(1)
        by_column = ca.MX(brings, 1) if own else by_w[width * link : width * link + brings]
        curved.append(functions.second(*given[link], by_column, of_g[start : start + holds]))
        start += holds
    total = ca.mtimes(by_x.T, ca.mtimes(hessian, by_x)) + ca.mtimes(picked.T, ca.mtimes(ca.diagcat(*curved), picked))
    named = {
        "grad_f": ca.Function("nlp_grad_f", [x, p], [f_, ca.densify(slope)], ["x", "p"], ["f", "grad_f_x"]),
        "jac_g": ca.Function(
            "nlp_jac_g", [x, p], [ca.vertcat(g_, *[item[1] for item in slopes]), by_rows], ["x", "p"], ["g", "jac_g_x"]
        ),
        "hess_lag": ca.Function(
            "nlp_hess_l", [x, p, of_f, of_g], [ca.triu(total)], ["x", "p", "lam_f", "lam_g"], ["hess_gamma_x_x"]
        ),
    }
    return Assembled({"x": x, "p": p, "f": f, "g": rows}, named)


def _picking(places: Iterable[int], count: int) -> Any:
    """The matrix that picks numbers out of so many."""
    columns = list(places)
    return ca.DM(ca.Sparsity.triplet(len(columns), count, list(range(len(columns))), columns), 1.0)
