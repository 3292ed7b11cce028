"""The links of an arm and their cross-sections as a DXF drawing, in mm and to scale, with dimensions."""

from __future__ import annotations

import io
import math
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from ezdxf import options, units  # pyright: ignore[reportPrivateImportUsage]
from ezdxf.enums import TextEntityAlignment
from ezdxf.filemanagement import new
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm, Link
from linkwright.core.arm.descriptions.formats import Exported
from linkwright.core.arm.placed.heights import heights
from linkwright.core.arm.placed.views import Side, sides
from linkwright.core.sections.section import Section
from linkwright.core.sections.shapes.circle import Circle
from linkwright.core.sections.shapes.tube import Tube
from linkwright.results.figures_in_words import figure, material_words, section_words

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts.layout import Modelspace

Points = NDArray[np.float64]

_OUTLINE, _HIDDEN, _CENTER, _SIZES, _WORDS = "OUTLINE", "HIDDEN", "CENTER", "DIMENSIONS", "TEXT"
_LAYERS: Mapping[str, tuple[int, str, int]] = MappingProxyType(
    {
        _OUTLINE: (7, "CONTINUOUS", 50),
        _HIDDEN: (8, "DASHED", 25),
        _CENTER: (1, "CENTER", 18),
        _SIZES: (3, "CONTINUOUS", 18),
        _WORDS: (7, "CONTINUOUS", 25),
    }
)
"""Colour, kind of line and its width (1/100 mm), by layer (ISO 128-2: visible edges thick, hidden edges and axes
thin)."""
_LETTERS = 0.02
"""Height of letters, of the longest link."""
_ROUND = (Circle, Tube)


@dataclass(frozen=True)
class _Sheet:
    """Where things are drawn: the page, the height of letters, and where sections begin (mm)."""

    space: Modelspace
    letters: float
    sections_at: float


def drawn(arm: Arm) -> Exported:
    """The drawing of an arm: a side view of each link as it stands with all joints at zero, beside it its section seen
    along the link from its joint, and that at the far end where the link tapers. Links that are rigid are axes."""
    lengths = [1e3 * link.length for link in arm.links]
    seen = [_seen(link, side) for link, side in zip(arm.links, sides(arm), strict=True)]
    largest = max([*lengths, *(item.high for item in seen), 1.0])
    document = _document(largest)
    sheet = _Sheet(document.modelspace(), _LETTERS * largest, max(lengths) + 0.2 * largest)
    below = 0.0
    for number, (link, each, height) in enumerate(zip(arm.links, seen, heights(arm), strict=True), start=1):
        room = max(each.high, 4.0 * sheet.letters)
        below -= 0.5 * room
        points = "" if height is None else f"; height points {height.words} with all joints at zero"
        _link(sheet, link, each, f"link {number}: {section_words(link)}{points}", below)
        below -= 0.5 * room + 10.0 * sheet.letters
    bare = [k for k, link in enumerate(arm.links, start=1) if link.section is None]
    carried = ("lengths", "cross-sections at scale 1:1 in mm", "where their heights point", "axes of the joints")
    named = (
        f"link {bare[0]} is rigid and has"
        if len(bare) == 1
        else f"links {', '.join(map(str, bare))} are rigid and have"
    )
    lost = (f"{named} no section to draw",) if bare else ()
    return Exported(arm, "dxf", _text(document), carried, (*lost, "how links are joined to the joints"), ())


def _document(largest: float) -> Drawing:
    with _undated():
        document = new("R2010", setup=True, units=units.MM)
    document.header["$LTSCALE"] = 0.05 * largest
    for name, (colour, line, width) in _LAYERS.items():
        document.layers.add(name, color=colour, linetype=line, lineweight=width)
    return document


def _text(document: Drawing) -> str:
    """The file, without the time and the identity of its making: the same for the same arm."""
    text = io.StringIO()
    with _undated():
        document.write(text)
    return text.getvalue()


@contextmanager
def _undated() -> Generator[None]:
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


@dataclass(frozen=True)
class _Cut:
    """A section as it is seen along its link, m: its edges in its directions (across, along its height), and how
    those are turned on the page."""

    section: Section
    side: Side

    @property
    def rings(self) -> list[Points]:
        """The edges on the page, mm: those of the outside first."""
        return [1e3 * self.side.section(np.asarray(ring)) for ring in self.section.outline()]

    @property
    def box(self) -> Points:
        """The corners of the section's width and height on the page, mm: from the left at the foot onwards."""
        outer = np.asarray(self.section.outline()[0])
        (left, foot), (right, top) = outer.min(axis=0), outer.max(axis=0)
        return 1e3 * self.side.section(np.array([(left, foot), (right, foot), (right, top), (left, top)]))


@dataclass(frozen=True)
class _Seen:
    """A link's cuts: at its joint and, where it tapers, at its far end; none where it has no section."""

    cuts: tuple[_Cut, ...]

    @property
    def high(self) -> float:
        """How high the link stands on the page, mm."""
        return max((float(np.ptp(cut.rings[0][:, 1])) for cut in self.cuts), default=0.0)


def _seen(link: Link, side: Side) -> _Seen:
    return _Seen(() if link.section is None else tuple(_Cut(end, side) for end in link.section.ends))


def _link(sheet: _Sheet, link: Link, seen: _Seen, words: str, at: float) -> None:
    """A link's side view with the middle of its height at `at`, and its sections beside it."""
    length, letters = 1e3 * link.length, sheet.letters
    low = at - 0.5 * seen.high
    text = f"{words}; {material_words(link)}; length {figure(length, 6)} mm"
    _words(sheet, text, (0.0, low - 4.5 * letters))
    edges = [(float(cut.rings[0][:, 1].max()), float(cut.rings[0][:, 1].min())) for cut in seen.cuts]
    axis = at if not edges else at - max(edges, key=lambda edge: edge[0] - edge[1])[0] + 0.5 * seen.high
    reach = 2.0 * letters
    sheet.space.add_line((-reach, axis), (length + reach, axis), dxfattribs={"layer": _CENTER})
    for end in (0.0, length):
        sheet.space.add_line((end, axis - reach), (end, axis + reach), dxfattribs={"layer": _CENTER})
    _size(sheet, (0.0, axis), (length, axis), (0.0, low - 2.0 * letters), 0.0)
    if not edges:
        return
    (top, foot), (far_top, far_foot) = edges[0], edges[-1]
    corners = [(0.0, top), (length, far_top), (length, far_foot), (0.0, foot)]
    sheet.space.add_lwpolyline([(x, axis + y) for x, y in corners], close=True, dxfattribs={"layer": _OUTLINE})
    for ring in seen.cuts[0].rings[1:]:
        for inside in (float(ring[:, 1].max()), float(ring[:, 1].min())):
            far = far_foot + (inside - foot) / (top - foot) * (far_top - far_foot)
            sheet.space.add_line((0.0, axis + inside), (length, axis + far), dxfattribs={"layer": _HIDDEN})
    begin = sheet.sections_at
    for name, cut in zip(("", "at the far end") if len(seen.cuts) > 1 else ("",), seen.cuts, strict=True):
        begin = _section(sheet, cut, begin, axis, name)


def _section(sheet: _Sheet, cut: _Cut, begin: float, axis: float, name: str) -> float:
    """A cross-section from `begin` on, its centroid at the height of the link's axis; gives where the next may begin.

    Its sizes are those along its width and height, however it is turned.
    """
    rings, letters = cut.rings, sheet.letters
    low, high = rings[0].min(axis=0), rings[0].max(axis=0)
    shift = np.array([begin - float(low[0]), axis])
    if isinstance(cut.section, _ROUND):
        for ring in rings:
            middle = (float(shift[0]), float(shift[1]))
            sheet.space.add_circle(middle, 0.5 * float(np.ptp(ring[:, 0])), dxfattribs={"layer": _OUTLINE})
    else:
        for ring in rings:
            places = [(float(x), float(y)) for x, y in ring + shift]
            sheet.space.add_lwpolyline(places, close=True, dxfattribs={"layer": _OUTLINE})
    corners = cut.box + shift
    left, right, top = corners[0], corners[1], corners[2]
    across, along = (edge / np.linalg.norm(edge) for edge in (right - left, top - right))
    for first, second, away in ((left, right, -along), (right, top, across)):
        edge = second - first
        angle = math.degrees(math.atan2(float(edge[1]), float(edge[0]))) % 180.0
        upright = angle if angle <= 90.0 else angle - 180.0  # so that its figures are not upside down
        _size(sheet, _pair(first), _pair(second), _pair(first + 2.0 * letters * away), upright)
    if name:
        _words(sheet, name, (begin, axis + float(low[1]) - 4.5 * letters))
    return begin + float(high[0] - low[0]) + 8.0 * letters


def _pair(point: Points) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def _words(sheet: _Sheet, words: str, at: tuple[float, float]) -> None:
    line = sheet.space.add_text(words, height=sheet.letters, dxfattribs={"layer": _WORDS})
    line.set_placement(at, align=TextEntityAlignment.TOP_LEFT)


def _size(
    sheet: _Sheet, first: tuple[float, float], second: tuple[float, float], base: tuple[float, float], angle: float
) -> None:
    """A linear dimension, mm."""
    letters = sheet.letters
    look: dict[str, Any] = {
        "dimtxt": letters,
        "dimasz": 0.8 * letters,
        "dimexe": 0.4 * letters,
        "dimexo": 0.3 * letters,
        "dimgap": 0.3 * letters,
        "dimlfac": 1.0,
        "dimdec": 3,
        "dimzin": 8,
        "dimtad": 1,
    }
    added = sheet.space.add_linear_dim(
        base=base, p1=first, p2=second, angle=angle, override=look, dxfattribs={"layer": _SIZES}
    )
    added.render()
