"""Levels on the base and on links: what they read of an arm by its own rotation matrices."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.registry import slots_of
from linkwright.core.diagnose.residual.observe import beyond_first_order, observe
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.instruments.spatial_arm import AXES, Truth, read, session, spatial_arm, torques

TILT_X, TILT_Y = slots_of("tilt")

SEAT = Rotation.from_euler("xyz", [0.02, 1.55, -0.03])
"""How the level sits on its link: turned a quarter about y, and askew."""
LINK = 3
NOISE = 20e-6


def tilted(q, payload, truth=None, base=(0.0, 0.0, 0.0), link=LINK, seat=SEAT):
    """What a level on a link reads, (N, 2): sines of how far its y rises and its x sinks, the base turned by `base`."""
    truth = truth or Truth()
    bent = q + np.array(truth.zeros) + np.array(truth.compliance) * torques(q, payload, truth)
    turned = Rotation.from_rotvec(np.tile(base, (len(q), 1)))
    for joint in range(link):
        turned = turned * Rotation.from_rotvec(np.outer(bent[:, joint], AXES[joint]))
    axes = (turned * seat).as_matrix()
    return np.column_stack([axes[:, 2, 1], -axes[:, 2, 0]])


def recorded(q, payload, values, link=LINK, seed=3, noise=NOISE):
    rng = np.random.default_rng(seed)
    instrument = Instrument(("tilt",), tilt_link=link)
    slots = np.tile((TILT_X, TILT_Y), (len(q), 1))
    return read(q, payload, values + noise * rng.standard_normal(values.shape), slots=slots, instrument=instrument)


@pytest.mark.parametrize("link", [2, 4])
def test_a_sound_arm_leaves_nothing_however_the_level_sits(link):
    q, payload = session(30, seed=4, repeats=1)
    values = tilted(q, payload, link=link)

    assert np.abs(observe(spatial_arm(), recorded(q, payload, values, link, noise=0.0)).residual).max() < 1e-9


def test_a_tilt_is_not_linearised():
    """A zero of 0.1 rad, beside which first order is off by milliradians: about it, what is left is exact."""
    q, payload = session(40, seed=5, repeats=1)
    values = tilted(q, payload, Truth(zeros=(0.0, 0.1, 0.0, 0.0, 0.0)), seat=Rotation.identity())
    recording = recorded(q, payload, values, noise=0.0)
    entry = EffectEntry("encoder_offset", (2,), {"offset": 0.1})

    # The level is free to sit otherwise, which takes up a zero of a joint whose neighbour is parallel to it.
    about = observe(spatial_arm(), recording, about=(entry,))
    linear = about.drive_moved(1) * 0.1
    beside = about.view.beside
    left = (about.residual - linear).reshape(-1)
    design = beside.reshape(len(left), -1)
    assert left - design @ np.linalg.lstsq(design, left, rcond=None)[0] == pytest.approx(np.zeros(len(left)), abs=1e-9)
    plain = observe(spatial_arm(), recording)
    assert np.abs(beyond_first_order(plain, (entry,))).max() > 1e-3


def test_a_level_on_a_link_finds_the_drive_that_gives():
    q, payload = session(45, seed=6)
    truth = Truth(compliance=(0.0, 0.0, 40e-6, 0.0, 0.0))
    result = diagnose(spatial_arm(), recorded(q, payload, tilted(q, payload, truth)))

    (finding,) = result.findings
    assert (finding.effect, finding.at) == ("joint_compliance", (3,))
    low, high = finding.parameters[0].interval
    assert low < 40e-6 < high
    assert high - low < 8e-6
    assert result.noise_floor == pytest.approx(np.sqrt(2) * NOISE, rel=0.2)
    assert result.rms_after == pytest.approx(np.sqrt(2) * NOISE, rel=0.15)
    assert any("does not see joints 1, 4 and 5 move" in note for note in result.notes)


def test_a_level_on_a_link_finds_that_the_base_is_not_plumb_and_which_way():
    q, payload = session(45, seed=7, payloads=(0.0,))
    base = (4e-4, -2e-4, 0.0)
    result = diagnose(spatial_arm(), recorded(q, payload, tilted(q, payload, base=base), link=LINK))

    (finding,) = result.findings
    assert finding.effect == "base_tilt"
    by_name = {parameter.name: parameter for parameter in finding.parameters}
    for name, value in zip(("about_x", "about_y"), base, strict=False):
        low, high = by_name[name].interval
        assert low < value < high
        assert high - low < 1e-4


def test_a_level_on_the_base_sees_no_joint_and_nothing_of_how_the_base_stands():
    q, payload = session(20, seed=8)
    values = np.tile([3e-3, -1e-3], (len(q), 1))
    result = diagnose(spatial_arm(), recorded(q, payload, values, link=0))

    assert result.verdict == "none"
    assert ("base_tilt", ()) in result.invisible
    assert any("does not see joints 1, 2, 3, 4 and 5 move" in note for note in result.notes)
