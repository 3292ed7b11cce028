"""Weights of a URDF: unknown where it says none, tensors and names there and back, and what MuJoCo loads."""

import xml.etree.ElementTree as ElementTree

import mujoco
import numpy as np
import pytest

from linkwright.core.arm.bodies.beams import PropertyNeeded
from linkwright.core.arm.descriptions.formats import export_arm
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.files.read import read_arm
from tests.arm.descriptions.urdf_chain import in_mujoco, posed, tip_pose

TWO = """<?xml version="1.0"?>
<robot name="two">
  <link name="pedestal"><inertial><mass value="20"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="upper"><inertial><origin xyz="0.2 0.03 -0.02" rpy="0.3 -0.2 0.9"/><mass value="3"/>
    <inertia ixx="0.021" ixy="0.001" ixz="0" iyy="0.075" iyz="0" izz="0.081"/></inertial></link>
  <link name="fore"><inertial><origin xyz="0.15 0 0.04"/><mass value="2"/>
    <inertia ixx="0.011" ixy="0" ixz="-0.002" iyy="0.031" iyz="0" izz="0.028"/></inertial></link>
  <link name="flange"><inertial><origin xyz="0 0.01 0.02"/><mass value="0.4"/>
    <inertia ixx="2e-4" ixy="1e-5" ixz="0" iyy="3e-4" iyz="0" izz="4e-4"/></inertial></link>
  <link name="tip"/>
  <joint name="j1" type="revolute"><parent link="pedestal"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="50" velocity="3"/></joint>
  <joint name="j2" type="prismatic"><parent link="upper"/><child link="fore"/><origin xyz="0.5 0 0" rpy="0.2 0 0"/>
    <axis xyz="0 0.6 0.8"/><limit lower="-0.1" upper="0.3" effort="300" velocity="0.7"/>
    <dynamics friction="4" damping="1.5"/></joint>
  <joint name="jf" type="fixed"><parent link="fore"/><child link="flange"/><origin xyz="0.3 0 0" rpy="0 0.4 0"/></joint>
  <joint name="jt" type="fixed"><parent link="flange"/><child link="tip"/><origin xyz="0.1 0 0"/></joint>
  <transmission name="t1"/>
</robot>"""


def imported(text, folder, **named):
    """The import of a URDF's text, and the arm as its arm file reads back."""
    path = folder / "robot.urdf"
    path.write_text(text, encoding="utf-8")
    result = import_robot(path, **named)
    (folder / "arm.yaml").write_text(result.to_yaml(), encoding="utf-8")
    return result, read_arm(folder / "arm.yaml")


def mass_matrix(model, coordinates):
    """Of MuJoCo at joint coordinates by name, with the torques of gravity and of speeds of 1, in the order of names."""
    data = posed(model, coordinates)
    full = np.zeros((model.nv, model.nv))
    for column, unit in zip(full, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, column, unit)
    order = [int(model.joint(name).dofadr[0]) for name in coordinates]
    data.qvel[:] = 1.0
    mujoco.mj_forward(model, data)
    return full[np.ix_(order, order)], data.qfrc_bias[order]


def same_dynamics(before, after, names, seed=1):
    """Mass matrices and bias torques of two URDFs by MuJoCo agree to 1e-9 of the greatest."""
    one, other = in_mujoco(before), in_mujoco(after)
    draw = np.random.default_rng(seed)
    for _ in range(3):
        at = dict(zip(names, draw.uniform(-1.0, 1.0, len(names)), strict=True))
        for a, b in zip(mass_matrix(one, at), mass_matrix(other, at), strict=True):
            assert b == pytest.approx(a, abs=1e-9 * max(1e-3, float(np.abs(a).max())))


def test_tensors_efforts_speeds_and_names_come_out_as_they_went_in(tmp_path):
    """Through the arm file: the flange is one body with the forearm, so their tensors are put together."""
    result, arm = imported(TWO, tmp_path)
    out = export_arm(arm, "urdf")
    root = ElementTree.fromstring(out.text)
    assert [link.get("name") for link in root.findall("link")] == ["base", "upper", "fore", "tip"]
    limits = {j.get("name"): j.find("limit").attrib for j in root.findall("joint") if j.find("limit") is not None}
    for name, effort, velocity in (("j1", 50.0, 3.0), ("j2", 300.0, 0.7)):
        assert float(limits[name]["effort"]) == pytest.approx(effort, rel=1e-12)
        assert float(limits[name]["velocity"]) == pytest.approx(velocity, rel=1e-12)
    same_dynamics(TWO, out.text, ["j1", "j2"])
    assert not any("steel balls" in item or "slender rods" in item for item in out.assumed)
    told = export_arm(arm, "mjcf")
    assert any(
        "joint 1: 50 N*m" in item and "joint 2: 0.7 m/s" in item.replace("700 mm/s", "0.7 m/s") for item in told.lost
    )
    model = mujoco.MjModel.from_xml_string(told.text)
    assert [model.joint(k).name for k in range(2)] == ["j1", "j2"]
    text = " ".join(result.lost)
    for words in ("pedestal: 20 kg", "flange", "transmission"):
        assert words in text
    held = {effect.effect: (effect.at, dict(effect.parameters)) for effect in arm.effects}
    assert held == {"friction_coulomb": ((2,), {"torque": 4.0}), "friction_viscous": ((2,), {"coefficient": 1.5})}
    dynamics = next(item for item in root.findall("joint") if item.get("name") == "j2").find("dynamics")
    assert {name: float(value) for name, value in dynamics.attrib.items()} == {"friction": 4.0, "damping": 1.5}


@pytest.mark.parametrize("seed", range(6))
def test_any_tensors_through_the_arm_file(tmp_path, seed):
    """Those of bodies made of points, their products among them, some bolted to another; by MuJoCo's mass matrices."""
    draw = np.random.default_rng(seed)
    bodies = [(draw.uniform(-1.0, 1.0, (5, 3)), draw.random() < 0.5) for _ in range(draw.integers(1, 5))]
    lines = ['<robot name="row"><link name="l0"/>']
    for number, (points, bolted) in enumerate(bodies, start=1):
        spread = points - points.mean(axis=0)
        own = (spread**2).sum() * np.eye(3) - spread.T @ spread + 1e-3 * np.eye(3)
        moments = " ".join(
            f'{name}="{own[at]!r}"'.replace("np.float64(", "").replace(")", "")
            for name, at in (
                ("ixx", (0, 0)),
                ("ixy", (0, 1)),
                ("ixz", (0, 2)),
                ("iyy", (1, 1)),
                ("iyz", (1, 2)),
                ("izz", (2, 2)),
            )
        )
        place = " ".join(repr(float(point)) for point in points[0])
        body = f'<inertial><origin xyz="{place}" rpy="{place}"/><mass value="{number}"/><inertia {moments}/></inertial>'
        limit = '<limit lower="-1" upper="1" effort="5" velocity="2"/>'
        lines.append(f'<link name="l{number}">{body}</link><joint name="j{number}" type="revolute">')
        lines.append(f'<origin xyz="0.3 0.1 0" rpy="1 0.2 0"/><axis xyz="0 0.6 0.8"/>{limit}')
        lines.append(f'<parent link="l{number - 1}"/><child link="l{number}"/></joint>')
        if bolted:
            lines.append(f'<link name="b{number}">{body}</link><joint name="f{number}" type="fixed">')
            lines.append(
                f'<origin xyz="0 0.2 0" rpy="0 0 1"/><parent link="l{number}"/><child link="b{number}"/></joint>'
            )
    text = "".join([*lines, "</robot>"])
    _, arm = imported(text, tmp_path, tip=f"l{len(bodies)}")
    same_dynamics(text, export_arm(arm, "urdf").text, [f"j{number}" for number in range(1, len(bodies) + 1)])


def chain(*links, drawn=()):
    """A URDF of links in a row, each with what stands in it; those `drawn` (from 1) by a box."""
    lines = ['<robot name="row"><link name="l0"/>']
    for number, inside in enumerate(links, start=1):
        box = '<visual><geometry><box size="0.1 0.1 0.3"/></geometry></visual>' if number in drawn else ""
        lines.append(f'<link name="l{number}">{inside}{box}</link><joint name="j{number}" type="revolute">')
        lines.append('<origin xyz="0 0 0.3"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="0" velocity="0"/>')
        lines.append(f'<parent link="l{number - 1}"/><child link="l{number}"/></joint>')
    return "".join([*lines, "</robot>"])


def weighs(kilograms, tensor='ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"'):
    """An inertial."""
    return f'<inertial><mass value="{kilograms}"/><inertia {tensor}/></inertial>'


@pytest.mark.parametrize(
    ("text", "masses"),
    [
        (chain("", "", ""), [None, None, None]),
        (chain("", "", "", drawn=(1, 2, 3)), [None, None, None]),
        (chain("", weighs(0), ""), [None, None, None]),
        (chain(weighs(3), "", weighs(1)), [3.0, None, 1.0]),
        (chain(weighs(3), "", weighs(1), drawn=(1, 3)), [3.0, 0.0, 1.0]),  # link 2 is a mere frame
        (chain(weighs(3), "", weighs(1), drawn=(1, 2)), [3.0, None, 1.0]),
        (chain("", "", "", drawn=(1, 3)), [None, None, None]),
    ],
)
def test_what_a_file_does_not_weigh_is_unknown(tmp_path, text, masses):
    """A link that is drawn by nothing, while others are drawn and weighed, is a frame between two joints."""
    result, arm = imported(text, tmp_path)
    known = [None if link.mass is None else link.mass + sum(mass.mass for mass in link.masses) for link in arm.links]
    assert known == masses
    lacking = [item.at for item in result.lacking if item.what == "mass of links"]
    unknown = tuple(number for number, mass in enumerate(masses, start=1) if mass is None)
    assert lacking == [unknown] * bool(unknown)


def test_what_is_unknown_is_left_out_or_asked_for(tmp_path):
    """A URDF goes without, as it came; a simulator's own format needs the mass, and says of which link."""
    _, arm = imported(chain(weighs(3), ""), tmp_path)
    out = export_arm(arm, "urdf")
    links = {link.get("name"): link for link in ElementTree.fromstring(out.text).findall("link")}
    assert links["l1"].find("inertial") is not None
    assert links["l2"].find("inertial") is None
    assert any("link 2" in item and "unknown mass" in item for item in out.lost)
    with pytest.raises(PropertyNeeded, match=r"chain\[2\].link.mass: the mass of link 2, l2, is unknown"):
        export_arm(arm, "mjcf")


@pytest.mark.parametrize(
    ("links", "words"),
    [
        (("", ""), "weighs nothing"),
        (
            (weighs(2), weighs(1, 'ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"')),
            "weighs nothing, or has no inertia",
        ),
        ((weighs(2), weighs(1, 'ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.5"')), "more than the others"),
        ((weighs(2), weighs(1, 'ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.3"')), "more than the others"),
        ((weighs(2), weighs(1)), None),
    ],
)
def test_exports_load_in_mujoco(tmp_path, links, words):
    """Whatever the weights; what MuJoCo is told to do about them is said, and nothing is where all is well."""
    text = chain(*links)
    _, arm = imported(text, tmp_path)
    out = export_arm(arm, "urdf")
    model = mujoco.MjModel.from_xml_string(out.text)
    assert ("<mujoco>" in out.text) == (words is not None)
    assert any(words in item for item in out.assumed) if words else not any("MuJoCo" in item for item in out.assumed)
    here = mujoco.MjData(model)
    here.qpos[:] = [0.3, -0.4]
    mujoco.mj_forward(model, here)
    assert here.body("l2").xpos == pytest.approx(tip_pose(text, "l0", "l2", {"j1": 0.3, "j2": -0.4})[:3, 3], abs=1e-9)


def test_a_negative_moment_is_not_carried(tmp_path):
    """0.1 - 0.2 kg*m^2: MuJoCo takes no such tensor, whatever it is told; a rod's stands there, and it is said."""
    impossible = weighs(1, 'ixx="0.1" ixy="0.2" ixz="0" iyy="0.1" iyz="0" izz="0.1"')
    _, arm = imported(chain(weighs(2), impossible), tmp_path)
    for to in ("urdf", "mjcf"):
        out = export_arm(arm, to)
        assert any("inertia of link 2" in item and "-0.1 kg*m^2" in item for item in out.lost)
        mujoco.MjModel.from_xml_string(out.text)


def test_names_that_cannot_stand_are_told(tmp_path):
    """`world` is MuJoCo's own; base, tip and tool give way to links and joints of those names."""
    text = chain(weighs(3), weighs(2)).replace('"l1"', '"world"').replace('"l2"', '"tip"').replace('"j1"', '"tool"')
    _, arm = imported(text, tmp_path)
    assert (arm.links[0].name, arm.links[1].name, arm.joints[0].name) == ("world", "tip", "tool")
    for to in ("urdf", "mjcf"):
        out = export_arm(arm, to)
        assert any("link 1" in item and "simulators keep" in item for item in out.lost)
        model = mujoco.MjModel.from_xml_string(out.text)
        assert model.joint("tool").id == 0
        assert model.body("tip").id > 0


def test_friction_of_two_armed_robots_is_numbered_through(tmp_path):
    """The torso's once, each arm's at its own joints; what mimics has no drive that could rub."""
    lines = ['<robot name="two"><link name="base"/><link name="torso"/>']
    rows = (
        ("waist", "base", "torso", 2.0, 0.0, ""),
        ("left1", "torso", "l1", 3.0, 0.5, ""),
        ("left2", "l1", "l2", 0.0, 0.5, ""),
        ("right1", "torso", "r1", 3.0, 0.0, ""),
        ("right2", "r1", "r2", 7.0, 0.0, '<mimic joint="right1"/>'),
    )
    lines += [f'<link name="{name}"/>' for name in ("l1", "l2", "r1", "r2")]
    lines += [
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0.3 0 0"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/>{more}'
        f'<dynamics friction="{friction}" damping="{damping}"/></joint>'
        for name, parent, child, friction, damping, more in rows
    ]
    result, arm = imported("\n".join([*lines, "</robot>"]), tmp_path, tip=["l2", "r2"])
    held = [(effect.effect, effect.at, *effect.parameters.values()) for effect in arm.effects]
    assert held == [
        ("friction_coulomb", (1,), 2.0),
        ("friction_coulomb", (2,), 3.0),
        ("friction_viscous", (2,), 0.5),
        ("friction_viscous", (3,), 0.5),
        ("friction_coulomb", (4,), 3.0),
    ]
    assert any("friction (joint 3: 7" in item for item in result.lost)
