"""The ranges in `subject_to` of lengths, outer dimensions, walls and tapers: once for all links, or by link."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.figures import RANGES
from linkwright.core.optimize.reading.by_link import by_link
from linkwright.core.sections.taper import MOST_TAPER
from linkwright.core.units.quantities import format_quantity, shown
from linkwright.core.units.reading import Mapping

Span = tuple[float, float]
"""The least and the greatest value."""


@dataclass(frozen=True)
class Ranges:
    """The ranges of one link (m) as a problem says them, None where it does not: a length then stays, and so does a
    `taper` (the size of the far end over that at the joint); dimensions have a range by default. `steps` are the
    thicknesses that walls are sold in, least first; none where any will do."""

    section_size: Span | None = None
    thickness: Span | None = None
    link_length: Span | None = None
    taper: Span | None = None
    steps: tuple[float, ...] = ()

    @property
    def sizes(self) -> tuple[Span, Span]:
        """Of every outer dimension and of every wall, m."""
        return self.section_size or RANGES["section_size"], self.thickness or RANGES["thickness"]

    @property
    def by_kind(self) -> dict[str, Span]:
        """The same, by the kind of dimension."""
        outer, wall = self.sizes
        return {"outer": outer, "wall": wall}

    @property
    def spans(self) -> dict[str, Span]:
        """All that holds, by its key in problem files."""
        outer, walls = self.sizes
        every = {"section_size": outer, "thickness": walls, "link_length": self.link_length, "taper": self.taper}
        return {name: span for name, span in every.items() if span is not None}


_SMALLEST, _LARGEST = 1e-6, 1e4
"""What a link or a wall can measure at all, m; beyond it, the powers in a search are not finite."""


def read_ranges(body: Mapping, arm: Arm) -> tuple[Ranges, ...]:
    """The ranges of each link; a rigid one has neither a length nor a taper to choose. Raises `InputError`."""
    by_name = {
        name: by_link(body, name, arm, partial(_walls if name == "thickness" else _range, default=default)).each
        for name, default in RANGES.items()
    }
    by_name["taper"] = by_link(body, "taper", arm, _taper).each
    return tuple(
        Ranges() if link.section is None else _with_steps({name: item[number] for name, item in by_name.items()})
        for number, link in enumerate(arm.links)
    )


def _with_steps(entries: dict[str, tuple[float, ...] | None]) -> Ranges:
    """The ranges of a link, of walls in steps from the least to the greatest of those."""
    spans: dict[str, Any] = dict(entries)
    walls = entries["thickness"]
    if isinstance(walls, _Steps):
        spans |= {"thickness": (walls[0], walls[-1]), "steps": tuple(walls)}
    return Ranges(**spans)


class _Steps(tuple[float, ...]):
    """Thicknesses that walls are sold in, least first."""

    __slots__ = ()


def shared_ranges(mapping: Mapping, ranges: Sequence[Ranges]) -> tuple[Ranges, ...]:
    """The ranges of links that all have the same dimensions, which must lie in the ranges of each of them."""
    shared: dict[str, Span] = {}
    for name in ("section_size", "thickness", "taper"):
        spans: list[Span] = [span for link_ranges in ranges if (span := getattr(link_ranges, name)) is not None]
        if not spans:
            continue
        low, high = max(span[0] for span in spans), min(span[1] for span in spans)
        if low > high:
            message = "has ranges that no size is in, and same: [size] gives all links one; loosen one of them"
            raise mapping.error(f"subject_to.{name}", message)
        shared[name] = low, high
    # What is said of one link only is said of all that are like it; of a rigid one nothing is.
    return tuple(link_ranges if link_ranges == Ranges() else replace(link_ranges, **shared) for link_ranges in ranges)


def _range(body: Mapping, name: str, default: Span) -> Span:
    if isinstance(body.content[name], str):
        bound = body.bound(name, "length")
        low = bound.value if bound.relation != "<=" else min(default[0], bound.value)
        high = bound.value if bound.relation != ">=" else max(default[1], bound.value)
    else:
        low, high = body.range(name, "length")
    if low <= 0.0:
        raise body.error(name, f"must be above zero, not {shown(body.content[name])}")
    if low < _SMALLEST or high > _LARGEST:
        ends = f"{format_quantity(_SMALLEST, 'length')} and {format_quantity(_LARGEST, 'length')}"
        raise body.error(name, f"must lie between {ends}, not {shown(body.content[name])}")
    return low, high


def _walls(body: Mapping, name: str, default: Span) -> Any:
    """The range of walls, or the steps that they are sold in."""
    if not isinstance(body.content[name], dict):
        return _range(body, name, default)
    with body.mapping(name).reading() as keys:
        steps = sorted(set(keys.vector("steps", "length")))
    if len(steps) < 2 or steps[0] < _SMALLEST:
        raise body.error(name, "needs two thicknesses or more, e.g. {steps: [2 mm, 3 mm, 4 mm]}")
    return _Steps(steps)


def _taper(body: Mapping, name: str) -> Span:
    """The least and the greatest size of a far end over that at the joint."""
    low, high = body.range(name, "dimensionless")
    if not 1.0 / MOST_TAPER <= low <= high <= MOST_TAPER:
        would_do = f"sizes of the far end over those at the joint between {1.0 / MOST_TAPER:g} and {MOST_TAPER:g}"
        raise body.error(name, f"holds {would_do}, e.g. [0.4, 1], not {shown(body.content[name])}")
    return low, high
