"""What holds a design back, what that costs, and why a problem has no answer."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from arm.evaluation import Evaluation
from optimize.choice.combinations import Choice
from optimize.choice.picks import Combination, some_combinations
from optimize.exchange.design import Variable, material_row, starting_points
from optimize.exchange.exchange import Context, Exchange, first_pool
from optimize.exchange.program import Solution
from sections import SHAPES
from units.quantities import format_quantity, read_bound

from .limits import Limit
from .problem import Problem
from .result import BindingLimit

_FELT = 1e-6
"""A multiplier below this (per cent of objective per per cent of limit) is a limit that does not hold anything back."""
_EXPLAINED = 24
"""Combinations looked at to explain why none is feasible."""
_ROUNDS = 12
_BROKEN = 1e-5
"""A limit whose logarithm had to give way by more than this is one that stands in the way."""


def price_unit(problem: Problem, unit: str) -> str:
    """The unit of a price: the objective's unit per the limit's."""
    own = problem.objective.unit
    return f"{own}/{unit}" if unit else own


def binding_limits(problem: Problem, choice: Choice, after: Evaluation) -> tuple[BindingLimit, ...]:
    """Every limit that holds the optimum, with what one unit more of it would buy; `after` is the design's own
    evaluation."""
    solution = choice.exchanged.solution
    # The objective is a logarithm: of the error that design can change, of the mass, or of the cost.
    unchanging = choice.exchange.program(choice.exchanged.pool).fixed_error if problem.minimize == "max_error" else 0.0
    worth = (choice.objective - unchanging) * problem.objective.factor
    found: list[BindingLimit] = []
    for limit, multiplier in zip(problem.limits, solution.limit_prices, strict=True):
        if abs(multiplier) < _FELT:
            continue
        unit, factor = limit.figure.unit, limit.figure.factor
        tightening = 1.0 if limit.relation == ">=" else -1.0
        found.append(
            BindingLimit(
                name=limit.name,
                text=limit.text,
                value=limit.of(after) * factor,
                limit=limit.value * factor,
                unit=unit,
                price=tightening * multiplier * worth / (limit.value * factor),
                price_unit=price_unit(problem, unit),
            )
        )
    return (*found, *_bounds(problem, choice, solution, worth))


def _bounds(problem: Problem, choice: Choice, solution: Solution, worth: float) -> list[BindingLimit]:
    """Bounds on lengths, outer sizes and walls that hold, all links' multipliers added up."""
    prices: dict[tuple[str, int], float] = {}
    where: dict[tuple[str, int], list[str]] = {}
    for variable, multiplier in zip(choice.space.variables, solution.bound_prices.tolist(), strict=True):
        if abs(multiplier) < _FELT:
            continue
        side = 1 if multiplier > 0.0 else 0
        value = variable.upper if side else variable.lower
        for name, moves in _moves(problem, choice, variable, side):
            slope = moves / (value if variable.logarithmic else variable.scale)
            prices[name, side] = prices.get((name, side), 0.0) - multiplier * slope
            where.setdefault((name, side), []).append(f"link {variable.link + 1} {variable.name}")
    _add_wall_prices(problem, choice, solution, prices, where)
    found: list[BindingLimit] = []
    for (name, side), slope in prices.items():
        bound = dict(_ranges(problem))[name][side]
        relation = "<=" if side else ">="
        places = ", ".join(dict.fromkeys(where[name, side]))
        text = f"{name} {relation} {format_quantity(bound, 'length')} ({places})"
        price = slope * worth * 1e-3
        found.append(BindingLimit(name, text, bound * 1e3, bound * 1e3, "mm", price, price_unit(problem, "mm")))
    return found


def _ranges(problem: Problem) -> list[tuple[str, tuple[float, float]]]:
    ranges = [("section_size", problem.section_size), ("thickness", problem.thickness)]
    if problem.link_length is not None:
        ranges.append(("link_length", problem.link_length))
    return ranges


def _moves(problem: Problem, choice: Choice, variable: Variable, side: int) -> list[tuple[str, float]]:
    """The problem's ranges that bound a variable, and how far its bound moves with theirs: an area's with both."""
    if variable.name == "length":
        return [("link_length", 1.0)]
    shape = choice.combination.shapes[variable.link]
    assert shape is not None
    kind = SHAPES[shape]
    place = [each.name for each in kind.variables].index(variable.name)

    def bound(sizes: tuple[float, float], walls: tuple[float, float]) -> float:
        return kind.variable_bounds(sizes, walls)[place][side]

    def stepped(bounds: tuple[float, float], relative: float) -> tuple[float, float]:
        low, high = bounds
        return (low, high * (1.0 + relative)) if side else (low * (1.0 + relative), high)

    sizes, walls = problem.section_size, problem.thickness
    step = 1e-6
    by_size = (bound(stepped(sizes, step), walls) - bound(stepped(sizes, -step), walls)) / (2.0 * step * sizes[side])
    by_wall = (bound(sizes, stepped(walls, step)) - bound(sizes, stepped(walls, -step))) / (2.0 * step * walls[side])
    return [(name, moves) for name, moves in (("section_size", by_size), ("thickness", by_wall)) if moves != 0.0]


def _add_wall_prices(
    problem: Problem,
    choice: Choice,
    solution: Solution,
    prices: dict[tuple[str, int], float],
    where: dict[tuple[str, int], list[str]],
) -> None:
    """Walls that are no variables hold through constraints of their own: their price by moving the bound a little."""
    multipliers = dict(solution.shape_prices)
    sections, _ = choice.space.sections_and_lengths(solution.x.tolist())
    for link, section in enumerate(sections):
        if section is None:
            continue
        now = section.bound_constraints(problem.section_size, problem.thickness)
        for side in (0, 1):
            step = 1e-6 * problem.thickness[side]
            low = problem.thickness[0] + (step if side == 0 else 0.0)
            high = problem.thickness[1] + (step if side == 1 else 0.0)
            moved = section.bound_constraints(problem.section_size, (low, high))
            for before, after in zip(now, moved, strict=True):
                multiplier = multipliers.get(f"link {link + 1}: {before.text}", 0.0)
                slope = multiplier * float(after.value - before.value) / step
                if abs(multiplier) > _FELT and slope != 0.0 and abs(float(before.value)) < 1e-6:
                    prices["thickness", side] = prices.get(("thickness", side), 0.0) + slope
                    where.setdefault(("thickness", side), []).append(f"link {link + 1} wall")


def why_infeasible(context: Context) -> str:
    """Which limits stand in each other's way, by the least relaxation that would let some combination through."""
    problem = context.problem
    best: tuple[float, str] | None = None
    for pick in some_combinations(problem, _EXPLAINED):
        found = _relaxation(context, pick)
        if found is not None and (best is None or found[0] < best[0]):
            best = found
    if best is None:
        return "no design keeps all limits, and no relaxation of them was found"
    return best[1]


def _relaxation(context: Context, pick: Combination) -> tuple[float, str] | None:
    from optimize.exchange.design import design_space

    problem = context.problem
    space = design_space(problem, pick.shapes)
    materials = material_row(pick.materials, problem)
    exchange = Exchange(context, space)
    for start in starting_points(space, materials, 3):
        pool = first_pool(context, space, start, pick.materials)
        x = start
        for _ in range(_ROUNDS):
            solution = exchange.program(pool).solve(x, materials, pool, relax=True)
            broken = [k for k, slack in enumerate(solution.slacks) if abs(slack) > _BROKEN]
            if not solution.solved or not broken:
                break
            needs = {k: _needed(problem.limits[k], solution.slacks[k]) for k in broken}
            limits = tuple(replace(limit, value=needs.get(k, limit.value)) for k, limit in enumerate(problem.limits))
            relaxed = Exchange(replace(context, problem=replace(problem, limits=limits)), space)
            grown = relaxed.worse_poses(solution, pick.materials, pool)
            if grown.size == pool.size:
                return sum(abs(solution.slacks[k]) for k in broken), _told(problem, needs)
            x, pool = solution.x, grown
    return None


def _needed(limit: Limit, slack: float) -> float:
    """The limit's value at the least relaxation, to four digits, rounded to the side that is feasible."""
    kind = limit.figure.kind
    way = 1.0 if (slack > 0.0) == (limit.relation != ">=") else -1.0
    exact = limit.value * math.exp(way * abs(slack)) * (1.0 + 1e-4 * way)
    need = exact
    for step in range(21):
        text = format_quantity(exact * (1.0 + 1e-4 * step * way), kind, digits=4)
        need = read_bound(f"<= {text}", kind, file="", key="").value
        if way * (need - exact) >= 0.0:
            break
    return need


def _told(problem: Problem, needs: Mapping[int, float]) -> str:
    parts: list[str] = []
    for index, value in needs.items():
        limit = problem.limits[index]
        need = format_quantity(value, limit.figure.kind, digits=4)
        parts.append(f"{limit.text} would have to be {limit.relation} {need}")
    rest = [limit.text for k, limit in enumerate(problem.limits) if k not in needs]
    kept = f", with {', '.join(rest)} kept" if rest else ""
    sizes = format_quantity(problem.section_size[0], "length"), format_quantity(problem.section_size[1], "length")
    return f"no design keeps all limits: {' and '.join(parts)}{kept} (section_size {sizes[0]} to {sizes[1]})"
