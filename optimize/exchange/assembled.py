"""The finite problem of all combinations of some shapes, put together of compiled functions.

Derivatives are joined by the chain rule, which takes a small part of the time that those of the whole would (A.
Griewank and A. Walther, Evaluating Derivatives, SIAM 2008, ch. 2). Combinations share one problem, in which a parameter
says of which shape each link is: setting up one for each takes as long as solving it.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.errors.model import ErrorModel
from linkwright.core.arm.figures.local_buckling import LOCAL_BUCKLING

from .binding_poses import Room
from .compiled import Core, Families, LinkFunctions, core_of, link_functions, numbers_of
from .design import MATERIAL_FIELDS, DesignSpace, design_space
from .expressions import link_fields, mode_count
from .scenarios import Scenarios


@dataclass(frozen=True)
class Assembled:
    """The finite problem of all combinations of some shapes: `solver`, and what it is made of. `links` has the
    functions of each link by its shape, `numbers` where in x those of each link stand, of `count` in all; a shape
    takes the first of its link's numbers and of its link's `heights` rows."""

    core: Core
    solver: Any
    links: tuple[dict[str | None, LinkFunctions], ...]
    numbers: tuple[tuple[int, ...], ...]
    count: int
    heights: tuple[int, ...]

    def kinds(self, shapes: Sequence[str | None]) -> list[float]:
        """The parameters that say which shapes the links have."""
        return [float(list(of_link).index(shape)) for of_link, shape in zip(self.links, shapes, strict=True)]

    @cached_property
    def rows(self) -> Any:
        """The rows (g) and their Jacobian by x and the parameters."""
        return self.solver.get_function("nlp_jac_g")

    def moving(self, shapes: Sequence[str | None]) -> NDArray[np.int_]:
        """Which rows which numbers move where the links have these shapes: (2, M), rows above numbers. Of all that
        share the problem, other shapes move more: a rod has no bore."""
        if self.core.modes is None:
            return np.array(self.rows.sparsity_out("jac_g_x").get_triplet(), dtype=int)
        width, count = len(link_fields(self.core.modes)), self.solver.size1_in("x0")
        slacks = range(self.count + 1, count - self.core.unknowns)
        of_core = _pattern(self.core.first, 1)
        brought = np.zeros((of_core.shape[1], count), dtype=bool)
        brought[width * len(shapes) :, self.count :] = np.eye(count - self.count, dtype=bool)
        of_links = np.zeros((sum(self.heights), count), dtype=bool)
        for link, shape in enumerate(shapes):
            column, rows = (_pattern(self.links[link][shape].first, output) for output in (2, 3))
            used = column.shape[1] - len(slacks)
            places = [*self.numbers[link][:used], *slacks]
            brought[width * link : width * link + len(column), places] = column
            first = sum(self.heights[:link])
            of_links[first : first + len(rows), places] = rows
        return np.stack(np.nonzero(np.concatenate((of_core @ brought, of_links))))

    def places(self, space: DesignSpace) -> NDArray[np.int_]:
        """Where in x the variables of a combination stand."""
        places = np.arange(len(space.variables))
        for link, numbers in enumerate(self.numbers if self.count > len(places) else ()):
            settle = numbers_of(space, link)
            places[settle] = numbers[: len(settle)]
        return places


@dataclass
class Compiled:
    """The functions that a search has compiled so far, by what they depend on."""

    assembled: dict[Hashable, Assembled] = field(default_factory=dict)
    links: dict[Hashable, LinkFunctions] = field(default_factory=dict)


def assembled(
    compiled: Compiled,
    space: DesignSpace,
    model: ErrorModel,
    families: Families,
    room: Room,
    scenarios: Scenarios | None,
    options: dict[str, Any],
) -> Assembled:
    """The finite problem of a combination, with a room of poses and the solver's options, which it may share with all
    others of its problem."""
    if scenarios is not None:
        return _assembled(compiled, space, core_of(space, model, families, room, scenarios, None), options)
    problem = space.problem
    modes: int | None = None
    if not space.balance(np.zeros(len(space.variables))):
        shapes = itertools.chain(*_shared_shapes(space)) if problem.limit(LOCAL_BUCKLING.name) else ()
        modes = max((mode_count(shape) for shape in shapes if shape is not None), default=0)
    key = (room, space.shapes if modes is None else (modes, _shared_shapes(space)))
    if key not in compiled.assembled:
        core = core_of(space, model, families, room, None, modes)
        compiled.assembled[key] = _assembled(compiled, space, core, options)
    return compiled.assembled[key]


def _shared_shapes(space: DesignSpace) -> tuple[tuple[str | None, ...], ...]:
    """The shapes that each link may have in a problem that a combination shares with others."""
    problem = space.problem
    every = tuple(problem.shapes_of(link) or (None,) for link in range(problem.arm.size))
    known = all(shape in shapes for shape, shapes in zip(space.shapes, every, strict=True))
    # Links that share their sizes where they are of one shape have other numbers in each combination.
    return every if known and "size" not in problem.same else tuple((shape,) for shape in space.shapes)


def _assembled(compiled: Compiled, space: DesignSpace, core: Core, options: dict[str, Any]) -> Assembled:
    """The finite problem by x, y, the slacks and the unknown poses. The rows of the links come after those of the
    core."""
    problem, single = space.problem, core.modes is None
    size, slacks = problem.arm.size, len(problem.limits)
    shapes = tuple((shape,) for shape in space.shapes) if single else _shared_shapes(space)
    spaces = [space]
    if any(len(item) > 1 for item in shapes):
        spaces = [
            design_space(problem, tuple(item[min(k, len(item) - 1)] for item in shapes))
            for k in range(max(map(len, shapes)))
        ]
    links = tuple(
        {
            shape: link_functions(compiled.links, spaces[min(k, len(spaces) - 1)], link, core)
            for k, shape in enumerate(item)
        }
        for link, item in enumerate(shapes)
    )
    if len(spaces) == 1:
        numbers, count = tuple(tuple(numbers_of(space, link)) for link in range(size)), len(space.variables)
    else:
        most = [max(item.value.size1_in(0) for item in of_link.values()) - slacks for of_link in links]
        ends = list(itertools.accumulate(most))
        numbers = tuple(tuple(range(end - many, end)) for many, end in zip(most, ends, strict=True))
        count = ends[-1]
    heights = tuple(max(item.value.size1_out(1) for item in of_link.values()) for of_link in links)
    width = 0 if single else len(link_fields(core.modes or 0))
    chosen = [
        _one_of([_padded(item, len(numbers[link]), slacks, width, heights[link]) for item in of_link.values()])
        for link, of_link in enumerate(links)
    ]
    program, given = _joined(core, chosen, numbers, count, slacks, heights)
    solver = ca.nlpsol("design", "ipopt", program, {**options, **given})
    return Assembled(core, solver, links, numbers, count, heights)


_Calls = tuple[Callable[..., Any], Callable[..., Any], Callable[..., Any]]
"""`value`, `first` and `second` of a link."""


def _padded(functions: LinkFunctions, numbers: int, slacks: int, least: int, height: int) -> _Calls:
    """A link's functions by so many numbers beside the slacks, with as much brought (`least`) and as many rows as
    others have: nothing moves by what a shape lacks."""
    used = functions.value.size1_in(0) - slacks
    brings, holds = functions.value.size1_out(0), functions.value.size1_out(1)
    width = max(brings, least)
    if (used, brings, holds) == (numbers, width, height):
        return functions.value, functions.first, functions.second
    u, material, levels = (
        ca.MX.sym(name, length)
        for name, length in (("u", numbers + slacks), ("material", len(MATERIAL_FIELDS)), ("levels", slacks))
    )
    of_column, of_rows = ca.MX.sym("of_column", width), ca.MX.sym("of_rows", height)
    given = (ca.vertcat(u[:used], u[numbers:]), material, levels)
    by = _picking([*range(used), *range(numbers, numbers + slacks)], numbers + slacks)

    def tall(rows: Any, height: int) -> Any:
        return rows if rows.size1() == height else ca.vertcat(rows, ca.MX(height - rows.size1(), rows.size2()))

    column, rows = functions.value(*given)
    _, _, by_column, by_rows = functions.first(*given)
    hessian = functions.second(*given, of_column[:brings], of_rows[:holds])
    brought = [tall(column, width), tall(rows, height)]
    slopes = [tall(ca.mtimes(by_column, by), width), tall(ca.mtimes(by_rows, by), height)]
    return (
        ca.Function("link", [u, material, levels], brought),
        ca.Function("link_first", [u, material, levels], [*brought, *slopes]),
        ca.Function(
            "link_second", [u, material, levels, of_column, of_rows], [ca.mtimes(by.T, ca.mtimes(hessian, by))]
        ),
    )


def _one_of(shapes: Sequence[_Calls]) -> _Calls:
    """The functions of a link by the number of its shape, and what they are by."""
    value, first, second = (ca.Function.conditional("link", list(item), item[0]) for item in zip(*shapes, strict=True))
    return value, first, second


def _joined(
    core: Core,
    links: Sequence[_Calls],
    numbers: Sequence[Sequence[int]],
    count: int,
    slacks: int,
    heights: Sequence[int],
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The program for the solver, and the derivatives given to it (by their names)."""
    single, size = core.modes is None, len(links)
    width = len(link_fields(core.modes or 0))
    x = ca.MX.sym("x", count + 1 + slacks + core.unknowns)
    every = ca.MX.sym("p", core.parameters + size)
    p = every[: core.parameters]
    first = len(MATERIAL_FIELDS) * size + 2 + 2 * slacks
    levels = p[first : first + slacks]
    rest = x[count:]
    places = [[*of_link, *range(count + 1, count + 1 + slacks)] for of_link in numbers]
    given = [
        (
            every[core.parameters + link],
            x[item],
            p[len(MATERIAL_FIELDS) * link : len(MATERIAL_FIELDS) * (link + 1)],
            levels,
        )
        for link, item in enumerate(places)
    ]
    values = [value(*of_link) for (value, _, _), of_link in zip(links, given, strict=True)]
    slopes = [slope(*of_link) for (_, slope, _), of_link in zip(links, given, strict=True)]
    picked = _picking(itertools.chain(*places), x.numel())

    def brought(of_links: Sequence[Any]) -> Any:
        return x if single else ca.vertcat(*[item[0] for item in of_links], rest)

    w, by_x = brought(slopes), ca.DM.eye(x.numel())
    if not single:
        by_x = ca.mtimes(ca.diagcat(*[item[2] for item in slopes]), picked)
        by_x = ca.vertcat(by_x, _picking(range(count, x.numel()), x.numel()))
    f, (f_, by_f) = core.objective(w, p), core.slope(w, p)
    g, (g_, jacobian) = core.value(brought(values), p), core.first(w, p)
    slope = ca.mtimes(by_x.T, by_f)
    ahead = core.slope.size1_out(1) - rest.numel()
    if not single and min(core.slope.sparsity_out(1).get_triplet()[0], default=ahead) >= ahead:
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
    for link, (_, _, second) in enumerate(links):
        brings = values[link][0].size1()
        by_column = ca.MX(brings, 1) if single else by_w[width * link : width * (link + 1)]
        curved.append(second(*given[link], by_column, of_g[start : start + heights[link]]))
        start += heights[link]
    total = ca.mtimes(by_x.T, ca.mtimes(hessian, by_x)) + ca.mtimes(picked.T, ca.mtimes(ca.diagcat(*curved), picked))
    named = {
        "grad_f": ca.Function("nlp_grad_f", [x, every], [f_, ca.densify(slope)], ["x", "p"], ["f", "grad_f_x"]),
        "jac_g": ca.Function(
            "nlp_jac_g",
            [x, every],
            [ca.vertcat(g_, *[item[1] for item in slopes]), by_rows],
            ["x", "p"],
            ["g", "jac_g_x"],
        ),
        "hess_lag": ca.Function(
            "nlp_hess_l", [x, every, of_f, of_g], [ca.triu(total)], ["x", "p", "lam_f", "lam_g"], ["hess_gamma_x_x"]
        ),
    }
    return {"x": x, "p": every, "f": f, "g": rows}, named


def _pattern(function: Any, output: int) -> NDArray[np.bool_]:
    """Where an output of a function may be other than zero."""
    return np.array(ca.DM(function.sparsity_out(output), 1.0).full(), dtype=bool)


def _picking(places: Iterable[int], count: int) -> Any:
    """The matrix that picks numbers out of so many."""
    columns = list(places)
    return ca.DM(ca.Sparsity.triplet(len(columns), count, list(range(len(columns))), columns), 1.0)
