"""A coarse column does not switch the check for outliers off, what warms up is no outlier, an outlier no physics."""

import numpy as np
import pytest

from linkwright.core.diagnose.residual.noise import noise_floor
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.arm_of_drives import SIGMA, arm_of_drives
from tests.diagnose.by_cosines import file, noise, poses, recording, tips
from tests.diagnose.recorded import planar_tip

FINE = 1.5e-6


@pytest.mark.parametrize("step", [5, None], ids=["in steps of 10 um", "constant"])
def test_one_coarse_column_does_not_switch_the_check_off(step):
    """The other column's noise is 1.5 um; two readings are millimetres off."""
    q = np.repeat(poses(1), 3, axis=0)
    tip = tips(q) + noise(1, len(q), FINE)
    tip[:, 0] = np.round(tip[:, 0], step) if step else tips(q)[:, 0]
    tip[10, 1] += 4e-3
    tip[70, 1] += 3e-3
    read = recording(q, tip)
    floor = noise_floor(read, file())
    assert [outlier.row for outlier in floor.outliers] == [11, 71]
    assert floor.sigma[1] == pytest.approx(FINE, rel=0.2)
    assert floor.sigma[0] < 1e-5 / np.sqrt(12.0) + FINE
    result = diagnose(file(), read)
    assert result.verdict == "none"
    assert result.scatter is None  # what rounding leaves is no scatter of the arm


@pytest.mark.parametrize(
    ("together", "lasts"),
    [pytest.param(1, 60.0, marks=pytest.mark.slow), pytest.param(4, 32.0, marks=pytest.mark.slow), (15, 60.0)],
)
def test_what_warms_up_is_no_outlier(together, lasts):
    """0.3 mm at first, then less with every reading: alone, in repeats of four and in one long stay."""
    q = np.repeat(poses(2, 120 // together), together, axis=0)
    time = 8.0 * np.arange(len(q))
    warms = 3e-4 * np.exp(-time / lasts)[:, None] * [1.0, 0.5]
    result = diagnose(file(), recording(q, tips(q) + warms + noise(2, len(q))))
    assert result.rejected_rows == ()
    assert all(finding.effect == "frame_drift" for finding in result.findings)


def test_a_first_reading_that_is_wrong_is_an_outlier_still():
    q = np.repeat(poses(2, 30), 4, axis=0)
    tip = tips(q) + noise(2, len(q))
    tip[[0, 40]] += 3e-4
    assert [outlier.row for outlier in noise_floor(recording(q, tip), file()).outliers] == [1, 41]


@pytest.mark.parametrize("seed", slow_but([0, 9, 14], 9))
def test_one_wrong_reading_is_set_aside_and_is_no_physics(seed):
    """Thirty poses, each read once, and nothing wrong but one reading, by ten times the noise."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.6, 1.6, (30, 3))
    tip = planar_tip(q) + SIGMA * rng.standard_normal((30, 2))
    wrong = int(rng.integers(30))
    tip[wrong] += 10.0 * SIGMA * np.array([np.cos(seed), np.sin(seed)])
    result = diagnose(arm_of_drives(), recording(q, tip, frame="free"))
    assert [item.row for item in result.rejected_rows] == [wrong + 1]
    assert result.verdict == "none"
