"""The bound on lists of options: against every combination of made-up rows, signs of all kinds."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from linkwright.core.optimize.choice.at_once.cells import COLUMNS
from linkwright.core.optimize.choice.at_once.pose_rows import PoseRow, row_of
from linkwright.core.optimize.choice.at_once.relaxation import Relaxation
from linkwright.core.optimize.choice.products import Power
from linkwright.core.optimize.rounding.options import Option
from linkwright.core.optimize.sizes.listed_search import Points
from linkwright.core.optimize.sizes.options import LinkList
from linkwright.core.optimize.sizes.rows import greatest, table_row
from linkwright.core.optimize.sizes.search import combined
from linkwright.core.sections.numeric import Array

_LINKS, _OPTIONS = 3, 6
_SOFT, _HEAVY = 2, 0


def _lists(generator: np.random.Generator) -> tuple[LinkList, ...]:
    lists: list[LinkList] = []
    for link in range(_LINKS):
        columns = np.zeros((_OPTIONS, len(COLUMNS)))
        columns[:, :6] = generator.normal(0.0, 0.7, (_OPTIONS, 6))
        lists.append(LinkList(link, (Option(None, None),) * _OPTIONS, columns))
    return tuple(lists)


def _row(generator: np.random.Generator, *, objective: bool, level: float = 0.0) -> PoseRow:
    """An error of two components: each link's flexibility alone and times weights, one in four of them against it."""
    terms: dict[Power, Array] = {(): generator.normal(0.0, 0.2, 2)}
    for link in range(_LINKS):
        terms[((link, _SOFT),)] = np.abs(generator.normal(0.0, 1.0, 2))
        for other in range(link, _LINKS):
            sign = -1.0 if generator.random() < 0.25 else 1.0
            terms[tuple(sorted(((link, _SOFT), (other, _HEAVY))))] = sign * np.abs(generator.normal(0.0, 0.5, 2))
    return row_of(terms, _LINKS, objective=objective, scale=1.0, shift=-level)


@pytest.mark.parametrize("seed", range(24))
def test_bound_and_losses_are_below_every_combination(seed: int) -> None:
    generator = np.random.default_rng(seed)
    lists = _lists(generator)
    relaxation = Relaxation([Points(item) for item in lists], range(_LINKS), _LINKS)
    mass = {((link, _HEAVY),): np.ones(1) for link in range(_LINKS)}
    rows = [_row(generator, objective=True) for _ in range(3)]
    rows.append(row_of(mass | {(): np.array([-generator.uniform(2.0, 4.0)])}, _LINKS, objective=False, scale=1.0))
    rows.append(_row(generator, objective=False, level=generator.uniform(4.0, 12.0)))
    relaxation.rows = rows
    every = np.array(list(itertools.product(range(_OPTIONS), repeat=_LINKS)))
    # By the rows as they are, products and all.
    values = np.full(len(every), -np.inf)
    for n, pick in enumerate(every.tolist()):
        y = np.concatenate([own.columns[k] for own, k in zip(lists, pick, strict=True)])
        kept = all(row.value(y) <= 1e-9 for row in rows if not row.objective)
        values[n] = max(row.value(y) for row in rows if row.objective) if kept else np.inf
    worst, left = greatest([table_row(row, lists) for row in rows], every, np.inf)
    assert sorted(left.tolist()) == np.flatnonzero(np.isfinite(values)).tolist()
    assert worst == pytest.approx(values[left])
    result = relaxation.solve(relaxation.root(), np.inf)
    assert result.bound <= values.min() * (1.0 + 1e-9)
    if np.isinf(result.bound):
        return
    scores = [item.columns @ price for item, price in zip(lists, result.prices, strict=True)]
    bound = result.constant + sum(float(item.min()) for item in scores)
    losses = [item - item.min() for item in scores]
    assert bound == pytest.approx(result.bound, rel=1e-3)
    for k in range(_LINKS):
        for option in range(_OPTIONS):
            least = values[every[:, k] == option].min()
            assert bound + losses[k][option] <= least * (1.0 + 1e-9)
    # Losses of several links add up.
    together = sum(losses[k][every[:, k]] for k in range(_LINKS))
    assert np.all(bound + together <= values * (1.0 + 1e-9))
    # A part of one design alone has a bound that is its value, but for what chords take off.
    best = every[int(values.argmin())]
    alone = relaxation.solve(relaxation.root([np.array([k]) for k in best]), np.inf)
    assert alone.bound == pytest.approx(values.min(), rel=2e-4)


def test_sums_below_are_all_those_that_there_are() -> None:
    generator = np.random.default_rng(3)
    losses = [generator.uniform(0.0, 1.0, 7) for _ in range(4)]
    result = combined(losses, 0.9, 10_000)
    assert result is not None
    every = np.array(list(itertools.product(range(7), repeat=4)))
    sums = sum(own[every[:, k]] for k, own in enumerate(losses))
    assert sorted(map(tuple, result.tolist())) == sorted(map(tuple, every[sums < 0.9].tolist()))
    assert combined(losses, 0.9, 5) is None
