"""Rollouts of whole logs: MuJoCo made the example's log with friction, a rotor and a gripper that the file lacks."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.preparation import prepare
from linkwright.core.diagnose.motion.rollout.simulator import rolled_out
from linkwright.core.diagnose.motion.rollout.windows import courses, driven, windows
from linkwright.core.diagnose.motion.simulate import simulate_motion
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.face.arm import read_arm
from linkwright.face.motion.log import read_log

pytest.importorskip("mujoco")
EXAMPLE = Path(__file__).parents[4] / "examples/motion-log"
FREE = np.array([[-50.0] * 4, [50.0] * 4])


@pytest.fixture(scope="module")
def arm():
    return import_robot(EXAMPLE / "robot.xml").arm


@pytest.fixture(scope="module")
def diagnosis():
    given = read_arm(EXAMPLE / "robot.xml")
    log = read_log(EXAMPLE / "log.csv", given).found
    return diagnose_motion(given.model, [log], Options(rollout=True, without=frozenset({"joint_compliance"})))


def test_the_corrected_arm_moves_as_was_measured(diagnosis):
    """25 s in half seconds. As given, the arm ends degrees away, and its wrist runs off; as corrected, within half a
    degree, on motion to which its sizes were not fitted too."""
    rollout = diagnosis.rollout
    assert (rollout.seconds, rollout.windows, rollout.lacks) == (0.5, 49, "")
    assert rollout.left[0] > 0
    assert rollout.left[1:] == (0, 0)
    for item in rollout.per_joint:
        assert item.before.q_end > np.radians(5.0)
        assert item.after.q_end < np.radians(0.5)
        assert item.after.q <= item.after.q_end
        assert item.held_out.q_end < 1.5 * item.after.q_end
        assert item.after.velocity < 0.1 * item.before.velocity


def test_what_is_drawn_begins_as_measured(diagnosis):
    trace = diagnosis.rollout.traces[0]
    starts = np.flatnonzero(~np.isfinite(trace.time))[:-1] + 1
    assert len(starts) == 48
    for name in ("before", "after"):
        assert np.array_equal(getattr(trace, name)[starts], trace.measured[starts])


def log_of(arm, *effects, **how):
    """A log without noise at 200 Hz, in which the arm has these effects."""
    return simulate_motion(replace(arm, effects=effects), noise=0.0, seconds=8.0, rate=200.0, **how)


def test_windows_leave_out_what_is_no_motion_of_the_arm(arm):
    """A torque that was not logged for an instant, and seconds in which something pushed."""
    log = log_of(arm)
    whole = windows(prepare(arm, log, rules=RULES), 0.5)
    torque = log.torque.copy()
    torque[250, 1] = np.nan  # at 1.25 s
    less = windows(prepare(arm, replace(log, torque=torque, aside=((4.1, 5.2),)), rules=RULES), 0.5)
    gone = {round(time, 3) for time in whole.time[:, 0]} - {round(time, 3) for time in less.time[:, 0]}
    assert gone == {1.0, 4.0, 4.5, 5.0}


def test_the_instrument_is_taken_off(arm):
    """What a torque constant and an offset make of the drives' torque does not move the arm."""
    instrument = (
        EffectEntry("torque_constant", (2,), {"excess": 0.1}),
        EffectEntry("torque_offset", (3,), {"torque": 2.0}),
    )
    rubs = EffectEntry("friction_viscous", (), {"coefficient": 3.0})
    arm, bare = replace(arm, effects=(rubs, *instrument)), replace(arm, effects=(rubs,))
    one, other = (prepare(item, simulate_motion(item, noise=0.0, rate=200.0), rules=RULES) for item in (arm, bare))
    found = driven(one.motion, one.measured, one)
    assert np.abs(found - other.measured).max() < 1e-3 * np.abs(other.measured).max()


def test_each_window_has_the_payload_of_its_log(arm):
    """Two kilograms more from the half on: simulated with them, the arm moves as measured; without, it does not."""
    rubs = EffectEntry("friction_viscous", (), {"coefficient": 3.0})
    arm = replace(arm, effects=(rubs,))
    light, heavy = (simulate_motion(item, noise=0.0, rate=200.0, seconds=8.0) for item in (arm, loaded(arm, 2.0)))
    half = light.time >= 4.0
    mass = arm.payload.mass + 2.0 * half
    log = replace(light, torque=np.where(half[:, None], heavy.torque, light.torque), payload_mass=mass)
    ends = {}
    for name, given in (("told", log), ("not told", replace(log, payload_mass=None))):
        prepared = prepare(arm, given, rules=RULES)
        here = windows(prepared, 0.5)
        off = np.zeros(len(here.rows))
        for which, simulator, some in courses(arm, here):
            rolled = rolled_out(simulator, some, FREE)
            off[which] = np.abs(rolled.q - prepared.motion.q[here.rows[which]])[:, -1].max(axis=1)
        ends[name] = off[here.time[:, 0] >= 4.0]
    assert np.median(ends["told"]) < 0.1 * np.median(ends["not told"])


def loaded(arm, mass):
    """The arm with a heavier payload."""
    return replace(arm, payload=replace(arm.payload, mass=arm.payload.mass + mass))


def test_why_a_log_cannot_be_simulated_is_told(arm):
    """A drive whose torque nobody logged."""
    rubs = EffectEntry("friction_viscous", (), {"coefficient": 3.0})
    log = log_of(arm, rubs)
    torque = log.torque.copy()
    torque[:, 2] = np.nan
    options = Options(rollout=True, without=frozenset(set(EFFECTS) - {"friction_viscous"}))
    result = diagnose_motion(arm, [replace(log, torque=torque)], options)
    assert result.rollout.lacks == "the torque of joint 3 was not logged"
