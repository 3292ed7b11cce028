"""Extruded bars with T-slots, as machine frames and hobby arms are built of."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import numpy as np

from linkwright.core.sections.numeric import Number
from linkwright.core.sections.section import Constraint, Dimension, Outline, Section, closed

_BORE, _CORNER = 16, 3
"""Points on a drawn bore, and chords of a rounded corner."""

Point = tuple[float, float]


@dataclass(frozen=True)
class TSlot(Section):
    """A bar of square cells one above the other, each with a bored core, diagonal ribs and a slot in each free side.

    Its properties come from its outline. What is sold has ribs and lips too thick to buckle.

    Attributes:
        width: side of a cell, m.
        height: a multiple of the width, m.
        opening: of a slot at the surface, m.
        chamber: width of a slot behind its lips, m.
        lip: thickness of the lips, m.
        core: side of the square about a bore, m.
        rib: thickness of the ribs, m.
        bore: diameter, m.
        corner_hole: side of a square hole in the middle of each corner, m; None: the corners are solid.
        corner_radius: of the outer corners, m; None: they are sharp.
    """

    width: Number
    height: Number
    opening: Number
    chamber: Number
    lip: Number
    core: Number
    rib: Number
    bore: Number
    corner_hole: Number | None = None
    corner_radius: Number | None = None

    shape: ClassVar[str] = "t_slot"
    synonyms: ClassVar[tuple[str, ...]] = ("extrusion", "profile", "t_slot_profile", "v_slot")
    solid: ClassVar[bool] = True
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "side of a cell, across the bending plane", "outer"),
        Dimension("height", "a multiple of the width, in the bending plane", "outer"),
        Dimension("opening", "of a slot at the surface", "radius"),
        Dimension("chamber", "width of a slot behind its lips", "radius"),
        Dimension("lip", "thickness of the lips", "wall"),
        Dimension("core", "side of the square about a bore", "radius"),
        Dimension("rib", "thickness of the ribs", "wall"),
        Dimension("bore", "diameter of the bore", "radius"),
        Dimension("corner_hole", "side of a square hole in each corner", "radius", optional=True),
        Dimension("corner_radius", "of the outer corners", "radius", optional=True),
    )

    @property
    def inner_diameter(self) -> Number:
        """The bore."""
        return self.bore

    def constraints(self) -> tuple[Constraint, ...]:
        """Slots that stay apart, ribs that meet the core, whole cells."""
        cells = self.height / self.width
        across = math.sqrt(2.0) * self.rib
        room = self.width - 2.0 * self.lip
        return (
            Constraint("cells", "height must be a multiple of width", np.abs(cells - np.round(cells)) - 1e-6),
            Constraint("opening", "opening must be less than chamber", self.opening / self.chamber - 1.0),
            Constraint("chamber", "chamber must leave room for the ribs", (self.chamber + across) / room - 1.0),
            Constraint("core", "core must be wider than its ribs", across / self.core - 1.0),
            Constraint("slot", "core must be less than chamber", self.core / self.chamber - 1.0),
            Constraint("bore", "bore must be less than core", self.bore / self.core - 1.0),
        )

    def outline(self) -> Outline:
        """The outer edge, then a bore in each cell, pockets between cells, and holes in the corners."""
        side, end = 0.5 * float(self.width), 0.5 * float(self.height)
        cells = [side * (2 * number + 1) - end for number in range(round(end / side))]
        slot, corner = self._slot(), self._corner(side, end)
        edge = [(y, z + cell) for cell in cells for y, z in slot] + corner
        edge += [(-z, y + end - side) for y, z in slot] + [(-y, z) for y, z in reversed(corner)]
        loops = [edge + [(-y, -z) for y, z in edge]]
        radius, angles = 0.5 * float(self.bore), -2.0 * math.pi / _BORE * np.arange(_BORE)
        loops += [[(radius * math.cos(a), cell + radius * math.sin(a)) for a in angles] for cell in cells]
        loops += [[(y, z + 0.5 * (low + high)) for y, z in self._pocket()] for low, high in pairwise(cells)]
        if self.corner_hole is not None:
            reach, middle = 0.5 * float(self.corner_hole), 0.25 * (float(self.width) + float(self.chamber))
            square = ((-reach, -reach), (-reach, reach), (reach, reach), (reach, -reach))
            corners = [(i * middle, k * (end - side + middle)) for i in (-1, 1) for k in (-1, 1)]
            loops += [[(y + dy, z + dz) for dy, dz in square] for y, z in corners]
        return [closed(each) for each in loops]

    def _rib(self) -> tuple[float, float, float]:
        """Half the chamber, half the core, and a rib's half thickness along the axes."""
        return 0.5 * float(self.chamber), 0.5 * float(self.core), float(self.rib) / math.sqrt(2.0)

    def _slot(self) -> list[Point]:
        """The slot in a cell's right side, upwards."""
        (chamber, core, rib), side = self._rib(), 0.5 * float(self.width)
        lip, opening = side - float(self.lip), 0.5 * float(self.opening)
        upper = [(core, core - rib), (chamber + rib, chamber), (lip, chamber), (lip, opening), (side, opening)]
        return [(y, -z) for y, z in reversed(upper)] + upper

    def _corner(self, side: float, end: float) -> list[Point]:
        """The upper right corner, anticlockwise."""
        if self.corner_radius is None:
            return [(side, end)]
        radius, angles = float(self.corner_radius), 0.5 * math.pi / _CORNER * np.arange(_CORNER + 1)
        return [(side - radius * (1.0 - math.cos(a)), end - radius * (1.0 - math.sin(a))) for a in angles]

    def _pocket(self) -> list[Point]:
        """The pocket between two cells about its middle, clockwise: its ribs are as thick as those to the cores."""
        (chamber, core, rib), side = self._rib(), 0.5 * float(self.width)
        wall = side - chamber - float(self.rib)
        right = [(core - rib, side - core), (chamber + float(self.rib) - rib, wall), (side - float(self.lip), wall)]
        half = right + [(y, -z) for y, z in reversed(right)]
        return half + [(-y, -z) for y, z in half]
