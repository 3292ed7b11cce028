"""Findings so large that first order does not hold: named alone, in full, and by the right one of two like names."""

import math
from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import Tube
from tests.cosserat_rod import rod_tip, rods_of
from tests.diagnose.recorded import LENGTHS, planar_arm, planar_tip, poses, sagging_tip, table, written

SIGMA = 20e-6


def measured(tmp_path, off, longer=(0.0, 0.0, 0.0), frame="known"):
    """Forty poses, each read three times, by textbook kinematics with zeros (rad) and lengths (m) off."""
    rng = np.random.default_rng(11)
    q = np.repeat(poses(40), 3, axis=0)
    tip = planar_tip(q + np.array(off), tuple(np.add(LENGTHS, longer))) + SIGMA * rng.standard_normal((120, 2))
    arm = planar_arm()
    path = written(tmp_path / "recording.csv", table(q, tip))
    if frame == "free":
        (tmp_path / "recording.yaml").write_text("frame: free\n", encoding="utf-8")
        return arm, read_recording(path, arm, tmp_path / "recording.yaml")
    return arm, read_recording(path, arm)


@pytest.mark.parametrize("frame", [pytest.param("known", marks=pytest.mark.slow), "free"])
def test_a_zero_off_by_two_degrees_is_named_alone(tmp_path, frame):
    off = math.radians(2.0)
    arm, recording = measured(tmp_path, (0.0, off, 0.0), frame=frame)
    result = diagnose(arm, recording)
    assert [(finding.effect, finding.at) for finding in result.findings] == [("encoder_offset", (2,))]
    low, high = result.findings[0].parameters[0].interval
    assert low < off < high
    assert result.rms_after < 1.1 * result.noise_floor
    assert any("linearised they would be" in note for note in result.notes)
    assert diagnose(result.corrected, recording).verdict == "none"


@pytest.mark.slow
def test_the_last_joints_zero_is_not_taken_for_the_tool(tmp_path):
    """To first order they are one; a degree of the zero is one number where a tool's offset is two."""
    arm, recording = measured(tmp_path, (0.0, 0.0, math.radians(-1.0)))
    result = diagnose(arm, recording)
    assert [(finding.effect, finding.at) for finding in result.findings] == [("encoder_offset", (3,))]
    assert ("tool_offset", ()) in [
        (alternative.effect, alternative.at) for alternative in result.findings[0].alternatives
    ]


@pytest.mark.slow
def test_a_zero_and_a_length_together(tmp_path):
    arm, recording = measured(tmp_path, (0.0, math.radians(1.5), 0.0), (0.006, 0.0, 0.0))
    result = diagnose(arm, recording)
    assert {(finding.effect, finding.at) for finding in result.findings} == {
        ("encoder_offset", (2,)),
        ("link_length", (1,)),
    }
    assert result.rms_after < 1.1 * result.noise_floor


@pytest.mark.slow
def test_a_small_zero_on_an_arm_that_sags_far_is_named_alone(tmp_path):
    """Three minutes of arc turn the sag by more than the noise; it is no torque of a counterbalance."""
    off, stiffness = 0.9e-3, 60.0
    q = np.repeat(poses(40), 3, axis=0)
    payload = np.where(np.arange(120) % 6 < 3, 0.5, 1.0)
    rng = np.random.default_rng(5)
    tip = sagging_tip(q + np.array([0.0, off, 0.0]), stiffness, payload)
    assert np.linalg.norm(tip - planar_tip(q), axis=1).max() > 0.05
    arm = planar_arm()
    joints = tuple(replace(joint, stiffness=stiffness) for joint in arm.joints)
    arm = replace(arm, joints=joints, gravity=(0.0, -9.81, 0.0))
    columns = table(q, tip + SIGMA / 2 * rng.standard_normal(tip.shape), payload_kg=payload)
    result = diagnose(arm, read_recording(written(tmp_path / "recording.csv", columns), arm))
    assert [(finding.effect, finding.at) for finding in result.findings] == [("encoder_offset", (2,))]
    low, high = result.findings[0].parameters[0].interval
    assert low < off < high
    assert result.rms_after < 1.1 * result.noise_floor


@pytest.mark.slow
def test_a_link_of_half_its_modulus_is_named_alone():
    """What it gives doubles, far from where a small lack of modulus would be in proportion; by an exact rod, of two
    tubes that bend by some millimetres under their payload."""
    material = load_catalogue(user=False).find("aluminium-6061-t6")
    joints = tuple(Joint(range=(-1.4, 1.4), stiffness=2e5, mass=1.0) for _ in range(2))
    links = tuple(Link(length, section=Tube(d, 0.003), material=material) for length, d in ((0.6, 0.08), (0.5, 0.07)))
    arm = Arm("soft", joints, links, gravity=(0.0, -9.81, 0.0))
    true = rods_of(arm)
    own = ("axial", "shear_y", "shear_z", "torsion", "bend_y", "bend_z")
    true[0] = replace(true[0], **{name: 0.5 * getattr(true[0], name) for name in own})
    rng = np.random.default_rng(3)
    q, payloads = rng.uniform(-1.4, 1.4, (24, 2)), np.tile([0.0, 25.0], 12)
    gravity, nothing = np.array(arm.gravity), np.zeros(3)
    tip = [rod_tip(true, item, gravity, mass, nothing)[0][:2] for item, mass in zip(q, payloads, strict=True)]
    seen = np.repeat(tip, 3, axis=0) + SIGMA / 2 * rng.standard_normal((72, 2))
    recording = Recording(
        "soft",
        np.repeat(q, 3, axis=0),
        seen,
        np.arange(1, 73),
        payload_mass=np.repeat(payloads, 3),
        time=1.0 * np.arange(72),
    )
    result = diagnose(arm, recording)
    assert [(finding.effect, finding.at) for finding in result.findings] == [("link_modulus", (1,))]
    low, high = result.findings[0].parameters[0].interval
    assert low < -0.5 < high
    assert result.rms_after < 1.1 * result.noise_floor


def test_a_bus_servo_gives_as_much_as_bus_servos_do(tmp_path):
    """Drives of 27 N m/rad, of which the second has 15: 30 mrad/(N m) more is a compliance like another."""
    arm = planar_arm()
    arm = replace(arm, joints=tuple(replace(joint, stiffness=27.0) for joint in arm.joints))
    q = np.repeat(poses(24), 4, axis=0)
    payload = np.tile([0.0, 0.0, 0.05, 0.05], 24)
    tip = sagging_tip(q, np.array([27.0, 15.0, 27.0]), payload)
    tip += 4e-4 * np.random.default_rng(5).standard_normal(tip.shape)
    recording = read_recording(written(tmp_path / "r.csv", table(q, tip, payload_kg=payload)), arm)
    found = diagnose(arm, recording)
    (finding,) = found.findings
    names = {(name.effect, name.at) for name in (finding, *finding.alternatives)}
    assert ("joint_compliance", (2,)) in names
    low, high = finding.parameters[0].interval
    assert low < 1.0 / 15.0 - 1.0 / 27.0 < high
