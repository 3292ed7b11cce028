"""The part of an optimisation's report that tells of the rounded design: its sections, its limits, what it cost."""

from __future__ import annotations

from linkwright.screen.evaluation import bound_words
from linkwright.screen.optimization import compared_words, limit_figure, rounding_headline, rounding_words
from linkwright.words import percent
from optimize.result import OptimizationResult, Rounded

from . import parts
from .page import section, table
from .section_picture import sections_grid
from .svg import element, text


def rounded_section(result: OptimizationResult, rounded: Rounded) -> str:
    """The section of the page."""
    named = (("before", result.after), ("after", rounded.evaluation))
    words = f"{_capital(rounding_headline(result, rounded))}. {_capital(bound_words(rounded.evaluation))}."
    drawn = sections_grid((("before", result.arm), ("after", rounded.arm)))
    found = element("p", text(f"{_capital(compared_words(rounded))}."))
    content = [element("p", text(words)), drawn, parts.links(named), _limits(rounded), found]
    lead = "Before and after rounding; arm.yaml holds the rounded design."
    return section(f"Rounded to {rounding_words(rounded)}", *content, lead=lead)


def _limits(rounded: Rounded) -> str:
    if not rounded.limits:
        return ""
    rows = [
        [each.text, limit_figure(each, each.before), limit_figure(each, each.after), percent(each.room, 3), "kept"]
        for each in rounded.limits
    ]
    return table(("limit", "optimum", "rounded", "to spare", ""), rows, numbers=(1, 2, 3))


def _capital(words: str) -> str:
    return words[:1].upper() + words[1:]
