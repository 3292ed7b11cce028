"""What instruments read of the second generator's arm: nothing but noise beyond the file, where nothing is wrong."""

import numpy as np
import pytest

from benchmarks.instruments.against import DEEP, INSTRUMENTS, NOISE, TURNS, outcome, recorded, stage_of
from benchmarks.instruments.touches import INSTRUMENTS as TOUCHING
from benchmarks.instruments.touches import met, touched, touching
from benchmarks.multibody.causes import Cause
from benchmarks.multibody.session import Plan, played
from linkwright.core.diagnose.diagnosis import diagnose
from linkwright.core.diagnose.residual.observe import observe

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def sound():
    return stage_of(1)


@pytest.mark.parametrize("instrument", INSTRUMENTS)
def test_a_sound_arm_leaves_an_instrument_its_noise(sound, instrument):
    arm, stage = sound
    left = observe(arm, recorded(stage, stage.tips, instrument, 5)).residual
    noise = [NOISE, NOISE, DEEP, *[TURNS] * 3] if instrument.startswith("camera") else [NOISE]

    assert float(np.sqrt(np.mean(left**2))) == pytest.approx(float(np.sqrt(np.mean(np.square(noise)))), rel=0.1)


def test_a_drive_that_gives_is_found_by_distances(sound):
    arm, stage = sound
    cause = Cause("joint_compliance", (2,), {"compliance": 2e-6}, ("compliance",))
    plan = Plan(stage.machine, stage.session)
    cause.write(plan)
    result = diagnose(arm, recorded(stage, played(plan), "wire, known anchor", 5))

    assert outcome(result, cause) == "named"
    assert outcome(result, Cause("joint_compliance", (3,), {}, ())) == "- +1 wrong"
    low, high = result.findings[0].parameters[0].interval
    assert low < 2e-6 < high


@pytest.mark.parametrize("kind", TOUCHING.values())
def test_a_sound_arm_that_touches_leaves_the_noise(kind):
    """Each touch is off by the noise along every axis that counts; the places that are fitted take up little of it."""
    arm, touch = touching(kind, 1)
    recording = touched(touch, lambda _: None, kind, 5)
    assert float(np.sqrt(np.mean(observe(arm, recording).residual ** 2))) == pytest.approx(NOISE, rel=0.1)


@pytest.mark.parametrize("kind", TOUCHING.values())
def test_touches_are_where_the_arm_with_something_wrong_ends(kind):
    """Played again at what the encoders read, the tip is at what it touches; the joints moved to get there."""
    _, touch = touching(kind, 1)
    cause = Cause("joint_compliance", (2,), {"compliance": 4e-6}, ("compliance",))
    session, tips = met(touch, cause.write)
    plan = Plan(touch.stage.machine, session)
    cause.write(plan)
    missed = np.einsum("vka,va->vk", touch.across, played(plan).reading.T - touch.goal)
    assert np.abs(missed).max() < 1e-7
    assert np.abs(tips.reading.T - played(plan).reading.T).max() < 1e-12
    assert np.abs(session.q - touch.stage.session.q).max() > 1e-5
    if touch.along is not None:
        ends = [tips.reading.T[(touch.label == 0) & (touch.along == at)].mean(axis=0) for at in (0.0, 0.5)]
        assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(0.5, abs=1e-6)


def test_an_offset_is_found_by_sockets():
    arm, touch = touching("same_point", 1)
    cause = Cause("encoder_offset", (3,), {"offset": 5e-4}, ("offset",))
    result = diagnose(arm, touched(touch, cause.write, "same_point", 5))
    assert outcome(result, cause) == "named"
    low, high = result.findings[0].parameters[0].interval
    assert low < 5e-4 < high
