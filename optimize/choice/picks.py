"""Which combinations of shapes and materials a problem allows."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from linkwright.core.arm.bodies.warping import warping_of
from linkwright.core.materials.material import Material
from linkwright.core.optimize.problem import Problem


@dataclass(frozen=True)
class Combination:
    """A shape and a material for each link; None for links that are rigid."""

    shapes: tuple[str | None, ...]
    materials: tuple[Material | None, ...]

    def agrees(self, same: frozenset[str]) -> bool:
        """Whether the links agree in what must be the same for all."""
        shapes, materials = (
            {choice for choice in choices if choice is not None} for choices in (self.shapes, self.materials)
        )
        same_shape = "section" in same or "size" in same
        return (len(shapes) <= 1 or not same_shape) and (len(materials) <= 1 or "material" not in same)


def options(problem: Problem) -> tuple[list[tuple[str | None, ...]], list[tuple[Material | None, ...]]]:
    """The shapes and the materials that each link may have."""
    shapes: list[tuple[str | None, ...]] = []
    materials: list[tuple[Material | None, ...]] = []
    for number, link in enumerate(problem.arm.links):
        if link.section is None:
            shapes.append((None,))
            materials.append((None,))
        else:
            shapes.append(problem.shapes_of(number))
            materials.append(problem.materials_of(number) or (None,))
    return shapes, materials


@dataclass(frozen=True)
class OptionTable:
    """The options (shape with material) of each elastic link (from 0) of an arm of so many links; a combination is a
    place in the table of them all, one number a link."""

    size: int
    links: tuple[int, ...]
    options: tuple[tuple[tuple[str, Material], ...], ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """How many options each link has."""
        return tuple(len(link_options) for link_options in self.options)

    def first_alike(self, problem: Problem) -> list[int]:
        """For each elastic link the place of the first that is like it in its options, their ranges, and what is asked
        of it."""
        kinds = [
            (
                link_options,
                problem.ranges[link].sizes,
                problem.limits_on_link(link),
                [problem.strength_share(link, m) for _, m in link_options],
                (problem.arm.links[link].length, warping_of(problem.arm, link))
                if problem.arm.links[link].asymmetry.warps
                else None,
            )
            for link, link_options in zip(self.links, self.options, strict=True)
        ]
        return [kinds.index(kind) for kind in kinds]

    def combination(self, place: Sequence[int]) -> Combination:
        """The combination at a place."""
        shapes: list[str | None] = [None] * self.size
        materials: list[Material | None] = [None] * self.size
        for link, link_options, k in zip(self.links, self.options, place, strict=True):
            shapes[link], materials[link] = link_options[k]
        return Combination(tuple(shapes), tuple(materials))

    def place(self, pick: Combination) -> tuple[int, ...]:
        """Where a combination stands."""
        return tuple(
            link_options.index((pick.shapes[link], pick.materials[link]))  # type: ignore[arg-type]
            for link, link_options in zip(self.links, self.options, strict=True)
        )


def option_table(problem: Problem) -> OptionTable:
    """What each elastic link may be."""
    links = tuple(k for k, link in enumerate(problem.arm.links) if link.section is not None)
    shapes, materials = options(problem)
    own = (
        tuple((shape, material) for shape in shapes[k] if shape for material in materials[k] if material) for k in links
    )
    return OptionTable(problem.arm.size, links, tuple(own))


def _agreeing(picks: Iterable[tuple[object, ...]], same: bool) -> list[tuple[object, ...]]:
    """The picks in which all links that have a choice agree, where they must."""
    return [pick for pick in picks if not same or len({item for item in pick if item is not None}) <= 1]


def combinations(problem: Problem) -> list[Combination]:
    """Every allowed combination."""
    shapes, materials = options(problem)
    shape_picks = _agreeing(itertools.product(*shapes), "section" in problem.same or "size" in problem.same)
    material_picks = _agreeing(itertools.product(*materials), "material" in problem.same)
    return [Combination(s, m) for s in shape_picks for m in material_picks]  # type: ignore[arg-type]


def count(problem: Problem) -> int:
    """How many combinations there are, without listing them."""
    total = 1
    for picks, same in zip(
        options(problem), ("section" in problem.same or "size" in problem.same, "material" in problem.same), strict=True
    ):
        sizes = [len(pick) for pick in picks]
        distinct = [set(pick) for pick in picks if pick != (None,)]
        total *= len(set.intersection(*distinct)) if same and distinct else math.prod(sizes)
    return total


def uniform(problem: Problem) -> list[Combination]:
    """The combinations in which all links that can agree do."""
    shapes, materials = options(problem)
    kinds = list(dict.fromkeys(itertools.chain.from_iterable(shapes)))
    common_materials = list(dict.fromkeys(itertools.chain.from_iterable(materials)))
    results = [
        Combination(
            tuple(shape if shape in item else next(iter(item)) for item in shapes),
            tuple(material if material in item else next(iter(item)) for item in materials),
        )
        for shape in kinds
        for material in common_materials
    ]
    return list(dict.fromkeys(results))


def one_link_changed(problem: Problem, pick: Combination, link: int) -> list[Combination]:
    """The combinations that differ from one in a link (from 0), or in all links where they must agree."""
    shapes, materials = options(problem)
    trials: list[Combination] = []
    for shape, material in itertools.product(shapes[link], materials[link]):
        new_shapes = tuple(shape if k == link else item for k, item in enumerate(pick.shapes))
        new_materials = tuple(material if k == link else item for k, item in enumerate(pick.materials))
        if "section" in problem.same or "size" in problem.same:
            new_shapes = tuple(shape if item is not None else None for item in pick.shapes)
        if "material" in problem.same:
            new_materials = tuple(material if item is not None else None for item in pick.materials)
        if all(one in item for one, item in zip((*new_shapes, *new_materials), (*shapes, *materials), strict=True)):
            trials.append(Combination(new_shapes, new_materials))
    return list(dict.fromkeys(trials))
