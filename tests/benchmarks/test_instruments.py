"""What instruments read of the second generator's arm: nothing but noise beyond the file, where nothing is wrong."""

import numpy as np
import pytest

from benchmarks.instruments.against import DEEP, INSTRUMENTS, NOISE, TURNS, outcome, recorded, stage_of
from benchmarks.multibody.causes import Cause
from benchmarks.multibody.session import Plan, played
from diagnose.diagnosis import diagnose
from diagnose.residual.observed import observe


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
