"""Arms from URDF: kinematics and weights as products of matrices and MuJoCo have them; one line for what is wrong."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.arm.chain.kinematics import place, tip_position
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.descriptions.formats import export_arm
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.files.read import read_arm
from linkwright.core.units.quantities import InputError
from tests.arm.descriptions.urdf_chain import in_mujoco, posed, tip_pose

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "urdf" / "tabletop.urdf"


def same_as_others(path, found, folder, seed=1, poses=5):
    """The written file against both: tips to 1e-9 m, orientations to 1e-9, gravity torques to 1e-9 of the greatest, or
    of the arm's weight (at 1 m) where they cancel."""
    text = path.read_text(encoding="utf-8")
    (folder / "arm.yaml").write_text(found.to_yaml(), encoding="utf-8")
    arm = read_arm(folder / "arm.yaml")
    model = in_mujoco(text)
    weight = 9.81 * sum(model.body_mass)
    draw = np.random.default_rng(seed)
    for _ in range(poses):
        q = [draw.uniform(*joint.range) for joint in arm.joints]
        named = dict(zip(found.joint_names, q, strict=True))
        pose = tip_pose(text, found.base, found.tip, named)
        assert tip_position(arm, q)[0] == pytest.approx(pose[:3, 3], abs=1e-9)
        assert np.array(place(arm, q).orientation, float) == pytest.approx(pose[:3, :3], abs=1e-9)
        data = posed(model, named)
        assert data.body(found.tip).xpos == pytest.approx(pose[:3, 3], abs=1e-9)
        torques = [float(joint.drive_load) for joint in solve(arm, q, beams_of(arm, (arm.payload,))).joints]
        theirs = [-data.joint(name).qfrc_bias[0] for name in found.joint_names]
        assert torques == pytest.approx(theirs, abs=1e-9 * max(weight, *map(abs, theirs)))


def test_the_example_is_what_its_file_says(tmp_path):
    """A fixed flange turned by nearly 90 degrees, a finger beside the tip, a slide, an oblique axis."""
    result = import_robot(EXAMPLE, tip="tip")
    same_as_others(EXAMPLE, result, tmp_path, poses=20)
    assert result.joint_names == ("turn", "shoulder", "reach")
    assert result.arm.joints[1].range == (-1.2, 2.0)
    assert result.arm.joints[2].range == (0.0, 0.15)
    assert [item.at for item in result.lacking if item.what == "limits"] == [(1,)]


COORDINATE = st.floats(-0.5, 0.5).map(lambda x: round(x, 6))
ANGLE = st.one_of(st.sampled_from([0.0, 1.5708, -1.570796, 1.57079632679, 3.14159]), st.floats(-3.0, 3.0))
JOINT = st.tuples(
    st.sampled_from(["revolute", "fixed", "prismatic", "continuous"]),
    st.tuples(COORDINATE, COORDINATE, COORDINATE),
    st.tuples(ANGLE, ANGLE, ANGLE),
    st.sampled_from(["1 0 0", "0 -1 0", "0 0 1", "0.6 0 0.8", "1 2 3"]),
    st.tuples(COORDINATE, COORDINATE, COORDINATE),
    st.booleans(),
)


def written(joints):
    """A URDF of these joints in a row, some with a second body bolted to their link."""
    lines = ['<robot name="row"><link name="l0"/>']
    for number, (kind, xyz, rpy, axis, center, twin) in enumerate(joints, start=1):
        weight = f'<inertial><origin xyz="{" ".join(map(str, center))}"/><mass value="{0.5 + 0.1 * number}"/>'
        weight += '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>'
        lines.append(f'<link name="l{number}">{weight}</link>')
        limit = (
            '<limit lower="-1.1" upper="2.3" effort="1" velocity="1"/>' if kind not in ("fixed", "continuous") else ""
        )
        frame = f'<origin xyz="{" ".join(map(repr, xyz))}" rpy="{" ".join(map(repr, rpy))}"/>'
        ends = f'<parent link="l{number - 1}"/><child link="l{number}"/><axis xyz="{axis}"/>'
        lines.append(f'<joint name="j{number}" type="{kind}">{frame}{ends}{limit}</joint>')
        if twin:
            lines.append(f'<link name="t{number}">{weight}</link><joint name="b{number}" type="fixed">{frame}')
            lines.append(f'<parent link="l{number}"/><child link="t{number}"/></joint>')
    return "\n".join([*lines, "</robot>"])


@settings(max_examples=25, deadline=None)
@given(joints=st.lists(JOINT, min_size=1, max_size=6).filter(lambda x: any(item[0] != "fixed" for item in x)))
def test_any_row_of_joints(tmp_path_factory, joints):
    """Turned by right angles to six digits as makers write them, fixed ones anywhere, bodies bolted on."""
    folder = tmp_path_factory.mktemp("row")
    path = folder / "row.urdf"
    path.write_text(written(joints), encoding="utf-8")
    same_as_others(path, import_robot(path, tip=f"l{len(joints)}"), folder, poses=2)


def test_another_base_feels_gravity_from_its_own_side(tmp_path):
    """The column stands on a base that is turned upside down; from there the arm hangs."""
    hung = EXAMPLE.read_text(encoding="utf-8").replace(
        '<link name="base"/>', '<link name="ceiling"/><link name="base"/>'
    )
    hung = hung.replace(
        '<joint name="turn"',
        '<joint name="hook" type="fixed"><origin xyz="0 0 2" rpy="3.14159265358979 0 0"/><parent link="ceiling"/>'
        '<child link="base"/></joint><joint name="turn"',
    )
    path = tmp_path / "hung.urdf"
    path.write_text(hung, encoding="utf-8")
    assert import_robot(path, tip="tip", base="base").arm.gravity == pytest.approx((0.0, 0.0, 9.81), abs=1e-12)
    same_as_others(path, import_robot(path, tip="tip"), tmp_path)


def elbowed(step, first="0 0 0.1"):
    """A shoulder, and an elbow that stands a `step` from it; the shoulder has a second origin."""
    weight = '<inertial><origin xyz="0.01 0.02 0.2"/><mass value="2"/>'
    weight += '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>'
    limit = '<limit lower="-1.1" upper="2.3"/>'
    joints = [
        f'<joint name="shoulder" type="revolute"><origin xyz="{first}"/><origin xyz="0 0 7"/><parent link="a"/>'
        f'<child link="upper"/><axis xyz="0 1 0"/>{limit}</joint>',
        f'<joint name="elbow" type="revolute"><origin xyz="{step}"/><parent link="upper"/><child link="fore"/>'
        f'<axis xyz="0 1 0"/>{limit}</joint>',
        '<joint name="end" type="fixed"><origin xyz="0.3 0 0"/><parent link="fore"/><child link="tip"/></joint>',
    ]
    links = f'<link name="a"/><link name="upper">{weight}</link><link name="fore">{weight}</link><link name="tip"/>'
    return f'<robot name="elbowed">{links}{"".join(joints)}</robot>'


def test_a_link_runs_along_its_longest_axis(tmp_path):
    """As it can be built: what is beside it is the next joint's origin, and said; tips and torques are the file's."""
    path = tmp_path / "elbowed.urdf"
    path.write_text(elbowed("0 -0.131 0.425").replace('<origin xyz="0 0 7"/>', ""), encoding="utf-8")
    result = import_robot(path)
    upper, elbow = result.arm.links[0], result.arm.joints[1]
    assert (upper.length, upper.direction) == (0.425, (0.0, 0.0, 1.0))
    assert elbow.origin_translation == (0.0, -0.131, 0.0)
    assert any("upper (425 mm, rest 0, -131, 0 mm)" in note for note in result.notes)
    same_as_others(path, result, tmp_path)
    path.write_text(elbowed("0.3 0 0.4"), encoding="utf-8")
    assert import_robot(path).arm.links[0].length == pytest.approx(0.5)
    assert not any("longest axis" in note for note in import_robot(path).notes)


def test_of_two_origins_the_first_counts(tmp_path):
    """As urdfdom and all that read by it take them (FirstChildElement), with a note."""
    path = tmp_path / "elbowed.urdf"
    path.write_text(elbowed("0 0 0.4"), encoding="utf-8")
    result = import_robot(path)
    assert result.arm.joints[0].origin_translation == (0.0, 0.0, 0.1)
    assert any("the first counts, as in ROS: shoulder" in note for note in result.notes)


def test_ranges_are_written_in_degrees(tmp_path):
    """However many digits a maker's radians have."""
    path = tmp_path / "elbowed.urdf"
    path.write_text(elbowed("0 0 0.4"), encoding="utf-8")
    ends = re.search(r"range: \[(\S+) deg, (\S+) deg\]", import_robot(path).to_yaml())
    assert ends
    assert [math.radians(float(end)) for end in ends.groups()] == pytest.approx([-1.1, 2.3], rel=1e-12)


ONE = '<link name="b"/>'
PAIR = '<link name="a"/><link name="b"/>'
JOINED = '<joint name="j" type="{}"><parent link="a"/><child link="b"/>{}</joint>'
LIMIT = '<limit lower="-1" upper="1"/>'


def joined(kind, inside=""):
    """Two links and a joint between them."""
    return f"<robot>{PAIR}{JOINED.format(kind, inside)}</robot>"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is no XML"),
        ("<robot>", "is no XML"),
        ('<!DOCTYPE robot [<!ENTITY a "b">]><robot name="&a;"/>', "line 1: holds a DOCTYPE"),
        ('<!DOCTYPE robot SYSTEM "file:///etc/hostname"><robot/>', "holds a DOCTYPE"),
        ('<?xml version="1.0" encoding="nothing"?><robot/>', "is no XML"),
        ("<mujoco/>", "holds no <worldbody>"),
        ("<robot/>", "holds no <link>"),
        ('<robot xmlns:xacro="x"><xacro:include filename="/etc/passwd"/></robot>', "expand it first"),
        (f"<robot>{ONE}{ONE}</robot>", "names are unique"),
        (f"<robot>{PAIR}</robot>", "several roots ('a', 'b')"),
        (joined("hinge"), "type 'hinge' is none of revolute"),
        (joined("revolute"), "has no <limit>"),
        (joined("fixed"), "no joint beyond 'a' moves"),
        (joined("floating"), "no joint beyond 'a' moves"),
        (f"<robot>{ONE}{JOINED.format('revolute', LIMIT)}</robot>", "link 'a' is not in the file"),
        (joined("revolute", LIMIT + '<axis xyz="0 0 0"/>'), "has no direction"),
        (joined("revolute", LIMIT + '<axis xyz="0 nan 1"/>'), "xyz is '0 nan 1'"),
        (joined("revolute", LIMIT + '<axis xyz="${a}"/>'), "a macro; expand it"),
        (joined("revolute", LIMIT + '<mimic joint="k"/>'), "'k', which is no joint"),
        (joined("revolute", LIMIT + '<mimic joint="j"/>'), "mimics 'j', which does not lead to it"),
        (joined("prismatic", '<limit lower="-inf" upper="inf"/>'), "no finite limits"),
        (
            joined("fixed").replace("</robot>", JOINED.format("fixed", "").replace('"j"', '"k"') + "</robot>"),
            "which joint 'j' carries already",
        ),
        (
            f"<robot>{PAIR}{ONE.replace('b', 'c')}{JOINED.format('fixed', '')}"
            '<joint name="k" type="fixed"><parent link="b"/><child link="a"/></joint></robot>',
            "form a ring",
        ),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path, text, words):
    """With what would do; nothing outside the file is looked at."""
    path = tmp_path / "arm.urdf"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as error:
        import_robot(path)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_a_mimic_follows(tmp_path):
    """A parallelogram: the third joint turns back by what the second turned, a fourth by half of that and 0.1 rad; by
    the product of matrices with their coordinates filled in."""
    lines = ['<robot name="parallel"><link name="l0"/>']
    mimics = {3: '<mimic joint="j2" multiplier="-1"/>', 4: '<mimic joint="j3" multiplier="0.5" offset="0.1"/>'}
    for number in (1, 2, 3, 4):
        weight = f'<inertial><origin xyz="0.1 0 0"/><mass value="{number}"/></inertial>'
        lines.append(f'<link name="l{number}">{weight}</link><joint name="j{number}" type="revolute">')
        lines.append(f'<origin xyz="0.3 0 0.1"/><parent link="l{number - 1}"/><child link="l{number}"/>')
        lines.append(f'<axis xyz="0 1 0"/><limit lower="-1" upper="1.2"/>{mimics.get(number, "")}</joint>')
    path = tmp_path / "parallel.urdf"
    path.write_text("".join([*lines, "</robot>"]), encoding="utf-8")
    result = import_robot(path, tip="l4")
    (tmp_path / "arm.yaml").write_text(result.to_yaml(), encoding="utf-8")
    arm = read_arm(tmp_path / "arm.yaml")
    assert [joint.driven for joint in arm.joints] == [True, True, False, False]
    draw = np.random.default_rng(4)
    for first, second in draw.uniform(-1.0, 1.2, (5, 2)):
        named = {"j1": first, "j2": second, "j3": -second, "j4": 0.1 - 0.5 * second}
        pose = tip_pose(path.read_text(encoding="utf-8"), "l0", "l4", named)
        assert tip_position(arm, [first, second, 0.0, 0.0])[0] == pytest.approx(pose[:3, 3], abs=1e-9)
    exported = export_arm(arm, "urdf")
    assert not any("follow" in item for item in exported.lost)
    assert any("follow" in item for item in export_arm(arm, "mjcf").lost)
    assert exported.text.count("<mimic ") == 2
    (tmp_path / "again.urdf").write_text(exported.text, encoding="utf-8")
    again = import_robot(tmp_path / "again.urdf").arm
    assert tip_position(again, [0.3, 0.7, 0.0, 0.0]) == pytest.approx(tip_position(arm, [0.3, 0.7, 0.0, 0.0]), abs=1e-9)


def test_where_the_fingers_part_is_proposed(tmp_path):
    """Where no end is a mere frame, the arm's tip is the link that carries the fingers."""
    fingers = "".join(
        f'<link name="{name}"><inertial><mass value="0.1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        f'</inertial></link><joint name="to {name}" type="prismatic"><parent link="hand"/><child link="{name}"/>'
        '<limit lower="0" upper="0.04" effort="1" velocity="1"/></joint>'
        for name in ("left", "right")
    )
    arm = '<joint name="turn" type="continuous"><parent link="base"/><child link="hand"/></joint>'
    path = tmp_path / "gripper.urdf"
    path.write_text(f'<robot name="r"><link name="base"/><link name="hand"/>{arm}{fingers}</robot>', encoding="utf-8")
    with pytest.raises(InputError, match="--tip hand, where they part"):
        import_robot(path)


def test_of_ends_that_the_same_joints_move_the_one_without_mass_is_taken():
    """It is a frame and no finger, and torques are the same for each; ends of other joints are asked for."""
    read = import_robot(EXAMPLE)
    assert read.tip == "tip"
    assert "With it move finger, and torques are the same for each" in read.notes[-1]
    assert read.arm == import_robot(EXAMPLE, tip="tip").arm
    with pytest.raises(InputError, match="there is no link 'tipp'; did you mean 'tip'"):
        import_robot(EXAMPLE, tip="tipp")
    with pytest.raises(InputError, match="'base' is not beyond 'slide'"):
        import_robot(EXAMPLE, tip="base", base="slide")


def test_names_cannot_write_keys(tmp_path):
    """A line break in a name stays within its comment."""
    path = tmp_path / "arm.urdf"
    named = EXAMPLE.read_text(encoding="utf-8").replace('"turn"', '"turn&#10;gravity: [9 m/s^2]"')
    path.write_text(named, encoding="utf-8")
    text = import_robot(path, tip="tip").to_yaml()
    (tmp_path / "arm.yaml").write_text(text, encoding="utf-8")
    assert read_arm(tmp_path / "arm.yaml").gravity == (0.0, 0.0, -9.81)


def test_a_joint_whose_limits_name_no_ends_turns(tmp_path):
    """Where effort and speed are all that a <limit> says: as in MJCF, not held at 0; what slides says how far."""
    path = tmp_path / "open.urdf"
    open_ = '<limit effort="9" velocity="2"/>'
    path.write_text(joined("revolute", open_), encoding="utf-8")
    (joint,) = import_robot(path).arm.joints
    assert joint.range == pytest.approx((-math.pi, math.pi))
    assert (joint.effort, joint.velocity) == (9.0, 2.0)
    path.write_text(joined("revolute", '<limit upper="1" effort="9" velocity="2"/>'), encoding="utf-8")
    assert import_robot(path).arm.joints[0].range == (0.0, 1.0)
    path.write_text(joined("prismatic", open_), encoding="utf-8")
    with pytest.raises(InputError, match="no finite limits"):
        import_robot(path)
