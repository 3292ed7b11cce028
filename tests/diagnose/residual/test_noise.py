"""The noise floor against the truth that was put in, clean and contaminated, coarse and declared."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import norm

from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.noise import NoiseFloor, noise_floor
from linkwright.core.diagnose.residual.robust_scale import qn, resolution
from linkwright.core.diagnose.residual.visits import repeat_groups
from linkwright.core.sections.numeric import Array
from tests.diagnose.recorded import planar_arm, planar_tip, poses

ARM = planar_arm()
SIGMA = np.array([15e-6, 30e-6])


def repeated(groups: int, repeats: int, seed: int, *, sigma: Array = SIGMA, physics: float = 3e-4) -> Recording:
    """Poses read several times; encoders differ in the last digits, and the arm is not what the model says."""
    random = np.random.default_rng(seed)
    q = np.repeat(poses(groups, seed), repeats, axis=0)
    tip = planar_tip(q + physics * np.sin(3.0 * q)) + sigma * random.standard_normal((len(q), 2))
    return Recording("r.csv", q, tip, np.arange(1, len(q) + 1))


def changed(recording: Recording, **fields: object) -> Recording:
    return Recording(**{**vars(recording), **fields})


@pytest.mark.parametrize("repeats", [2, 3, 5])
def test_sigma_is_within_its_sampling_error(repeats: int) -> None:
    """Over many recordings the ratio to the truth is 1 within four standard errors of its mean."""
    results = [noise_floor(repeated(30, repeats, seed), ARM) for seed in range(40)]
    dof = 30 * (repeats - 1)
    assert all(result.source == "repeats" for result in results)
    assert np.mean([result.degrees_of_freedom for result in results]) > dof - 0.5
    squares = np.array([[*result.sigma] for result in results if result.sigma is not None]) ** 2 / SIGMA**2
    assert squares.mean(axis=0) == pytest.approx([1.0, 1.0], abs=4.0 * math.sqrt(2.0 / dof / 40))
    assert all(result.rms_m == pytest.approx(math.hypot(*(result.sigma or ()))) for result in results)


def test_clean_repeats_have_hardly_ever_an_outlier() -> None:
    """The bound is one clean recording in a hundred; of 200, nine or more would come by chance once in 10^4."""
    called = sum(bool(noise_floor(repeated(20, 3, seed), ARM).outliers) for seed in range(200))
    assert called <= 8


def test_outliers_are_named_and_do_not_count() -> None:
    ratios: list[float] = []
    for seed in range(20):
        recording = repeated(40, 3, seed)
        random = np.random.default_rng(1000 + seed)
        wrong = random.choice(40, 6, replace=False) * 3 + random.integers(0, 3, 6)
        tip = recording.tip.copy()
        angle = random.uniform(0.0, 2.0 * math.pi, 6)
        tip[wrong] += 20.0 * SIGMA.max() * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        result = noise_floor(changed(recording, tip=tip), ARM)
        assert {outlier.row for outlier in result.outliers} == {int(k) + 1 for k in wrong}
        assert result.degrees_of_freedom == 80 - 6
        ratios.append(float(np.mean(np.square(result.sigma or ()) / SIGMA**2)))
    assert np.mean(ratios) == pytest.approx(1.0, abs=4.0 * math.sqrt(1.0 / 74 / 20))


def test_of_a_pair_nobody_can_say_which_is_wrong() -> None:
    recording = repeated(40, 2, 3)
    tip = recording.tip.copy()
    tip[21] += 1e-3
    result = noise_floor(changed(recording, tip=tip), ARM)
    assert result.outliers == ()
    assert result.doubtful == (21, 22)
    assert any("rows 21 to 22" in sentence for sentence in result.warnings)
    assert result.sigma is not None
    assert max(result.sigma) < 2.0 * SIGMA.max()


@pytest.mark.parametrize(("repeats", "off"), [(4, (1.0, 1.1)), (5, (1.0, 2.0, 3.0))])
def test_of_halves_nobody_can_say_which_is_wrong(repeats: int, off: tuple[float, ...]) -> None:
    """Two readings from one side of a drive with play and two from the other: no majority, so that none is set aside;
    what would tell them apart is said where it was not logged."""
    recording = repeated(40, repeats, 3)
    tip = recording.tip.copy()
    tip[10 * repeats : 10 * repeats + len(off)] += 1e-3 * np.array(off)[:, None]
    result = noise_floor(changed(recording, tip=tip), ARM)
    assert result.outliers == ()
    assert result.doubtful == tuple(range(10 * repeats + 1, 11 * repeats + 1))
    assert any("log them (dir1, ...)" in sentence for sentence in result.warnings)
    sides = np.ones_like(recording.q)
    logged = noise_floor(changed(recording, tip=tip, sides=sides), ARM)
    assert logged.doubtful == result.doubtful
    assert not any("dir1" in sentence for sentence in logged.warnings)


def test_the_last_digits_of_encoders_do_not_count_as_noise() -> None:
    recording = repeated(40, 3, 3)
    q = recording.q + 1e-4 * np.random.default_rng(2).uniform(-0.5, 0.5, recording.q.shape)
    result = noise_floor(changed(recording, q=q, tip=recording.tip + planar_tip(q) - planar_tip(recording.q)), ARM)
    assert np.array(result.sigma) == pytest.approx(SIGMA, rel=0.25)


def test_a_free_frame_gives_the_same_floor() -> None:
    recording = repeated(40, 3, 3)
    c, s = math.cos(2.0), math.sin(2.0)
    moved = recording.tip @ np.array([[c, s], [-s, c]]) + [3.0, -1.0]
    free = noise_floor(changed(recording, tip=moved, frame="free"), ARM)
    assert free.rms_m == pytest.approx(noise_floor(recording, ARM).rms_m, rel=1e-3)


def test_without_repeats_the_declared_sigma_counts_and_is_said() -> None:
    recording = repeated(40, 1, 3)
    result = noise_floor(changed(recording, sigma=15e-6), ARM)
    assert (result.source, result.degrees_of_freedom, result.sigma) == ("declared", 0, (15e-6, 15e-6))
    assert "declared sigma of 0.015 mm" in result.sentence
    nothing = noise_floor(recording, ARM)
    assert (nothing.source, nothing.sigma, nothing.rms_m) == ("none", None, None)


def test_a_declared_sigma_that_repeats_contradict() -> None:
    even = np.array([20e-6, 20e-6])
    warned = [
        bool(noise_floor(changed(repeated(30, 3, seed, sigma=even), sigma=20e-6), ARM).warnings) for seed in range(100)
    ]
    assert sum(warned) <= 6  # one in a hundred is meant; seven of a hundred come by chance once in 10^4
    for declared in (12e-6, 32e-6):
        result = noise_floor(changed(repeated(30, 3, 1, sigma=even), sigma=declared), ARM)
        assert result.source == "repeats"
        assert any("declared sigma" in sentence for sentence in result.warnings)


def test_a_few_repeats_do_not_overrule_a_declared_sigma() -> None:
    recording = repeated(20, 1, 3)
    q, tip = np.vstack([recording.q, recording.q[-1:]]), np.vstack([recording.tip, recording.tip[-1:] + 1e-5])
    result = noise_floor(Recording("r.csv", q, tip, np.arange(1, 22), sigma=15e-6), ARM)
    assert (result.source, result.sigma) == ("declared", (15e-6, 15e-6))


def test_repeats_that_are_alike_show_the_resolution() -> None:
    recording = repeated(30, 3, 3)
    tips = np.round(planar_tip(recording.q), 4)
    result = noise_floor(changed(recording, tip=tips), ARM)
    assert result.resolution == pytest.approx(1e-4)
    assert result.sigma == pytest.approx((1e-4 / math.sqrt(12.0),) * 2)
    assert "resolution" in result.sentence


def test_poses_visited_again_show_drift() -> None:
    drifts: list[float] = []
    for seed in range(10):
        recording = repeated(30, 3, seed)
        random = np.random.default_rng(seed)
        shift = np.repeat(random.normal(0.0, 1e-4, (30, 2)), 3, axis=0)
        tip = recording.tip + shift + SIGMA * random.standard_normal((90, 2))
        both = Recording("r.csv", np.vstack([recording.q] * 2), np.vstack([recording.tip, tip]), np.arange(1, 181))
        result = noise_floor(both, ARM)
        assert result.drift_degrees_of_freedom == 30
        drifts.append(result.drift_m or 0.0)
    # Two visits that differ by d have the variance d^2/2 about their mean, for each of two components.
    assert np.mean(np.square(drifts)) == pytest.approx(1e-8, rel=0.3)
    still = repeated(30, 3, 1)
    tip = still.tip + SIGMA * np.random.default_rng(9).standard_normal((90, 2)) - 0.0
    again = Recording("r.csv", np.vstack([still.q] * 2), np.vstack([still.tip, tip]), np.arange(1, 181))
    assert (noise_floor(again, ARM).drift_m or 0.0) < 5e-5
    assert noise_floor(still, ARM).drift_m is None


def test_another_payload_side_or_a_pause_is_no_repeat() -> None:
    recording = repeated(4, 3, 3)
    assert [len(group) for group in repeat_groups(recording, ARM)] == [3, 3, 3, 3]
    payload = np.r_[0.0, 0.0, 5.0, np.zeros(9)]
    sides = np.ones((12, 3))
    sides[4:, 1] = -1.0
    time = np.r_[np.arange(10.0), 5000.0, 5001.0]
    grouped = repeat_groups(changed(recording, payload_mass=payload, sides=sides, time=time), ARM)
    assert [group.tolist() for group in grouped] == [[0, 1], [2], [3], [4, 5], [6, 7, 8], [9], [10, 11]]


def test_a_slow_sweep_is_no_single_visit() -> None:
    q = np.linspace(0.0, 0.1, 1001)[:, None] * np.ones(3)
    recording = Recording("r.csv", q, planar_tip(q), np.arange(1, 1002))
    same = 2e-4
    assert all(np.ptp(q[group, 0]) <= same + 1e-12 for group in repeat_groups(recording, ARM))


@pytest.mark.parametrize("count", [2, 3, 6, 9, 10, 25, 200])
def test_qn_estimates_the_standard_deviation_of_gaussian_samples(count: int) -> None:
    """Unbiased with the published small-sample factors (Croux & Rousseeuw 1992), to their printed three digits."""
    random = np.random.default_rng(count)
    draws = [qn(random.standard_normal(count)) for _ in range(4000)]
    error = np.std(draws) / math.sqrt(len(draws))
    assert np.mean(draws) == pytest.approx(1.0, abs=4.0 * error + 0.01)


def test_qn_survives_half_of_the_values_being_wrong() -> None:
    values = norm.ppf((np.arange(200) + 0.5) / 200.0)
    values[:90] = 1e6 * np.arange(1, 91)
    assert 0.5 < qn(values) < 6.0


@pytest.mark.parametrize("step", [1e-3, 2.5e-6, 5e-5, 2e-7, 1e-8])
def test_resolution(step: float) -> None:
    counts = np.random.default_rng(1).integers(-400_000, 400_000, 300)
    assert resolution(counts * step) == pytest.approx(step)
    assert resolution(np.random.default_rng(1).uniform(size=50)) is None
    assert resolution(np.full(5, 0.25)) is None
    # Of a coordinate that stays near nought, as across the plane in which an arm moves, a half metre is no step.
    assert resolution(np.array([13597e-9, -2980e-9, -561e-9, 15665e-9])) == pytest.approx(1e-9)


def test_floor_is_a_plain_result() -> None:
    result = noise_floor(repeated(10, 3, 1), ARM)
    assert isinstance(result, NoiseFloor)
    assert "20 degrees of freedom" in result.sentence
