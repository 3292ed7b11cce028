"""What each link can be: every listed section in every material that it comes in, with what it brings to sums."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.errors.model import needs_shear_modulus
from linkwright.core.arm.figures import KEPT_WITHIN, Limit, OfLinks, excess
from linkwright.core.optimize.choice.at_once.cells import COLUMNS, twisted
from linkwright.core.optimize.choice.at_once.cells import columns_of as columns_of_sections
from linkwright.core.optimize.exchange.design import material_row, material_values
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.reading.lacking import LeftOut
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


def agreeing(lists: Sequence[LinkList], same: frozenset[str]) -> list[tuple[NDArray[np.intp], ...]]:
    """All designs, in parts that agree in what must be the same: of each link the options (by number) in a part."""
    kinds = [kinds_of(link_list, same) for link_list in lists]
    results: list[tuple[NDArray[np.intp], ...]] = []
    for kind in dict.fromkeys(kinds[0]):
        options = tuple(
            np.array([k for k, item in enumerate(link_kinds) if item == kind], dtype=np.intp) for link_kinds in kinds
        )
        if all(len(link_options) for link_options in options):
            results.append(options)
    return results


def kinds_of(own: LinkList, same: frozenset[str]) -> list[object]:
    """Of each option what must be the same for all links."""
    kinds: list[object] = []
    for option in own.options:
        size = option.section if "size" in same else None
        shape = option.section.shape if "section" in same else None
        kinds.append((size, shape, option.material.name if "material" in same else None))
    return kinds
