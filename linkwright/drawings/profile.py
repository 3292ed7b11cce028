"""Shapes by the drawing of their outline: the closed edges of a DXF file."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from linkwright.core.sections import Dimension, Number, Outline, Polygon, Section, SectionError
from linkwright.core.sections.numeric import Array
from linkwright.core.units.extras import not_installed
from linkwright.core.units.quantities import InputError

_CHORD = 5e-4
"""How far chords of curves may lie inside them, of the drawing's height."""
_JOINED = 1e-6
"""How far apart ends of edges that meet may be, of the drawing's size."""


@dataclass(frozen=True)
class Drawn(Section):
    """A section that looks like a drawing, of any height.

    Attributes:
        height: m.
    """

    height: Number

    drawing: ClassVar[Path]
    dimensions: ClassVar[tuple[Dimension, ...]] = (Dimension("height", "height of the drawing", "outer"),)

    @property
    def inner_diameter(self) -> Number | None:
        """Not known: drawings say nothing of what fits through."""
        return None

    def outline(self) -> Outline:
        """The drawing's edges, curves as chords."""
        return [loop * float(self.height) for loop in _of_height_one(self.drawing)]


def shape_from_dxf(path: Path, name: str, *, solid: bool = False) -> type[Section]:
    """A shape that looks like a drawing. Raises `InputError` where that has no outline."""
    made = type(
        "".join(part.capitalize() for part in name.split("_")),
        (Drawn,),
        {"shape": name, "drawing": path, "solid": solid, "__doc__": f"A section as drawn in {path.name}."},
    )
    _of_height_one(path)
    return made


@lru_cache(maxsize=64)
def _of_height_one(path: Path) -> tuple[Array, ...]:
    """The outer edge, then holes, closed, about the centroid, for a drawing of height one."""
    loops = sorted(_loops(path), key=lambda loop: -abs(_area(loop)))
    if not loops:
        raise InputError(path, "", "has no closed outline in its model space; edges must meet, or be closed polylines")
    size = float(np.ptp(loops[0][:, 1]))
    try:
        edges = [[(float(y), float(z)) for y, z in loop / size] for loop in loops]
        return tuple(Polygon(tuple(edges[0]), tuple(tuple(hole) for hole in edges[1:])).outline())
    except SectionError as error:
        raise InputError(path, "", f"its outline cannot be: {error.message}") from None


def _loops(path: Path) -> Iterator[Array]:
    """Closed edges in the drawing's unit, (N, 2) without the first point at the end. Raises `InputError`."""
    try:
        import ezdxf
        from ezdxf.path import make_path  # pyright: ignore[reportPrivateImportUsage]
    except ModuleNotFoundError:
        raise InputError(path, "", not_installed("DXF", "ezdxf", "dxf")) from None

    try:
        document = ezdxf.readfile(path)  # pyright: ignore[reportPrivateImportUsage]
    except OSError as error:
        raise InputError(path, "", f"cannot be read: {error.strerror or 'it is no DXF file'}") from None
    except ezdxf.DXFStructureError as error:  # pyright: ignore[reportPrivateImportUsage]
        raise InputError(path, "", f"is no sound DXF file: {error}") from None
    known = "LWPOLYLINE POLYLINE CIRCLE ELLIPSE SPLINE LINE ARC"
    edges = [make_path(entity) for entity in document.modelspace().query(known)]  # type: ignore[arg-type]
    every = [point for edge in edges for point in edge.control_vertices()]
    if not every:
        return
    size = max(math.dist(point, every[0]) for point in every)
    lines = [np.array([(at.x, at.y) for at in edge.flattening(_CHORD * size)]) for edge in edges]
    yield from _joined(lines, _JOINED * size)


def _joined(lines: list[Array], near: float) -> Iterator[Array]:
    """Loops of lines that end where others begin. What does not close is no edge of the section."""
    rest = list(lines)
    while rest:
        loop = rest.pop()
        while math.dist(loop[0], loop[-1]) > near:
            at, turned = _following(loop[-1], rest, near)
            if at is None:
                break
            line = rest.pop(at)
            loop = np.vstack((loop, (line[::-1] if turned else line)[1:]))
        else:
            apart = np.hypot(*np.diff(loop, axis=0).T) > near
            yield loop[:-1][apart]


def _following(end: Any, lines: list[Array], near: float) -> tuple[int | None, bool]:
    """Which line goes on from a point, and whether from its last point to its first."""
    for number, line in enumerate(lines):
        for turned, start in ((False, line[0]), (True, line[-1])):
            if math.dist(end, start) <= near:
                return number, turned
    return None, False


def _area(loop: Array) -> float:
    y, z = loop.T
    return 0.5 * float(y @ np.roll(z, -1) - z @ np.roll(y, -1))
