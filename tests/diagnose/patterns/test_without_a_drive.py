"""Joints that have no drive: what is not sought there, and what still is."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.diagnose.patterns.library import candidates
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.units.reading import InputError
from tests.diagnose.instruments.spatial_arm import SIGMA, Truth, read, session, spatial_arm, tips


def recorded():
    q, payload = session(30, 4)
    tip = tips(q, payload, Truth()) + SIGMA * np.random.default_rng(4).standard_normal((len(q), 3))
    return read(q, payload, tip)


def sought(arm, recording, index):
    """The effects that are sought at one joint (from 0) alone."""
    results = {candidate.effect for candidate, _ in candidates(observe(arm, recording)) if candidate.at == (index,)}
    return {effect for effect in results if EFFECTS[effect].place == "joint"}


def test_a_passive_joint_has_its_encoder_and_bearing_but_no_drive():
    arm, recording = spatial_arm(), recorded()
    joints = tuple(replace(joint, passive=k == 1) for k, joint in enumerate(arm.joints))
    of_drives = {"joint_compliance", "joint_hardening", "gear_transmission_error", "joint_coupling"}
    assert of_drives <= sought(arm, recording, 1)
    passive = sought(replace(arm, joints=joints), recording, 1)
    assert not any(EFFECTS[effect].drive.needed for effect in passive)
    assert {"encoder_offset", "encoder_scale", "encoder_eccentricity", "axis_misalignment"} <= passive
    assert of_drives <= sought(replace(arm, joints=joints), recording, 2)


def test_a_passive_joint_is_read_and_written(tmp_path):
    file = tmp_path / "arm.yaml"
    text = "name: a\nchain:\n  - joint: {passive: true%s}\n    link: {length: 1 m, mass: 1 kg}\n%s"
    file.write_text(text % ("", ""))
    arm = read_arm(file)
    assert [joint.passive for joint in arm.joints] == [True]
    file.write_text(arm_to_yaml(arm))
    assert read_arm(file) == arm
    for key, further in ((", stiffness: 1 kN*m/rad", ""), ("", "effects: [{effect: backlash, at: 1, play: 1 mrad}]\n")):
        file.write_text(text % (key, further))
        with pytest.raises(InputError, match="drive"):
            read_arm(file)
