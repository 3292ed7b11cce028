"""What holds a design back, and what that costs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.optimize.balance.balance import FIELDS
from linkwright.core.optimize.choice.combinations import Choice
from linkwright.core.optimize.exchange.design import TAPER, Variable
from linkwright.core.optimize.exchange.far_ends import far_constraints
from linkwright.core.optimize.exchange.program import Solution
from linkwright.core.sections import SHAPES
from linkwright.core.units.quantities import format_quantity

from .problem import Problem
from .result import BindingLimit

_FELT = 1e-6
"""A multiplier below this (per cent of objective per per cent of limit) is a limit that does not hold anything back."""


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
                assumed=limit.assumed,
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
        if variable.name == TAPER or variable.name in FIELDS:
            continue
        value = variable.upper if side else variable.lower
        for name, moves in _moves(problem, choice, variable, side):
            slope = moves / (value if variable.logarithmic else variable.scale)
            prices[name, side] = prices.get((name, side), 0.0) - multiplier * slope
            where.setdefault((name, side), []).append(f"link {variable.link + 1} {variable.name}")
    _add_wall_prices(problem, choice, solution, prices, where)
    _add_far_prices(problem, choice, solution, prices, where)
    found = [
        *_taper_bounds(problem, choice, solution, worth),
        *_balance_bounds(problem, choice, solution, worth),
    ]
    for (name, side), slope in prices.items():
        bound = dict(_ranges(problem))[name][side]
        relation = "<=" if side else ">="
        places = ", ".join(dict.fromkeys(where[name, side]))
        text = f"{name} {relation} {format_quantity(bound, 'length')} ({places})"
        price = slope * worth * 1e-3
        found.append(BindingLimit(name, text, bound * 1e3, bound * 1e3, "mm", price, price_unit(problem, "mm")))
    return found


def _taper_bounds(problem: Problem, choice: Choice, solution: Solution, worth: float) -> Iterator[BindingLimit]:
    """The bounds on tapers that hold, with the multipliers of all links at each added up."""
    prices: dict[int, list[tuple[int, float]]] = {}
    for variable, multiplier in zip(choice.space.variables, solution.bound_prices.tolist(), strict=True):
        if variable.name == TAPER and abs(multiplier) > _FELT:
            prices.setdefault(1 if multiplier > 0.0 else 0, []).append((variable.link, multiplier))
    for side, own in prices.items():
        assert problem.taper is not None
        bound = problem.taper[side]
        places = ", ".join(f"link {link + 1}" for link, _ in own)
        text = f"taper {'<=' if side else '>='} {bound:g} ({places})"
        price = -sum(multiplier for _, multiplier in own) / bound * worth
        yield BindingLimit("taper", text, bound, bound, "", price, price_unit(problem, ""))


_UNITS: Mapping[str, tuple[str, float]] = MappingProxyType(
    {
        "torque": ("N*m", 1.0),
        "linear_stiffness": ("N/mm", 1e-3),
        "force": ("N", 1.0),
        "mass": ("kg", 1.0),
        "length": ("mm", 1e3),
    }
)
"""The unit in which people read what balances an arm, by its kind, and what one SI unit is in it."""


def _balance_bounds(problem: Problem, choice: Choice, solution: Solution, worth: float) -> Iterator[BindingLimit]:
    """The ends of ranges of counterweights and counterbalances that hold."""
    words = {(each.place, each.field): each for each in problem.balances}
    for variable, multiplier in zip(choice.space.variables, solution.bound_prices.tolist(), strict=True):
        if variable.name not in FIELDS or abs(multiplier) < _FELT:
            continue
        balance = words[variable.link, variable.name]
        bound = variable.upper if multiplier > 0.0 else variable.lower
        unit, factor = _UNITS[balance.kind]
        text = f"{balance.words} {'<=' if multiplier > 0.0 else '>='} {format_quantity(bound, balance.kind)}"
        price = -multiplier / variable.scale * worth / factor
        value = bound * factor
        yield BindingLimit(variable.name, text, value, value, unit, price, price_unit(problem, unit))


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


def _add_far_prices(
    problem: Problem,
    choice: Choice,
    solution: Solution,
    prices: dict[tuple[str, int], float],
    where: dict[tuple[str, int], list[str]],
) -> None:
    """The bounds that hold a far end whose taper is chosen: their price by moving each range a little."""
    multipliers = dict(solution.shape_prices)
    sections, _ = choice.space.sections_and_lengths(solution.x.tolist())
    tapers = choice.space.log_tapers(solution.x)
    for link, (section, log_taper) in enumerate(zip(sections, tapers, strict=True)):
        if section is None or problem.taper is None:
            continue
        now = far_constraints(section, log_taper, problem)
        for name, side in (("section_size", 0), ("section_size", 1), ("thickness", 0), ("thickness", 1)):
            span = list(getattr(problem, name))
            step = 1e-6 * span[side]
            span[side] += step
            moved = far_constraints(section, log_taper, replace(problem, **{name: (span[0], span[1])}))
            for before, after in zip(now, moved, strict=True):
                multiplier = multipliers.get(f"link {link + 1}: {before.text}", 0.0)
                moves = float(after.value - before.value) / step
                slope = multiplier * moves
                # Rows are scaled by their ranges: what moves by less than this only does by that.
                held = abs(multiplier) > _FELT and abs(float(before.value)) < 1e-6 and abs(moves) * span[side] > 1e-4
                if held:
                    prices[name, side] = prices.get((name, side), 0.0) + slope
                    where.setdefault((name, side), []).append(f"link {link + 1} far end")
