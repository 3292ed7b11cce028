"""The search against least squares of every subset, one by one."""

import itertools
import math

import numpy as np
import pytest

from linkwright.core.diagnose.search.subsets import (
    Products,
    best_subsets,
    criterion_for,
    families,
    products,
)
from tests.diagnose.core_cases import random_pool

RANKS = (1, 1, 2, 3, 4, 1, 2)


def left_by(parts, beside, vector):
    """What least squares of some groups' columns beside the nuisances leaves."""
    matrix = np.concatenate([beside, *parts], axis=1)
    left = vector - matrix @ np.linalg.lstsq(matrix, vector, rcond=1e-10)[0]
    return float(left @ left)


def case(seed, collinear=False):
    rng = np.random.default_rng(seed)
    columns = [rng.standard_normal((60, rank)) for rank in RANKS]
    if collinear:
        columns[1] = -3.0 * columns[0]  # the same pattern twice
        columns[3][:, 1] = columns[2] @ [1.0, 2.0]  # two groups share a direction
        columns[6] = columns[4][:, :2] @ rng.standard_normal((2, 2))  # one group within another
        columns[5][:, 0] = columns[0][:, 0] + 1e-3 * columns[5][:, 0]  # nearly the same
    pool, columns, beside = random_pool(rng, RANKS, columns=columns)
    vector = columns[0] @ [0.5] + columns[4] @ rng.standard_normal(4) * 0.4 + rng.standard_normal(60)
    return pool, columns, beside, pool.projected(vector), vector


@pytest.mark.parametrize("collinear", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_gains_are_those_of_least_squares(seed, collinear):
    pool, columns, beside, white, vector = case(seed, collinear)
    start = products(pool, white)
    assert start.rss == pytest.approx(left_by([], beside, vector))
    for size in (0, 1, 2):
        for taken in itertools.combinations(range(len(RANKS)), size):
            parts = [columns[m] for m in taken]
            given = start.beside(pool.columns(taken))
            before = left_by(parts, beside, vector)
            assert given.rss == pytest.approx(before, rel=1e-6)
            direct = [before - left_by([*parts, columns[m]], beside, vector) for m in range(len(RANKS))]
            result = given.gains()
            # The ridge of 1e-8 and directions below 1e-9 cost a pattern that differs by 1e-3 a few per cent of its own.
            tolerance = 2e-2 if collinear else 1e-6
            assert result == pytest.approx(direct, rel=tolerance, abs=tolerance * start.rss)
            # One after the other is as good as at once.
            in_turn = start
            for member in taken:
                in_turn = in_turn.beside(pool.columns([member]))
            assert in_turn.rss == pytest.approx(before, rel=1e-6)
            assert in_turn.gains() == pytest.approx(result, abs=1e-6 * start.rss)


@pytest.mark.parametrize("collinear", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_best_subsets_are_the_best_of_all(seed, collinear):
    """Every size up to three: the winner is the one that trying all of them finds."""
    pool, columns, beside, white, vector = case(seed, collinear)
    criterion = criterion_for(pool, 57)
    result = best_subsets(pool, white, criterion)
    for size in (0, 1, 2, 3):
        every = {
            taken: criterion(left_by([columns[m] for m in taken], beside, vector), taken)
            for taken in itertools.combinations(range(len(RANKS)), size)
        }
        best = result[size][0]
        assert best.criterion == pytest.approx(min(every.values()), abs=0.1 if collinear else 1e-5)
        assert best.criterion == pytest.approx(every[best.members], abs=0.1 if collinear else 1e-5)
        assert [s.criterion for s in result[size]] == sorted(s.criterion for s in result[size])


def test_what_is_not_allowed_stays_out():
    pool, _, _, white, _ = case(1)
    result = best_subsets(pool, white, criterion_for(pool, 57), allowed=lambda number: number not in (0, 4))
    assert all({0, 4}.isdisjoint(s.members) for subsets in result.values() for s in subsets)
    assert set(best_subsets(pool, white, criterion_for(pool, 57), allowed=lambda _: False)) == {0}


def test_variants_of_one_family_do_not_join():
    rng = np.random.default_rng(5)
    names = ["a", "a", "a", "b", "b", "c"]
    pool, columns, _ = random_pool(rng, (1, 1, 1, 1, 1, 1), names=names)
    white = pool.projected(columns[0][:, 0] + columns[1][:, 0] + 0.3 * rng.standard_normal(60))
    assert sorted(map(sorted, families(pool))) == [[0, 1, 2], [3, 4], [5]]
    for subsets in best_subsets(pool, white, criterion_for(pool, 57)).values():
        for subset in subsets:
            used = [names[m] for m in subset.members]
            assert len(set(used)) == len(used)


def test_criterion_by_hand():
    """n log(RSS/n) + k log n + 2 log C(P, s) + 2 log V of each member: Chen & Chen (2008) with gamma 1."""
    rng = np.random.default_rng(6)
    pool, _, _ = random_pool(rng, (1, 2, 3, 1), names=["a", "b", "c", "a"])
    criterion = criterion_for(pool, 50)
    by_hand = 50 * math.log(7.5 / 50) + (1 + 3) * math.log(50) + 2 * math.log(math.comb(3, 2)) + 2 * math.log(2)
    assert criterion(7.5, (0, 2)) == pytest.approx(by_hand, rel=1e-12)
    assert criterion(7.5, ()) == pytest.approx(50 * math.log(7.5 / 50), rel=1e-12)


def test_noise_that_saturates_is_no_answer():
    """Groups that together have as many directions as there are readings fit anything; that is no reason for them."""
    rng = np.random.default_rng(7)
    pool, _, _ = random_pool(rng, (6, 6, 1), rows=12, nuisances=0)
    white = rng.standard_normal(12)
    result = best_subsets(pool, white, criterion_for(pool, 12), largest=2)
    best = min((subsets[0] for subsets in result.values()), key=lambda subset: subset.criterion)
    assert best.members in ((), (2,))


def test_products_beside_everything_leave_nothing():
    pool, _, _, white, _ = case(2)
    all_columns = pool.columns(range(len(RANKS)))
    rest = products(pool, white).beside(all_columns)
    assert isinstance(rest, Products)
    diagonal, blocks = rest.blocks
    assert max(np.abs(block).max() for block in (diagonal, *blocks)) < 1e-8
    assert np.abs(rest.against).max() < 1e-7


def test_products_of_some_groups_are_those_of_all():
    """Beside columns that are taken, and once some of these are given back."""
    pool, _, _, white, _ = case(2)
    start, some = products(pool, white), np.arange(len(RANKS)) % 3 != 1
    taken = np.flatnonzero(some)[:3].tolist()
    columns = pool.columns(taken)
    assert start.of(some).beside(columns).gains()[some] == pytest.approx(start.beside(columns).gains()[some], abs=1e-9)
    back = start.of(some).beside(columns).leaving(np.arange(RANKS[taken[0]]))
    rest = start.beside(pool.columns(taken[1:]))
    assert back.gains()[some] == pytest.approx(rest.gains()[some], abs=1e-9)
    assert back.rss == pytest.approx(rest.rss, rel=1e-9)
    assert back.among(back.at) == pytest.approx(rest.among(back.at), abs=1e-9)
    assert not back.gains()[~some].any()
