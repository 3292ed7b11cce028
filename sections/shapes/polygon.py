"""Solid or hollow polygon of given points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.formulas.outlines import Outlined, about_centroid, with_shear
from linkwright.core.sections.formulas.saint_venant import moments
from linkwright.core.sections.numeric import Number
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import Dimension, Outline, Section, SectionError, closed, poisson_square

Points: TypeAlias = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Polygon(Section):
    """A simple polygon with holes, of plain numbers; it has no design variables but can be `scaled`.

    Lists of points are accepted and kept as tuples. Raises SectionError (a ValueError) when an edge crosses
    another, when a hole is not wholly inside, or when a loop encloses no area.

    Attributes:
        points: (y, z) of the outer edge in either sense, not repeated at the end, m.
        holes: the same for each hole.
    """

    points: Points
    holes: tuple[Points, ...] = ()

    shape: ClassVar[str] = "polygon"
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("points", "corners of the outer edge, [y, z] each", "points"),
        Dimension("holes", "corners of each hole", "points", optional=True),
    )

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", _as_points("points", self.points))
        object.__setattr__(self, "holes", tuple(_as_points("holes", hole) for hole in self.holes))
        _check_simple("points", np.array(self.points))
        outer = np.array(self.points)
        seen: list[NDArray[np.float64]] = []
        for number, hole in enumerate(self.holes, start=1):
            loop = np.array(hole)
            _check_simple("holes", loop)
            if _crossing(outer, loop) is not None or not _inside(loop[0], outer):
                raise SectionError("holes", f"hole {number} is not wholly inside the outer edge")
            for other, earlier in enumerate(seen, start=1):
                if _crossing(earlier, loop) is not None or _inside(loop[0], earlier) or _inside(earlier[0], loop):
                    raise SectionError("holes", f"hole {number} overlaps hole {other}")
            seen.append(loop)

    @cached_property
    def _outlined(self) -> Outlined:
        return Outlined(about_centroid([np.array(self.points)] + [np.array(hole) for hole in self.holes]))

    @property
    def inner_diameter(self) -> Number | None:
        """0 without holes; None with some, whose shapes say nothing of what fits through."""
        return None if self.holes else 0.0

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI) about axes parallel to the given ones; area and second moments exact.

        J, shear areas, shear centre and warping constant come from a boundary element solution, within 0.2 % for walls
        down to a hundredth of the outer size. Shear areas are those for a force along y or z, also where these are not
        principal axes. Section moduli are I over the extreme fibre, meaningful where product_moment_yz is zero. The
        torsion modulus leaves out the tenth of each edge next to a re-entrant corner, where theory has an unbounded
        stress.
        """
        return with_shear(self._outlined.figures, poisson_square(poisson_ratio))

    @property
    def greatest_radius(self) -> float:
        """How far its farthest corner is from the centroid, m."""
        return max(float(np.linalg.norm(ring, axis=1).max()) for ring in self.outline())

    def outline(self) -> Outline:
        """The polygon and its holes."""
        return [closed([(float(y), float(z)) for y, z in loop]) for loop in self._outlined.loops]

    def check(self) -> tuple[str, ...]:
        """Nothing: a polygon that exists has passed its checks."""
        return ()

    def scaled(self, factor: Number) -> Self:
        """The polygon with all points multiplied by a factor (plain number)."""
        return type(self)(
            tuple((y * factor, z * factor) for y, z in self.points),
            tuple(tuple((y * factor, z * factor) for y, z in hole) for hole in self.holes),
        )

    def rotated(self, angle: float) -> Self:
        """The polygon turned anticlockwise about the origin of its points, angle in rad."""
        c, s = float(np.cos(angle)), float(np.sin(angle))
        return type(self)(
            tuple((c * y - s * z, s * y + c * z) for y, z in self.points),
            tuple(tuple((c * y - s * z, s * y + c * z) for y, z in hole) for hole in self.holes),
        )

    @classmethod
    def contradiction(cls, outer: tuple[float, float], wall: tuple[float, float]) -> str | None:
        """A polygon is fixed: it cannot be chosen within bounds."""
        del outer, wall
        return "polygon: its points are fixed, so it cannot be chosen within bounds"


def _as_points(key: str, points: Any) -> Points:
    try:
        array = np.asarray(points, dtype=float)
    except (TypeError, ValueError) as error:
        raise SectionError(key, "corners must be pairs of plain numbers") from error
    if array.ndim != 2 or array.shape[1] != 2 or not np.all(np.isfinite(array)):
        raise SectionError(key, "corners must be pairs of plain finite numbers")
    if len(array) > 1 and np.array_equal(array[0], array[-1]):
        array = array[:-1]
    if len(array) < 3:
        raise SectionError(key, "a polygon needs at least three corners")
    return tuple((float(y), float(z)) for y, z in array)


def _check_simple(key: str, loop: NDArray[np.float64]) -> None:
    if np.any(np.all(loop == np.roll(loop, -1, axis=0), axis=1)):
        raise SectionError(key, "two neighbouring corners coincide")
    crossing = _crossing(loop, loop)
    if crossing is not None:
        first, second = crossing
        raise SectionError(key, f"edges {first + 1} and {second + 1} of the polygon cross or touch")
    size = float(np.ptp(loop, axis=0).max())
    if abs(moments([loop - loop[0]]).area) < 1e-12 * size**2:
        raise SectionError(key, "the polygon encloses no area")


def _crossing(first: NDArray[np.float64], second: NDArray[np.float64]) -> tuple[int, int] | None:
    """Indices of a pair of edges, one of each loop, that meet; edges that share a corner of one loop do not
    count."""
    same = first is second
    p, q = first[:, None, :], np.roll(first, -1, axis=0)[:, None, :]
    a, b = second[None, :, :], np.roll(second, -1, axis=0)[None, :, :]

    def side(start: Sequence[Any] | Any, end: Any, point: Any) -> NDArray[np.float64]:
        u, v = end - start, point - start
        scale = np.hypot(u[..., 0], u[..., 1]) * np.hypot(v[..., 0], v[..., 1]) + 1e-300
        value = (u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]) / scale
        return np.where(np.abs(value) < 1e-12, 0.0, np.sign(value))

    straddle = (side(p, q, a) * side(p, q, b) <= 0) & (side(a, b, p) * side(a, b, q) <= 0)
    low, high = np.minimum(p, q), np.maximum(p, q)
    boxes = np.all((np.minimum(a, b) <= high) & (np.maximum(a, b) >= low), axis=-1)
    meet = straddle & boxes
    if same:
        count = len(first)
        index = np.arange(count)
        gap = (index[:, None] - index[None, :]) % count
        # Neighbours share a corner; they may only not fold back on one another.
        forward = q[:, 0] - p[:, 0]
        after = np.roll(forward, -1, axis=0)
        cross = forward[:, 0] * after[:, 1] - forward[:, 1] * after[:, 0]
        lengths = np.hypot(*forward.T) * np.hypot(*after.T)
        back = (np.abs(cross) < 1e-12 * lengths) & (np.einsum("ek,ek->e", forward, after) < 0)
        if back.any():
            edge = int(np.argmax(back))
            return edge, (edge + 1) % count
        meet &= (gap > 1) & (gap < count - 1)
    result = np.argwhere(meet)
    return (int(result[0][0]), int(result[0][1])) if len(result) else None


def _inside(point: NDArray[np.float64], loop: NDArray[np.float64]) -> bool:
    """Whether a point is inside a loop, by counting edges to its right."""
    y0, z0 = loop.T
    y1, z1 = np.roll(loop, -1, axis=0).T
    spans = (z0 > point[1]) != (z1 > point[1])
    height = np.where(spans, z1 - z0, 1.0)
    return bool(np.count_nonzero(spans & (point[0] < y0 + (point[1] - z0) / height * (y1 - y0))) % 2)
