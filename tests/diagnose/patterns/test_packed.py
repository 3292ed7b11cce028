"""Patterns held without their noughts."""

import numpy as np
import pytest

from linkwright.core.diagnose.patterns.packed import Columns, packed


@pytest.mark.parametrize(
    ("rows", "channels"),
    [(slice(0, 30), [0, 1, 2, 3]), (slice(12, 20), [1, 3]), (slice(0, 0), [0]), (slice(29, 30), [2])],
)
def test_columns_come_back_whole_and_without_rows(rows, channels):
    given = np.zeros((30, 4, 2))
    given[rows, channels] = 1.0 + np.arange(given[rows, channels].size, dtype=float).reshape(
        given[rows, channels].shape
    )
    part = packed(given)
    assert part.shape == given.shape
    assert part.values.size == given[rows, channels].size
    assert (part.whole() == given).all()
    keep = np.arange(30) % 3 != 1
    assert (part.kept(keep).whole() == given[keep]).all()
    held = Columns([part]).and_one(2.0 * given)
    assert len(held) == 2
    assert (held[1] == 2.0 * given).all()
    assert [item.sum() for item in held[:1]] == [given.sum()]
