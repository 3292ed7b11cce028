"""What every cross-section offers: its properties, its outline, and the variables by which to optimise it."""

from __future__ import annotations

import dataclasses
import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar, Literal, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.formulas.by_ratios import FITTED, figures_by_ratios, fitted_range
from linkwright.core.sections.formulas.outlines import with_shear
from linkwright.core.sections.numeric import Number, is_symbol, sqrt
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.wall import Wall, WallKind

Bounds: TypeAlias = tuple[float, float]
"""Least and greatest allowed value, m (or m^2 for an area)."""

Outline: TypeAlias = list[NDArray[np.float64]]
"""Closed polylines, the outer edge first (anticlockwise), then the holes; N x 2 arrays of (y, z), m."""

LEAST_OPENING = 0.02
"""A hollow or flanged section keeps at least this fraction of its size free of wall."""

_ANY_POISSON_RATIO = 0.3
_ALSO_CALLED = MappingProxyType(
    {
        "diameter": ("d", "dia", "outer_diameter", "od", "size"),
        "thickness": ("t", "wall", "wall_thickness"),
        "width": ("b", "breadth"),
        "height": ("h", "depth"),
    }
)

CURVE_POINTS = 96
"""Points on a drawn circle or ellipse."""


class SectionError(ValueError):
    """A section that cannot be; ``key`` names the dimension (or ``shape``) at fault.

    Attributes:
        key: the dimension's name, or ``shape``.
        message: one line, without the key.
    """

    def __init__(self, key: str, message: str) -> None:
        super().__init__(f"{key}: {message}")
        self.key = key
        self.message = message


@dataclass(frozen=True)
class Dimension:
    """A dimension by which people describe a shape.

    Attributes:
        name: as in arm files, also the attribute of the shape.
        meaning: one phrase.
        kind: ``outer`` (bounded by a problem's section_size) or ``wall`` (by its thickness), ``radius``
            (of a fillet or a corner, fixed) or ``points``.
        optional: may be left out always.
        unless: may be left out when all of these are given instead.

    >>> import linkwright as lw
    >>> lw.Dimension("side", "side of the square", "outer").kind
    'outer'
    """

    name: str
    meaning: str
    kind: Literal["outer", "wall", "radius", "points"]
    optional: bool = False
    unless: tuple[str, ...] = ()

    @property
    def synonyms(self) -> tuple[str, ...]:
        """What people call it as well."""
        return _ALSO_CALLED.get(self.name, ())


@dataclass(frozen=True)
class DesignVariable:
    """A quantity that an optimiser chooses.

    Attributes:
        name: for reports.
        meaning: one phrase.
        kind: ``outer`` and ``wall`` are lengths (m), ``area`` an area (m^2).
        logarithmic: whether mass and deflection are convex in its logarithm rather than in itself.
    """

    name: str
    meaning: str
    kind: Literal["outer", "wall", "area"]
    logarithmic: bool = True


def design_variables(dimensions: Sequence[Dimension], *names: str) -> tuple[DesignVariable, ...]:
    """The lengths among the dimensions that have these names, as design variables."""
    kinds = {dimension.name: dimension for dimension in dimensions}
    result = ((kinds[name], kinds[name].kind) for name in names)
    return tuple(DesignVariable(item.name, item.meaning, kind) for item, kind in result if kind in ("outer", "wall"))


@dataclass(frozen=True)
class Constraint:
    """A dimensionless inequality; the section is allowed where ``value <= 0``.

    Attributes:
        name: short identifier.
        text: the inequality in words, for reports.
        value: a float, array or CasADi expression.
    """

    name: str
    text: str
    value: Number


class Section(ABC):
    """A cross-section; every concrete shape is a frozen dataclass of its dimensions in metres.

    Dimensions may be floats, NumPy arrays (all of one shape) or CasADi expressions; the same formulas serve
    all.

    >>> import linkwright as lw
    >>> [each.name for each in lw.shapes["tube"].dimensions]
    ['diameter', 'thickness']
    """

    shape: ClassVar[str]
    """Name in arm files."""
    synonyms: ClassVar[tuple[str, ...]] = ()
    """What people call the shape as well, for who is told its name."""
    dimensions: ClassVar[tuple[Dimension, ...]]
    """What describes the shape."""
    variables: ClassVar[tuple[DesignVariable, ...]]
    """What an optimiser chooses; empty where the shape is fixed. By default the dimensions that have to be given."""
    solid: ClassVar[bool] = False
    """Whether it has no walls that could buckle."""
    open: ClassVar[bool] = False
    """Whether no wall closes on itself, so that there is no hollow."""
    most_wall: ClassVar[float] = 0.5
    """The wall at which nothing is left open, as a fraction of the outer size where all outer sizes are equal."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "dimensions" in vars(cls) and "variables" not in vars(cls):
            needed = [
                dimension.name
                for dimension in cls.dimensions
                if dimension.kind in ("outer", "wall") and not dimension.optional
            ]
            # An outline is fitted to one ratio; of several, sizes come from lists.
            fitted = cls.properties is not Section.properties or len(needed) <= FITTED
            cls.variables = design_variables(cls.dimensions, *(needed if fitted else ()))

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Geometric properties (SI); the Poisson's ratio of the material enters the shear areas only.

        A shape that has no formulas leaves this to its outline (`formulas.outlines`): area and moments are those within
        it, J, shear areas, shear centre and warping constant a boundary element solution, within 0.2 % for walls down
        to a hundredth of the size, kept by ratios of dimensions. Of one ratio (a tube's wall over its width) they are
        fitted once, within 0.1 % (the torsion modulus within 1 %), so that an optimiser may choose both dimensions. Of
        several, dimensions are plain numbers. Raises SectionError otherwise.
        """
        sizes = self.given()
        name = next((item.name for item in self.dimensions if item.kind == "outer" and item.name in sizes), "")
        if not name:
            raise SectionError("shape", f"a {self.shape} without `properties` needs a dimension of kind 'outer'")
        size = sizes.pop(name)
        ratios = {other: value / size for other, value in sizes.items()}
        parts = {dimension.name: dimension.kind for dimension in self.dimensions}
        span = None
        if self.variables and len(ratios) == 1:
            span = fitted_range(parts[next(iter(ratios))], self.most_wall * (1.0 - LEAST_OPENING))
        figures = figures_by_ratios(type(self), name, ratios, span)
        if figures is None:
            raise SectionError("shape", f"a {self.shape} has no formulas for sizes that are to be chosen")
        return with_shear(figures, poisson_square(poisson_ratio), size)

    @property
    def greatest_radius(self) -> Number:
        """How far it reaches from its centroid at most, m; where a shape says nothing, as far as the corner of a box
        about it."""
        properties = self.properties(_ANY_POISSON_RATIO)
        return sqrt(properties.extreme_fibre_y**2 + properties.extreme_fibre_z**2)

    @abstractmethod
    def outline(self) -> Outline:
        """Polylines for drawing to scale, in metres about the centroid (y right, z up); plain floats only."""

    @property
    def ends(self) -> tuple[Section, ...]:
        """The section at both ends of a link; one alone where it is the same all along."""
        return (self,)

    def wall_parts(self, web: WallKind) -> tuple[Wall, ...] | None:
        """Its walls, their places counted from the left and lower edge of its bounding box; `web` says how a wall along
        the height counts that may be bent about its middle. None where they are not known."""
        del web
        return () if self.solid else None

    def together(self) -> tuple[Wall, ...]:
        """Several walls that are limited together as one, beside each by itself."""
        return ()

    def given(self) -> dict[str, Any]:
        """The dimensions that were given, by name, as an arm file would hold them (m)."""
        named = {dimension.name: getattr(self, dimension.name) for dimension in self.dimensions}
        return {name: value for name, value in named.items() if value is not None}

    @property
    def inner_diameter(self) -> Number | None:
        """Diameter of the thickest round cable that fits through the closed hollow, m: 0 where there is none; None
        where the shape has walls and does not say."""
        return None if not self.open and any(dimension.kind == "wall" for dimension in self.dimensions) else 0.0

    @property
    def inner_widths(self) -> tuple[Number, ...] | None:
        """Widths of the closed hollow, m, the least of which is the inner diameter: apart, each is smooth."""
        result = self.inner_diameter
        return None if result is None else (result,)

    def scaled(self, factor: Number) -> Self:
        """The same section with every dimension multiplied by a factor."""
        fields = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}  # type: ignore[arg-type]
        return type(self)(**{name: v if v is None else v * factor for name, v in fields.items()})

    # ---- validity

    def constraints(self) -> tuple[Constraint, ...]:
        """Inequalities between dimensions that make the section possible (walls that fit inside, say)."""
        return ()

    def check(self) -> tuple[str, ...]:
        """The conditions that the section violates, as text; conditions on symbols are not judged."""
        broken = [
            f"{name} must be positive"
            for name, value in self.given().items()
            if not is_symbol(value) and not np.all(np.asarray(value, dtype=float) > 0.0)
        ]
        if broken:
            return tuple(broken)
        judged = (c for c in self.constraints() if not is_symbol(c.value))
        return tuple(c.text for c in judged if not np.all(np.asarray(c.value) <= 1e-9))

    # ---- for the optimiser

    @classmethod
    def from_variables(cls, values: Sequence[Number]) -> Self:
        """The section whose design variables have these values, in the order of ``variables`` (SI)."""
        if len(values) != len(cls.variables):
            raise ValueError(f"{cls.shape} has {len(cls.variables)} design variables, not {len(values)}")
        return cls(**{variable.name: value for variable, value in zip(cls.variables, values, strict=True)})

    def variable_values(self) -> tuple[Number, ...]:
        """The values of the design variables of this section, in the order of ``variables`` (SI)."""
        return tuple(getattr(self, variable.name) for variable in self.variables)

    @classmethod
    def variable_bounds(cls, outer: Bounds, wall: Bounds) -> tuple[Bounds, ...]:
        """Least and greatest value of each design variable, given those of outer sizes and of walls (m)."""
        return tuple(outer if variable.kind == "outer" else wall for variable in cls.variables)

    def bound_constraints(self, outer: Bounds, wall: Bounds) -> tuple[Constraint, ...]:
        """Bounds on dimensions that are not design variables themselves (the wall of a tube), and on the ratio by which
        properties from an outline are fitted."""
        del outer, wall
        if type(self).properties is not Section.properties or len(self.variables) != FITTED:
            return ()
        (whole, size), (part, value) = ((item, getattr(self, item.name)) for item in self.variables)
        low, high = fitted_range(part.kind, self.most_wall * (1.0 - LEAST_OPENING))
        text = f"{part.name} must stay between {low:g} and {high:g} of the {whole.name}"
        return (
            Constraint(f"{part.name}_least", text, low - value / size),
            Constraint(f"{part.name}_most", text, value / size - high),
        )

    @classmethod
    def contradiction(cls, outer: Bounds, wall: Bounds) -> str | None:
        """Why no section of this shape fits the bounds (m), in one line; None where some section does."""
        for label, (low, high) in (("section_size", outer), ("thickness", wall)):
            used = label == "section_size" or any(d.kind == "wall" for d in cls.dimensions)
            if used and not 0.0 < low <= high:
                return f"{label}: {low * 1e3:g} mm must be positive and not above {high * 1e3:g} mm"
        if not cls.variables:
            return (
                f"{cls.shape}: its properties come from its outline, and of more than {FITTED} dimensions no formula "
                "is made; give their values, or take stock sizes"
            )
        has_walls = any(d.kind == "wall" for d in cls.dimensions)
        if has_walls and wall[0] > cls.most_wall * (1.0 - LEAST_OPENING) * outer[1]:
            return (
                f"{cls.shape}: walls of at least {wall[0] * 1e3:g} mm do not fit into an outer size of "
                f"at most {outer[1] * 1e3:g} mm"
            )
        return None

    @classmethod
    def start(cls, area: float, outer: Bounds, wall: Bounds) -> Self:
        """A section inside the bounds (m) whose area (m^2) is as near to the wanted one as they allow.

        All outer sizes are equal, and so are all walls. Raises SectionError where the bounds contradict
        each other.
        """
        from scipy.optimize import brentq  # commands that only look things up load no solver

        reason = cls.contradiction(outer, wall)
        if reason is not None:
            raise SectionError("shape", reason)

        def at(fraction: float) -> Self:
            """Sections from the smallest to the largest, geometrically; walls kept inside."""
            size = outer[0] * (outer[1] / outer[0]) ** fraction
            size = max(size, wall[0] / (cls.most_wall * (1.0 - 2.0 * LEAST_OPENING))) if has_walls else size
            size = min(size, outer[1])
            most = cls.most_wall * (1.0 - LEAST_OPENING) * size
            thickness = min(wall[0] * (wall[1] / wall[0]) ** fraction, most)
            return cls.uniform(size, thickness)

        has_walls = any(d.kind == "wall" for d in cls.dimensions)

        def short(fraction: float) -> float:
            """By how much (in its logarithm) the area is too small; it grows all along."""
            return math.log(area / float(at(fraction).properties(0.3).area))

        if short(0.0) <= 0.0:
            return at(0.0)
        return at(1.0) if short(1.0) >= 0.0 else at(float(brentq(short, 0.0, 1.0)))  # type: ignore[arg-type]

    @classmethod
    def uniform(cls, size: float, thickness: float) -> Self:
        """The section with all outer dimensions and all walls equal (m)."""
        return cls.from_variables([size if v.kind == "outer" else thickness for v in cls.variables])


def ellipse_points(width: float, height: float, *, clockwise: bool = False) -> NDArray[np.float64]:
    """A closed polyline on an ellipse about the origin, (CURVE_POINTS + 1) x 2, m."""
    angle = np.arange(CURVE_POINTS) * (2.0 * math.pi / CURVE_POINTS) * (-1.0 if clockwise else 1.0)
    points = np.column_stack((0.5 * width * np.cos(angle), 0.5 * height * np.sin(angle)))
    return np.vstack((points, points[:1]))


def closed(points: Sequence[tuple[float, float]]) -> NDArray[np.float64]:
    """The points as an array, the first repeated at the end, (N + 1) x 2, m."""
    array = np.asarray(points, dtype=float)
    return np.vstack((array, array[:1]))


def opening(name: str, part: str, whole: str, ratio: Number) -> Constraint:
    """That ``part`` over ``whole``, which is ``ratio``, stays so far below one that something is left open."""
    return Constraint(name, f"{part} must stay below {1.0 - LEAST_OPENING:.0%} of {whole}", ratio - 1.0 + LEAST_OPENING)


def common_properties(*, shear: tuple[Number, Number], **values: Number) -> SectionProperties:
    """Properties with the section moduli filled in and shear areas from (A / A_sy, A / A_sz).

    Centroid and extreme fibres that are not given are those of a section in the middle of its height and width.
    """
    half_width, half_height = 0.5 * values["width"], 0.5 * values["height"]
    middle = {"centroid_y": half_width, "centroid_z": half_height}
    values = {**middle, "extreme_fibre_y": half_height, "extreme_fibre_z": half_width, **values}
    return SectionProperties(
        section_modulus_y=values["second_moment_y"] / values["extreme_fibre_y"],
        section_modulus_z=values["second_moment_z"] / values["extreme_fibre_z"],
        shear_area_y=values["area"] / shear[0],
        shear_area_z=values["area"] / shear[1],
        **values,
    )


def stress_area(second_moment: Number, width: Number, first_moment: Number) -> Number:
    """A shear force over its stress where walls of that width (m) are cut, I b / Q, m^2; ``first_moment`` (m^3) is that
    of all beyond the cut about the centroid (D. I. Jourawski 1856; Gere & Goodno, Mechanics of Materials, shear
    stresses in beams)."""
    return second_moment * width / first_moment


def hollow_torsion_modulus(enclosed: Number, thickness: Number, torsion_constant: Number) -> Number:
    """W_t of a closed wall, m^3: Bredt's stress T / (2 A_m t), and that of the wall's twist, T t / (2 J).

    ``enclosed`` is the area A_m within the wall's middle line (m^2). Stress concentrations at inner corners are left
    out.
    """
    return 1.0 / (1.0 / (2.0 * enclosed * thickness) + 0.5 * thickness / torsion_constant)


def poisson_square(poisson_ratio: Number) -> Number:
    """(nu / (1 + nu))^2.

    The energy of the flexural shear stress is exactly ``a + c (nu / (1 + nu))^2`` for every section: the
    part of the
    stress that nu brings is self-equilibrated and so orthogonal to the gradient field that remains at nu = 0.
    """
    return (poisson_ratio / (1.0 + poisson_ratio)) ** 2
