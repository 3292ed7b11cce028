"""All lengths and a slide's travel in one proportion are the instrument's scale, to the last digit."""

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.effects import Settings
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but

SIGMA = 15e-6
COLUMN, UPPER, LOWER = 0.35, 0.42, 0.3


def arm_on_a_rail():
    """A carriage on a rail along x carries a column upwards and two links that turn; everything is rigid."""
    return Arm(
        "on a rail",
        (Joint("prismatic", (1.0, 0.0, 0.0), (0.0, 1.5)), Joint(range=(-2.0, 2.0)), Joint(range=(-2.0, 2.0))),
        (Link(COLUMN, (0.0, 1.0, 0.0), mass=0.0), Link(UPPER, mass=0.0), Link(LOWER, mass=0.0)),
    )


def reached(q, scale=1.0):
    """Tips (N, 2), m, by the textbook; with the rail's travel and all lengths `scale` times as long."""
    first, both = q[:, 1], q[:, 1] + q[:, 2]
    along = q[:, 0] + UPPER * np.cos(first) + LOWER * np.cos(both)
    up = COLUMN + UPPER * np.sin(first) + LOWER * np.sin(both)
    return scale * np.stack([along, up], axis=1)


def recording_of(rng, scale=1.0, repeats=2):
    low, high = (0.0, -1.8, -1.8), (1.5, 1.8, 1.8)
    q = np.repeat(rng.uniform(low, high, (40, 3)), repeats, axis=0)
    tip = reached(q, scale) + SIGMA * rng.standard_normal((len(q), 2))
    return Recording("r.csv", q, tip, np.arange(1, len(q) + 1), time=20.0 * np.arange(len(q)))


@pytest.mark.parametrize("size", [1e-6, 3e-4, -2e-2])
def test_a_stretch_of_everything_is_the_scale_of_the_instrument(size):
    """Both move the tip by that share of where it is, seen from the base."""
    recording = recording_of(np.random.default_rng(1))
    observed = observe(arm_on_a_rail(), recording)
    expected = size * reached(recording.q)
    small = 1e-9 * np.abs(expected).max()
    stretched = observed.signature("link_length", Settings((), {"stretch": size}))
    scaled = observed.signature("instrument_scale", Settings((), {"scale": size}))
    assert stretched == pytest.approx(expected, rel=1e-9, abs=small)
    assert scaled == pytest.approx(expected, rel=1e-9, abs=small)


def test_a_stretch_of_one_link_is_its_length_alone():
    """Of link 2 its 0.42 m; of link 1 its column and the rail's travel."""
    recording = recording_of(np.random.default_rng(1))
    observed = observe(arm_on_a_rail(), recording)
    longer = observed.signature("link_length", Settings((1,), {"length": 1e-3 * UPPER}))
    assert observed.signature("link_length", Settings((1,), {"stretch": 1e-3})) == pytest.approx(longer, rel=1e-12)
    expected = 1e-3 * np.column_stack([recording.q[:, 0], np.full(recording.size, COLUMN)])
    assert observed.signature("link_length", Settings((0,), {"stretch": 1e-3})) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("seed", slow_but([2, 3], 2))
def test_nobody_can_tell_a_stretch_from_the_scale(seed):
    """0.3 in a thousand, by whichever of the two: one class with both names, that of one thing first, and its size."""
    result = diagnose(arm_on_a_rail(), recording_of(np.random.default_rng(seed), scale=1.0 + 3e-4))
    assert result.verdict == "alias_class"
    (finding,) = result.findings
    assert finding.effect == "instrument_scale"
    assert "link_length" in {alternative.effect for alternative in finding.alternatives}
    alike = {alternative.effect: alternative.likeness for alternative in finding.alternatives}
    assert max(alike.values()) == pytest.approx(1.0, abs=1e-6)
    (size,) = finding.parameters
    assert size.interval[0] < 3e-4 < size.interval[1]
    assert result.rms_after < 1.1 * result.noise_floor
