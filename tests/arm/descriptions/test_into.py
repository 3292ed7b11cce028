"""What was found, in the user's own file: frames as the corrected arm has them, and every other byte as it was."""

import re
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.descriptions.exported import identified_geometry
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.descriptions.into import into_file
from linkwright.core.units.quantities import InputError
from tests.arm.descriptions.urdf_chain import posed, tip_pose

URDF = """<?xml version='1.0'?>\r
<!-- the maker's own file: do not reformat -->
<robot name = "odd">
\t<link name="root"/> <link name="base"/><link name="upper"/><link name="motor"/>
  <link name="fore"/><link name="wrist"/><link name="tool0"/>
  <joint name="stand" type="fixed"><parent link="root"/><child link="base"/><origin xyz="0 0 0.7" rpy="0 0 1"/></joint>
  <joint type="revolute"
         name='slew'><parent link="base"/><child link="upper"/><origin   xyz='0   0  0.30'/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="5" velocity="1"/></joint>
  <joint name="bolt" type="fixed"><origin xyz="0.1 0 0" rpy="0.3 0.2 0"/>
    <parent link="upper"/><child link="motor"/></joint>
  <joint name="lift" type="revolute"><origin rpy="0 1.5707963 0" xyz="0.05 .4 1e-1"/><!-- 400 mm -->
    <parent link="motor"/><child link="fore"/><axis xyz="0 0.6 0.8"/>
    <limit lower="-1" upper="1" effort="5" velocity="1"/></joint>
  <joint name="reach" type="prismatic"><parent link="fore"/><child link="wrist"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.3" effort="5" velocity="1"/></joint>
  <joint name="end" type="fixed"><parent link="wrist"/><child link="tool0"/><origin xyz="0.25 0 0"/></joint>
</robot>
"""
FOUND = (
    EffectEntry("encoder_offset", (1,), {"offset": 0.01}),
    EffectEntry("encoder_offset", (2,), {"offset": -0.02}),
    EffectEntry("encoder_offset", (3,), {"offset": 0.003}),
    EffectEntry("link_length", (1,), {"length": 0.002}),
    EffectEntry("link_length", (3,), {"length": -0.0015}),
    EffectEntry("axis_misalignment", (2,), {"tilt_u": 0.004, "tilt_v": -0.003, "shift_u": 0.001, "shift_v": 0.0}),
)


def robot(folder, text=URDF, name="robot.urdf"):
    """The file, and the arm that it is."""
    path = folder / name
    path.write_bytes(text.encode())
    return path


def in_file(text, q):
    """Where the tip stands in link `base` by the products of matrices of a URDF's text."""
    return tip_pose(text, "base", "tool0", dict(zip(("slew", "lift", "reach"), q, strict=True)))[:3, 3]


@pytest.mark.parametrize("found", [FOUND, *((item,) for item in FOUND)])
def test_a_urdf_stands_as_the_corrected_arm(tmp_path, found):
    """To 1e-9 m at any pose; what is between the numbers stays, and so do joints that nothing was found of."""
    path = robot(tmp_path)
    arm = import_robot(path, base="base", tip="tool0").arm
    out = into_file(replace(arm, effects=found), path)
    assert not out.lost
    true = identified_geometry(replace(arm, effects=found))
    draw = np.random.default_rng(2)
    for _ in range(4):
        q = [draw.uniform(*joint.range) for joint in arm.joints]
        assert in_file(out.text, q) == pytest.approx(tip_position(true, q)[0], abs=1e-9)
        assert np.abs(in_file(URDF, q) - in_file(out.text, q)).max() > 1e-5
    # All but the frames is the same, and in frames all but the numbers and what had to be added.
    frame = re.compile(r"<origin[^>]*/>")
    assert frame.sub("", out.text) == frame.sub("", URDF)
    told = {item.split(":")[0].removeprefix("joint ") for item in out.carried}
    assert told <= {"slew", "lift", "reach", "tool0"}


def test_one_zero_is_one_attribute(tmp_path):
    """Of the second joint's roll, pitch and yaw; the rest of the file is the same, byte for byte."""
    path = robot(tmp_path, URDF.replace("0 1.5707963 0", "0 0  0.3").replace("0 0.6 0.8", "0 0 1"))
    arm = import_robot(path, base="base", tip="tool0").arm
    out = into_file(replace(arm, effects=(EffectEntry("encoder_offset", (2,), {"offset": 0.05}),)), path)
    assert out.text.encode() == path.read_bytes().replace(b"0 0  0.3", b"0 0  0.35")
    assert out.carried == ("lift: rpy 0 0  0.3 is now 0 0  0.35",)
    nothing = into_file(arm, path)
    assert nothing.text.encode() == path.read_bytes()
    assert nothing.carried[0].startswith("nothing")


MJCF = """<mujoco model="odd"><compiler eulerseq="XYZ" autolimits="true"/>
  <!-- degrees -->
  <default><joint axis="0 1 0" damping="3"/><default class="big"><joint axis="0 0 1"/><position kp="900"/>
  </default></default>
  <worldbody><body name="stand" pos="0 0 0.7">
    <body name="upper" childclass="big" pos="0 0 0.3"><joint name="slew" range="-57 57"/><geom size="0.1" mass="1"/>
      <body name="motor" pos="0.1 0 0" euler="20 10 5">
        <body name="fore" pos="0.05 .4 1e-1" quat="0.8 0 0.6 0">
          <joint name="lift" pos="0 0.02 0" ref="15" class="main"/><geom size="0.1" mass="1"/>
          <body name="wrist" pos="0.3 0 0"><joint name="reach" type="slide" axis="1 0 0"/><geom size="0.1" mass="1"/>
            <site name="tip" pos="0.25 0 0"/></body></body></body></body></body></worldbody>
  <actuator><position class="big" joint="slew"/><position joint="lift" kp="500"/></actuator>
</mujoco>
"""


FRAMED = (
    MJCF.replace('<body name="upper"', '<frame pos="0.1 0.2 0" euler="0 0 30"><frame pos="0 0 0.1"><body name="upper"')
    .replace('<joint name="lift" pos', '<frame pos="0.01 0 0" euler="0 0 10"><joint name="lift" pos')
    .replace('class="main"/><geom', 'class="main"/></frame><geom')
    .replace('<body name="wrist"', '<frame pos="0 0.1 0" euler="0 5 0" childclass="main"><body name="wrist"')
    .replace(
        '<site name="tip" pos="0.25 0 0"/></body>', '<frame pos="0 0 0.1"><site name="tip"/></frame></body></frame>'
    )
    .replace("</body></worldbody>", "</frame></frame></body></worldbody>")
)


def of_mjcf(text):
    """The same arm as an arm file has it, by MuJoCo's own frames at coordinates 0."""
    from linkwright.core.arm.chain.chain import Arm, Joint, Link

    model = mujoco.MjModel.from_xml_string(text)
    data = posed(model, {"slew": 0.0, "lift": 0.0, "reach": 0.0})
    base = np.array([0.0, 0.0, 0.7])
    joints, links, before = [], [], None
    places = [data.xanchor[model.joint(name).id] - base for name in ("slew", "lift", "reach")]
    axes = [data.xaxis[model.joint(name).id] for name in ("slew", "lift", "reach")]
    for number, name in enumerate(("slew", "lift", "reach")):
        onward = (places[number + 1] if number < 2 else data.site("tip").xpos - base) - places[number]
        start = tuple(places[0]) if before is None else (0.0, 0.0, 0.0)
        span = (0.0, 0.3) if name == "reach" else (-1.0, 1.0)
        kind = "prismatic" if name == "reach" else "revolute"
        joints.append(Joint(kind, tuple(axes[number]), span, origin_translation=start, name=name))
        links.append(Link(float(np.linalg.norm(onward)), tuple(onward / np.linalg.norm(onward)), mass=1.0))
        before = name
    return Arm("odd", tuple(joints), tuple(links), gravity=(0.0, 0.0, -9.81))


@pytest.mark.parametrize("text", [MJCF, FRAMED], ids=["bodies", "frames"])
def test_an_mjcf_stands_as_the_corrected_arm(tmp_path, text):
    """Degrees, defaults, an Euler sequence, an anchor beside its body and a reference angle; other frames than the arm
    file's, and `<frame>`s about bodies, a joint and the tip. The stiffness found goes into the servo that has one."""
    path = robot(tmp_path, text, "robot.xml")
    arm = of_mjcf(text)
    soft = EffectEntry("joint_compliance", (2, 3), {"compliance": 1e-4})
    out = into_file(replace(arm, effects=(*FOUND, soft)), path)
    true = identified_geometry(replace(arm, effects=FOUND))
    model = mujoco.MjModel.from_xml_string(out.text)
    draw = np.random.default_rng(3)
    for _ in range(4):
        q = [draw.uniform(*joint.range) for joint in arm.joints]
        named = dict(zip(("slew", "lift", "reach"), q, strict=True))
        there = posed(model, named).site("tip").xpos - [0.0, 0.0, 0.7]
        assert there == pytest.approx(tip_position(true, q)[0], abs=1e-9)
    assert model.actuator_gainprm[1, 0] == pytest.approx(1e4)
    assert model.actuator_gainprm[0, 0] == 900.0
    assert out.lost == ("stiffness of the drive of joint 3: reach has no position servo",)
    assert into_file(arm, path).text.encode() == path.read_bytes()
    assert "<!-- degrees -->" in out.text


def test_what_is_found_beside_frames_is_told(tmp_path):
    """A URDF has no place for a drive that gives, nor a tip where no frame stands at it."""
    path = robot(tmp_path)
    arm = import_robot(path, base="base", tip="wrist").arm
    arm = replace(arm, tool=(0.1, 0.0, 0.0))
    effects = (EffectEntry("joint_compliance", (2,), {"compliance": 1e-4}), FOUND[4])
    out = into_file(replace(arm, effects=effects), path)
    assert any("joint_compliance" in item for item in out.lost)
    assert any("tip stands" in item for item in out.lost)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            lambda arm: replace(arm, joints=(arm.joints[0], replace(arm.joints[1], name="lifd"), arm.joints[2])),
            "'lift'",
        ),
        (lambda arm: replace(arm, joints=(replace(arm.joints[0], zero=0.2), *arm.joints[1:])), "'lift' stands"),
        (lambda arm: replace(arm, joints=(arm.joints[1], arm.joints[0], arm.joints[2])), "another order"),
    ],
)
def test_another_arms_file_is_refused(tmp_path, change, words):
    """In one line that names the joint."""
    path = robot(tmp_path)
    arm = change(import_robot(path, base="base", tip="tool0").arm)
    with pytest.raises(InputError, match=words) as error:
        into_file(arm, path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("<worldbody>", "<worldbody>" + "<body>" * 300 + "</body>" * 300, "holds elements more than 256 within"),
        ('eulerseq="XYZ"', 'eulerseq="xy"', "eulerseq is 'xy'; write three"),
        ('ref="15"', 'ref="a bit"', "has 'a bit' where a number is due"),
        ('axis="1 0 0"', 'axis="0 0 0"', "a direction without a length"),
        ('axis="1 0 0"', 'axis="0 1e300 0"', "a direction without a length"),
        ("<mujoco", '<?xml version="1.0" encoding="iso-8859-1"?><!-- \xe9 --><mujoco', "another encoding"),
    ],
)
def test_a_file_that_cannot_be_one_is_one_line(tmp_path, old, new, words):
    """What MuJoCo would not read, or what would not be found again in the file's bytes."""
    path = tmp_path / "robot.xml"
    assert old in MJCF
    path.write_bytes(MJCF.replace(old, new, 1).encode("latin-1"))
    with pytest.raises(InputError, match=words) as error:
        into_file(of_mjcf(MJCF), path)
    assert "\n" not in str(error.value)
