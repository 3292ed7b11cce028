"""Elliptical tube of constant wall."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from linkwright.core.sections.numeric import Number, maximum, minimum, sqrt
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import (
    CURVE_POINTS,
    Constraint,
    Dimension,
    Outline,
    Section,
    closed,
    common_properties,
    ellipse_points,
    hollow_torsion_modulus,
    opening,
    stress_area,
)
from linkwright.core.sections.wall import Arc, Wall, WallKind

NODES = 12
"""Points on a quarter of the ellipse, at the middles of equal steps of its parameter."""
STEP = 0.5 * math.pi / NODES
COSINES = tuple(math.cos((j + 0.5) * STEP) for j in range(NODES))
SINES = tuple(math.sin((j + 0.5) * STEP) for j in range(NODES))
FLOW = tuple(
    tuple(
        2.0
        / NODES
        * sum(
            math.cos((2 * k + 1) * (i + 0.5) * STEP) * math.sin((2 * k + 1) * (j + 0.5) * STEP) / (2 * k + 1)
            for k in range(NODES)
        )
        for j in range(NODES)
    )
    for i in range(NODES)
)
"""Integral from a node to the end of the quarter of what has odd sine harmonics only, from its values at the nodes."""

WHOLE = tuple(
    2.0 / NODES * sum(math.sin((2 * k + 1) * (j + 0.5) * STEP) / (2 * k + 1) for k in range(NODES))
    for j in range(NODES)
)
"""The same over the whole quarter."""

_ARC_STEPS = 8
"""Into how many steps of its parameter a quarter of an ellipse is parted."""


@dataclass(frozen=True)
class EllipticalTube(Section):
    """A tube whose outer edge is an ellipse and whose wall is equally thick everywhere, measured square to that edge.

    The inner edge is the curve parallel to the ellipse, which is no ellipse itself: not the hollow whose axes are
    shorter by two walls. It needs a wall below the least radius of curvature, half the square of the shorter axis
    over the longer one.

    Attributes:
        width: outer full axis along y, m.
        height: outer full axis along z, m.
        thickness: of the wall, m.
    """

    width: Number
    height: Number
    thickness: Number

    shape: ClassVar[str] = "elliptical_tube"
    synonyms: ClassVar[tuple[str, ...]] = ("oval_tube", "hollow_ellipse")
    dimensions: ClassVar[tuple[Dimension, ...]] = (
        Dimension("width", "outer axis across the bending plane", "outer"),
        Dimension("height", "outer axis in the bending plane", "outer"),
        Dimension("thickness", "wall thickness, the same everywhere", "wall"),
    )

    @property
    def inner_diameter(self) -> Number:
        """The least width of the hollow, m."""
        return minimum(*self.inner_widths)

    @property
    def inner_widths(self) -> tuple[Number, Number]:
        """Both axes of the hollow, m."""
        return self.width - 2.0 * self.thickness, self.height - 2.0 * self.thickness

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI); area, second and plastic moduli to 1e-6 for width / height from 0.3 to 3.

        J is Bredt's plus L t^3 / 4 (L the wall's middle line), which is exact for a thin circle and within 0.8 % for
        width / height from 0.3 to 3 and walls up to 0.8 of the greatest; shear areas there are within 0.5 %: they
        come from the shear flow with the first moment of the thick wall, while Poisson's part (below 0.1 %) is left
        out. The torsion modulus is `hollow_torsion_modulus`, up to 20 % above
        that of the stress inside a sharply curved end.
        """
        del poisson_ratio
        b, h, t = self.width, self.height, self.thickness
        up, right = _Quarter.of(b, h, t), _Quarter.of(h, b, t)
        area = 4.0 * up.sum([s * t - c * t**2 / 2.0 for s, c in zip(up.speed, up.turn, strict=True)])
        second_moment_y, second_moment_z = 4.0 * up.second_moment(), 4.0 * right.second_moment()
        perimeter = 4.0 * up.sum(up.speed)
        middle = perimeter - math.pi * t
        enclosed = 0.25 * math.pi * b * h - 0.5 * perimeter * t + 0.25 * math.pi * t**2
        torsion = 4.0 * enclosed**2 * t / middle + 0.25 * middle * t**3
        return common_properties(
            shear=(right.shear_factor(area, second_moment_z), up.shear_factor(area, second_moment_y)),
            area=area,
            second_moment_y=second_moment_y,
            second_moment_z=second_moment_z,
            torsion_constant=torsion,
            plastic_modulus_y=4.0 * weighted(WHOLE, up.first),
            plastic_modulus_z=4.0 * weighted(WHOLE, right.first),
            torsion_modulus=hollow_torsion_modulus(enclosed, t, torsion),
            shear_stress_area_y=stress_area(second_moment_z, 2.0 * t, 2.0 * weighted(WHOLE, right.first)),
            shear_stress_area_z=stress_area(second_moment_y, 2.0 * t, 2.0 * weighted(WHOLE, up.first)),
            width=b,
            height=h,
        )

    @property
    def greatest_radius(self) -> Number:
        """Half of its longer axis, m."""
        return 0.5 * maximum(self.width, self.height)

    def outline(self) -> Outline:
        """The ellipse, and the curve a wall inside it."""
        p, q = 0.5 * self.width, 0.5 * self.height
        angle = np.arange(CURVE_POINTS) * (-2.0 * math.pi / CURVE_POINTS)
        c, s = np.cos(angle), np.sin(angle)
        inward = self.thickness / np.hypot(q * c, p * s)
        hole = [(float(y), float(z)) for y, z in zip(c * (p - inward * q), s * (q - inward * p), strict=True)]
        return [ellipse_points(self.width, self.height), closed(hole)]

    def constraints(self) -> tuple[Constraint, ...]:
        """The wall must stay below the radius of curvature at both ends of both axes."""
        sides = (("curvature_width", self.width, self.height), ("curvature_height", self.height, self.width))
        return tuple(
            opening(name, "the wall", "the least radius of curvature", 2.0 * self.thickness * one / other**2)
            for name, one, other in sides
        )

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...]:
        """As a round tube of the curvature radius there: one axis squared over the other where its slenderness is asked
        for. Both are told, so that an optimiser meets no kink."""
        del web
        b, h, t = self.width, self.height, self.thickness
        half_b, half_h = 0.5 * (b - t), 0.5 * (h - t)
        arcs: list[tuple[Arc, ...]] = [(), ()]
        for step in range(_ARC_STEPS + 1):
            angle = 0.5 * math.pi * step / _ARC_STEPS
            cosine, sine = math.cos(angle), math.sin(angle)
            radius = ((half_b * sine) ** 2 + (half_h * cosine) ** 2) ** 1.5 / (half_b * half_h)
            # The points nearer to the top belong to it, the others to the sides.
            top = 2 * step >= _ARC_STEPS
            arcs[top] += (Arc(radius, 0.5 * b + half_b * cosine, 0.5 * h + half_h * sine),)
        enclosed = math.pi * half_b * half_h
        return (
            Wall("flange", "top and bottom of the wall", "round", b**2 / h, t, arcs=arcs[1], encloses=enclosed),
            Wall("web", "the sides of the wall", "round", h**2 / b, t, arcs=arcs[0], encloses=enclosed),
        )


def weighted(weights: Sequence[float], values: Sequence[Number]) -> Number:
    """Sum of products."""
    total: Number = 0.0
    for weight, value in zip(weights, values, strict=True):
        total = total + weight * value
    return total


@dataclass(frozen=True)
class _Quarter:
    """A quarter of the wall at its nodes, for bending about the axis across the direction ``along``.

    Attributes:
        thickness: m.
        along: outer axis along the force, m.
        across: the other one, m.
        speed: length of the outer edge per step of the parameter, m.
        turn: change of its direction per step.
        place: distance of the outer edge from the axis of bending, m.
        slope: component of the outward normal along the force.
        first: first moment of the wall per step, m^3.
    """

    thickness: Number
    along: Number
    across: Number
    speed: Sequence[Number]
    turn: Sequence[Number]
    place: Sequence[Number]
    slope: Sequence[Number]
    first: Sequence[Number]

    @classmethod
    def of(cls, across: Number, along: Number, t: Number) -> _Quarter:
        p, q = 0.5 * across, 0.5 * along
        speed = [sqrt((p * s) ** 2 + (q * c) ** 2) for c, s in zip(COSINES, SINES, strict=True)]
        turn = [p * q / v**2 for v in speed]
        place = [q * s for s in SINES]
        slope = [p * s / v for s, v in zip(SINES, speed, strict=True)]
        # Integral over the wall of (z - n m) (v - n c) dn: z the place, m the slope, v the speed, c the turn.
        first = [
            v * (z * t - m * t**2 / 2.0) - c * (z * t**2 / 2.0 - m * t**3 / 3.0)
            for v, c, z, m in zip(speed, turn, place, slope, strict=True)
        ]
        return cls(t, along, across, speed, turn, place, slope, first)

    def sum(self, values: Sequence[Number]) -> Number:
        total: Number = 0.0
        for value in values:
            total = total + value
        return STEP * total

    def second_moment(self) -> Number:
        """Of the quarter, m^4: the wall's (z - n m)^2 (v - n c), integrated across it."""
        t = self.thickness
        rows = zip(self.speed, self.turn, self.place, self.slope, strict=True)
        return self.sum(
            [
                v * (z**2 * t - z * m * t**2 + m**2 * t**3 / 3.0)
                - c * (z**2 * t**2 / 2.0 - 2.0 * z * m * t**3 / 3.0 + m**2 * t**4 / 4.0)
                for v, c, z, m in rows
            ]
        )

    def shear_factor(self, area: Number, second_moment: Number) -> Number:
        """A / A_s from the shear flow, less what the wall's thickness evens out (within 0.3 % of a wall's share)."""
        t = self.thickness
        energies: list[Number] = []
        for row, v, c in zip(FLOW, self.speed, self.turn, strict=True):
            flow = weighted(row, self.first)
            energies.append(flow**2 * (v - 0.5 * c * t) / t)
        evened = 1.0 - 0.9 * (t / self.along) ** 2 * self.across / (self.across + self.along)
        return 4.0 * area / second_moment**2 * self.sum(energies) * evened
