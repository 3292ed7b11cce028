"""What a cut through a link is: shapes, their properties, and the variables by which to optimise them.

Knows nothing of arms, materials, files or units; every number is in SI.
"""

from linkwright.core.sections.build import build
from linkwright.core.sections.numeric import Number
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import (
    Bounds,
    Constraint,
    DesignVariable,
    Dimension,
    Outline,
    Section,
    SectionError,
)
from linkwright.core.sections.shapes import (
    SHAPES,
    Angle,
    Channel,
    Circle,
    Ellipse,
    EllipticalTube,
    FreeFlangeISection,
    HexagonalTube,
    ISection,
    Octagon,
    OctagonalTube,
    Polygon,
    Rectangle,
    RectangularTube,
    Triangle,
    TriangularTube,
    TSection,
    TSlot,
    Tube,
)
from linkwright.core.sections.stock.tables import Stock, StockSize, load_stock
from linkwright.core.sections.walls import Arc, Wall, WallLimit, is_solid, slenderness_limits, walls

__all__ = [
    "SHAPES",
    "Angle",
    "Arc",
    "Bounds",
    "Channel",
    "Circle",
    "Constraint",
    "DesignVariable",
    "Dimension",
    "Ellipse",
    "EllipticalTube",
    "FreeFlangeISection",
    "HexagonalTube",
    "ISection",
    "Number",
    "Octagon",
    "OctagonalTube",
    "Outline",
    "Polygon",
    "Rectangle",
    "RectangularTube",
    "Section",
    "SectionError",
    "SectionProperties",
    "Stock",
    "StockSize",
    "TSection",
    "TSlot",
    "Triangle",
    "TriangularTube",
    "Tube",
    "Wall",
    "WallLimit",
    "build",
    "is_solid",
    "load_stock",
    "slenderness_limits",
    "walls",
]
