"""The smooth model of what nothing explains: it predicts what is smooth, and leaves known physics alone."""

import numpy as np
import pytest

from linkwright.core.diagnose.answer.gaussian_process import smooth_model


def made(count, rng):
    """Joint angles (N, 2), a smooth displacement (N, 2) over them and a known pattern (N, 2, 1), m."""
    q = rng.uniform(-1.5, 1.5, (count, 2))
    wave = 1e-4 * np.column_stack([np.sin(2.0 * q[:, 0]) * q[:, 1], np.cos(1.5 * q.sum(axis=1))])
    known = np.column_stack([np.sin(q[:, 0]), np.cos(q[:, 0])])[:, :, None]
    return q, wave, known


def test_it_predicts_what_it_has_not_seen():
    rng = np.random.default_rng(1)
    q, wave, _ = made(150, rng)
    model = smooth_model(q, wave + rng.normal(0.0, 5e-6, wave.shape), [])
    there, truth, _ = made(80, rng)
    missed = model.predict(there) - truth
    assert np.sqrt(np.mean(missed**2)) < 0.1 * np.sqrt(np.mean(truth**2))


def test_it_takes_nothing_of_what_is_known():
    """A residual that known physics describes is no business of the process."""
    rng = np.random.default_rng(2)
    q, _, known = made(120, rng)
    residual = 1e-4 * known[:, :, 0] + rng.normal(0.0, 5e-6, (120, 2))
    taken = smooth_model(q, residual, [known]).predict(q)
    left = smooth_model(q, residual, []).predict(q)
    size = np.sqrt(np.mean(known**2)) * 1e-4
    assert np.sqrt(np.mean(taken**2)) < 0.15 * size
    assert np.sqrt(np.mean(left**2)) > 0.8 * size


def test_of_noise_it_makes_little():
    rng = np.random.default_rng(3)
    q, _, _ = made(120, rng)
    noise = rng.normal(0.0, 1e-5, (120, 2))
    there, _, _ = made(60, rng)
    assert np.sqrt(np.mean(smooth_model(q, noise, []).predict(there) ** 2)) < 0.5e-5


def test_inputs_that_never_change_do_no_harm():
    rng = np.random.default_rng(4)
    q, wave, _ = made(60, rng)
    with_constant = np.column_stack([q, np.full(60, 293.15)])
    assert np.isfinite(smooth_model(with_constant, wave, []).predict(with_constant)).all()


@pytest.mark.parametrize("count", [5, 400])
def test_few_and_many_readings(count):
    rng = np.random.default_rng(5)
    q, wave, _ = made(count, rng)
    assert smooth_model(q, wave, []).predict(q).shape == (count, 2)
