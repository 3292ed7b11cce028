"""What was found of a moving arm, in the user's own file: MuJoCo takes the torques of the corrected arm's model, and
every byte that says something else is as it was."""

import re
from dataclasses import replace

import mujoco
import numpy as np

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.descriptions.into import into_file
from linkwright.core.arm.motion.dynamics import model_torque
from linkwright.core.arm.motion.motion import Motion
from tests.arm.descriptions.test_in_motion import ROTORS, RUBS, WEIGHS, in_mujoco, states
from tests.arm.descriptions.test_into import MJCF, of_mjcf, robot
from tests.arm.motion.robots import PANDA, UR10E, urdf_of


def with_more(arm, effects):
    """The arm with effects beyond those that its file has."""
    return replace(arm, effects=(*arm.effects, *effects))


def added(arm, effects, size):
    """What the effects take of the drives, by the arm's own model."""
    motion = Motion(arm, np.arange(5.0), *states(size))
    return model_torque(replace(motion, arm=with_more(arm, effects))) - model_torque(motion)


def test_a_urdf_moves_as_the_corrected_arm(tmp_path):
    """Links with a tensor, one whose inertial is turned, and one without; a joint with dynamics and others without."""
    text = urdf_of(UR10E).replace(
        '<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"/><dynamics friction="9.0"  damping="0"/>', 1
    )
    path = robot(tmp_path, text)
    arm = import_robot(path).arm
    turned = EffectEntry(
        "link_inertial",
        (6,),
        {"mass": 0.3, "first_moment_y": 0.02, "inertia_xx": 0.02, "inertia_yy": 0.02, "inertia_zz": 0.02},
    )
    effects = (*RUBS, *WEIGHS, turned)
    out = into_file(with_more(arm, effects), path)
    assert not out.lost
    plain = in_mujoco(text, *states(6))
    np.testing.assert_allclose(in_mujoco(out.text, *states(6)) - plain, added(arm, effects, 6), rtol=0, atol=1e-8)
    assert 'friction="12"  damping="1.5"' in out.text
    weights = re.compile(r"<inertial>.*?</inertial>|<dynamics[^>]*/>")
    assert weights.sub("", out.text) == weights.sub("", text)
    nothing = into_file(arm, path)
    assert nothing.text == text


def test_a_link_without_weight_is_given_one(tmp_path):
    text = re.sub(r'<link name="link7">.*?</link>', '<link name="link7"/>', urdf_of(PANDA))
    path = robot(tmp_path, text)
    arm = import_robot(path).arm
    tool = EffectEntry("payload", (), {"mass": 0.8, "centre_z": 0.05, "inertia_xx": 1e-3, "inertia_yy": 1e-3,
                                       "inertia_zz": 1e-3})  # fmt: skip
    weighed = replace(arm, links=(*arm.links[:-1], replace(arm.links[-1], mass=0.0)))
    out = into_file(replace(arm, effects=(tool,)), path)
    assert out.text.count("<inertial>") == 7
    light = text.replace(
        '<link name="link7"/>',
        '<link name="link7"><inertial><mass value="1e-12"/><inertia ixx="1e-12" iyy="1e-12" izz="1e-12" ixy="0" '
        'ixz="0" iyz="0"/></inertial></link>',
    )
    result = in_mujoco(out.text, *states(7)) - in_mujoco(light, *states(7))
    np.testing.assert_allclose(result, added(weighed, (tool,), 7), rtol=0, atol=1e-8)


def test_an_mjcf_moves_as_the_corrected_arm(tmp_path):
    """Bodies whose frames are not the arm's links', degrees, and inertials written in every way."""
    text = MJCF.replace(' damping="3"', "")
    for number, inertial in enumerate(
        (
            '<inertial pos="0 0.1 0" mass="2" diaginertia="0.02 0.03 0.04" euler="10 20 0"/>',
            '<inertial pos="0.1 0 0" mass="1.5" fullinertia="0.3 0.3 0.4 0.01 0 0.02"/>',
            '<inertial mass="0.7" pos="0 0 0" diaginertia="0.01 0.01 0.01"/>',
        )
    ):
        start = text.index(("slew", "lift", "reach")[number])
        at = text.index('<geom size="0.1" mass="1"/>', start)
        text = text[:at] + inertial + text[at + len('<geom size="0.1" mass="1"/>') :]
    path = robot(tmp_path, text, "robot.xml")
    arm = of_mjcf(text)
    effects = (*RUBS, *ROTORS, *WEIGHS)
    out = into_file(replace(arm, effects=effects), path)
    assert not out.lost
    model = mujoco.MjModel.from_xml_string(out.text)
    assert model.joint("lift").stiffness[0] == 12.0
    result = in_mujoco(out.text, *states(3)) - in_mujoco(text, *states(3))
    np.testing.assert_allclose(result, added(arm, effects, 3), rtol=0, atol=1e-8)


def test_a_body_weighed_by_its_shapes_is_given_an_inertial(tmp_path):
    """MuJoCo weighs shapes and what was found together, also of a body whose joint stands beside its origin."""
    text = MJCF.replace(' damping="3"', "").replace(
        '<geom size="0.1" mass="1"/>', '<geom type="box" size="0.1 0.12 0.1" pos="0.1 0.02 0" euler="0 20 10"/>', 2
    )
    path = robot(tmp_path, text, "robot.xml")
    arm = of_mjcf(text)
    out = into_file(replace(arm, effects=WEIGHS), path)
    assert not out.lost
    result = in_mujoco(out.text, *states(3)) - in_mujoco(text, *states(3))
    np.testing.assert_allclose(result, added(arm, WEIGHS, 3), rtol=0, atol=1e-8)


def test_a_body_whose_shapes_do_not_tell_its_weight_is_told(tmp_path):
    heavy = (EffectEntry("link_inertial", (2,), {"mass": 0.3}),)
    for change, says in (
        (('<geom size="0.1" mass="1"/>', '<geom type="mesh" mesh="gone" mass="1"/>'), "geoms that cannot be read"),
        (('class="main"/><geom', 'class="main"/><joint name="more" axis="1 0 0"/><geom'), "several joints"),
        (("<compiler ", '<compiler inertiafromgeom="true" '), "weighs what its geoms do"),
    ):
        text = MJCF.replace(*change)
        out = into_file(replace(of_mjcf(MJCF), effects=heavy), robot(tmp_path, text, "robot.xml"))
        assert says in out.lost[0]
        assert out.text == text
