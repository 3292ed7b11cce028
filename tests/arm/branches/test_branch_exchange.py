"""Several arms on one torso for simulators: MuJoCo reads them back and feels the same weights at every drive."""

import numpy as np
import pytest

import linkwright as lw
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.compensation import model_error
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.files.read import read_arm
from linkwright.core.units.quantities import InputError
from tests import two_arms

LOW, HIGH = np.radians(np.array(two_arms.RANGES)).T


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(
        two_arms.arm_text().replace(
            "payload: {mass: 2.0 kg}", "payload: {mass: 2.0 kg}\n    tool: {xyz: [0 m, 0.1 m, 0.05 m]}"
        )
    )
    return path


def poses(count: int, seed: int = 1):
    return np.random.default_rng(seed).uniform(LOW, HIGH, (count, len(LOW)))


@pytest.mark.parametrize("to", ["mjcf", "urdf"])
def test_torques_and_tips_in_mujoco(file, to):
    mujoco = pytest.importorskip("mujoco")
    result = lw.export_arm(lw.read_arm(file), to=to)
    model = mujoco.MjModel.from_xml_string(result.text)
    model.opt.gravity[:] = two_arms.GRAVITY
    data = mujoco.MjData(model)
    joints = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, f"joint{number}") for number in range(1, 8)]
    assert len(joints) == model.nq == 7
    arms = {tip: read_arm(file, tip=tip) for tip in ("left", "right")}
    for q in poses(10):
        for joint, value in zip(joints, q, strict=True):
            data.qpos[model.jnt_qposadr[joint]] = value
        mujoco.mj_forward(model, data)
        held = [-data.qfrc_bias[model.jnt_dofadr[joint]] for joint in joints]
        for tip, joints_of in (("left", (0, 1, 2, 3, 4)), ("right", (0, 1, 5, 6))):
            state = solve(arms[tip], q.tolist(), beams_of(arms[tip]))
            for joint in joints_of:
                assert state.joints[joint].drive_load == pytest.approx(held[joint], abs=1e-9)
            if to == "mjcf":
                assert data.site(f"{tip}_tip").xpos == pytest.approx(np.array(state.tip(), dtype=float), abs=1e-9)


def test_the_fork_sags_in_mujoco_as_it_does_here(tmp_path):
    """Elastic torso and arms, drives that give: the servos asked for a pose stand where the model says."""
    mujoco = pytest.importorskip("mujoco")
    section = "section: {shape: circle, diameter: 50 mm}, material: steel-s355"
    lines = (
        two_arms.arm_text().replace("rigid: true, mass: 10 kg", section).replace("rigid: true, mass: 2.5 kg", section)
    )
    path = tmp_path / "arm.yaml"
    path.write_text(lines.replace("{type: revolute, axis: y", "{type: revolute, stiffness: 60 kN*m/rad, axis: y"))
    model = mujoco.MjModel.from_xml_string(lw.export_arm(lw.read_arm(path), to="mjcf").text)
    q = np.array([0.4, 0.2, -0.5, 0.3, 0.6, -0.8, 0.2])
    data = mujoco.MjData(model)
    data.ctrl[:] = q
    for number, value in enumerate(q, start=1):
        data.joint(f"joint{number}").qpos[0] = value
    mujoco.mj_forward(model, data)
    stood = {tip: data.site(f"{tip}_tip").xpos.copy() for tip in ("left", "right")}
    # Newton's steps to where nothing is left over: stiffness by differences, as drives and springs are linear.
    for _ in range(4):
        base = residual(mujoco, model, data)
        slope = np.empty((model.nv, model.nv))
        rest = data.qpos.copy()
        for k in range(model.nv):
            data.qpos[:] = rest
            data.qpos[k] += 1e-6
            slope[:, k] = (residual(mujoco, model, data) - base) / 1e-6
        data.qpos[:] = rest - np.linalg.solve(slope, base)
    mujoco.mj_forward(model, data)
    for tip in ("left", "right"):
        moved = data.site(f"{tip}_tip").xpos - stood[tip]
        due = model_error(read_arm(path, tip=tip), q[None], {"left": 1.0, "right": 2.0}[tip])[0]
        assert np.linalg.norm(due) > 2e-4
        assert moved == pytest.approx(due, abs=0.01 * np.linalg.norm(due))


def residual(mujoco, model, data):
    mujoco.mj_forward(model, data)
    return data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias


def test_urdf_holds_both_tips(file):
    import xml.etree.ElementTree as ElementTree

    root = ElementTree.fromstring(lw.export_arm(lw.read_arm(file), to="urdf").text)
    parents = {item.get("name"): item.find("parent").get("link") for item in root.iter("joint")}
    assert parents["joint3"] == parents["joint6"] == "link2"
    assert {parents[f"{tip}_tool"] for tip in ("left", "right")} == {"link5", "link7"}
    masses = sum(float(item.get("value")) for item in root.iter("mass"))
    assert masses == pytest.approx(30.0, abs=1e-6)
    assert len(lw.export_arm(lw.read_arm(file), to="bom").text.splitlines()) == 8


def test_a_table_against_the_error_of_one_tip(file):
    """With a soft pitch axis, over what the other arm does too; what is added brings the tip back."""
    soft = file.with_name("soft.yaml")
    soft.write_text(file.read_text() + "effects:\n  - {effect: joint_compliance, at: 2, compliance: 50 urad/(N*m)}\n")
    with pytest.raises(InputError, match="and this takes one; name one of them"):
        lw.compensate(lw.read_arm(soft), grid=2)
    result = lw.compensate(lw.read_arm(soft, tip="right"), poses=poses(4).tolist()).found
    assert np.abs(result.error).max() > 1e-3
    assert np.all(result.left < 0.02 * np.linalg.norm(result.error, axis=1))
    assert not np.any(result.correction[:, 2:5])  # the left arm's joints stay


BODY = (
    '<link name="{}"><inertial><origin xyz="{}"/><mass value="{}"/>'
    '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{}" type="{}"><parent link="{}"/><child link="{}"/><origin xyz="{}" rpy="{}"/><axis xyz="{}"/>'
    '<limit lower="-1" upper="1.2" effort="9" velocity="1"/></joint>'
)
ROBOT = "".join(
    [
        '<robot name="two-armed">',
        *(BODY.format(*item) for item in (
            ("pelvis", "0 0 0", 30), ("chest", "0.02 0 0.2", 8), ("head", "0 0.01 0.1", 2),
            ("l_mount", "0 0.05 0", 0.7),
            ("l_upper", "0 0.01 -0.1", 2), ("l_lower", "0.1 0 0", 1.2), ("l_finger", "0 0.02 0.01", 0.1),
            ("r_upper", "0 -0.01 -0.12", 2.1), ("r_lower", "0.11 0 0", 1.3), ("r_hand", "0.02 0 0", 0.4),
        )),
        '<link name="l_tool"/><link name="r_tool"/>',
        JOINT.format("yaw", "revolute", "pelvis", "chest", "0 0 0.9", "0 0 0.1", "0 0.3 1"),
        JOINT.format("neck", "revolute", "chest", "head", "0 0 0.5", "0 0 0", "0 0 1"),
        JOINT.format("l_fix", "fixed", "chest", "l_mount", "0 0.1 0.35", "0.2 0 0", "1 0 0"),
        JOINT.format("l_shoulder", "revolute", "l_mount", "l_upper", "0 0.08 0", "0 0.1 0", "0 1 0"),
        JOINT.format("l_elbow", "revolute", "l_upper", "l_lower", "0 0.02 -0.25", "0 0 0", "0 1 0"),
        JOINT.format("l_grip", "prismatic", "l_lower", "l_finger", "0.2 0 0", "0 0 0", "0 1 0"),
        JOINT.format("l_end", "fixed", "l_lower", "l_tool", "0.25 0 0.01", "0 0.3 0", "1 0 0"),
        JOINT.format("r_shoulder", "revolute", "chest", "r_upper", "0 -0.18 0.35", "-0.2 0 0", "0 1 0"),
        JOINT.format("r_elbow", "revolute", "r_upper", "r_lower", "0 -0.02 -0.25", "0 0 0", "0 1 0"),
        JOINT.format("r_wrist", "revolute", "r_lower", "r_hand", "0.2 0 0", "0 0 0", "1 0 0"),
        JOINT.format("r_end", "fixed", "r_hand", "r_tool", "0.1 0 0", "0 0 0", "1 0 0"),
        "</robot>",
    ]
)  # fmt: skip


def test_a_two_armed_urdf_is_a_torso_with_branches(tmp_path):
    """Tips and torques at every drive are those of MuJoCo's own reading of the file."""
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "robot.urdf"
    path.write_text(ROBOT)
    lw.import_arm(path, tip=["l_tool", "r_tool"]).save(tmp_path / "arm.yaml")
    assert "- joint: {name: r_shoulder," in (tmp_path / "arm.yaml").read_text()
    names = ["yaw", "l_shoulder", "l_elbow", "r_shoulder", "r_elbow", "r_wrist"]
    arms = {tip: read_arm(tmp_path / "arm.yaml", tip=tip) for tip in ("l_tool", "r_tool")}
    settings = '<mujoco><compiler fusestatic="false" boundinertia="1e-9"/></mujoco></robot>'
    model = mujoco.MjModel.from_xml_string(ROBOT.replace("</robot>", settings))
    data = mujoco.MjData(model)
    for q in np.random.default_rng(2).uniform(-0.9, 1.1, (6, 6)):
        for name, value in zip(names, q, strict=True):
            data.joint(name).qpos[0] = value
        mujoco.mj_forward(model, data)
        for tip, joints in (("l_tool", (0, 1, 2)), ("r_tool", (0, 3, 4, 5))):
            state = solve(arms[tip], q.tolist(), beams_of(arms[tip]))
            assert np.array(state.tip(), dtype=float) == pytest.approx(data.body(tip).xpos, abs=1e-9)
            for joint in joints:
                held = data.joint(names[joint]).qfrc_bias[0]
                assert state.joints[joint].drive_load == pytest.approx(-held, abs=1e-9)


@pytest.mark.parametrize(
    ("tips", "said"),
    [
        (["l_tool", "l_tool"], "names a link twice"),
        (["l_tool", "r_tool", "l_finger"], "part at several places"),
        (["l_tool", "torso"], "there is no link 'torso'"),
    ],
)
def test_tips_that_make_no_branches(tmp_path, tips, said):
    path = tmp_path / "robot.urdf"
    path.write_text(ROBOT)
    with pytest.raises(InputError, match=said):
        lw.import_arm(path, tip=tips)
    path.write_text(ROBOT.replace('name="yaw" type="revolute"', 'name="yaw" type="fixed"'))
    with pytest.raises(InputError, match="share no joint that moves, so that none loads another; import each by"):
        lw.import_arm(path, tip=["l_tool", "r_tool"])
