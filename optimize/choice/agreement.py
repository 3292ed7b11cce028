"""What links must agree in, and of how many kinds they may be at most: `same`, and limits on numbers of kinds."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.figures import OfKinds
from linkwright.core.materials.material import Material

if TYPE_CHECKING:
    from linkwright.core.optimize.problem import Problem

Places = NDArray[np.intp]
_MOST_PARTS = 600
"""All designs are cut into no more parts than this; of more the parts hold designs of too many kinds as well."""


@dataclass(frozen=True)
class Agreement:
    """The links are of so many kinds at most: `kind` says what a link of a shape (by name) and a material is. With
    `sized` kinds differ by dimensions as well."""

    kind: Callable[[str, Material], Hashable]
    most: int
    sized: bool = False


def agreements(problem: Problem) -> tuple[Agreement, ...]:
    """All that the links of a problem must agree in."""
    asked: list[Agreement] = []
    if "section" in problem.same or "size" in problem.same:
        asked.append(Agreement(lambda shape, _: shape, 1, sized="size" in problem.same))
    if "material" in problem.same:
        asked.append(Agreement(lambda _, material: material.name, 1))
    for limit in problem.limits:
        follows = limit.figure.follows
        if isinstance(follows, OfKinds):
            asked.append(Agreement(follows.kind, math.floor(limit.value), follows.sized))
    return tuple(asked)


def codes_of(kinds: Sequence[Sequence[Hashable]]) -> list[Places]:
    """The kinds of each link's options as numbers, the same for the same kind."""
    known: dict[Hashable, int] = {}
    return [np.array([known.setdefault(kind, len(known)) for kind in link], dtype=np.intp) for link in kinds]


def within(codes: Sequence[Places], picks: NDArray[np.integer], most: int) -> NDArray[np.bool_]:
    """Which designs (rows: an option of each link) are of so many kinds at most."""
    kinds = np.sort(np.stack([link[picks[:, k]] for k, link in enumerate(codes)], axis=1), axis=1)
    return np.asarray((np.diff(kinds, axis=1) != 0).sum(axis=1) < most)


def table(codes: Sequence[Places], most: int) -> NDArray[np.bool_]:
    """The same for every design, an axis for each link."""
    size = len(codes)
    shape = tuple(len(link) for link in codes)
    number = np.zeros(shape, dtype=np.int16)
    for kind in range(1 + max(int(link.max()) for link in codes)):
        there = np.zeros(shape, dtype=bool)
        for axis, link in enumerate(codes):
            there |= (link == kind).reshape([-1 if k == axis else 1 for k in range(size)])
        number += there
    return number <= most


def parts(asked: Sequence[tuple[Sequence[Places], int]], sizes: Sequence[int]) -> list[tuple[Places, ...]]:
    """All designs that agree, in parts: of each link the options (by number) in a part. `asked` has the codes of the
    links' options and of how many kinds they may be, `sizes` how many options each link has."""
    every: list[tuple[Places, ...]] = [tuple(np.arange(size) for size in sizes)]
    for codes, most in asked:
        every = list(_unique(cut for part in every for cut in _cut(part, codes, most)))
    return every


def _cut(part: tuple[Places, ...], codes: Sequence[Places], most: int) -> Iterator[tuple[Places, ...]]:
    kinds = sorted(set(np.concatenate([link[ids] for link, ids in zip(codes, part, strict=True)]).tolist()))
    if len(kinds) <= most or math.comb(len(kinds), most) > _MOST_PARTS:
        yield part
        return
    for some in itertools.combinations(kinds, most):
        cut = tuple(ids[np.isin(link[ids], some)] for link, ids in zip(codes, part, strict=True))
        if all(len(ids) for ids in cut):
            yield cut


def _unique(every: Iterator[tuple[Places, ...]]) -> Iterator[tuple[Places, ...]]:
    seen: set[tuple[bytes, ...]] = set()
    for part in every:
        key = tuple(ids.tobytes() for ids in part)
        if key not in seen:
            seen.add(key)
            yield part


def number_of(asked: Sequence[tuple[Sequence[Places], int]], sizes: Sequence[int]) -> int:
    """How many designs agree, without listing them: by the sets of kinds that the links up to one are of."""
    ways: dict[tuple[frozenset[int], ...], int] = {tuple(frozenset[int]() for _ in asked): 1}
    for link, size in enumerate(sizes):
        options: dict[tuple[int, ...], int] = {}
        for option in range(size):
            kinds = tuple(int(codes[link][option]) for codes, _ in asked)
            options[kinds] = options.get(kinds, 0) + 1
        after: dict[tuple[frozenset[int], ...], int] = {}
        for used, count in ways.items():
            for kinds, times in options.items():
                more = tuple(item | {kind} for item, kind in zip(used, kinds, strict=True))
                if all(len(item) <= most for item, (_, most) in zip(more, asked, strict=True)):
                    after[more] = after.get(more, 0) + count * times
        ways = after
    return sum(ways.values())
