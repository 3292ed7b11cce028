"""Cross-sections of the links, all drawn to one scale, as they stand with all joints at zero: up is up on the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import zip_longest
from typing import TypeAlias

import numpy as np

from linkwright.core.arm.chain.chain import Arm, Link
from linkwright.core.arm.figures.strength import StrengthResult
from linkwright.core.arm.placed.heights import HeightPoints, heights
from linkwright.core.arm.placed.views import Side, sides
from linkwright.results.figures_in_words import figure, material_words, mm, percent, section_words

from .svg import drawing, element, nice_below, path, scale_bar, text

_Drawn: TypeAlias = tuple[Link, Side, HeightPoints | None]


def sections_grid(arms: Sequence[tuple[str, Arm]], strengths: Mapping[str, StrengthResult] | None = None) -> str:
    """A card for each link with its cross-section in each arm, beside the stress that it bears where `strengths` say;
    `arms` are (before or after, arm)."""
    side = _largest(arms)
    if side <= 0.0:
        return element("p", text("No link has a section: all are rigid."))
    rows = zip_longest(*(list(zip(arm.links, sides(arm), heights(arm), strict=True)) for _, arm in arms))
    made = {
        n: row for n, row in enumerate(rows, start=1) if any(x is not None and x[0].section is not None for x in row)
    }
    cards = element(
        "div", *(_card(number, arms, row, side, strengths or {}) for number, row in made.items()), class_="cards"
    )
    rigid = [str(n) for n in range(1, max(len(arm.links) for _, arm in arms) + 1) if n not in made]
    if not rigid:
        return cards
    note = f"Rigid, without a section: link{'s' if len(rigid) > 1 else ''} {', '.join(rigid)}."
    return cards + element("p", text(note), class_="lead")


def section_picture(arm: Arm, index: int) -> str:
    """The cross-section of a link (from 0) alone, as large as there is room; nothing where it is rigid."""
    link, side = arm.links[index], sides(arm)[index]
    if link.section is None:
        return ""
    size = 1e3 * float(np.ptp(side.section(np.asarray(link.section.outline()[0])), axis=0).max())
    return _section(index + 1, "", link, side, size)


def _card(
    number: int,
    arms: Sequence[tuple[str, Arm]],
    row: Sequence[_Drawn | None],
    size: float,
    strengths: Mapping[str, StrengthResult],
) -> str:
    figures = [
        _figure(number, when, item, size, _stress(strengths.get(when), number - 1, when))
        for (when, _), item in zip(arms, row, strict=True)
        if item is not None
    ]
    heading = element("h3", text(f"Link {number}"))
    return element("div", heading, element("div", *figures, class_=f"columns-{len(arms)}"), class_="card")


def _largest(arms: Sequence[tuple[str, Arm]]) -> float:
    sizes = [
        1e3 * float(np.ptp(side.section(np.asarray(link.section.outline()[0])), axis=0).max())
        for _, arm in arms
        for link, side in zip(arm.links, sides(arm), strict=True)
        if link.section is not None
    ]
    return max(sizes, default=0.0)


def _stress(strength: StrengthResult | None, index: int, when: str) -> str:
    """The greatest stress of a link in words, and a bar that is full where the material yields."""
    if strength is None or index not in strength.links:
        return ""
    at = strength.links.index(index)
    stress, factor = strength.stress[at], strength.safety_factor[at]
    words = f"bears {figure(1e-6 * stress, 3)} MPa"
    if factor is None or factor <= 0.0:
        return element("figcaption", text(words))
    words += f" of {figure(1e-6 * stress * factor, 3)} MPa ({percent(1.0 / factor)})"
    fill = element("span", class_=f"fill {when or 'after'}", style=f"width:{100.0 * min(1.0, 1.0 / factor):.2f}%")
    bar = element("div", element("span", fill, class_="track whole"), class_="bar")
    return element("figcaption", text(words), bar)


def _figure(number: int, when: str, each: _Drawn, size: float, stress: str) -> str:
    link, side, height = each
    points = "" if height is None else f"height {height.words}"
    words = [element("strong", text(when)) if when else "", text(section_words(link)), text(points)]
    words += [text(material_words(link)), text(f"length {mm(link.length, 5)}")]
    caption = element("figcaption", element("span", "<br>".join(word for word in words if word)))
    drawn = _section(number, when, link, side, size) if link.section is not None else ""
    return element("figure", drawn, stress, caption)


def _section(number: int, when: str, link: Link, side: Side, size: float) -> str:
    width = 1.12 * size
    rings: list[list[tuple[float, float]]] = []
    if link.section is not None:
        outline = [side.section(np.asarray(ring)) for ring in link.section.outline()]
        center = 0.5 * (outline[0].max(axis=0) + outline[0].min(axis=0))
        rings = [[(1e3 * float(y), -1e3 * float(z)) for y, z in ring - center] for ring in outline]
    length = nice_below(0.5 * size)
    bar = scale_bar(-length / 2, 0.66 * size, length, 0.012 * size, 0.075 * size, f"{figure(length)} mm")
    about = f"cross-section of link {number} {when}: {section_words(link)}"
    drawn = path(rings, f"link profile {when or 'after'}") if rings else ""
    return drawing(-width / 2, -width / 2, width, width + 0.14 * size, about, drawn, bar)
