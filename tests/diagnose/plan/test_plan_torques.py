"""Plans with torques: what they promise against the scatter of many recordings by sums of cosines, as diagnosed."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.diagnose.plan.plan_request import Asked
from linkwright.core.diagnose.plan.planning import plan
from linkwright.core.diagnose.residual.torque import drive_torques
from linkwright.core.diagnose.rules.rules import RULES
from tests.diagnose.plan.test_plan import silent

LENGTHS, MASSES, NOISE, RUBS = (0.4, 0.42, 0.3), (6.0, 4.0, 2.5), (0.4, 0.3, 0.2), (1.5, 0.8, 0.4)
FAST = replace(RULES, plan=replace(RULES.plan, tried=64, rivals=3, passes=1), search=replace(RULES.search, draws=199))
DRAWS = 250


@pytest.fixture(scope="module")
def found():
    arm = Arm(
        "weighs",
        tuple(Joint(range=(-1.6, 1.6)) for _ in LENGTHS),
        tuple(Link(length, mass=mass) for length, mass in zip(LENGTHS, MASSES, strict=True)),
        gravity=(0.0, -9.81, 0.0),
        payload=LoadCase(mass=0.0),
    )
    effects = (("joint_compliance", (1,)),)
    return plan(arm, Asked(14, effects, payloads=(0.0, 5.0), rules=FAST, torque_noise=NOISE), silent)


def held(q, payload, sides):
    """What drives hold (N, 3), N*m: centres in the middle of each link, by cosines, and the friction of each side."""
    across = np.cos(np.cumsum(q, axis=1)) * LENGTHS
    ends = np.cumsum(across, axis=1)
    centres, starts = ends - 0.5 * across, ends - across
    torque = np.empty(q.shape)
    for joint in range(3):
        weigh = sum(MASSES[k] * (centres[:, k] - starts[:, joint]) for k in range(joint, 3))
        torque[:, joint] = 9.81 * (weigh + payload * (ends[:, 2] - starts[:, joint])) + RUBS[joint] * sides[:, joint]
    return torque


def test_many_recordings_scatter_as_promised(found):
    """Factors of links and payload, and friction, of every drive."""
    recording, rng = found.recording, np.random.default_rng(11)
    state = solve(found.arm, list(recording.q.T), beams_of(found.arm), payload_mass=recording.payload_mass)
    sound = held(recording.q, recording.payload_mass, recording.sides)
    visit = (recording.row - 1) // 3
    drawn = np.array([
        [(torque.links.value, torque.payload.value, torque.friction) for torque in drive_torques(
            found.arm, replace(recording, torque=sound + NOISE * rng.standard_normal(sound.shape)), state, visit,
            FAST.residual,
        )]
        for _ in range(DRAWS)
    ])  # fmt: skip
    told = np.array([(torque.links, torque.payload, torque.friction) for torque in found.promise.torques])
    assert told.shape == (3, 3)
    assert drawn.std(axis=0) / told == pytest.approx(np.ones((3, 3)), abs=4.0 / np.sqrt(2 * DRAWS))
    true = np.stack([np.ones(3), np.ones(3), RUBS], axis=1)
    assert np.abs((drawn.mean(axis=0) - true) / told).max() < 4.0 / np.sqrt(DRAWS)


def test_poses_are_chosen_for_torques_too(found):
    """Weights and friction are better known than at random, on average clearly."""
    names = ("links", "payload", "friction")
    gains = [
        found.torques_at_random(torque.joint, n) / getattr(torque, n) for torque in found.promise.torques for n in names
    ]
    without = plan(found.arm, replace(found.asked, torque_noise=()), silent)
    assert without.promise.torques == ()
    assert np.mean(np.log(gains)) > np.log(1.1)
    assert min(gains) > 0.8
