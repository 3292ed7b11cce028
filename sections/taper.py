"""Sections that change along a link: every dimension linear from its joint to its far end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.build import build
from linkwright.core.sections.numeric import Number, maximum
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import Constraint, DesignVariable, Dimension, Outline, Section, SectionError
from linkwright.core.sections.shapes import SHAPES


@dataclass(frozen=True)
class Tapered(Section):
    """A section whose dimensions change linearly along the link; `properties` and `outline` are those at the joint.

    Make one with `build_tapered`. It is evaluated as it is (`arm.chain.taper` integrates along the link), and an
    optimiser does not choose its dimensions. Plain numbers only.

    Attributes:
        near: the section at the joint.
        far: the section at the far end, of the same shape.
    """

    near: Section
    far: Section

    dimensions: ClassVar[tuple[Dimension, ...]] = ()
    variables: ClassVar[tuple[DesignVariable, ...]] = ()

    @property
    def shape(self) -> str:  # type: ignore[override]
        """The shape of every cut."""
        return self.near.shape

    @property
    def ends(self) -> tuple[Section, ...]:
        """The section at the joint, and that at the far end."""
        return self.near, self.far

    def properties(self, poisson_ratio: Number) -> SectionProperties:
        """Properties (SI) at the joint."""
        return self.near.properties(poisson_ratio)

    def along(self, share: NDArray[np.float64], poisson_ratio: float) -> SectionProperties:
        """Properties (SI) at shares (N,) of the link's length from its joint, as arrays (N,)."""
        ends = self.near.given(), self.far.given()
        columns = {name: value + share * (ends[1][name] - value) for name, value in ends[0].items()}
        return type(self.near)(**columns).properties(poisson_ratio)

    def cut(self, share: float) -> Section:
        """The section at a share of the link's length from its joint."""
        far = self.far.given()
        return type(self.near)(
            **{name: value + share * (far[name] - value) for name, value in self.near.given().items()}
        )

    @property
    def greatest_radius(self) -> Number:
        """That of the larger end."""
        return maximum(self.near.greatest_radius, self.far.greatest_radius)

    def outline(self) -> Outline:
        """The outline at the joint."""
        return self.near.outline()

    def given(self) -> dict[str, Any]:
        """The dimensions, a pair (at the joint, at the far end) where they differ, m."""
        far = self.far.given()
        return {name: value if far[name] == value else (value, far[name]) for name, value in self.near.given().items()}

    def scaled(self, factor: Number) -> Self:
        """The same with every dimension multiplied by a factor."""
        return type(self)(self.near.scaled(factor), self.far.scaled(factor))

    def constraints(self) -> tuple[Constraint, ...]:
        """Those of both ends."""
        return (*self.near.constraints(), *self.far.constraints())

    def check(self) -> tuple[str, ...]:
        """What either end violates; what lies between is then sound too, as every condition is on a ratio."""
        return (*self.near.check(), *self.far.check())


@dataclass(frozen=True)
class FreeTaper(Tapered):
    """A taper that an optimiser chooses: models of the arm take the ratio of its ends' sizes as an input.

    `near` and `far` are what the arm as given has, alike but in size.
    """


MOST_TAPER = 10.0
"""How much larger one end of a link can be than the other where the ends are alike."""


def similar(near: Section, ratio: float) -> Section:
    """The section whose far end is the one at the joint with every dimension times a ratio."""
    return near if ratio == 1.0 else Tapered(near, near.scaled(ratio))


def size_ratio(section: Section) -> float | None:
    """The size of the far end over that at the joint, 1 of a uniform link; None where the ends are not alike."""
    if not isinstance(section, Tapered):
        return 1.0
    ends = section.near.given(), section.far.given()
    ratios = [ends[1][name] / value for name, value in ends[0].items()]
    alike = max(ratios) - min(ratios) <= 1e-9 * max(ratios) and 1.0 / MOST_TAPER <= ratios[0] <= MOST_TAPER
    return float(ratios[0]) if alike else None


def build_tapered(shape_name: str, dimensions: Mapping[str, Any]) -> Section:
    """The section of this shape and these dimensions (m), of which some are pairs: at the joint, at the far end.

    Raises SectionError as `build` does, and for a polygon, an angle (askew all along), and anything but two numbers.
    """
    kind = SHAPES.get(shape_name)
    points = (
        {dimension.name for dimension in kind.dimensions if dimension.kind == "points"}
        if kind is not None
        else set[str]()
    )
    lists = {name: value for name, value in dimensions.items() if isinstance(value, (list, tuple))}
    pairs = {name: value for name, value in lists.items() if name not in points}
    if kind is None or not pairs:
        return build(shape_name, dimensions)
    for name, value in pairs.items():
        if len(value) != 2 or any(isinstance(item, (list, tuple)) for item in value):
            raise SectionError(name, "is one length, or two for a taper: [at the joint, at the far end]")
    if points or shape_name == "angle":
        raise SectionError(next(iter(pairs)), f"the shape '{shape_name}' cannot be tapered")
    near, far = (
        build(shape_name, {name: pairs[name][end] if name in pairs else value for name, value in dimensions.items()})
        for end in (0, 1)
    )
    return Tapered(near, far) if near != far else near
