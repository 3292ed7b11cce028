"""What holds a design back, and what that costs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.optimize.balance.balance import FIELDS
from linkwright.core.optimize.choice.combinations import Choice
from linkwright.core.optimize.exchange.design import TAPER, design_space
from linkwright.core.optimize.exchange.far_ends import far_constraints
from linkwright.core.optimize.exchange.program import Solution
from linkwright.core.units.quantities import format_quantity

from .problem import Problem
from .result import BindingLimit

_FELT = 1e-6
"""A multiplier below this (per cent of objective per per cent of limit) is a limit that does not hold anything back."""
_STEP = 1e-6
"""By how much (relative) the end of a range is moved to see what it is worth."""
_OF_SECTIONS = ("section_size", "thickness")


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
    sizes = ("section_size", "thickness", "link_length")
    return (
        *found,
        *_ranges(problem, choice, worth, ("taper",)),
        *_balance_bounds(problem, choice, solution, worth),
        *_ranges(problem, choice, worth, sizes),
    )


def _ranges(problem: Problem, choice: Choice, worth: float, names: Sequence[str]) -> list[BindingLimit]:
    """The ends of ranges of tapers, sizes and lengths that hold, with the prices of all places at each added up; from
    the base out."""
    found: list[tuple[int, BindingLimit]] = []
    for name in names:
        span: tuple[float, float] | None = getattr(problem, name)
        if span is None:
            continue
        for side in (0, 1):
            bound, step = span[side], _STEP * span[side]
            ends = (span[0], bound + step) if side else (bound + step, span[1])
            prices = _moved(problem, replace(problem, **{name: ends}), choice, rows=name in _OF_SECTIONS)
            if not prices:
                continue
            unit, factor, shown = "mm", 1e3, format_quantity(bound, "length")
            if name == "taper":
                unit, factor, shown = "", 1.0, f"{bound:g}"
            text = f"{name} {'<=' if side else '>='} {shown} ({', '.join(prices)})"
            price = sum(prices.values()) / step * worth / factor
            limit = BindingLimit(name, text, bound * factor, bound * factor, unit, price, price_unit(problem, unit))
            found.append((int(next(iter(prices)).split()[1]), limit))
    return [limit for _, limit in sorted(found, key=lambda each: each[0])]


def _moved(problem: Problem, moved: Problem, choice: Choice, *, rows: bool) -> dict[str, float]:
    """What the logarithm of the objective changes by, place by place, where the end of a range is moved a little: by
    the bounds of variables, and (`rows`) by what holds sections that is no variable's bound."""
    solution, found = choice.exchanged.solution, dict[str, float]()
    variables = design_space(moved, choice.space.shapes).variables
    for own, other, multiplier in zip(choice.space.variables, variables, solution.bound_prices.tolist(), strict=True):
        before, after = (own.upper, other.upper) if multiplier > 0.0 else (own.lower, other.lower)
        if abs(multiplier) > _FELT and before != after:
            place = f"link {own.link + 1}" if own.name == TAPER else f"link {own.link + 1} {own.name}"
            found[place] = found.get(place, 0.0) - multiplier * (own.to_x(after) - own.to_x(before))
    multipliers = dict(solution.shape_prices) if rows else {}
    sections, _ = choice.space.sections_and_lengths(solution.x.tolist())
    for link, (section, log_taper) in enumerate(zip(sections, choice.space.log_tapers(solution.x), strict=True)):
        if section is None or not rows:
            continue
        for place, now, then in (
            ("wall", *(section.bound_constraints(each.section_size, each.thickness) for each in (problem, moved))),
            ("far end", *(far_constraints(section, log_taper, each) for each in (problem, moved))),
        ):
            for before, after in zip(now, then, strict=True):
                multiplier = multipliers.get(f"link {link + 1}: {before.text}", 0.0)
                change = float(after.value - before.value)
                # Rows are scaled by their ranges: what moves by less than this only does by that.
                if abs(multiplier) > _FELT and abs(float(before.value)) < 1e-6 and abs(change) > 1e-4 * _STEP:
                    found[f"link {link + 1} {place}"] = found.get(f"link {link + 1} {place}", 0.0) + multiplier * change
    return found


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
