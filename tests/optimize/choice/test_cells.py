"""What a link may be, in cells: no section inside one that keeps its limits is below what the cell is said to reach."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from linkwright.core.optimize.choice.at_once.cells import COLUMNS, Cells, Ids, link_cells
from linkwright.core.optimize.choice.at_once.partial_cells import mixture, multipliers
from linkwright.core.sections.numeric import Array
from tests.optimize.builders import jointed, problem_of, ranged

SHAPES = "circle, ellipse, rectangle, triangle, i_section, tube, rectangular_tube"
PROBLEM = (
    f"choose: {{section: [{SHAPES}], material: [aluminium-6061-t6, steel-s355]}}\n"
    "subject_to: {mass: '<= 8 kg', section_size: [20 mm, 120 mm], thickness: [2 mm, 10 mm],"
    " wall_slenderness: '<= 1'}\n"
)
DEPTHS, TRIALS, LOOKED_AT, SAMPLES = 6, 4, 25, 200


@pytest.fixture
def cells(tmp_path: Path) -> Cells:
    return link_cells(problem_of(tmp_path, jointed((500, 400), ranged("-60 60", "0 60")), PROBLEM))[0]


def prices(rng: np.random.Generator) -> Array:
    """What weight, compliances and the price of the material may be worth: some nothing, all at least that."""
    price = rng.uniform(0.0, 1.0, len(COLUMNS)) * rng.integers(0, 2, len(COLUMNS))
    price[COLUMNS.index("expansion")] = price[COLUMNS.index("length")] = 0.0
    return price


def least_sampled(cells: Cells, cell: int, price: Array, rng: np.random.Generator) -> float:
    """The least of a sum over sections inside a cell that keep their limits; infinite where none was met."""
    kind = cells._kinds[cells._kind[cells.option[cell]]]
    size = len(kind.names)
    low, high = cells.low[cell, :size], cells.high[cell, :size]
    points = low + rng.uniform(0.0, 1.0, (SAMPLES, size)) * (high - low)
    columns, kept, _ = cells._measured(kind, cells.option[cell : cell + 1], points[None])
    return float(np.where(kept[0], columns[0] @ price, np.inf).min())


def test_no_section_is_below_its_cell(cells: Cells) -> None:
    rng = np.random.default_rng(11)
    ids, met, across = cells.roots, 0, 0
    for _ in range(DEPTHS):
        for _ in range(TRIALS):
            price = prices(rng)
            some: Ids = rng.choice(ids, min(LOOKED_AT, len(ids)), replace=False)
            values, _ = cells.least_kept(some, price, np.inf)
            for cell, value in zip(some.tolist(), values.tolist(), strict=True):
                least = least_sampled(cells, cell, price, rng)
                assert least >= value - 1e-9
                met += np.isfinite(least)
                across += np.isfinite(least) and bool(cells.across[cell])
        ids = rng.choice(ids, min(len(ids), 150), replace=False)
        ids = cells.split(ids, (cells.high - cells.low)[ids].argmax(axis=1))
    assert met > 300
    assert across > 50


def test_of_a_cell_across_a_limit_the_corner_beyond_it_is_not_what_counts(cells: Cells) -> None:
    rng = np.random.default_rng(5)
    ids = cells.roots
    for _ in range(20):
        ids = cells.split(ids, (cells.high - cells.low)[ids].argmax(axis=1))
        ids = ids[cells.across[ids]]
        ids = rng.choice(ids, min(len(ids), 300), replace=False)
    price = np.zeros(len(COLUMNS))
    price[[COLUMNS.index("weight"), COLUMNS.index("bending_height")]] = 1.0, 0.5
    scores = cells.corners[ids, :-1] @ price
    least = scores.argmin(axis=1)
    beyond = (cells.held[ids, least] > 0.0).any(axis=1)
    values, _ = cells.least_kept(ids, price, np.inf)
    assert beyond.sum() > 50
    assert np.mean((values > scores.min(axis=1))[beyond]) > 0.9


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**31), limits=st.integers(1, 3))
def test_multipliers_bound_the_linear_program_over_the_corners(seed: int, limits: int) -> None:
    rng = np.random.default_rng(seed)
    scores, held = rng.normal(size=(5, 16)), rng.normal(size=(5, 16, limits))
    result = multipliers(scores, held)
    assert (result >= 0.0).all()
    told = (scores + np.einsum("nch,nh->nc", held, result)).min(axis=1)
    for k in range(len(scores)):
        program = linprog(scores[k], held[k].T, np.zeros(limits), np.ones((1, 16)), [1.0], bounds=(0.0, None))
        mixed = mixture(scores[k], held[k])
        assert (mixed is None) == (program.status == 2)
        if mixed is None:
            continue
        assert told[k] <= program.fun + 1e-9
        if limits == 1:
            assert told[k] == pytest.approx(program.fun, abs=1e-9)
        shares, weights = mixed
        assert (scores[k] + held[k] @ weights).min() == pytest.approx(program.fun, abs=1e-7)
        assert shares @ scores[k] == pytest.approx(program.fun, abs=1e-7)
