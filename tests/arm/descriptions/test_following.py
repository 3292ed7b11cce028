"""Joints that follow others in formats that know turns alone, against the plane's trigonometry and MuJoCo."""

import math
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import linkwright as lw
from tests.arm.descriptions.urdf_chain import tip_pose

PALLETISER = """
name: palletiser
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {axis: z, range: [-160 deg, 160 deg]}
    link: {length: 500 mm, direction: [0, 0, 1], rigid: true, mass: 30 kg}
  - joint: {axis: -y, range: [40 deg, 130 deg]}
    link: {length: 800 mm, rigid: true, mass: 12 kg}
  - joint: {axis: -y, range: [-60 deg, 40 deg], follows: "q3 - q2"}
    link: {length: 900 mm, rigid: true, mass: 8 kg}
  - joint: {axis: -y, follows: "-q3"}
    link: {length: 150 mm, rigid: true, mass: 3 kg}
effects:
  - {effect: encoder_offset, at: [2], offset: 5 mrad}
"""
OFFSET = 5e-3


def placed(q):
    """The tip where forearm and wrist keep their own angles whatever the upper arm does, and the turns of all."""
    angles = [q[1] + OFFSET, q[2], 0.0]
    out = sum(length * math.cos(angle) for length, angle in zip((0.8, 0.9, 0.15), angles, strict=True))
    up = 0.5 + sum(length * math.sin(angle) for length, angle in zip((0.8, 0.9, 0.15), angles, strict=True))
    return (out * math.cos(q[0]), out * math.sin(q[0]), up), (q[0], q[1], q[2] - q[1], -q[2])


def drawn():
    low, high = np.radians([[-160, 40, -60], [160, 130, 40]])
    return np.random.default_rng(6).uniform(low, high, (5, 3))


@pytest.fixture
def arm(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(PALLETISER)
    return lw.read_arm(path)


def test_a_urdf_says_turns_and_what_it_cannot_say(arm):
    result = lw.export_arm(arm, to="urdf").found
    root = ElementTree.fromstring(result.text)
    # The wrist follows the forearm's coordinate, which is no single joint's turn here.
    assert root.find(".//mimic") is None
    assert any("follow others" in item and "(joint 3, 4)" in item for item in result.lost)
    limits = [item.find("limit").attrib for item in root.iter("joint") if item.get("type") == "revolute"]
    ends = [[math.degrees(float(limit[end])) for end in ("lower", "upper")] for limit in limits]
    assert np.array(ends) == pytest.approx(np.array([[-160, 160], [40, 130], [-190, 0], [-40, 60]]))
    for q in drawn():
        tip, turns = placed(q)
        pose = tip_pose(result.text, "base", "tip", {f"joint{k}": turn for k, turn in enumerate(turns, start=1)})
        assert pose[:3, 3] == pytest.approx(tip, abs=1e-9)


def test_mujoco_stands_where_the_turns_say(arm):
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(lw.export_arm(arm, to="mjcf").found.text)
    data = mujoco.MjData(model)
    for q in drawn():
        tip, turns = placed(q)
        data.qpos[:] = turns
        mujoco.mj_forward(model, data)
        assert data.site("tip").xpos == pytest.approx(tip, abs=1e-9)
        # The servos can be asked for it.
        assert np.all((model.actuator_ctrlrange[:, 0] <= turns) & (turns <= model.actuator_ctrlrange[:, 1]))


def test_passive_joints_are_named(arm):
    held = arm.replace("chain[1].joint.passive", True)
    assert "that joints are passive (joint 1)" in lw.export_arm(held, to="mjcf").found.lost
