"""Rows with free lengths once the lengths are settled: products of what sections bring alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwright.core.optimize.choice.at_once.cells import COLUMNS, LENGTH
from linkwright.core.optimize.choice.at_once.pose_rows import PoseRow
from linkwright.core.sections.numeric import Array

_WIDTH = len(COLUMNS)


class SettledRow:
    """A row that is asked for at one set of lengths after another; what they share is prepared."""

    def __init__(self, row: PoseRow) -> None:
        self.row = row
        self._places = np.arange(LENGTH, row.powers.shape[1], _WIDTH)
        plain = row.powers.copy()
        plain[:, self._places] = 0.0
        self._powers, index = np.unique(plain, axis=0, return_inverse=True)
        self._inverse = index.ravel()
        self._lengths = row.powers[:, self._places]

    def at(self, logarithms: Array) -> PoseRow:
        """The row at logarithms of the lengths of all links (n)."""
        terms = np.exp(self._lengths @ logarithms)[:, None] * self.row.coefficients
        size = len(self._powers)
        columns = [np.bincount(self._inverse, terms[:, k], minlength=size) for k in range(terms.shape[1])]
        return replace(self.row, coefficients=np.stack(columns, axis=1), powers=self._powers)
