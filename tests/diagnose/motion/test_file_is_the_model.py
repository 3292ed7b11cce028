"""What a diagnosis of motion logs promises is what the file leaves that it writes: one model fits, writes and reads."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link
from linkwright.core.arm.files.read import arm_from
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.arm.motion.dynamics import model_torque, torque_stages
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.predict import predict_motion
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.units.reading import Mapping, parse_yaml

SECONDS, RATE = 16.0, 100.0


def two_links(*effects: EffectEntry) -> Arm:
    """Two links that turn in an upright plane."""
    links = (
        Link(0.3, mass=2.4, center_of_mass=0.15, inertia=(1e-4, 0.018, 0.018, 0.0, 0.0, 0.0)),
        Link(0.25, mass=1.6, center_of_mass=0.125, inertia=(1e-4, 0.008, 0.008, 0.0, 0.0, 0.0)),
    )
    return Arm("two links", (Joint(), Joint()), links, effects=effects)


def motion_of(arm: Arm, seed: int) -> Motion:
    """A motion of sums of sines with its exact speeds and accelerations."""
    random = np.random.default_rng(seed)
    time = np.arange(0.0, SECONDS, 1.0 / RATE)
    rates = 2.0 * np.pi * np.array([0.21, 0.43, 0.71])[:, None] * random.uniform(0.9, 1.1, (3, 2))
    sizes, phases = random.normal(size=(3, 2)) * 0.5, random.uniform(0.0, 6.28, (3, 2))
    angle = time[:, None, None] * rates + phases
    q = (sizes * np.sin(angle)).sum(axis=1)
    v, a = (sizes * rates * np.cos(angle)).sum(axis=1), -(sizes * rates**2 * np.sin(angle)).sum(axis=1)
    return Motion(arm, time, q, v, a)


def log_of(arm: Arm, seed: int, noise: float = 0.02) -> MotionLog:
    """What an arm would log of that motion."""
    motion = motion_of(arm, seed)
    torque = model_torque(motion) + noise * np.random.default_rng(seed + 1).standard_normal(motion.q.shape)
    return MotionLog(f"log{seed}.csv", motion.time, motion.q, torque, np.arange(1, motion.size + 1), motion.velocity)


def read_back(arm: Arm) -> Arm:
    """An arm once it has been written and read."""
    return arm_from(Mapping(parse_yaml(arm_to_yaml(arm), file="arm.yaml"), file="arm.yaml"), load_catalogue())


def test_the_load_that_friction_goes_by_holds_what_effects_weigh():
    more = EffectEntry("payload", (), {"mass": 2.0})
    arm = two_links(more)
    motion = motion_of(arm, 1)
    rubs = motion_of(two_links(more, EffectEntry("friction_load", (1,), {"share": 0.1})), 1)
    load = torque_stages(motion).load
    assert np.abs(load - inverse_dynamics(motion)).max() > 1.0
    expected = 0.1 * np.abs(load[:, 0]) * np.tanh(motion.velocity[:, 0] / 0.01)
    np.testing.assert_allclose((model_torque(rubs) - model_torque(motion))[:, 0], expected, atol=1e-12)


@settings(max_examples=3, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)
@given(st.integers(0, 1000), st.floats(0.05, 0.3), st.floats(-0.15, 0.15), st.floats(0.2, 1.0), st.booleans())
def test_the_file_leaves_what_was_promised_and_can_be_diagnosed_again(seed, share, excess, coulomb, several):
    """Load friction, gain and dry friction of some size; the arm as given has dry friction of its own."""
    given_ = two_links(EffectEntry("friction_coulomb", (1, 2), {"torque": 0.5}))
    truth = two_links(
        EffectEntry("friction_load", (1,), {"share": share}),
        EffectEntry("torque_constant", (2,), {"excess": excess}),
        EffectEntry("friction_coulomb", (1,), {"torque": coulomb}),
        EffectEntry("friction_coulomb", (2,), {"torque": 0.5}),
    )
    logs = [log_of(truth, seed + number) for number in range(2 if several else 1)]
    result = diagnose_motion(given_, logs)
    small = [item.small for item in result.findings]
    assert small == sorted(small)
    # What several add is at most what they add one by one (Minkowski), up to what linearising about the file changes.
    singly = sum(max(item.rms_explained) for item in result.findings if item.small)
    assert max(result.small_together) <= 1.05 * singly
    file = read_back(result.corrected)
    predictions = [predict_motion(file, log) for log in logs]
    counts = np.array([prediction.samples for prediction in predictions])
    squares = (np.square([prediction.rms for prediction in predictions]) * counts).sum(axis=0) / counts.sum(axis=0)
    promised = [joint.after for joint in result.per_joint]
    np.testing.assert_allclose(np.sqrt(squares), promised, rtol=1e-6)
    assert all(joint.held_out <= 1.1 * joint.before for joint in result.per_joint)
    again = diagnose_motion(file, logs)
    np.testing.assert_allclose([joint.before for joint in again.per_joint], promised, rtol=1e-6)


def test_gears_that_lose_power_by_direction_keep_their_promise():
    """Gears pass 85 % forwards and hold back with 70 %."""
    forwards, backwards = 1.0 / 0.85, 0.7
    arm = two_links()
    motion = motion_of(arm, 4)
    load = inverse_dynamics(motion)
    drives = load * motion.velocity > 0.0
    torque = load * np.where(drives, forwards, backwards)
    torque += 0.02 * np.random.default_rng(5).standard_normal(load.shape)
    log = MotionLog("log.csv", motion.time, motion.q, torque, np.arange(1, motion.size + 1), motion.velocity)
    result = diagnose_motion(arm, [log])
    left = predict_motion(read_back(result.corrected), log)
    np.testing.assert_allclose(left.rms, [joint.after for joint in result.per_joint], rtol=1e-6)
    assert max(left.rms) < 0.03
    losses = [size.value for f in result.findings if f.effect == "gear_efficiency" for size in f.parameters]
    assert losses == pytest.approx([forwards - 1.0, 1.0 - backwards] * 2, abs=0.02)
