"""The shapes by name, one file each."""

from __future__ import annotations

from registries import Registry
from sections.section import Section
from sections.shapes.angle import Angle
from sections.shapes.channel import Channel
from sections.shapes.circle import Circle
from sections.shapes.ellipse import Ellipse
from sections.shapes.elliptical_tube import EllipticalTube
from sections.shapes.i_section import FreeFlangeISection, ISection
from sections.shapes.polygon import Polygon
from sections.shapes.rectangle import Rectangle
from sections.shapes.rectangular_tube import RectangularTube
from sections.shapes.regular_polygon import Octagon, OctagonalTube
from sections.shapes.t_section import TSection
from sections.shapes.triangle import Triangle
from sections.shapes.triangular_tube import TriangularTube
from sections.shapes.tube import Tube


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
    ISection,
    Channel,
    TSection,
    Angle,
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
    "ISection",
    "Octagon",
    "OctagonalTube",
    "Polygon",
    "Rectangle",
    "RectangularTube",
    "TSection",
    "Triangle",
    "TriangularTube",
    "Tube",
]
