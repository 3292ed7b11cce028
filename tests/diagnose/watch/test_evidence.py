"""Evidence of a change in a series: textbook tests, false alarms and power over many series by chance alone."""

import warnings

import numpy as np
import pytest
from scipy import stats

from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.watch.course import Series, course_of
from linkwright.core.diagnose.watch.evidence import kink, level, steps, tried
from tests.diagnose.watch.quiet import told_at

WHEN = 7.0 * np.arange(30)
LEVEL = level(0.01, 50, 1)


def _course(values, errors=None):
    errors = np.ones(len(values)) if errors is None else errors
    return course_of(Series(values, errors, WHEN[: len(values)], np.ones(len(values)), RULES.watch), LEVEL)


def test_without_a_prior_it_is_the_textbook_t_test():
    rng = np.random.default_rng(4)
    values = rng.standard_normal(12)
    result = tried(values[None], np.ones((1, 12)), np.ones((12, 1)), steps(12), np.ones(1), 0.0)
    for after in range(1, 12):
        t = stats.ttest_ind(values[after:], values[:after]).statistic if 1 < after < 11 else result.t[0, after - 1]
        assert result.t[0, after - 1] == pytest.approx(t, rel=1e-9)
    slope = tried(values[None], np.ones((1, 12)), np.ones((12, 1)), kink(WHEN[:12], 0)[:, None], np.ones(1), 0.0)
    line = stats.linregress(WHEN[:12], values)
    assert slope.sizes[0, 0] / WHEN[11] == pytest.approx(line.slope, rel=1e-9)
    assert 2.0 * stats.t.sf(abs(slope.t[0, 0]), slope.freedom) == pytest.approx(line.pvalue, rel=1e-9)


def test_weights_are_those_of_weighted_least_squares():
    rng = np.random.default_rng(5)
    values, errors = rng.standard_normal(10), rng.uniform(0.5, 3.0, 10)
    result = tried(values[None], errors[None] ** 2, np.ones((10, 1)), steps(10)[:, 4:5], np.ones(1), 0.0)
    design = np.column_stack([np.ones(10), steps(10)[:, 4]]) / errors[:, None]
    sizes, left, *_ = np.linalg.lstsq(design, values / errors, rcond=None)
    error = np.sqrt(np.linalg.inv(design.T @ design)[1, 1] * left[0] / 8)
    assert (result.sizes[0, 0], result.errors[0, 0]) == pytest.approx((sizes[1], error), rel=1e-9)


@pytest.mark.parametrize(
    ("between", "uneven"),
    [((3.0, *(0.0,) * 7), 0.0), ((1.0,) * 8, 0.5)],
    ids=["one scatters three times as much", "recordings of all kinds"],
)
def test_a_year_of_quiet_weeks_is_quiet(between, uneven):
    """Of 150 watches of 50 weeks and eight parameters one or two may alarm, looked at again every week."""
    rng = np.random.default_rng(11)
    errors = np.exp(uneven * rng.standard_normal((150, 1, 50))) * np.ones((150, 8, 50))
    values = errors * rng.standard_normal((150, 8, 50))
    values += np.array(between)[:, None] * rng.standard_normal((150, 8, 50))
    alarms = int((told_at(values, errors) > 0).any(axis=1).sum())
    assert alarms <= 5  # more in one of two hundred such runs
    if not uneven:
        assert (told_at(values, errors, chance=0.5) > 0).any(axis=1).mean() > 0.15  # it can alarm


def test_a_step_of_four_standard_errors_is_told_within_weeks():
    rng = np.random.default_rng(12)
    values = rng.standard_normal((100, 8, 34))
    values[:, 2, 25:] += 4.0
    told = told_at(values, np.ones_like(values))[:, 2]
    late = told - 25
    assert np.median(late[told > 0]) <= 4
    assert np.mean((told > 25) & (late <= 6)) > 0.9


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_step_is_told_as_one_with_its_date_and_size(seed):
    rng = np.random.default_rng(seed)
    values = rng.standard_normal(30) + 6.0 * (np.arange(30) >= 14)
    (change,) = _course(values).changes
    assert change.turn.kind == "step"
    assert change.earliest <= 14 <= change.latest <= change.earliest + 3
    assert abs(change.size - 6.0) < 3.0 * change.error < 2.0


def test_a_recording_off_alone_and_a_steady_drift():
    rng = np.random.default_rng(8)
    values = rng.standard_normal(30)
    values[10] += 15.0
    off = _course(values)
    assert [(change.turn.kind, change.turn.at) for change in off.changes] == [("once", 10)]
    assert off.deviations.mean() == pytest.approx(1.0, abs=0.35)
    drift = _course(rng.standard_normal(30) + 0.4 * np.arange(30))
    assert [change.turn.kind for change in drift.changes] == ["drift"]
    assert drift.changes[0].size == pytest.approx(0.4 * 29, abs=3.0)


def test_two_steps_are_two():
    rng = np.random.default_rng(9)
    place = np.arange(30)
    values = rng.standard_normal(30) + 7.0 * (place >= 10) - 12.0 * (place >= 21)
    result = _course(values).changes
    assert [(item.turn.kind, item.turn.at) for item in result] == [("step", 10), ("step", 21)]
    assert [item.size for item in result] == pytest.approx([7.0, -12.0], abs=1.5)


@pytest.mark.parametrize("later", [0.0, 1e-13, 5.0])
def test_a_series_that_does_not_scatter_has_a_course(later):
    """Copies of a recording, or an estimate that stays at its bound: ways to tell a change that are one and the same
    (the first alone, or a step after it) are no two."""
    place, quiet = np.arange(30), np.zeros(30)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for values in (place >= 1, place >= 17, (place >= 1) * 1.0 + (place >= 2), (place >= 9) * 1.0 - (place >= 10)):
            result = course_of(Series(1.0 + later * values, 1e-6 + quiet, WHEN[:30], quiet, RULES.watch), LEVEL)
            assert np.isfinite(result.deviations).all()
            assert (later < 1.0) or result.changes
