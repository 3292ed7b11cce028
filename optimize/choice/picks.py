"""Which combinations of shapes and materials a problem allows."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.bodies.warping import warping_of
from linkwright.core.arm.figures import OfKinds
from linkwright.core.materials.material import Material
from linkwright.core.optimize.problem import Problem

from .agreement import Agreement, Places, agreements, codes_of, number_of, parts, within


@dataclass(frozen=True)
class Combination:
    """A shape and a material for each link; None for links that are rigid."""

    shapes: tuple[str | None, ...]
    materials: tuple[Material | None, ...]

    def agrees(self, asked: Sequence[Agreement]) -> bool:
        """Whether its links agree in what they must."""
        links = [
            (shape, material) for shape, material in zip(self.shapes, self.materials, strict=True) if shape and material
        ]
        return all(len({item.kind(*link) for link in links}) <= item.most for item in asked)


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
    link_options = (
        tuple((shape, material) for shape in shapes[k] if shape for material in materials[k] if material) for k in links
    )
    return OptionTable(problem.arm.size, links, tuple(link_options))


def agreeing(problem: Problem, table: OptionTable) -> list[tuple[list[Places], int]]:
    """What the links must agree in: the kinds of their options as numbers, and of how many they may be."""
    return [
        (codes_of([[item.kind(*option) for option in link] for link in table.options]), item.most)
        for item in agreements(problem)
    ]


def combinations(problem: Problem) -> list[Combination]:
    """Every allowed combination, those of the same shapes together."""
    table = option_table(problem)
    asked = agreeing(problem, table)
    every: list[NDArray[np.intp]] = []
    for part in parts(asked, table.shape):
        rows = np.stack([axis.ravel() for axis in np.meshgrid(*part, indexing="ij")], axis=1)
        every.append(rows[np.all([within(codes, rows, most) for codes, most in asked], axis=0)] if asked else rows)
    if not every:
        return []
    rows = np.unique(np.concatenate(every), axis=0)
    picks = [table.combination(row) for row in rows.tolist()]
    shapes = [list(dict.fromkeys(shape for shape, _ in link)) for link in table.options]

    def place(pick: Combination) -> list[int]:
        return [names.index(pick.shapes[link] or "") for names, link in zip(shapes, table.links, strict=True)]

    return sorted(picks, key=place)


def count(problem: Problem) -> int:
    """How many combinations there are, without listing them."""
    table = option_table(problem)
    asked = agreeing(problem, table)
    return number_of(asked, table.shape) if asked else math.prod(table.shape)


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
    table, asked = option_table(problem), agreements(problem)
    agreed = [pick for pick in dict.fromkeys(results) if pick.agrees(asked)]
    if not agreed:
        first = ([int(ids[0]) for ids in part] for part in parts(agreeing(problem, table), table.shape))
        agreed = [pick for pick in map(table.combination, first) if pick.agrees(asked)]
    return agreed


def one_link_changed(problem: Problem, pick: Combination, link: int) -> list[Combination]:
    """The combinations that differ from one in a link (from 0), or where links must agree in all that are as it is."""
    shapes, materials = options(problem)
    asked = agreements(problem)
    trials: list[Combination] = []
    for shape, material in itertools.product(shapes[link], materials[link]):
        new_shapes = tuple(shape if k == link else item for k, item in enumerate(pick.shapes))
        new_materials = tuple(material if k == link else item for k, item in enumerate(pick.materials))
        trial = Combination(new_shapes, new_materials)
        if not trial.agrees(asked):
            new_shapes = tuple(shape if item == pick.shapes[link] else item for item in pick.shapes)
            new_materials = tuple(material if item == pick.materials[link] else item for item in pick.materials)
            trial = Combination(new_shapes, new_materials)
        known = zip((*trial.shapes, *trial.materials), (*shapes, *materials), strict=True)
        if all(one in item for one, item in known) and trial.agrees(asked):
            trials.append(trial)
    return list(dict.fromkeys(trials))


def disagreement(problem: Problem) -> str:
    """Why no combination has links that agree as they must; an empty text where one does."""
    if count(problem):
        return ""
    asked = [limit.text for limit in problem.limits if isinstance(limit.figure.follows, OfKinds)]
    asked += [f"same: [{', '.join(sorted(problem.same))}]"] if problem.same else []
    table = option_table(problem)
    lists = (
        f"link {link + 1}: {', '.join(f'{shape} of {material.name}' for shape, material in item)}"
        for link, item in zip(table.links, table.options, strict=True)
    )
    return f"no combination keeps {' and '.join(asked)}; what links can be: {'; '.join(lists)}"
