"""What an answer says of its question: limits and choices in words, and how the arm as given errs over its poses."""

from __future__ import annotations

from linkwright.core.arm.errors.model import error_model
from linkwright.core.arm.evaluation import ErrorMap, error_map
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.optimize.exchange.design import numeric_beams
from linkwright.core.optimize.exchange.exchange import Context
from linkwright.core.units.quantities import format_quantity

from .problem import Problem


def map_of_given(given: Problem, context: Context, poses: int) -> ErrorMap:
    """The error map of the arm as given; with other drives or tapers it has an error model of its own."""
    search = whole_error(context)
    if context.problem.arm is not given.arm:
        search = WorstSearch(error_model(given.arm, given.load_cases), given.workspace)
    return error_map(search, numeric_beams(given.arm, given.load_cases), poses=poses)


def whole_error(context: Context) -> WorstSearch:
    """The search for the whole error, which maps show whatever counts of it."""
    problem = context.problem
    if problem.workspace.error == "whole":
        return context.search
    return WorstSearch(error_model(problem.arm, problem.load_cases), problem.workspace)


def limits_in_words(problem: Problem) -> tuple[str, ...]:
    """The limits and ranges, as people write them."""
    ranges = {"section_size": problem.section_size, "thickness": problem.thickness, "link_length": problem.link_length}
    spans = [
        f"{name} {format_quantity(span[0], 'length')} to {format_quantity(span[1], 'length')}"
        for name, span in ranges.items()
        if span is not None
    ]
    if problem.taper is not None:
        spans.append(f"taper {problem.taper[0]:g} to {problem.taper[1]:g}")
    # Where sections are listed, ranges have left out sizes already.
    return (*(limit.text for limit in problem.limits), *(() if problem.sizes is not None else spans))


def choices_in_words(problem: Problem) -> tuple[str, ...]:
    """What each link could be, as people write it."""
    found: list[str] = []
    if problem.shapes is not None:
        found.append(f"section: {', '.join(problem.shapes)}")
    if problem.materials is not None:
        found.append(f"material: {', '.join(material.name for material in problem.materials)}")
    if problem.sizes is not None:
        counts = [str(len(own)) for own in problem.sizes if own]
        alike = len(set(counts)) == 1
        found.append(f"sizes: {counts[0]} listed for each link" if alike else f"sizes listed: {', '.join(counts)}")
    if problem.actuators is not None:
        lists = [", ".join(each.name for each in own) for own in problem.actuators]
        each = [f"joint {number}: {names}" for number, names in enumerate(lists, start=1) if names]
        alike = len(each) == len(lists) and len(set(lists)) == 1
        found.append(f"actuator: {lists[0] if alike else '; '.join(each)}")
    for each in problem.balances:
        low, high = (format_quantity(value, each.kind) for value in (each.lower, each.upper))
        found.append(f"{each.words}: {low} to {high}")
    found += [f"motor {' or '.join(place.words for place in choice.places)}" for choice in problem.motors]
    if problem.same:
        found.append(f"the same for all links: {', '.join(sorted(problem.same))}")
    return tuple(found)
