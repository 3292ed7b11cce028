"""Standard errors of fits to series that are correlated in time: by series drawn with numpy, of which the truth is
known."""

import numpy as np
import pytest
from scipy.signal import lfilter

from linkwright.core.diagnose.motion.encoders.serial import serial

ROWS, DRAWS = 300, 400


def correlated(random, memory):
    """A series of first order that repeats itself by `memory` from row to row."""
    return lfilter([1.0], [1.0, -memory], random.standard_normal(ROWS + 2000))[-ROWS:]


def tried(random, memory_of_column, memory_of_noise):
    """The size of a column that is not in the series, and its standard errors, beside an offset."""
    design = np.column_stack((correlated(random, memory_of_column), np.ones(ROWS)))
    noise = correlated(random, memory_of_noise)
    sizes = np.linalg.lstsq(design, noise, rcond=None)[0]
    return sizes[0], serial(design, noise - design @ sizes, np.ones(ROWS, dtype=bool))


@pytest.mark.parametrize(("column", "noise"), [(0.0, 0.0), (0.9, 0.0), (0.9, 0.9), (0.98, 0.98), (0.98, 0.995)])
def test_chance_is_as_often_as_sure_as_is_said(column, noise):
    """Of 400 series 4 are expected below one percent; more than 12 happen to three of ten thousand such tests."""
    random = np.random.default_rng(3)
    each = [tried(random, column, noise) for _ in range(DRAWS)]
    assert sum(errors.chance(0, size) < 0.01 for size, errors in each) <= 12


@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_errors_are_as_large_as_sizes_scatter(memory):
    random = np.random.default_rng(4)
    each = [tried(random, memory, memory) for _ in range(DRAWS)]
    scatter = np.std([size for size, _ in each])
    assert np.sqrt(np.mean([errors.error[0] ** 2 for _, errors in each])) == pytest.approx(scatter, rel=0.25)


def test_rows_that_repeat_others_tell_nothing_more():
    """Four times the rows, each four times: as sure as one in four of them, where independent rows would be twice."""
    random = np.random.default_rng(5)
    column, noise = np.sin(0.03 * np.arange(ROWS)), random.standard_normal(ROWS)
    use = np.ones(ROWS, dtype=bool)
    once = serial(column[:, None], noise, use).error[0]
    repeated = serial(np.repeat(column, 4)[:, None], np.repeat(noise, 4), np.repeat(use, 4)).error[0]
    assert repeated == pytest.approx(once, rel=0.1)


def test_a_number_that_is_known_beforehand_is_known_no_worse():
    random = np.random.default_rng(6)
    column, noise = np.sin(0.03 * np.arange(ROWS))[:, None], random.standard_normal(ROWS)
    width = 1e-3
    held = serial(column, noise, np.ones(ROWS, dtype=bool), np.full(1, 1.0 / width**2), np.full(1, width))
    assert held.error[0] == pytest.approx(width, rel=0.01)
