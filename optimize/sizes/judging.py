"""Designs of listed sections over their whole workspace: the search of `optimize.rounding`, which here also keeps the
poses that told, so that they become rows of the finite problem."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.optimize.exchange.binding_poses import Pool
from linkwright.core.optimize.exchange.exchange import Context
from linkwright.core.optimize.exchange.program import cut_of
from linkwright.core.optimize.limits import Cut
from linkwright.core.optimize.rounding.designs_at_once import Group, Table
from linkwright.core.optimize.rounding.fixed_sizes import RoundSearch
from linkwright.core.optimize.rounding.options import Rounding
from linkwright.core.sections.numeric import Array

from .options import LinkList

_ADDED = 3
"""Poses of the error that one design adds at most."""


class Judge(RoundSearch):
    """Finds the best of the designs that it is offered; `pool` holds the poses that told."""

    def __init__(
        self,
        context: Context,
        lists: tuple[LinkList, ...],
        heard: Callable[[int, int], None] | None = None,
        table: Table | None = None,
    ) -> None:
        """`table` is that of the lists (`table_of`), where it is there already."""
        super().__init__(context, table_of(context, lists) if table is None else table, Rounding(None), heard)
        self.pool = Pool()

    def learn(self, arm: Arm, p: Array) -> None:
        """Add the poses that a design shows, whatever it is worth."""
        if self.context.uses_error:
            worst = self.context.search.worst(p, certify=False)
            near = [pose for pose in worst.poses if pose.error > 0.9 * worst.error][:_ADDED]
            self.add_poses(np.array([pose.q for pose in near]), [pose.load_case for pose in near], p)
        for family, prepared in self.context.families:
            found = family.worst(prepared, self.problem, self.context.search, arm, p)
            self.pool = self.pool.with_cuts(family.name, family.first(found))

    def add_poses(self, q: Array, load_cases: list[int], p: Array) -> None:
        """As poses that bound others, and as rows of the error and of each family that bounds many."""
        super().add_poses(q, load_cases, p)
        search = self.context.search
        for row, case in zip(q, load_cases, strict=True):
            if self.context.uses_error:
                pose = search.worst_poses_at(row[None], p, search.case_at(row, p, case))[0]
                self.pool = self.pool.with_errors((cut_of(self.context.model, pose),))
            for family, prepared in self.context.families:
                if family.bounds_many and family.more(prepared) == 0:
                    self.pool = self.pool.with_cuts(family.name, [Cut(tuple(row.tolist()), case)])

    def _search(self, pick: tuple[int, ...]) -> None:
        """As it is; what a design shows of figures whose poses say more than where joints stand joins the rows."""
        super()._search(pick)
        families = [each for each in self.context.families if each[0].bounds_many and each[0].more(each[1]) > 0]
        if not families or (self.best is not None and self.best[0] == pick):
            return
        arm = self.table.arm_of(pick)
        p = self.table.figures(np.array([pick])).p[0]
        for family, prepared in families:
            found = family.worst(prepared, self.problem, self.context.search, arm, p)
            self.pool = self.pool.with_cuts(family.name, [each.cut for each in found])

    def cuts(self) -> Pool:
        """All poses that told, those of families that look at designs one by one among them."""
        for name, cuts in self._cuts.items():
            self.pool = self.pool.with_cuts(name, cuts)
        return self.pool


def table_of(context: Context, lists: tuple[LinkList, ...]) -> Table:
    """All options of the links, ready to be combined."""
    groups = [Group((each.link,), tuple((own,) for own in each.options), len(each.options)) for each in lists]
    return Table(context.problem, context.problem.arm, groups, [context.problem.arm.lengths])
