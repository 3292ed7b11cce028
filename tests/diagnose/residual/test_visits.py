"""The noise of poses that are stayed at for hours, or only ever come back to."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.noise import noise_floor
from linkwright.core.diagnose.residual.visits import differences_of_revisits, without_drift
from tests.diagnose.recorded import planar_arm, planar_tip, poses

ARM: Arm = planar_arm()
SIGMA = 8e-6


def stay(seed: int, drift: float, *, count: int = 480) -> Recording:
    """Eight hours at one pose, while the tip moves by `drift` (m) as an arm does that warms."""
    random = np.random.default_rng(seed)
    q, time = np.repeat(poses(1, seed), count, axis=0), np.linspace(0.0, 28800.0, count)
    moved = drift * (1.0 - np.exp(-time / 5000.0))[:, None] * np.array([0.8, -0.6])
    tip = planar_tip(q) + moved + SIGMA * random.standard_normal((count, 2))
    return Recording("r.csv", q, tip, np.arange(1, count + 1), time=time)


def cycles(seed: int, *, drift: float = 0.0, sigma: float = SIGMA) -> Recording:
    """Five poses, thirty times one after the other (ISO 9283)."""
    random = np.random.default_rng(seed)
    q = np.tile(poses(5, seed), (30, 1))
    wandered = drift * np.linspace(0.0, 1.0, 150)[:, None]
    tip = planar_tip(q + 1e-3 * np.cos(q)) + wandered + sigma * random.standard_normal((150, 2))
    return Recording("r.csv", q, tip, np.arange(1, 151))


@pytest.mark.parametrize("drift", [0.0, 50e-6, 500e-6])
def test_drift_within_a_stay_is_no_noise(drift: float) -> None:
    """The mean of twenty estimates with some 350 degrees of freedom a component: within 2 % of the truth."""
    results = [noise_floor(stay(seed, drift), ARM) for seed in range(20)]
    assert all(result.source == "repeats" and not result.outliers for result in results)
    assert np.mean([result.rms_m or 0.0 for result in results]) == pytest.approx(math.sqrt(2.0) * SIGMA, rel=0.02)
    if drift:
        moved = np.std(drift * (1.0 - np.exp(-np.linspace(0.0, 28800.0, 480) / 5000.0)))
        assert [result.drift_m for result in results] == pytest.approx([float(moved)] * 20, rel=0.15)


def test_a_stay_without_drift_is_kept_whole() -> None:
    """The test's level is 1 in 1000: of 300 still stays hardly any is cut."""
    random = np.random.default_rng(1)
    cut = sum(len(without_drift(random.standard_normal((60, 3)), [np.arange(60)])) > 1 for _ in range(300))
    assert cut <= 3


@pytest.mark.parametrize("drift", [0.0, 60e-6])
def test_poses_that_are_come_back_to(drift: float) -> None:
    results = [noise_floor(cycles(seed, drift=drift), ARM) for seed in range(20)]
    assert {result.source for result in results} == {"revisits"}
    # From cycle to cycle the drift is a thirtieth of itself, 2 um: next to nothing beside 8 um of noise.
    assert np.mean([result.rms_m or 0.0 for result in results]) == pytest.approx(math.sqrt(2.0) * SIGMA, rel=0.06)
    assert all("visited again" in result.sentence for result in results)


def test_a_declared_sigma_goes_before_revisits() -> None:
    assert noise_floor(replace(cycles(1), sigma=5e-6), ARM).source == "declared"


def test_poses_of_their_own_say_nothing_of_noise() -> None:
    q = poses(50)
    recording = Recording("r.csv", q, planar_tip(q), np.arange(1, 51))
    assert noise_floor(recording, ARM).source == "none"


def test_differences_have_the_variance_of_a_reading() -> None:
    random = np.random.default_rng(3)
    values = random.normal(0.0, 2.0, (4000, 2)) + np.linspace(0.0, 50.0, 4000)[:, None]
    result = differences_of_revisits(values, [np.arange(2000), np.arange(2000, 4000)])
    assert result.shape == (3998, 2)
    assert np.sqrt(np.mean(result**2)) == pytest.approx(2.0, rel=0.03)
