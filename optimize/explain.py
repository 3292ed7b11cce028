"""The limits and ranges that bind at the optimum, their prices (multipliers), and what is in no feasible design."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Literal

from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.materials.material import Material
from linkwright.core.optimize.balance.balance import FIELDS
from linkwright.core.optimize.choice.combinations import Choice, Combination
from linkwright.core.optimize.exchange.design import TAPER, design_space, material_row, starting_points
from linkwright.core.optimize.exchange.exchange import Context, Exchange
from linkwright.core.optimize.exchange.program import Ask, Solution
from linkwright.core.optimize.exchange.rows import far_constraints
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.reading.ranges import Ranges
from linkwright.core.optimize.result import BindingLimit, Candidate, Dropped
from linkwright.core.units.quantities import format_quantity

_FELT = 1e-6
"""A multiplier below this (per cent of objective per per cent of limit) is a limit that does not hold anything back."""
_STEP = 1e-6
"""By how much (relative) the end of a range is moved to see what it is worth."""
_OF_SECTIONS = ("section_size", "thickness")


def price_unit(problem: Problem, unit: str) -> str:
    """The unit of a price: the objective's unit per the limit's."""
    objective_unit = problem.objective.unit
    return f"{objective_unit}/{unit}" if unit else objective_unit


def binding_limits(problem: Problem, choice: Choice, after: Evaluation) -> tuple[BindingLimit, ...]:
    """Every limit that holds the optimum, with what one unit more of it would buy; `after` is the design's
    evaluation."""
    solution = choice.exchanged.solution
    # The objective is a logarithm: of the error that design can change, of the mass, or of the cost.
    unchanging = choice.exchange.program(choice.exchanged.pool).fixed_error if problem.minimize == "max_error" else 0.0
    worth = (problem.objective.badness(choice.objective) - unchanging) * problem.objective.factor
    binding: list[BindingLimit] = []
    for limit, multiplier in zip(problem.limits, solution.limit_prices, strict=True):
        if abs(multiplier) < _FELT or limit.aim:
            continue
        unit, factor = limit.figure.unit, limit.figure.factor
        tightening = 1.0 if limit.relation == ">=" else -1.0
        binding.append(
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
        *binding,
        *_ranges(problem, choice, worth, ("taper",)),
        *_balance_bounds(problem, choice, solution, worth),
        *_ranges(problem, choice, worth, sizes),
    )


def _ranges(problem: Problem, choice: Choice, worth: float, names: Sequence[str]) -> list[BindingLimit]:
    """The ends of ranges of tapers, sizes and lengths that hold, with the prices of all places at each added up; from
    the base out."""
    binding: list[tuple[int, BindingLimit]] = []
    for name in names:
        spans = [link_ranges.spans.get(name) for link_ranges in problem.ranges]
        ends = dict.fromkeys((side, span[side]) for side in (0, 1) for span in spans if span is not None)
        for side, bound in ends:
            step = _STEP * bound
            prices = _moved(
                problem, _with_end(problem, name, side, bound, bound + step), choice, rows=name in _OF_SECTIONS
            )
            if not prices:
                continue
            unit, factor, shown = "mm", 1e3, format_quantity(bound, "length")
            if name == "taper":
                unit, factor, shown = "", 1.0, f"{bound:g}"
            text = f"{name} {'<=' if side else '>='} {shown} ({', '.join(prices)})"
            price = sum(prices.values()) / step * worth / factor
            limit = BindingLimit(name, text, bound * factor, bound * factor, unit, price, price_unit(problem, unit))
            binding.append((int(next(iter(prices)).split()[1]), limit))
    return [limit for _, limit in sorted(binding, key=lambda item: item[0])]


def _with_end(problem: Problem, name: str, side: int, bound: float, other: float) -> Problem:
    """The problem with the lower (0) or the upper (1) end of a range at another place, for all links that have it."""
    changed: list[Ranges] = []
    for ranges in problem.ranges:
        span = ranges.spans.get(name)
        if span is not None and span[side] == bound:
            ranges = replace(ranges, **{name: (span[0], other) if side else (other, span[1])})
        changed.append(ranges)
    return replace(problem, ranges=tuple(changed))


def _moved(problem: Problem, moved: Problem, choice: Choice, *, rows: bool) -> dict[str, float]:
    """What the logarithm of the objective changes by, place by place, where the end of a range is moved a little: by
    the bounds of variables, and (`rows`) by what holds sections that is no variable's bound."""
    solution, prices = choice.exchanged.solution, dict[str, float]()
    variables = design_space(moved, choice.space.shapes).variables
    for variable, other, multiplier in zip(
        choice.space.variables, variables, solution.bound_prices.tolist(), strict=True
    ):
        before, after = (variable.upper, other.upper) if multiplier > 0.0 else (variable.lower, other.lower)
        if abs(multiplier) > _FELT and before != after:
            place = (
                f"link {variable.link + 1}" if variable.name == TAPER else f"link {variable.link + 1} {variable.name}"
            )
            prices[place] = prices.get(place, 0.0) - multiplier * (variable.to_x(after) - variable.to_x(before))
    multipliers = dict(solution.shape_prices) if rows else {}
    sections, _ = choice.space.sections_and_lengths(solution.x.tolist())
    for link, (section, log_taper) in enumerate(zip(sections, choice.space.log_tapers(solution.x), strict=True)):
        if section is None or not rows:
            continue
        ranges = problem.ranges[link], moved.ranges[link]
        for place, now, then in (
            ("wall", *(section.bound_constraints(*link_ranges.sizes) for link_ranges in ranges)),
            ("far end", *(far_constraints(section, log_taper, link_ranges) for link_ranges in ranges)),
        ):
            for before, after in zip(now, then, strict=True):
                multiplier = multipliers.get(f"link {link + 1}: {before.text}", 0.0)
                change = float(after.value - before.value)
                # Rows are scaled by their ranges: what moves by less than this only does by that.
                if abs(multiplier) > _FELT and abs(float(before.value)) < 1e-6 and abs(change) > 1e-4 * _STEP:
                    prices[f"link {link + 1} {place}"] = (
                        prices.get(f"link {link + 1} {place}", 0.0) + multiplier * change
                    )
    return prices


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
    words = {(item.place, item.field): item for item in problem.balances}
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


_GIVES = 1e-6
"""A limit that has to give way by less than this (in its logarithm) is kept."""


def dropped_of(context: Context, choice: Choice) -> tuple[Dropped, ...]:
    """What dropped out of a choice, and by which limits; nothing of what the poses of the best design do not tell."""
    problem = context.problem
    materials = [link.material for link in problem.arm.links if link.material is not None]
    known = {material.name: material for material in (*materials, *(problem.materials or ()))}
    dropped: list[Dropped] = []
    chosen: dict[Literal["material", "section"], Sequence[str]] = {
        "material": [material.name for material in problem.materials or ()],
        "section": problem.shapes or (),
    }
    for kind, names in chosen.items():
        for name in names:
            tried = [candidate for candidate in choice.candidates if name in _of(candidate, kind)]
            if not tried or any(item.outcome != "infeasible" for item in tried):
                continue
            # Of one that has it everywhere, where there is one.
            purest = max(tried, key=lambda item, name=name, kind=kind: _of(item, kind).count(name))
            limits = _broken(context, choice, purest, known)
            if limits:
                dropped.append(Dropped(kind, name, limits))
    return tuple(dropped)


def _of(candidate: Candidate, kind: str) -> tuple[str | None, ...]:
    return candidate.materials if kind == "material" else candidate.shapes


def _broken(context: Context, choice: Choice, candidate: Candidate, known: dict[str, Material]) -> tuple[str, ...]:
    """The limits that give way in the least relaxation of all of them."""
    problem = context.problem
    materials = tuple(None if name is None else known[name] for name in candidate.materials)
    pick = Combination(candidate.shapes, materials)
    space = design_space(problem, pick.shapes)
    row = material_row(pick.materials, problem)
    program = Exchange(context, space, choice.exchange.compiled).program(choice.exchanged.pool, spare=False)
    for start in starting_points(space, row, 1):
        solution = program.solve(start, row, choice.exchanged.pool, Ask(problem.limits, relax=True))
        if solution.solved:
            gives = zip(problem.limits, solution.slacks, strict=True)
            return tuple(limit.text for limit, slack in gives if abs(slack) > _GIVES)
    return ()
