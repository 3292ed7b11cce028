"""The shapes by name, one file each."""

from __future__ import annotations

from linkwright.core.registries import Registry
from linkwright.core.sections.section import Section
from linkwright.core.sections.shapes.angle import Angle
from linkwright.core.sections.shapes.channel import Channel
from linkwright.core.sections.shapes.circle import Circle
from linkwright.core.sections.shapes.ellipse import Ellipse
from linkwright.core.sections.shapes.elliptical_tube import EllipticalTube
from linkwright.core.sections.shapes.i_section import FreeFlangeISection, ISection
from linkwright.core.sections.shapes.polygon import Polygon
from linkwright.core.sections.shapes.rectangle import Rectangle
from linkwright.core.sections.shapes.rectangular_tube import RectangularTube
from linkwright.core.sections.shapes.regular_polygon import HexagonalTube, Octagon, OctagonalTube
from linkwright.core.sections.shapes.t_section import TSection
from linkwright.core.sections.shapes.t_slot import TSlot
from linkwright.core.sections.shapes.triangle import Triangle
from linkwright.core.sections.shapes.triangular_tube import TriangularTube
from linkwright.core.sections.shapes.tube import Tube


def _fault(kind: object) -> str | None:
    good = isinstance(kind, type) and issubclass(kind, Section)
    return None if good else f"a shape must be a class derived from sections.Section, not {kind!r}"


SHAPES: Registry[type[Section]] = Registry("shape", "linkwright.sections", lambda kind: kind.shape, _fault)
"""Every shape by its name in arm files; users and installed packages (`linkwright.sections`) add theirs."""

SHAPES.ship(
    Circle,
    Tube,
    Ellipse,
    EllipticalTube,
    Rectangle,
    RectangularTube,
    Triangle,
    TriangularTube,
    Octagon,
    OctagonalTube,
    HexagonalTube,
    ISection,
    Channel,
    TSection,
    Angle,
    TSlot,
    Polygon,
)

__all__ = [
    "SHAPES",
    "Angle",
    "Channel",
    "Circle",
    "Ellipse",
    "EllipticalTube",
    "FreeFlangeISection",
    "HexagonalTube",
    "ISection",
    "Octagon",
    "OctagonalTube",
    "Polygon",
    "Rectangle",
    "RectangularTube",
    "TSection",
    "TSlot",
    "Triangle",
    "TriangularTube",
    "Tube",
]
