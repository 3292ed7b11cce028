"""Points of a trade-off whose sections are listed: the combination that minimises one figure while the other is
constrained, and among its ties the one that is best in the other figure too."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.figures import Limit
from linkwright.core.materials.material import Material
from linkwright.core.optimize.choice.picks import Combination
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.sizes.designs_at_once import Table
from linkwright.core.optimize.sizes.options import link_lists
from linkwright.core.optimize.sizes.search import CLOSE, ListSearch
from linkwright.core.units.quantities import NoAnswer

from .point import Design, Notify
from .question import Axis, Question

_EXACTLY = 1e-9
"""Of designs as good in the figure pushed as the best, within this share, that with the least of the other counts."""


@dataclass(frozen=True)
class _Known:
    """A design that is optimal for every bound on the constrained figure from its badness to `most`."""

    push: int
    least: float
    most: float
    design: Design


class ListedSearch:
    """Finds designs from lists for one problem (of a group) of a trade-off."""

    def __init__(self, asked: Question, problem: Problem, notify: Notify) -> None:
        """`notify` is called between the parts of the work. Raises `NoAnswer` where a link has no section to be."""
        self.asked, self.problem, self._notify = asked, problem, notify
        self.share = 0.0
        assert problem.sizes is not None
        for number, (link_sizes, link) in enumerate(zip(problem.sizes, problem.arm.links, strict=True), start=1):
            if link.section is not None and not link_sizes:
                raise NoAnswer(f"link {number}: none of the sizes listed is of that shape")
        self.context = context_of(replace(problem, sizes=None))
        self.lists = link_lists(problem)
        self._table = Table(self.context.problem, self.lists)
        self._known: list[_Known] = []

    def best(self, push: int, held: float, near: Sequence[Design], *, wide: bool = False) -> Design | None:
        """As `Search.best`; where to start from (`near`, `wide`) is not asked for: every combination is bounded."""
        del near, wide
        for known in self._known:
            if known.push == push and known.least <= held <= known.most:
                return known.design
        question = self.asked
        pushed, other = (question.x, question.y) if push == question.x_limit else (question.y, question.x)
        best = self._least(pushed, other, held)
        if best is None or best[1] > question.cap(push) * (1.0 + 1e-6):
            return None
        numbers, badness, proven = best
        again = self._least(other, pushed, badness * (1.0 + _EXACTLY))
        least = held
        if again is not None:
            numbers, least = again[0], again[1]
            proven = proven and again[2]
        shapes: list[str | None] = [None] * self.problem.arm.size
        materials: list[Material | None] = [None] * self.problem.arm.size
        codes = [-1.0] * self.problem.arm.size
        for link_list, number in zip(self.lists, numbers, strict=True):
            option = link_list.options[number]
            shapes[link_list.link] = option.section.shape
            materials[link_list.link], codes[link_list.link] = option.material, float(option.place)
        combination = Combination(tuple(shapes), tuple(materials))
        design = Design(combination, tuple(codes), Pool(), badness, None, proven)
        if proven:
            self._known.append(_Known(push, least, held, design))
        return design

    def _least(self, axis: Axis, other: Axis, held: float) -> tuple[tuple[int, ...], float, bool] | None:
        """The options with the least of one figure while the other is not above `held`, that least, and whether no
        combination has less."""
        limits: tuple[Limit, ...] = self.asked.problem.limits[:-2]
        if math.isfinite(held):
            limits = (*limits, other.limit(held))
        problem = replace(self.context.problem, minimize=axis.name, limits=limits)
        search = ListSearch(
            replace(self.context, problem=problem), self.lists, progress=self._heard(), table=self._table
        )
        best = search.run()
        if best.interrupted:
            raise KeyboardInterrupt
        if best.pick is None:
            return None
        gap = best.gap
        return best.pick[:-1], best.objective, gap is not None and gap <= 2.0 * CLOSE

    def _heard(self) -> Callable[[int, int, str], None]:
        def heard(_done: int, _of: int, text: str) -> None:
            self._notify(text)

        return heard


def listed_arm(problem: Problem, numbers: Sequence[float]) -> Arm:
    """The arm with sections by their numbers; links that have none (-1) stay."""
    assert problem.sizes is not None
    links = list(problem.arm.links)
    for place, (number, listed) in enumerate(zip(numbers, problem.sizes, strict=True)):
        if number < 0.0:
            continue
        m, k = divmod(int(number), len(listed))
        option, material = listed[k], problem.materials_of(place)[m]
        name = None if option.stock is None else option.stock.name
        links[place] = links[place].chosen(option.section, name, material)
    return problem.arm.with_links(tuple(links))
