"""A joint's irregular curve is found as one thing, and predicts where it was not fitted."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.diagnose.fitting.held_out import HeldOut, splits
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.core_cases import SIGMA, prepared_null

ORDERS = np.array([3, 8, 13, 17, 22, 27])


def wavy(rng, count=1400):
    """Two rigid links whose second encoder errs by six waves of 0.1 mrad; tips by plain kinematics."""
    arm = Arm("wavy", (Joint(), Joint()), (Link(0.5, mass=0.0), Link(0.4, mass=0.0)))
    q = rng.uniform(-2.5, 2.5, (count, 2))
    size, phase = 1e-4, rng.uniform(0.0, 2.0 * np.pi, len(ORDERS))
    error = size * np.sin(q[:, 1, None] * ORDERS + phase).sum(axis=1)
    tip = tip_position(arm, q + np.stack([np.zeros(count), error], axis=1))[:, :2]
    noisy = tip + SIGMA * rng.standard_normal(tip.shape)
    return arm, Recording(file="", q=q, tip=noisy, row=np.arange(1, count + 1)), error


@pytest.mark.slow
def test_a_curve_is_one_finding():
    arm, recording, error = wavy(np.random.default_rng(4))
    result = diagnose(arm, recording)
    assert [(finding.effect, finding.at) for finding in result.findings] == [("joint_waviness", (2,))]
    size = {p.parameter: p.value for p in result.findings[0].parameters}
    told = sum(
        size[f"sine_{k}"] * np.sin(k * recording.q[:, 1]) + size[f"cosine_{k}"] * np.cos(k * recording.q[:, 1])
        for k in range(1, 33)
    )
    # 64 coefficients from 2,800 components of 15 um over 0.4 m: some 5 urad.
    assert np.sqrt(np.mean((told - error) ** 2)) < 10e-6
    assert result.rms_after_held_out < 1.1 * SIGMA * np.sqrt(2.0)


def test_held_out_fits_are_held_as_asked():
    """A tether of next to nothing changes nothing; one far above what the data say keeps the size at nought."""
    null = prepared_null()
    folds = splits(null.observed, 1)["random rows"]
    rng = np.random.default_rng(2)
    columns = [rng.standard_normal((*null.observed.residual.shape, 2)) for _ in range(2)]

    def rms(*tethers):
        return HeldOut(null.observed, columns, folds, tethers).rms()

    free = rms(None, None)
    assert rms(np.full(2, 1e-6), None) == pytest.approx(free, rel=1e-9)
    assert rms(np.full(2, 1e12), None) == pytest.approx(HeldOut(null.observed, columns[1:], folds).rms(), rel=1e-6)
    both = HeldOut(null.observed, columns, folds)
    assert both.rms([1]) == pytest.approx(HeldOut(null.observed, columns[1:], folds).rms(), rel=1e-12)
    assert both.rms([]) == pytest.approx(np.sqrt(np.mean(np.sum(null.observed.tip_residual() ** 2, axis=1))))


def test_a_column_of_nothing_but_rounding_does_no_harm():
    """A tether on it must not push everything else below what the solver drops."""
    null = prepared_null()
    folds = splits(null.observed, 1)["random rows"]
    real = np.ones((*null.observed.residual.shape, 1))
    nothing = np.full_like(real, 1e-25)
    shifted = replace(null.observed, residual=null.observed.residual + 1e-3)
    alone = HeldOut(shifted, [real], folds).rms()
    assert HeldOut(shifted, [real, nothing], folds, [None, np.full(1, 5e3)]).rms() == pytest.approx(alone, rel=1e-6)
