"""A tracker that wanders is no physics, and what goes with time otherwise is found as before."""

import math
from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.time_vs_path import rather_with_time
from linkwright.core.diagnose.residual.wander import growth, remembered, walks, wander_in, without_wander
from linkwright.core.diagnose.residual.wander_seen import seen_to_wander
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.diagnose.several.recordings import together
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.by_cosines import GIVES, SIGMA, file, noise, poses, recording, tips


def test_whitening_is_that_of_the_whole_covariance():
    """Against Cholesky's factor of the dense covariance of noise and random walk."""
    rng = np.random.default_rng(1)
    grows = rng.uniform(0.0, 0.3, 11)
    walked = np.concatenate([[0.0], np.cumsum(grows)])
    covariance = np.eye(12) + np.minimum.outer(walked, walked)
    values = rng.standard_normal((12, 2, 3))
    dense = np.linalg.solve(np.linalg.cholesky(covariance), values.reshape(12, -1)).reshape(values.shape)
    assert without_wander(values, grows) == pytest.approx(dense, abs=1e-12)


def test_each_recording_has_a_walk_of_its_own():
    """The covariance of two recordings is that of each, and nought between them; walks that are drawn have it."""
    rng = np.random.default_rng(11)
    time = np.cumsum(rng.uniform(1.0, 9.0, 12))
    which = np.repeat([0, 1], [7, 5])
    grows = growth(time, 0.04, which)
    since = time - np.where(which == 0, time[0], time[7])
    walked = 0.04 * np.minimum.outer(since, since) * (which[:, None] == which)
    values = rng.standard_normal((12, 2))
    dense = np.linalg.solve(np.linalg.cholesky(np.eye(12) + walked), values)
    assert without_wander(values, grows) == pytest.approx(dense, abs=1e-12)
    drawn = walks(grows, rng.standard_normal((12, 40000)))
    assert drawn @ drawn.T / 40000 == pytest.approx(walked, abs=0.05 * walked.max())


def found_in(values, time, which=None, beside=None):
    beside = np.zeros((*values.shape, 0)) if beside is None else beside
    return wander_in(values, time, which, beside, rules=RULES.fitting).rate


def test_a_walk_is_found_as_fast_as_it_is_and_none_in_white_noise():
    rng = np.random.default_rng(2)
    white = rng.standard_normal((20, 300, 2))
    time = 5.0 * np.arange(300)
    assert [found_in(item, time) for item in white] == [0.0] * 20
    walked = white + np.cumsum(0.2 * rng.standard_normal(white.shape), axis=1)
    rates = np.array([found_in(item, time) for item in walked])
    assert np.sqrt(5.0 * np.median(rates)) == pytest.approx(0.2, rel=0.35)  # the grid's step


def test_what_nuisances_take_up_is_neither_a_walk_nor_hides_one():
    """An instrument a hundred scatters away, another way in each of two recordings: where the frames are fitted the
    same walk is found as without, and none in noise."""
    rng = np.random.default_rng(12)
    time, which = 5.0 * np.arange(300), np.repeat([0, 1], 150)
    beside = np.zeros((300, 2, 4))
    for one in (0, 1):
        beside[which == one, :, 2 * one : 2 * one + 2] = np.eye(2)
    away = beside @ np.array([100.0, -40.0, 30.0, 250.0])
    white = rng.standard_normal((20, 300, 2))
    assert [found_in(item + away, time, which, beside) for item in white] == [0.0] * 20
    walked = white + walks(growth(time, 0.008, which), rng.standard_normal((300, 20, 2))).transpose(1, 0, 2)
    rates = np.array([found_in(item + away, time, which, beside) for item in walked])
    assert np.sqrt(5.0 * np.median(rates)) == pytest.approx(0.2, rel=0.35)


def read(seed, moved, softer=0.0):
    q = np.repeat(poses(seed, 50), 3, axis=0)
    time = 8.0 * np.arange(len(q))
    tip = tips(q, gives=GIVES + np.array([0.0, softer, 0.0]))
    return recording(q, tip + noise(seed, len(q)) + moved(time, np.random.default_rng(seed)))


def walk(time, rng):
    return np.cumsum(0.15 * SIGMA * rng.standard_normal((len(time), 2)), axis=0)


@pytest.mark.parametrize("seed", slow_but(range(4), 1))
def test_a_tracker_that_wanders_is_no_physics(seed):
    """0.15 of the noise a reading: 0.03 mm at the end, which had physics named at p = 1e-14."""
    result = diagnose(file(), read(seed, walk))
    assert result.verdict == "none"
    assert any(note.startswith("The instrument may wander") for note in result.notes)


def back(seed, moved):
    """Ten poses, gone through five times."""
    q = np.repeat(np.tile(poses(seed, 10), (5, 1)), 2, axis=0)
    time = 8.0 * np.arange(len(q))
    return recording(q, tips(q) + noise(seed, len(q)) + moved(time, np.random.default_rng(seed)))


def test_only_what_does_not_move_with_the_arm_shows_that_the_instrument_wanders():
    """Poses that are come back to, or a target on the base; without them it may, and white noise never does."""

    def seen(made):
        observed = observe(file(), made)
        return seen_to_wander(observed, observed.tip_residual())

    def still(time, _):
        return np.zeros((len(time), 2))

    def fast(time, rng):
        return 2.0 * walk(time, rng)

    assert [seen(back(seed, fast)) for seed in range(3)] == ["what was read again at poses visited again"] * 3
    assert [seen(back(seed, still)) for seed in range(8)] == [""] * 8
    assert [seen(read(seed, fast)) for seed in range(3)] == [""] * 3
    # A target that stands still beside an arm that creeps, and one that goes with the instrument.
    rng = np.random.default_rng(7)
    gone = fast(8.0 * np.arange(150), np.random.default_rng(1))
    target = np.array([0.1, 0.0, 0.0]) + SIGMA * rng.standard_normal((150, 3))
    moved = target + np.column_stack([gone, np.zeros(150)])
    assert seen(replace(read(1, fast), base_target=target)) == ""
    assert seen(replace(read(1, fast), base_target=moved)) == "the target on the base"


@pytest.mark.slow
def test_a_tracker_that_was_mounted_anew_wanders_on():
    """Two recordings with frames of their own: each walk was taken for physics, as only that of one was looked for."""
    for seed in (0, 2, 4):
        parts = [replace(read(k, walk), frame="free") for k in (seed, seed + 1)]
        result = diagnose(file(), together(parts, file()))
        assert result.verdict == "none"
        assert any(note.startswith("The instrument may wander") for note in result.notes)


@pytest.mark.slow
def test_a_drive_is_found_beside_a_tracker_that_wanders():
    result = diagnose(file(), read(1, walk, softer=4e-6))
    assert [(finding.effect, finding.at) for finding in result.findings] == [("joint_compliance", (2,))]
    size = result.findings[0].parameters[0]
    assert size.interval[0] < 4e-6 < size.interval[1]
    assert result.unknown is None


def _warming(seed, warm, moved):
    q = np.repeat(poses(seed, 50), 2, axis=0)
    tip = tips(q) + moved(np.random.default_rng(seed + 50)) + noise(seed, len(q))
    return diagnose(file(), recording(q, tip, temperature=293.15 + warm))


def test_a_walk_is_not_what_a_hall_that_warms_evenly_does():
    """Whatever goes with a smooth temperature goes with time: a walk was `something that follows the temperature`."""
    warm = 6.0 * (1.0 - np.exp(-np.arange(100) / 50.0))
    result = _warming(3, warm, lambda rng: np.cumsum(0.35 * SIGMA * rng.standard_normal((100, 2)), axis=0))
    assert result.verdict == "none"
    assert any(note.startswith("The instrument may wander") for note in result.notes)


@pytest.mark.parametrize("seed", slow_but([3, 4], 3))
def test_what_does_follow_the_temperature_is_no_walk(seed):
    warm = 6.0 * np.sin(np.linspace(0.0, 2.0 * np.pi, 100))
    result = _warming(seed, warm, lambda _: SIGMA * np.outer(warm, [1.0, -0.5]))
    assert result.unknown is not None
    assert result.unknown.depends_on == ("temperature_degC", "time")
    assert result.unknown.shape == "something that follows the temperature"


@pytest.mark.slow
def test_what_else_goes_with_time_is_no_walk():
    """A frame that drifts evenly, and something that slipped."""
    along = np.array([1.0, 0.5])
    drift = diagnose(file(), read(5, lambda time, _: 5e-8 * time[:, None] * along))
    assert [finding.effect for finding in drift.findings] == ["frame_drift"]
    slipped = diagnose(file(), read(6, lambda time, _: 6e-5 * (time > 500.0)[:, None] * along))
    assert slipped.verdict == "unknown"
    assert slipped.unknown.since == pytest.approx(504.0, abs=16.0)


def _raster(rounds):
    """Three joints through a grid of poses, each next to the one before, so many times over."""
    steps = np.linspace(-1.2, 1.2, 7)
    there = np.array([(a, b) for i, a in enumerate(steps) for b in (steps if i % 2 == 0 else steps[::-1])])
    once = np.concatenate([there, 0.5 * there[:, :1]], axis=1)
    return np.tile(once, (rounds, 1))


def _gone_along(q, moved):
    tip = tips(q)
    return recording(q, tip + noise(7, len(q)) + moved(8.0 * np.arange(len(q)), np.random.default_rng(3)))


@pytest.mark.parametrize("rounds", slow_but([1, 4], 1))
def test_physics_along_a_raster_is_no_wander(rounds):
    """Poses and time go together in one round; in four, what the arm does comes back with the pose."""
    q = _raster(rounds)
    bends = recording(q, tips(q, gives=GIVES + np.array([0.0, 6e-6, 0.0])) + noise(7, len(q)))
    result = diagnose(file(), bends)
    assert [(finding.effect, finding.at) for finding in result.findings] == [("joint_compliance", (2,))]
    assert not any(note.startswith("The instrument may wander") for note in result.notes)


def test_a_wander_shows_where_poses_are_come_back_to():
    """Along a raster each pose is near the one before; four rounds of it tell what stays from what wanders."""
    read_again = _gone_along(_raster(4), lambda time, rng: 3.0 * walk(time, rng))
    result = diagnose(file(), read_again)
    assert result.findings == ()
    assert any(note.startswith("The instrument wanders, as what was read again") for note in result.notes)


def _wandered_along_one_round(seed):
    """0.2 of the noise a reading: nothing tells it from the arm there, which was named at p = 1e-14."""
    q = np.repeat(_raster(1), 3, axis=0)
    walked = np.cumsum(0.2 * SIGMA * np.random.default_rng(seed).standard_normal((len(q), 2)), axis=0)
    result = diagnose(file(), recording(q, tips(q) + noise(seed, len(q)) + walked))
    assert any(note.startswith("The remainder changes with time and with") for note in result.notes)
    return result


def test_neighbours_that_tell_as_much_as_one_have_one_sign():
    """With signs visit by visit the mass of link 1 was named."""
    assert _wandered_along_one_round(3).verdict == "none"


def test_along_one_round_no_p_value_is_given_beside_a_wander():
    result = _wandered_along_one_round(2)
    assert [finding.effect for finding in result.findings] == ["frame_drift"]
    assert all(math.isnan(finding.p_value) for finding in result.findings)
    assert any("none is given" in note for note in result.notes)


def test_neighbours_that_remember_count_as_fewer():
    """An autoregression of 0.8: its integrated autocorrelation time is (1 + 0.8)/(1 - 0.8) = 9."""
    rng = np.random.default_rng(5)
    values = np.zeros((20000, 1))
    for k in range(1, len(values)):
        values[k] = 0.8 * values[k - 1] + rng.standard_normal(1)
    assert remembered(values) == pytest.approx(9, abs=1)
    assert remembered(rng.standard_normal((20000, 1))) <= 2


def test_time_and_pose_are_told_apart():
    """Values of the time at poses at random go with time, values of the pose do not."""
    rng = np.random.default_rng(4)
    at = rng.uniform(-1.0, 1.0, (200, 2))
    in_time = np.sin(np.arange(200) / 15.0)[:, None] + 0.3 * rng.standard_normal((200, 1))
    in_pose = np.sin(2.0 * at[:, :1]) + 0.3 * rng.standard_normal((200, 1))
    assert rather_with_time(in_time, at, rules=RULES.fitting)
    assert not rather_with_time(in_pose, at, rules=RULES.fitting)
