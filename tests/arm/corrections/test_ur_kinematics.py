"""The calibration of a UR robot with what was found in it, against the robot's own chain of Denavit and Hartenberg."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
import yaml

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.corrections.ur_kinematics import into_kinematics
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.units.quantities import InputError

# config/ur5e/default_kinematics.yaml of UniversalRobots/Universal_Robots_ROS2_Description
UR5E = """kinematics:   # extracted
  shoulder: {x: 0, y: 0, z: 0.1625, roll: 0, pitch: 0, yaw: 0}
  upper_arm:
    x: 0
    y: 0
    z: 0
    roll: 1.570796327
    pitch: 0
    yaw: 0
  forearm: {x: -0.425, y: 0, z: 0, roll: 0, pitch: 0, yaw: 0}
  wrist_1: {x: -0.3922, y: 0, z: 0.1333, roll: 0, pitch: 0, yaw: 0}
  wrist_2: {x: 0, y: -0.0997, z: -2.044881182297852e-11, roll: 1.570796327, pitch: 0, yaw: 0}
  wrist_3:
    x: 0
    y: 0.09959999999999999
    z: -2.042830148012698e-11
    roll: 1.570796326589793
    pitch: 3.141592653589793
    yaw: 3.141592653589793
  hash: calib_12788084448423163542
"""
# universal-robots.com, DH parameters for calculations of kinematics and dynamics: UR5e
A = np.array([0.0, -0.425, -0.3922, 0.0, 0.0, 0.0])
D = np.array([0.1625, 0.0, 0.0, 0.1333, 0.0997, 0.0996])
ALPHA = np.array([np.pi / 2, 0.0, 0.0, np.pi / 2, -np.pi / 2, 0.0])
JOINTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
PARTS = ("shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3")


def urdf(text):
    """The chain that ur_macro.xacro makes of a calibration."""
    links = ["base_link", "base_link_inertia", *(f"{part}_link" for part in PARTS), "tool0"]
    out = ['<robot name="ur">', *(f'<link name="{link}"/>' for link in links)]
    out.append('<joint name="b" type="fixed"><parent link="base_link"/><child link="base_link_inertia"/>')
    out.append(f'<origin rpy="0 0 {np.pi!r}"/></joint>')
    kinematics = yaml.safe_load(text)["kinematics"]
    for joint, part, on in zip(JOINTS, PARTS, links[1:], strict=False):
        xyz, rpy = (
            " ".join(repr(float(kinematics[part][key])) for key in keys)
            for keys in (("x", "y", "z"), ("roll", "pitch", "yaw"))
        )
        out.append(f'<joint name="{joint}_joint" type="revolute"><parent link="{on}"/><child link="{part}_link"/>')
        out.append(f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="0 0 1"/><limit lower="-6" upper="6"/></joint>')
    out.append('<joint name="t" type="fixed"><parent link="wrist_3_link"/><child link="tool0"/></joint></robot>')
    return "\n".join(out)


def ros_tip(text, poses):
    """Where MuJoCo has tool0 of that chain, in base_link."""
    body = '<mujoco><compiler balanceinertia="true" boundmass="1" boundinertia="1" fusestatic="false"/></mujoco>'
    model = mujoco.MjModel.from_xml_string(urdf(text).replace('<robot name="ur">', f'<robot name="ur">{body}'))
    data = mujoco.MjData(model)
    results = []
    for q in poses:
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        results.append(data.body("tool0").xpos.copy())
    return np.array(results)


def robot_tip(poses, theta, a, d, alpha):
    """Where a UR's controller has its flange: theta and d along z, then a and alpha along x; in base_link, which stands
    half a turn from its base."""
    results = []
    for q in poses:
        where = np.eye(4)
        for turn, along, aside, twist in zip(q + theta, d, a, alpha, strict=True):
            c, s, ca, sa = np.cos(turn), np.sin(turn), np.cos(twist), np.sin(twist)
            step = [[c, -s * ca, s * sa, aside * c], [s, c * ca, -c * sa, aside * s], [0, sa, ca, along], [0, 0, 0, 1]]
            where = where @ np.array(step)
        results.append(where[:3, 3] * [-1.0, -1.0, 1.0])
    return np.array(results)


@pytest.fixture
def calibration(tmp_path):
    path = tmp_path / "my_robot_calibration.yaml"
    path.write_text(UR5E, encoding="utf-8")
    return path


def arm_of(tmp_path, text=UR5E, base="base_link"):
    path = tmp_path / "ur.urdf"
    path.write_text(urdf(text), encoding="utf-8")
    return import_robot(path, base=base, tip="tool0").arm


FOUND = (
    EffectEntry("encoder_offset", (2,), {"offset": 0.004}),
    EffectEntry("encoder_offset", (4,), {"offset": -0.007}),
    EffectEntry("link_length", (2,), {"length": 0.0008}),
    EffectEntry("axis_misalignment", (2,), {"tilt_v": -0.003}),  # v points against x
)


@pytest.mark.parametrize("base", ["base_link", "base_link_inertia"])
def test_ros_has_the_tip_where_the_robot_has_it(tmp_path, calibration, base):
    """The robot differs from its file by delta_theta of joints 2 and 4, delta_a of the upper arm and delta_alpha of the
    shoulder; by millimetres before, by what the file's digits leave after."""
    theta = np.array([0.0, 0.004, 0.0, -0.007, 0.0, 0.0])
    a, alpha = A.copy(), ALPHA.copy()
    a[1] -= 0.0008
    alpha[0] += 0.003
    poses = np.random.default_rng(4).uniform(-3.0, 3.0, (20, 6))
    true = robot_tip(poses, theta, a, D, alpha)
    assert ros_tip(UR5E, poses) == pytest.approx(robot_tip(poses, 0.0 * theta, A, D, ALPHA), abs=1e-8)
    out = into_kinematics(replace(arm_of(tmp_path, base=base), effects=FOUND), calibration)
    assert np.abs(ros_tip(UR5E, poses) - true).max() > 1e-3
    assert ros_tip(out.text, poses) == pytest.approx(true, abs=2e-8)
    assert not out.lost


def test_what_was_not_found_stays_character_for_character(tmp_path, calibration):
    arm = arm_of(tmp_path)
    assert into_kinematics(arm, calibration).text == UR5E
    out = into_kinematics(replace(arm, effects=FOUND[:1]), calibration)
    assert out.carried == ("upper_arm.pitch 0 is now -0.004",)
    assert out.text == UR5E.replace("    pitch: 0\n    yaw: 0\n", "    pitch: -0.004\n    yaw: 0\n", 1)


def test_what_the_file_cannot_hold_is_told(tmp_path, calibration):
    droop = EffectEntry("joint_compliance", (2,), {"compliance": 1e-6})
    longer = EffectEntry("link_length", (6,), {"length": 0.001})
    lost = into_kinematics(replace(arm_of(tmp_path), effects=(droop,)), calibration).lost
    assert len(lost) == 1
    assert "joint_compliance" in lost[0]
    (lost,) = into_kinematics(replace(arm_of(tmp_path), effects=(longer,)), calibration).lost
    assert "the file ends at wrist_3" in lost


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("-0.425", "-0.612", "it is of another arm"),
        ("x: -0.425, ", "", "kinematics.forearm.x: is missing"),
        ("-0.425", "long", "kinematics.forearm.x: needs a number"),
        ("kinematics:", "kinematics: [", "is no YAML"),
        ("kinematics:", "dynamics:", "kinematics.shoulder.x: is missing"),
    ],
)
def test_another_file_is_refused_in_one_line(tmp_path, calibration, old, new, words):
    arm = arm_of(tmp_path)
    calibration.write_text(UR5E.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=words) as caught:
        into_kinematics(arm, calibration)
    assert "\n" not in str(caught.value)


def test_an_arm_of_three_joints_is_none(tmp_path, calibration):
    arm = arm_of(tmp_path)
    with pytest.raises(InputError, match="the arm has 3"):
        into_kinematics(replace(arm, joints=arm.joints[:3], links=arm.links[:3]), calibration)
