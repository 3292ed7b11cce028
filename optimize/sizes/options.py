"""What each link can be: every listed section in every material that it comes in, with what it brings to sums."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.errors.model import needs_shear_modulus
from linkwright.core.arm.figures import KEPT_WITHIN, Limit, OfLinks, excess
from linkwright.core.optimize.choice.agreement import Agreement, Places, agreements, codes_of, parts
from linkwright.core.optimize.choice.at_once.cells import COLUMNS, twisted
from linkwright.core.optimize.choice.at_once.cells import columns_of as columns_of_sections
from linkwright.core.optimize.exchange.design import material_row, material_values
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.reading.conditions import LeftOut
from linkwright.core.optimize.rounding.options import Option, comes_in
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import NoAnswer


@dataclass(frozen=True)
class LinkList:
    """The options of one link (from 0), and their columns (N, K): logarithms of features, expansion as it is."""

    link: int
    options: tuple[Option, ...]
    columns: Array


def link_lists(problem: Problem) -> tuple[LinkList, ...]:
    """The options of each elastic link that keep all limits on single links; raises `NoAnswer` where none does."""
    assert problem.sizes is not None
    made: dict[object, tuple[tuple[Option, ...], Array]] = {}
    lists: list[LinkList] = []
    for number, listed in enumerate(problem.sizes):
        if not listed:
            continue
        materials = problem.materials_of(number)
        shares = tuple(problem.strength_share(number, material) for material in materials)
        key = (id(listed), materials, shares, problem.limits_on_link(number), twisted(problem, number))
        if key not in made:
            every = [
                Option(item.section, material, None if item.stock is None else item.stock.name, m * len(listed) + k)
                for m, material in enumerate(materials)
                for k, item in enumerate(listed)
                if item.stock is None or comes_in(item.stock, material)
            ]
            if not every:
                names = " or ".join(material.name for material in materials)
                raise NoAnswer(f"link {number + 1}: none of the sizes listed comes in {names}")
            options, broken = keeping(problem, number, every)
            if broken is not None:
                raise NoAnswer(f"no section listed keeps {broken.text}")
            made[key] = tuple(options), columns_of(problem, number, options)
        lists.append(LinkList(number, *made[key]))
    return tuple(lists)


def without_stock(problem: Problem) -> tuple[LeftOut, ...]:
    """The materials that may be chosen and in which none of the sizes listed for any link that may be of them comes."""
    left_out: list[LeftOut] = []
    for material in problem.materials or ():
        entries = [
            listed
            for number, listed in enumerate(problem.sizes or ())
            if listed and material in problem.materials_of(number)
        ]
        sizes = [item.stock for listed in entries for item in listed]
        if sizes and not any(size is None or comes_in(size, material) for size in sizes):
            shapes = " or ".join(dict.fromkeys(size.shape for size in sizes if size is not None))
            left_out.append(LeftOut(material.name, f"no stock size of {shapes} listed comes in it"))
    return tuple(left_out)


def keeping(problem: Problem, link: int, options: Sequence[Option]) -> tuple[list[Option], Limit | None]:
    """The options of a link (from 0) that keep the limits on single links, in their order until one is kept by none,
    which is the second."""
    left = list(options)
    for limit in problem.limits_on_link(link):
        kept = [option for option in left if _keeps(problem, limit, option)]
        if not kept:
            return left, limit
        left = kept
    return left, None


def _keeps(problem: Problem, limit: Limit, option: Option) -> bool:
    follows = limit.figure.follows
    assert isinstance(follows, OfLinks)
    values = follows.values(option.section, option.material.at(problem.arm.temperature)) or ()
    return all(excess(limit, float(value)) <= KEPT_WITHIN for value in values)


def columns_of(problem: Problem, link: int, options: Sequence[Option]) -> Array:
    """The columns (N, K) of options of a link (from 0)."""
    shear, ends = needs_shear_modulus(problem.arm, problem.load_cases), twisted(problem, link)
    groups: dict[tuple[str, tuple[str, ...], str], list[int]] = {}
    for place, option in enumerate(options):
        key = (option.section.shape, tuple(option.section.given()), option.material.name)
        groups.setdefault(key, []).append(place)
    columns = np.zeros((len(options), len(COLUMNS)))
    for (_, names, _), places in groups.items():
        first = options[places[0]]
        sizes = {name: np.array([float(getattr(options[k].section, name)) for k in places]) for name in names}
        values = material_values(material_row((first.material,), problem, link), 0)
        section = type(first.section)(**sizes)  # type: ignore[call-arg]
        columns[places] = columns_of_sections(section, values, (len(places),), shear=shear, twisted=ends)
    return columns


def agreeing(problem: Problem, lists: Sequence[LinkList]) -> list[tuple[list[Places], int]]:
    """What the links must agree in: the kinds of their options as numbers, and of how many they may be."""

    def kind(item: Agreement, option: Option) -> object:
        return item.kind(option.section.shape, option.material), option.section if item.sized else None

    return [
        (codes_of([[kind(item, option) for option in link_list.options] for link_list in lists]), item.most)
        for item in agreements(problem)
    ]


def agreeing_parts(problem: Problem, lists: Sequence[LinkList]) -> list[tuple[Places, ...]]:
    """All designs, in parts that agree in what they must: of each link the options (by number) in a part."""
    return parts(agreeing(problem, lists), [len(link_list.options) for link_list in lists])
