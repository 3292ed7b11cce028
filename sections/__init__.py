"""What a cut through a link is: shapes, their properties, and the variables by which to optimise them.

Knows nothing of arms, materials, files or units; every number is in SI.
"""

from sections.build import build
from sections.numeric import Number
from sections.properties import SectionProperties
from sections.section import (
    Bounds,
    Constraint,
    DesignVariable,
    Dimension,
    Outline,
    Section,
    SectionError,
)
from sections.shapes import (
    SHAPES,
    Circle,
    Ellipse,
    FreeFlangeISection,
    ISection,
    Polygon,
    Rectangle,
    RectangularTube,
    Triangle,
    Tube,
)
from sections.stock import Stock, StockSize, load_stock, section_from_name

__all__ = [
    "SHAPES",
    "Bounds",
    "Circle",
    "Constraint",
    "DesignVariable",
    "Dimension",
    "Ellipse",
    "FreeFlangeISection",
    "ISection",
    "Number",
    "Outline",
    "Polygon",
    "Rectangle",
    "RectangularTube",
    "Section",
    "SectionError",
    "SectionProperties",
    "Stock",
    "StockSize",
    "Triangle",
    "Tube",
    "build",
    "load_stock",
    "section_from_name",
]
