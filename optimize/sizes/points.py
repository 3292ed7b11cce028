"""Listed sections as cells of one point each, for the bounds on all combinations (`optimize.choice.at_once`)."""

from __future__ import annotations

import numpy as np

from linkwright.core.optimize.choice.at_once.cells import Cells

from .options import LinkList


class Points(Cells):
    """The options of a link: each is a cell that is never split, with the number that the list gives it."""

    def __init__(self, link_list: LinkList) -> None:
        count = len(link_list.options)
        self.count = count
        self.option = np.arange(count)
        self.roots = np.arange(count)
        self.corners = np.repeat(link_list.columns[:, None], 2, axis=1)
        self.kept = np.ones((count, 2), dtype=bool)
        self.bends = np.zeros((count, 0, link_list.columns.shape[1]))
        self.held, self.held_bends = np.zeros((count, 1, 0)), np.zeros((count, 0, 0))
        self.across = np.zeros(count, dtype=bool)

    @property
    def spent(self) -> bool:
        """A point has no parts."""
        return True
