"""The edges of cross-sections as CAD programs hold them: straight lines, arcs and ellipses, not chords of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.section import Section
from linkwright.core.sections.shapes.circle import Circle
from linkwright.core.sections.shapes.ellipse import Ellipse
from linkwright.core.sections.shapes.elliptical_tube import EllipticalTube
from linkwright.core.sections.shapes.i_section import ISection
from linkwright.core.sections.shapes.rectangle import box
from linkwright.core.sections.shapes.rectangular_tube import RectangularTube
from linkwright.core.sections.shapes.tube import Tube

Point: TypeAlias = tuple[float, float]
"""Across and along the height, m from the centroid."""

_Radius: TypeAlias = Callable[[Point], float]

_ARCS = 64
"""That stand for a curve which is neither line, arc nor ellipse: the area within is true to 1e-6 where its axes are as
2 to 1, to 5e-6 where they are as 3 to 1."""
_LEAST_RADIUS, _LEAST_LINE = 1e-7, 1e-6
"""m, and relative: what is left of an arc or a line at the end of a taper where there is none, so that each edge of one
end has its like at the other."""


@dataclass(frozen=True)
class Ring:
    """An ellipse about the centroid; half axes, m."""

    across: float
    high: float


@dataclass(frozen=True)
class Corners:
    """A polygon whose corners may be rounded, each by its radius (m; 0: sharp)."""

    points: tuple[Point, ...]
    radii: tuple[float, ...]


@dataclass(frozen=True)
class Line:
    """A straight edge."""

    first: Point
    second: Point


@dataclass(frozen=True)
class Arc:
    """An arc through three points."""

    first: Point
    middle: Point
    second: Point


@dataclass(frozen=True)
class Arcs:
    """Arcs one after another, all around."""

    arcs: tuple[Arc, ...]


Contour: TypeAlias = Ring | Corners | Arcs


def contours(section: Section) -> list[Contour]:
    """The outer edge, then those of holes. A shape of another kind has the lines of its `outline`."""
    match section:
        case Circle():
            return [Ring(0.5 * section.diameter, 0.5 * section.diameter)]
        case Tube():
            outer = 0.5 * section.diameter
            return [Ring(outer, outer), Ring(outer - section.thickness, outer - section.thickness)]
        case Ellipse():
            return [Ring(0.5 * section.width, 0.5 * section.height)]
        case EllipticalTube():
            return [Ring(0.5 * section.width, 0.5 * section.height), _parallel(section)]
        case RectangularTube() if section.radii is not None:
            flange, web = section.walls
            inner = section.width - 2.0 * web, section.height - 2.0 * flange
            sizes = ((section.width, section.height), inner)
            pairs = zip(sizes, section.radii, strict=True)
            return [_sharp(box(*size), lambda _, radius=radius: float(radius)) for size, radius in pairs]
        case ISection() if section.root_radius is not None:
            radius, half = float(section.root_radius), 0.5 * section.web_thickness
            roots = ISection(**{name: value for name, value in section.given().items() if name != "root_radius"})
            return [
                _sharp(roots.outline()[0], lambda point: radius if math.isclose(abs(point[0]), half) else 0.0),
            ]
        case _:
            return [_sharp(loop, lambda _: 0.0) for loop in section.outline()]


def edges(contour: Corners, keep: Sequence[bool] = ()) -> list[Line | Arc]:
    """The edges of a polygon, one after another; a rounded corner is an arc. So is one to `keep` as such whatever its
    radius, and between those a line is left."""
    points = [np.array(item) for item in contour.points]
    count = len(points)
    radii = list(contour.radii)
    if keep:
        radii = [max(radius, _LEAST_RADIUS * kept) for radius, kept in zip(radii, keep, strict=True)]
    sides = [float(np.linalg.norm(points[(k + 1) % count] - points[k])) for k in range(count)]
    ways = [_unit(points[(k + 1) % count] - points[k]) for k in range(count)]
    halves = [0.5 * math.acos(float(np.clip(-ways[k - 1] @ ways[k], -1.0, 1.0))) for k in range(count)]
    if keep:
        taken = [radius / math.tan(half) for radius, half in zip(radii, halves, strict=True)]
        full = [taken[k] + taken[(k + 1) % count] > (1.0 - _LEAST_LINE) * sides[k] for k in range(count)]
        radii = [radius * (1.0 - _LEAST_LINE * (full[k] or full[k - 1])) for k, radius in enumerate(radii)]
    arcs: list[Arc | None] = []
    for k, (point, radius, half) in enumerate(zip(points, radii, halves, strict=True)):
        if not radius:
            arcs.append(None)
            continue
        reach = radius / math.tan(half)
        middle = point + radius * (1.0 / math.sin(half) - 1.0) * _unit(ways[k] - ways[k - 1])
        arcs.append(Arc(_point(point - reach * ways[k - 1]), _point(middle), _point(point + reach * ways[k])))
    lines: list[Line | Arc] = []
    for k, (arc, following) in enumerate(zip(arcs, [*arcs[1:], arcs[0]], strict=True)):
        if arc is not None:
            lines.append(arc)
        first = contour.points[k] if arc is None else arc.second
        second = contour.points[(k + 1) % count] if following is None else following.first
        if math.dist(first, second) > _NOTHING:
            lines.append(Line(first, second))
    return lines


_NOTHING = 1e-9
"""m; arcs that meet leave no line between them."""


def _unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    return vector / float(np.linalg.norm(vector))


def _point(place: NDArray[np.float64]) -> Point:
    return float(place[0]), float(place[1])


def _sharp(loop: NDArray[np.float64], radius: _Radius) -> Corners:
    points = tuple(_point(item) for item in loop[:-1])
    return Corners(points, tuple(radius(point) for point in points))


def _parallel(section: EllipticalTube) -> Arcs:
    """The inner edge of an elliptical tube, a wall inside its ellipse."""
    p, q = 0.5 * float(section.width), 0.5 * float(section.height)
    angle = np.arange(2 * _ARCS + 1) * (math.pi / _ARCS)
    c, s = np.cos(angle), np.sin(angle)
    inward = float(section.thickness) / np.hypot(q * c, p * s)
    points = [_point(item) for item in np.column_stack((c * (p - inward * q), s * (q - inward * p)))]
    points[-1] = points[0]
    return Arcs(tuple(Arc(*points[k : k + 3]) for k in range(0, 2 * _ARCS, 2)))
