"""The links of an arm and their cross-sections as a DXF drawing, in mm and to scale, with dimensions."""

from __future__ import annotations

import io
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

from arm.chain.chain import Arm, Link
from arm.descriptions.formats import Exported
from linkwright.results.figures_in_words import figure, material_words, section_words
from sections.section import Section
from sections.shapes.circle import Circle
from sections.shapes.tube import Tube
from sections.taper import Tapered

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
    """The drawing of an arm: a side view of each link, height up, beside it its section at the joint, and at the far
    end where the link tapers. Links that are rigid are axes."""
    lengths = [1e3 * link.length for link in arm.links]
    largest = max([*lengths, *(_height(link) for link in arm.links), 1.0])
    document = _document(largest)
    sheet = _Sheet(document.modelspace(), _LETTERS * largest, max(lengths) + 0.2 * largest)
    below = 0.0
    for number, link in enumerate(arm.links, start=1):
        room = max(_height(link), 4.0 * sheet.letters)
        below -= 0.5 * room
        _link(sheet, number, link, below)
        below -= 0.5 * room + 10.0 * sheet.letters
    bare = [k for k, link in enumerate(arm.links, start=1) if link.section is None]
    carried = ("lengths", "cross-sections at scale 1:1 in mm", "axes of the joints")
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


def _height(link: Link) -> float:
    """The greatest extent of a link's section along its height, mm."""
    if link.section is None:
        return 0.0
    return max(float(np.ptp(_outer(end)[:, 1])) for end in _ends(link.section))


def _ends(section: Section) -> tuple[Section, ...]:
    return (section.near, section.far) if isinstance(section, Tapered) else (section,)


def _outer(section: Section) -> Points:
    """The outer edge, mm: across, and along the height."""
    return 1e3 * np.asarray(section.outline()[0])


def _link(sheet: _Sheet, number: int, link: Link, at: float) -> None:
    """A link's side view with its axis at the height `at`, and its sections beside it."""
    length, letters = 1e3 * link.length, sheet.letters
    height = _height(link)
    words = f"link {number}: {section_words(link)}; {material_words(link)}; length {figure(length, 6)} mm"
    _words(sheet, words, (0.0, at - 0.5 * height - 4.5 * letters))
    reach = 2.0 * letters
    sheet.space.add_line((-reach, at), (length + reach, at), dxfattribs={"layer": _CENTER})
    for end in (0.0, length):
        sheet.space.add_line((end, at - reach), (end, at + reach), dxfattribs={"layer": _CENTER})
    low = at - 0.5 * height - 1.0 * letters
    _size(sheet, (0.0, at), (length, at), (0.0, low - letters), 0.0)
    if link.section is None:
        return
    ends = _ends(link.section)
    near, far = _outer(ends[0]), _outer(ends[-1])
    middle = [0.5 * (each[:, 1].max() + each[:, 1].min()) for each in (near, far)]
    edges = [[each[:, 1].max() - m, each[:, 1].min() - m] for each, m in zip((near, far), middle, strict=True)]
    corners = [(0.0, edges[0][0]), (length, edges[1][0]), (length, edges[1][1]), (0.0, edges[0][1])]
    sheet.space.add_lwpolyline([(x, at + y) for x, y in corners], close=True, dxfattribs={"layer": _OUTLINE})
    for inside in _inner_heights(ends[0], middle[0]):
        scale = (edges[1][0] - edges[1][1]) / (edges[0][0] - edges[0][1])
        across = inside if len(ends) == 1 else inside * scale
        sheet.space.add_line((0.0, at + inside), (length, at + across), dxfattribs={"layer": _HIDDEN})
    begin = sheet.sections_at
    for name, end in zip(("", "at the far end") if len(ends) > 1 else ("",), ends, strict=True):
        begin = _section(sheet, end, begin, at, name)


def _inner_heights(section: Section, middle: float) -> list[float]:
    """Where edges lie that a side view does not see, mm from the middle: those of holes."""
    holes = [1e3 * np.asarray(ring)[:, 1] - middle for ring in section.outline()[1:]]
    return [float(end) for hole in holes for end in (hole.max(), hole.min())]


def _section(sheet: _Sheet, section: Section, begin: float, at: float, name: str) -> float:
    """A cross-section from `begin` on, the middle of its height at `at`; gives where the next may begin."""
    rings = [1e3 * np.asarray(ring) for ring in section.outline()]
    low, high = rings[0].min(axis=0), rings[0].max(axis=0)
    width, height = (float(each) for each in high - low)
    shift = np.array([begin + 0.5 * width, at]) - 0.5 * (low + high)
    if isinstance(section, _ROUND):
        for ring in rings:
            radius = 0.5 * float(np.ptp(ring[:, 0]))
            sheet.space.add_circle((begin + 0.5 * width, at), radius, dxfattribs={"layer": _OUTLINE})
    else:
        for ring in rings:
            places = [(float(x), float(y)) for x, y in ring + shift]
            sheet.space.add_lwpolyline(places, close=True, dxfattribs={"layer": _OUTLINE})
    letters = sheet.letters
    under, right = at - 0.5 * height, begin + width
    _size(sheet, (begin, under), (right, under), (begin, under - 2.0 * letters), 0.0)
    _size(sheet, (right, under), (right, under + height), (right + 2.0 * letters, under), 90.0)
    if name:
        _words(sheet, name, (begin, under - 4.5 * letters))
    return right + 8.0 * letters


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
