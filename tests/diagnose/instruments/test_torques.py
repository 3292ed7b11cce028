"""Drives' torques of an arm that is weighed by its own rotation matrices: links and payload pull, friction drags."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.reading.write import recording_text
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.units.quantities import InputError
from tests.diagnose.instruments.spatial_arm import GRAVITY, SIGMA, placed, session, spatial_arm

MASSES = np.array([2.0, 8.0, 5.0, 1.0, 0.5])
COMPLIANCE = 8e-6
FRICTION = np.array([3.0, 5.0, 2.0, 0.5, 0.4])
NOISE = 0.2


def weighed_arm():
    arm = spatial_arm()
    return arm.with_links(tuple(replace(link, mass=m) for link, m in zip(arm.links, MASSES.tolist(), strict=True)))


def weights(q, payload, masses, beyond=0.0):
    """The torque (N, 5) of weights about each joint: links pull at their middles, the payload at the tip, or so far (m)
    beyond it along the last link."""
    tip, places, axes = placed(q)
    ends = np.concatenate([places[:, 1:], tip[:, None]], axis=1)
    middles = 0.5 * (places + ends)
    last = tip - places[:, -1]
    held = tip + beyond * last / np.linalg.norm(last, axis=1)[:, None]
    result = np.zeros(q.shape)
    for joint in range(5):
        for link in range(joint, 5):
            arm = middles[:, link] - places[:, joint]
            pull = [0.0, 0.0, -GRAVITY * masses[link]]
            result[:, joint] += np.sum(np.cross(arm, pull) * axes[:, joint], axis=1)
        arm = held - places[:, joint]
        pulls = np.outer(payload, [0.0, 0.0, -GRAVITY])
        result[:, joint] += np.sum(np.cross(arm, pulls) * axes[:, joint], axis=1)
    return result


def recorded(masses=MASSES, scale=1.0, sign=1.0, seed=11, compliance=COMPLIANCE, beyond=0.0):
    """Torques beside tips, of an arm whose drive 2 gives under what really weighs on it."""
    rng = np.random.default_rng(seed)
    q, payload = session(45, seed=seed)
    sides = np.repeat(rng.choice([-1.0, 1.0], (45, 5)), 2, axis=0)
    load = weights(q, payload, masses, beyond)
    bent = q.copy()
    for _ in range(4):
        bent[:, 1] = q[:, 1] + compliance * weights(bent, payload, masses, beyond)[:, 1]
    tip = placed(bent)[0] + SIGMA * rng.standard_normal((len(q), 3))
    torque = sign * (scale * -load + FRICTION * sides + 1.5) + NOISE * rng.standard_normal(q.shape)
    return Recording(
        "r.csv", q, tip, np.arange(1, len(q) + 1), time=15.0 * np.arange(len(q)), payload_mass=payload,
        sides=sides, torque=torque,
    )  # fmt: skip


def says(result, words):
    return any(words in note for note in result.notes)


def test_torques_bear_the_weights_out_and_tell_friction():
    result = diagnose(weighed_arm(), recorded(compliance=0.0))

    assert result.verdict == "none"
    assert says(result, "Torques confirm the weights of the links")
    (friction,) = [note for note in result.notes if "Friction by the torques" in note]
    for drive, value in zip((2, 3), (5.0, 2.0), strict=True):
        (part,) = [item for item in friction.split(", ") if f"at drive {drive}" in item]
        assert float(part.split("N")[0].split()[-1].rstrip(" ")) == pytest.approx(value, abs=0.15)


def test_a_link_that_is_heavier_than_the_file_says_is_told_and_its_drive_judged_by_the_torque():
    heavy = MASSES * np.array([1.0, 1.6, 1.0, 1.0, 1.0])
    recording = recorded(masses=heavy)
    result = diagnose(weighed_arm(), recording)

    assert says(result, "By the torque of drive 2 the links beyond it weigh on it")
    assert says(result, "is judged under the loads that the torques show")
    (finding,) = [item for item in result.findings if (item.effect, item.at) == ("joint_compliance", (2,))]
    low, high = finding.parameters[0].interval
    assert low < COMPLIANCE < high
    assert high - low < 0.1 * COMPLIANCE
    assert len(result.findings) == 1


@pytest.mark.slow
def test_torques_of_another_scale_say_nothing_against_the_weights():
    result = diagnose(weighed_arm(), recorded(scale=1.2))

    assert says(result, "Either its scale (a torque constant) is off, or weights and centres")
    assert not says(result, "is judged under the loads")
    (finding,) = result.findings
    low, high = finding.parameters[0].interval
    assert low < COMPLIANCE < high


def test_a_payload_whose_centre_is_elsewhere_is_not_told_as_another_mass():
    """0.2 m beyond the tip it weighs the more on a drive, the nearer that is: no one factor fits."""
    result = diagnose(weighed_arm(), recorded(compliance=0.0, beyond=0.2))

    assert says(result, "Its centre of mass is more likely off than its mass")
    assert not says(result, "By the torques the payload is ")


def test_a_drive_that_holds_next_to_nothing_says_nothing_of_weights():
    """Whatever its sensor reads (here fourteen times the load) is no weight: what its torque and the model share is
    chance."""
    recording = recorded(compliance=0.0)
    torque = recording.torque.copy()
    torque[:, 4] *= 14.0
    result = diagnose(weighed_arm(), replace(recording, torque=torque))

    assert not says(result, "drive 5")
    assert says(result, "Torques confirm the weights of the links")


def test_torques_of_another_sign_are_refused_in_one_line(tmp_path):
    file = tmp_path / "r.csv"
    file.write_text(recording_text(recorded(sign=-1.0), weighed_arm()), encoding="utf-8")
    with pytest.raises(InputError, match=r"tau2_Nm, tau3_Nm.*: goes against .*write `columns: \{tau2_Nm: -tau2_Nm"):
        read_recording(file, weighed_arm())

    file.write_text(recording_text(recorded(), weighed_arm()), encoding="utf-8")
    assert read_recording(file, weighed_arm()).torque is not None
