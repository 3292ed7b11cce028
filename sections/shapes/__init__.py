"""The shapes by name, one file each."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from sections.section import Section
from sections.shapes.angle import Angle
from sections.shapes.channel import Channel
from sections.shapes.circle import Circle
from sections.shapes.ellipse import Ellipse
from sections.shapes.elliptical_tube import EllipticalTube
from sections.shapes.i_section import FreeFlangeISection, ISection
from sections.shapes.octagon import Octagon, OctagonalTube
from sections.shapes.polygon import Polygon
from sections.shapes.rectangle import Rectangle
from sections.shapes.rectangular_tube import RectangularTube
from sections.shapes.t_section import TSection
from sections.shapes.triangle import Triangle
from sections.shapes.triangular_tube import TriangularTube
from sections.shapes.tube import Tube

SHAPES: Mapping[str, type[Section]] = MappingProxyType(
    {
        kind.shape: kind
        for kind in (
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
    }
)
"""Every shape by its name in arm files."""

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
