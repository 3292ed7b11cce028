"""MJCF files as arms, held against MuJoCo's own compiler: where tips are, what drives bear, what joints have."""

import mujoco
import numpy as np
import pytest

import linkwright as lw
from linkwright.core.arm.chain.following import completed
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics

POSES = 12

FRAMES = """
<mujoco model="frames">
  <compiler angle="degree" eulerseq="zYx"/>
  <option gravity="0.5 -1 -9.7"/>
  <default>
    <joint damping="0.2" armature="0.05"/>
    <default class="heavy"><joint frictionloss="3" damping="2" range="-90 120" axis="0 1 0"/></default>
  </default>
  <worldbody>
    <light pos="0 0 3"/>
    <body name="post" pos="0.1 0.2 0.3" quat="1 0.3 -0.2 0.1">
      <body name="turret" euler="20 -30 45" pos="0 0 0.2">
        <inertial mass="3" pos="0.02 0.01 0.1" quat="1 0.2 0.1 0" diaginertia="0.03 0.02 0.025"/>
        <joint name="turn" class="heavy" axis="0.1 0 1" pos="0.03 -0.02 0.01" ref="12"/>
        <frame pos="0.05 0 0.4" axisangle="0 1 0.2 35" childclass="heavy">
          <body name="boom" pos="0 0.02 0" xyaxes="1 0.2 0 0.1 1 0.3">
            <inertial mass="2" pos="0.3 0 0.01" fullinertia="0.02 0.05 0.06 0.001 -0.002 0.003"/>
            <joint name="lift" pos="0 0.04 0"/>
            <joint name="reach" type="slide" axis="1 0.1 0" range="-0.1 0.4" ref="0.05" armature="2" damping="30"/>
            <joint name="roll" axis="1 0 0" stiffness="4" springref="10" pos="0 0 0.02"/>
            <body name="wrist" pos="0.5 0 0" zaxis="0.2 -0.3 0.4">
              <inertial mass="0.5" pos="0 0 0.05" diaginertia="0.001 0.001 0.0008"/>
              <joint name="bend" axis="0 1 0" range="-100 100" limited="false"/>
              <body name="flange" pos="0 0 0.1" quat="0.5 0.5 -0.5 0.5">
                <inertial mass="0.2" pos="0.01 0 0" diaginertia="0.0001 0.0001 0.0001"/>
                <site name="tool" pos="0.02 0.03 0.04"/>
              </body>
            </body>
          </body>
        </frame>
      </body>
    </body>
  </worldbody>
</mujoco>"""

GEOMS = """
<mujoco model="geoms">
  <compiler angle="radian" inertiagrouprange="0 2" {compiler}/>
  <default>
    <geom density="2700"/>
    <default class="pin"><geom type="cylinder" size="0.02 0.05" pos="0 0 0.03" density="7850"/></default>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="one" pos="0 0 0.1">
      <joint name="a" axis="0 0 1"/>
      <geom size="0.05"/>
      <geom class="pin" euler="0.3 0.2 0.1"/>
      <geom type="capsule" fromto="0 0.01 0 0.3 0.1 -0.05" size="0.03"/>
      <geom type="box" size="0.3 0.3 0.3" group="3"/>
      <geom type="box" size="0.3 0.3 0.3" mass="0"/>
      <body name="two" pos="0.3 0.1 -0.05" euler="0.4 0 0.2">
        <joint name="b" axis="0 1 0"/>
        <geom type="box" fromto="0 0 0 0.2 0.05 0.1" size="0.02 0.03" mass="1.5"/>
        <geom type="ellipsoid" size="0.05 0.03 0.02" pos="0.2 0.05 0.1" zaxis="1 1 0"/>
        <geom type="capsule" size="0.02 0.1" quat="1 1 0 0"/>
        <body name="three" pos="0.2 0.05 0.1">
          <joint name="c" axis="1 0 0"/>
          <inertial mass="0.3" pos="0.1 0.02 0" diaginertia="0.001 0.0002 0.0003"/>
          <geom type="box" size="0.1 0.1 0.1" group="1"/>
          <site name="tool" pos="0.1 0 0"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>"""

# A hull with a dent: what is exact and what counts facets twice differ.
CORNERS = np.array([[0, 0, 0], [0.4, 0, 0], [0, 0.3, 0], [0.05, 0.05, 0.05], [0, 0, 0.5]])
FACETS = ((0, 2, 1), (0, 1, 4), (0, 4, 2), (1, 2, 3), (1, 3, 4), (2, 4, 3))


def write(tmp_path, text, name="arm.xml"):
    path = tmp_path / name
    path.write_text(text)
    return path


def beside_mujoco(path, tip=None):
    """The import, and the greatest differences of its tip (m) and of its rigid torques (N*m, N) from MuJoCo's."""
    result = import_robot(path, tip=tip)
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    for what in (model.dof_armature, model.dof_damping, model.jnt_stiffness):
        what[:] = 0.0
    data = mujoco.MjData(model)
    rng = np.random.default_rng(4)
    q, v, a = (rng.uniform(-1.5, 1.5, (POSES, result.arm.size)) for _ in range(3))
    q = completed(result.arm, q)
    torques = inverse_dynamics(Motion(result.arm, np.zeros(POSES), q, v, a))
    tips = tip_position(result.arm, q)
    joints = [model.joint(name) for name in result.joint_names]
    is_site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, result.tip) < 0
    away = loaded = 0.0
    for k in range(POSES):
        for number, joint in enumerate(joints):
            data.qpos[joint.qposadr], data.qvel[joint.dofadr], data.qacc[joint.dofadr] = (
                q[k, number],
                v[k, number],
                a[k, number],
            )
        mujoco.mj_inverse(model, data)
        place = data.site(result.tip).xpos if is_site else data.body(result.tip).xpos
        away = max(away, np.abs(place - tips[k]).max())
        bears = np.array([data.qfrc_inverse[joint.dofadr[0]] for joint in joints])
        loaded = max(loaded, np.abs(bears - torques[k]).max())
    return result, away, loaded


def test_frames_joints_and_inertials(tmp_path):
    result, away, loaded = beside_mujoco(write(tmp_path, FRAMES))
    assert result.joint_names == ("turn", "lift", "reach", "roll", "bend")
    assert result.tip == "tool"
    assert away < 1e-12
    assert loaded < 1e-9


def test_what_joints_have_of_their_own(tmp_path):
    path = write(tmp_path, FRAMES)
    arm = import_robot(path).arm
    model = mujoco.MjModel.from_xml_path(str(path))
    said = {(e.effect, e.at[0], name): value for e in arm.effects for name, value in e.parameters.items()}
    for number, name in enumerate(("turn", "lift", "reach", "roll", "bend"), start=1):
        dof, joint = model.joint(name).dofadr[0], model.joint(name).id
        assert said["friction_viscous", number, "coefficient"] == model.dof_damping[dof]
        assert said["armature", number, "inertia"] == model.dof_armature[dof]
        assert said.get(("friction_coulomb", number, "torque"), 0.0) == model.dof_frictionloss[dof]
        assert said.get(("spring", number, "stiffness"), 0.0) == model.jnt_stiffness[joint]
        if model.jnt_limited[joint]:
            assert arm.joints[number - 1].range == pytest.approx(tuple(model.jnt_range[joint]))
    assert said["spring", 4, "rest"] == pytest.approx(model.qpos_spring[model.joint("roll").qposadr[0]])
    assert arm.joints[4].range == pytest.approx((np.radians(-100.0), np.radians(100.0)))
    assert arm.gravity == (0.5, -1.0, -9.7)


@pytest.mark.parametrize(
    "compiler",
    [
        "",
        'inertiafromgeom="true"',
        'balanceinertia="true"',
        'boundmass="2" boundinertia="0.01"',
        'settotalmass="12.5"',
    ],
)
def test_bodies_weigh_what_the_compiler_makes_of_their_geoms(tmp_path, compiler):
    if "balance" not in compiler:
        compiler += ' balanceinertia="true"'  # no body has the tensor of the third
    _, away, loaded = beside_mujoco(write(tmp_path, GEOMS.format(compiler=compiler)))
    assert away < 1e-12
    assert loaded < 1e-9


@pytest.mark.parametrize("inertia", ["legacy", "exact"])
def test_meshes_weigh_as_they_are_told_to(tmp_path, inertia):
    facets = "".join(
        "facet normal 0 0 0 outer loop "
        + " ".join(f"vertex {x} {y} {z}" for x, y, z in CORNERS[list(facet)])
        + " endloop endfacet\n"
        for facet in FACETS
    )
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "dent.stl").write_text(f"solid dent\n{facets}endsolid dent\n")
    triangles = CORNERS[np.array(FACETS)].astype("<f4")
    records = np.zeros(len(triangles), dtype=[("n", "<f4", 3), ("c", "<f4", (3, 3)), ("rest", "<u2")])
    records["c"] = triangles
    (tmp_path / "meshes" / "dent.stl").write_bytes(
        b"\0" * 80 + len(triangles).to_bytes(4, "little") + records.tobytes()
    )
    text = f"""
    <mujoco><compiler meshdir="meshes"/>
      <asset><mesh file="dent.stl" scale="1 0.8 0.7" inertia="{inertia}"/></asset>
      <worldbody><body name="link"><joint name="a" axis="0 1 0"/><joint name="b" axis="1 0 0.2"/>
        <geom type="mesh" mesh="dent" pos="0.1 0.2 0.3" quat="1 0.3 0.2 0.1"/>
      </body></worldbody></mujoco>"""
    result, _, loaded = beside_mujoco(write(tmp_path, text))
    # MuJoCo holds a mesh's corners in single precision.
    assert loaded < 1e-5 * 9.81 * result.arm.links[1].masses[0].mass


def test_a_mesh_that_is_not_there_leaves_the_mass_unknown(tmp_path):
    text = """
    <mujoco><asset><mesh file="gone.stl"/></asset><worldbody><body name="link"><joint name="a"/>
      <geom type="mesh" mesh="gone"/><geom size="0.1"/><site name="tip" pos="0.3 0 0"/></body></worldbody></mujoco>"""
    result = import_robot(write(tmp_path, text))
    assert result.arm.links[0].mass is None
    assert [item.at for item in result.lacking if item.what == "mass of links"] == [(1,)]
    (said,) = result.unread
    assert said in result.notes
    assert "gone.stl" in said
    assert "The weight of link is unknown; write <inertial pos=" in said


def test_the_mass_that_a_geom_gives_to_a_mesh_that_is_not_there_counts(tmp_path):
    """At the middle of its link, beside what is known of where it is; where all is guessed, as a slender rod."""
    text = """
    <mujoco><asset><mesh file="gone.stl"/></asset><worldbody><body name="link"><joint name="a" axis="0 1 0"/>
      <geom type="mesh" mesh="gone" mass="1.5"/>{}<site name="tip" pos="0.3 0 0"/></body></worldbody></mujoco>"""
    alone = import_robot(write(tmp_path, text.format("")))
    (link,) = alone.arm.links
    assert (link.mass, link.center_of_mass, link.inertia) == (1.5, 0.15, None)
    (said,) = alone.unread
    assert "gone.stl" in said
    assert "is 1.5 kg as the file has it, and counts at the middle of link 1; write <inertial pos=" in said
    assert not [item for item in alone.lacking if item.what == "mass of links"]
    assert [item.at for item in alone.lacking if item.what == "inertia of links"] == [(1,)]
    beside = import_robot(write(tmp_path, text.format('<geom size="0.05" pos="0 0 0.2" mass="0.5"/>'))).arm
    still = np.zeros((1, 1))
    torque = inverse_dynamics(Motion(beside, np.zeros(1), still, still, still))
    assert float(torque[0, 0]) == pytest.approx(-9.81 * 1.5 * 0.15)
    shared = text.replace("<asset>", '<compiler settotalmass="6"/><asset>')
    assert import_robot(write(tmp_path, shared.format(""))).arm.links[0].mass == pytest.approx(6.0)


def test_included_files_and_ties(tmp_path):
    write(
        tmp_path,
        """<mujocoinclude><body name="finger" pos="0 0 0.2"><inertial mass="0.1" pos="0 0 0.01" diaginertia="1e-5 1e-5
        1e-5"/><joint name="b" axis="0 1 0" ref="0.1"/><site name="tip" pos="0 0 0.1"/></body></mujocoinclude>""",
        "finger.xml",
    )
    text = """
    <mujoco><compiler angle="radian"/><worldbody><body name="hand">
      <inertial mass="1" pos="0 0 0.1" diaginertia="0.01 0.01 0.01"/><joint name="a" axis="0 1 0" ref="0.3"/>
      <include file="finger.xml"/></body></worldbody>
      <equality><joint joint1="b" joint2="a" polycoef="0.2 -0.5 0 0 0"/></equality></mujoco>"""
    result, away, _ = beside_mujoco(write(tmp_path, text))
    assert away < 1e-12
    tie = result.arm.joints[1].follows
    # MuJoCo: b - 0.1 = 0.2 - 0.5 (a - 0.3).
    assert tie.ties[0].weight == -0.5
    assert tie.constant == pytest.approx(0.1 + 0.2 + 0.5 * 0.3)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<mujoco><worldbody/></mujoco>", "no joint beyond 'world' moves"),
        ('<mujoco><worldbody><body><joint type="cog"/></body></worldbody></mujoco>', "type 'cog' is none of hinge"),
        ("<mujoco><worldbody><body><freejoint/></body></worldbody></mujoco>", "no joint beyond 'world' moves"),
        ('<mujoco><worldbody><body><joint axis="0 0"/></body></worldbody></mujoco>', "3 numbers are due"),
        ('<mujoco><include file="../other.xml"/></mujoco>', "outside its folder"),
        ('<mujoco><worldbody><replicate count="3"/></worldbody></mujoco>', "makes bodies that are not written here"),
        ('<mujoco><compiler eulerseq="xy"/><worldbody/></mujoco>', "eulerseq is 'xy'"),
        ('<mujoco><compiler boundmass="x"/><worldbody><body/></worldbody></mujoco>', "has 'x' where a number is due"),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path, text, said):
    with pytest.raises(lw.InputError, match=r"arm\.xml") as raised:
        lw.read_arm(write(tmp_path, text))
    assert said in str(raised.value)
    assert "\n" not in str(raised.value)


def test_what_is_exported_is_read_again(tmp_path):
    arm = lw.read_arm("examples/urdf/tabletop.urdf", tip="tip")
    text = lw.export_arm(arm, to="mjcf").text
    back = lw.read_arm(write(tmp_path, text), tip="tip")
    q = np.random.default_rng(2).uniform(-1.0, 1.0, (POSES, 3))
    motion = [Motion(item.model, np.zeros(POSES), q, q[:, ::-1], -q) for item in (arm, back)]
    np.testing.assert_allclose(*(tip_position(item.model, q) for item in (arm, back)), atol=1e-12)
    np.testing.assert_allclose(*map(inverse_dynamics, motion), atol=1e-7)
