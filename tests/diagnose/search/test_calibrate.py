"""How often chance is called physics, and that visits stay whole."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom, kstest

from linkwright.core.diagnose.search.calibrate import Draws, each_given_others, one_more, p_value, shuffled
from linkwright.core.diagnose.search.subsets import criterion_for, products
from tests.diagnose.core_cases import random_pool

VISITS = np.repeat(np.arange(24), 3)


@pytest.mark.parametrize("count", [4, 30])
def test_visits_stay_whole(count):
    """Every visit's readings come out in their order, next to each other in the cycle, under one sign."""
    visits = np.repeat(np.arange(count), np.arange(count) % 3 + 1)
    table = np.column_stack([visits + 1.0, np.arange(len(visits)) + 1.0])
    rng = np.random.default_rng(1)
    signs = set()
    for _ in range(20):
        drawn = shuffled(table, visits, rng)
        assert sorted(np.abs(drawn[:, 1])) == sorted(table[:, 1])
        for visit in range(count):
            places = np.flatnonzero(np.abs(drawn[:, 0]) == visit + 1.0)
            assert len({float(np.sign(x)) for x in drawn[places, 0]}) == 1
            signs.add((visit, float(np.sign(drawn[places[0], 0]))))
            start = next(p for p in places if (p - 1) % len(table) not in places or len(places) == len(table))
            run = (start + np.arange(len(places))) % len(table)
            assert sorted(run) == sorted(places)
            assert np.abs(drawn[run, 1]) == pytest.approx(table[visits == visit, 1])
    assert len(signs) == 2 * count


@pytest.mark.parametrize("count", [5, 40])
def test_a_draw_is_least_squares_of_readings_turned_about_by_visit(count):
    """Of many visits the signs alone; each group is fitted beside the smaller model to every draw by itself."""
    rng = np.random.default_rng(11)
    visits = np.repeat(np.arange(count), np.arange(count) % 4 + 3)
    rows = 2 * len(visits)
    pool, _, _ = random_pool(rng, (1, 1, 2, 3, 1), rows=rows, nuisances=2)
    vector = pool.projected(rng.standard_normal(rows))
    criterion, everything = criterion_for(pool, rows), np.array([True, True, True, False, True])
    among = [everything]
    initial, draws = products(pool, vector), np.random.default_rng(2)
    result = one_more(initial, vector, (3,), criterion, Draws(visits, 2, 40, draws), among)[0]
    smaller = np.hstack([pool.nuisance, pool.basis[:, pool.columns([3])]])
    residual = vector - smaller @ np.linalg.lstsq(smaller, vector, rcond=None)[0]
    table, again, expected = residual.reshape(-1, 2), np.random.default_rng(2), []

    def left(columns, vector):
        return float(np.sum((vector - columns @ np.linalg.lstsq(columns, vector, rcond=None)[0]) ** 2))

    for _ in result.drawn:
        signs = again.choice((-1.0, 1.0), count)[visits][:, None] if count > 20 else None
        drawn = (shuffled(table, visits, again) if signs is None else signs * table).reshape(-1)
        best = [
            criterion.count * np.log(left(smaller, drawn) / left(np.hstack([smaller, pool.basis[:, at]]), drawn))
            - criterion.price[number]
            for number, at in ((k, pool.columns([k])) for k in (0, 1, 2, 4))
        ]
        expected.append(max(best))
    assert result.drawn == pytest.approx(expected, rel=1e-9)


def p_values(pool, make, draws=99, trials=150, seed=1):
    rng = np.random.default_rng(seed)
    criterion = criterion_for(pool, len(pool.nuisance) - pool.nuisance.shape[1])
    everything = np.ones(len(pool.groups), dtype=bool)
    results = []
    for _ in range(trials):
        vector = pool.projected(make(rng))
        initial = products(pool, vector)
        tested = one_more(initial, vector, (), criterion, Draws(VISITS, 2, draws, rng), [everything])
        results.append(tested[0].p_value)
    return np.array(results)


def reach(rng):
    """How far each reading's visit scatters, and how far its arm reaches."""
    return np.repeat(rng.uniform(0.2, 2.0, 24), 3)


@pytest.mark.parametrize("kind", ["plain", "by visit", "by reach"])
def test_under_a_null_p_is_uniform(kind):
    """Readings on their own, readings that share their visit's scatter, and scatter that grows where patterns do."""
    rng = np.random.default_rng(2)
    size = reach(rng) if kind == "by reach" else np.ones(72)
    shared = [rng.standard_normal((24, 2, rank))[VISITS] for rank in (*(1,) * 12, 3)]
    columns = [(size[:, None, None] * part).reshape(144, -1) for part in shared]
    pool, _, _ = random_pool(rng, (), columns=columns, rows=144)

    def null(rng):
        shared = 0.0 if kind == "plain" else rng.standard_normal((24, 2))[VISITS]
        return (size[:, None] * (shared + 0.5 * rng.standard_normal((72, 2)))).reshape(-1)

    result = p_values(pool, null)
    assert kstest(result, "uniform").pvalue > 1e-3
    assert np.sum(result <= 0.05) <= binom.ppf(0.999, len(result), 0.05)


def test_a_constant_offset_is_seen():
    """It would survive any order of the visits; their signs tell it."""
    rng = np.random.default_rng(3)
    constant = np.tile([1.0, 0.0], 72)[:, None]
    columns = [*(rng.standard_normal((144, 1)) for _ in range(10)), constant]
    pool, columns, _ = random_pool(rng, (), columns=columns, rows=144, nuisances=0)
    criterion = criterion_for(pool, 144)
    vector = 0.8 * constant[:, 0] + rng.standard_normal(144)
    everything = np.ones(11, dtype=bool)
    among = [everything, ~everything]
    tested = one_more(products(pool, vector), vector, (), criterion, Draws(VISITS, 2, 499, rng), among)
    assert tested[0].best == 10
    assert tested[0].p_value < 0.002
    assert tested[1].p_value == 1.0


def test_what_is_given_is_not_found_again():
    rng = np.random.default_rng(4)
    columns = [rng.standard_normal((144, 1)) for _ in range(8)]
    pool, columns, _ = random_pool(rng, (), columns=columns, rows=144)
    vector = pool.projected(3.0 * columns[2][:, 0] + rng.standard_normal(144))
    criterion = criterion_for(pool, 141)
    everything = np.ones(8, dtype=bool)
    initial, how = products(pool, vector), Draws(VISITS, 2, 199, rng)
    bare = one_more(initial, vector, (), criterion, how, [everything])
    rest = one_more(initial, vector, (2,), criterion, how, [everything])
    assert bare[0].best == 2
    assert bare[0].p_value < 1e-3
    assert rest[0].p_value > 0.01


def test_p_counts_draws_and_reads_the_tail_off_beyond_them():
    rng = np.random.default_rng(5)
    drawn = rng.gumbel(3.0, 2.0, 400)
    middle = float(np.quantile(drawn, 0.7))
    assert p_value(middle, drawn) == pytest.approx((1 + np.sum(drawn >= middle)) / 401)
    far = 3.0 + 2.0 * 12.0
    logarithms = [np.log(p_value(far, rng.gumbel(3.0, 2.0, 400))) for _ in range(60)]
    # The spread of 400 draws is known to 5 %, so one logarithm to 0.6, and the mean of 60 to 0.1 (and a bias of 0.1).
    assert np.mean(logarithms) == pytest.approx(-12.0, abs=0.4)
    assert p_value(far, drawn[:20]) == pytest.approx(1.0 / 21.0)


def test_a_group_that_could_fit_anything_is_not_tested():
    rng = np.random.default_rng(8)
    pool, _, _ = random_pool(rng, (9, 1), rows=16, nuisances=0)
    visits = np.arange(8)
    vector = rng.standard_normal(16)
    everything = np.ones(2, dtype=bool)
    initial, criterion = products(pool, vector), criterion_for(pool, 16)
    tested = one_more(initial, vector, (), criterion, Draws(visits, 2, 99, rng), [everything])
    assert tested[0].best == 1


@pytest.mark.parametrize("twins", [False, True])
def test_each_group_is_tested_beside_the_others_the_weakest_first(twins):
    """As `one_more` tests it beside them, by the same draws; groups that hold a direction twice too."""
    rng = np.random.default_rng(6)
    columns = [rng.standard_normal((144, rank)) for rank in (1, 2, 1, 1, 3, 1)]
    if twins:
        columns[2] = columns[0] + columns[1][:, :1]
    pool, columns, _ = random_pool(rng, (), columns=columns, rows=144)
    vector = pool.projected(0.5 * columns[3][:, 0] + 2.0 * columns[1] @ [1.0, 1.0] + rng.standard_normal(144))
    criterion, initial = criterion_for(pool, 141), products(pool, vector)
    library = np.array([True, True, True, True, True, False])
    members, others = (0, 1, 2, 3), (5,)

    def how():
        return Draws(VISITS, 2, 199, np.random.default_rng(7))

    tested = each_given_others(initial, vector, members, others, criterion, how(), library)
    weakest = -np.inf
    for place, p in tested:
        rest = [m for m in (*members, *others) if m != members[place]]
        # Each has its own draws: those of the first alone are the same.
        alone = one_more(initial, vector, rest, criterion, how(), [library])[0]
        statistic = float(alone.each[members[place]])
        assert statistic >= weakest - 1e-6
        if weakest == -np.inf:
            assert p == pytest.approx(p_value(statistic, alone.drawn), rel=1e-6)
        weakest = statistic


def test_draws_go_where_they_decide():
    """A statistic that many draws reach, one far beyond all, and one near the level."""
    rng = np.random.default_rng(9)
    columns = [rng.standard_normal((144, 1)) for _ in range(12)]
    pool, columns, _ = random_pool(rng, (), columns=columns, rows=144)
    criterion, everything = criterion_for(pool, 141), np.ones(12, dtype=bool)
    needed: dict[float, int] = {}
    for strength in (0.0, 0.45, 3.0):
        vector = pool.projected(strength * columns[4][:, 0] + rng.standard_normal(144))
        how = Draws(VISITS, 2, 499, np.random.default_rng(1), level=0.003)
        tested = one_more(products(pool, vector), vector, (), criterion, how, [everything])[0]
        in_full = one_more(products(pool, vector), vector, (), criterion, replace(how, level=None), [everything])[0]
        assert (tested.p_value <= 0.003) == (in_full.p_value <= 0.003)
        assert len(in_full.drawn) == 499
        needed[strength] = len(tested.drawn)
    assert max(needed[0.0], needed[3.0]) <= 64
    assert needed[0.45] == 499
