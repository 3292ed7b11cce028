"""What an answer says of its question: limits and choices in words, and how the arm as given errs over its poses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from linkwright.core.arm.error_map import ErrorMap, error_map
from linkwright.core.arm.errors.model import error_model
from linkwright.core.arm.evaluation import Evaluation
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.optimize.exchange.design import numeric_beams
from linkwright.core.optimize.exchange.exchange import Context
from linkwright.core.optimize.reading.ranges import Span
from linkwright.core.units.quantities import format_quantity

from .base.read import base_in_words
from .problem import Problem

_POSES = 20_000


def map_of_given(given: Problem, context: Context, poses: int) -> ErrorMap:
    """The error map of the arm as given; with other drives or tapers it has an error model of its own."""
    search = whole_error(context)
    if context.problem.arm is not given.arm:
        search = WorstSearch(error_model(given.arm, given.load_cases), given.workspace)
    return error_map(search, numeric_beams(given.arm, given.load_cases), poses=poses)


def map_of(problem: Problem, evaluation: Evaluation) -> ErrorMap:
    """The error map of an arm that was evaluated over a problem's workspace, with an error model of its own."""
    arm, cases = evaluation.arm, evaluation.load_cases
    search = WorstSearch(error_model(arm, cases), replace(problem.workspace, error="whole"))
    return error_map(search, numeric_beams(arm, cases), poses=_POSES)


def whole_error(context: Context) -> WorstSearch:
    """The search for the whole error, which maps show whatever counts of it."""
    problem = context.problem
    if problem.workspace.error == "whole":
        return context.search
    return WorstSearch(error_model(problem.arm, problem.load_cases), problem.workspace)


def limits_in_words(problem: Problem) -> tuple[str, ...]:
    """The limits and ranges, as people write them."""
    names = dict.fromkeys(name for link_ranges in problem.ranges for name in link_ranges.spans)
    spans = [f"{name} {span_by_link(problem, name)}" for name in names]
    # Where sections are listed, ranges have left out sizes already.
    return (*(limit.text for limit in problem.limits if not limit.aim), *(() if problem.sizes is not None else spans))


def span_by_link(problem: Problem, name: str) -> str:
    """A range of sizes, once for all links or link by link."""
    spans: list[tuple[str, ...]] = []
    for link, link_ranges in zip(problem.arm.links, problem.ranges, strict=True):
        span = None if link.section is None else link_ranges.spans.get(name)
        spans.append(() if span is None else (span_in_words(name, span),))
    return _by_link(spans)


def span_in_words(name: str, span: Span) -> str:
    """A range with its unit."""
    return " to ".join(f"{end:g}" if name == "taper" else format_quantity(end, "length") for end in span)


def choices_in_words(problem: Problem) -> tuple[str, ...]:
    """What each link could be, as people write it."""
    return (*_sections_in_words(problem), *_drives_in_words(problem))


def _sections_in_words(problem: Problem) -> Iterator[str]:
    shapes = [problem.shapes_of(link) for link in range(problem.arm.size)]
    if problem.shapes is not None:
        yield f"section: {_by_link(shapes)}"
    if problem.materials is not None:
        names = [tuple(material.name for material in problem.materials_of(link)) for link in range(problem.arm.size)]
        yield f"material: {_by_link([names[link] if shape else () for link, shape in enumerate(shapes)])}"
    if problem.sizes is not None:
        counts = [str(len(sections)) for sections in problem.sizes if sections]
        same = len(set(counts)) == 1
        yield f"sizes: {counts[0]} listed for each link" if same else f"sizes listed: {', '.join(counts)}"


def _drives_in_words(problem: Problem) -> Iterator[str]:
    if problem.actuators is not None:
        lists = [", ".join(actuator.name for actuator in actuators) for actuators in problem.actuators]
        by_joint = [f"joint {number}: {names}" for number, names in enumerate(lists, start=1) if names]
        same = len(by_joint) == len(lists) and len(set(lists)) == 1
        yield f"actuator: {lists[0] if same else '; '.join(by_joint)}"
    for balance in problem.balances:
        low, high = (format_quantity(value, balance.kind) for value in (balance.lower, balance.upper))
        yield f"{balance.words}: {low} to {high}"
    for choice in problem.motors:
        yield f"motor {' or '.join(place.words for place in choice.places)}"
    if problem.base is not None:
        yield f"base: {', '.join(base_in_words(problem.base))}"
    if problem.same:
        yield f"the same for all links: {', '.join(sorted(problem.same))}"


def _by_link(names: Sequence[Sequence[str]]) -> str:
    """Names of each elastic link (none for a rigid one), said once where all have the same."""
    texts = {number: ", ".join(link_names) for number, link_names in enumerate(names, start=1) if link_names}
    if len(set(texts.values())) == 1:
        return next(iter(texts.values()))
    return "; ".join(f"link {number}: {text}" for number, text in texts.items())
