"""What a report shows, whether as a page or on paper: the described result, its pictures, its figures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from linkwright.report.described import body
from linkwright.report.page import WITHOUT_SCRIPT, page
from linkwright.report.pictures.plots import Figure
from linkwright.results.document import Description


@dataclass(frozen=True)
class Contents:
    """`pictures` are HTML by the name that the description gives them, `figures` what scripts draw in it by their own
    names; `without` says what a reader misses whose browser runs none."""

    described: Description
    pictures: Mapping[str, str]
    figures: Mapping[str, Figure] = field(default_factory=dict[str, Figure])
    without: str = WITHOUT_SCRIPT


def page_of(contents: Contents) -> str:
    """The page as one HTML file that loads nothing."""
    described = contents.described
    parts = body(described, contents.pictures)
    return page(described.title, described.headline, parts, contents.figures, contents.without)
