"""Arms for other programs: read back alike, and MuJoCo sags as first order says."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.chain.kinematics import place, tip_position
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.descriptions.formats import HELD, export_arm
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.tip import active_effects, tip_error
from linkwright.core.arm.files.read import arm_from, read_arm
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping, parse_yaml

WELDING = Path(__file__).resolve().parents[3] / "examples" / "welding-arm" / "arm.yaml"

SPATIAL = """\
name: bench -- with a "name"
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {range: [-180 deg, 180 deg], stiffness: 60 kN*m/rad, mass: 6 kg}
    dh: {d: 300 mm, alpha: 90 deg}
    link: {rigid: true, mass: 10 kg}
  - joint: {range: [-90 deg, 90 deg], stiffness: 40 kN*m/rad, mass: 5 kg, zero: 10 deg, backlash: 1 arcmin}
    dh: {a: 500 mm}
    link: {section: {shape: rectangular_tube, width: 60 mm, height: 80 mm, thickness: 3 mm},
           material: aluminium-6061-t6, masses: [{mass: 3 kg, at: [-100 mm, 20 mm, 0 mm]}]}
  - joint: {range: [-90 deg, 90 deg], stiffness: 20 kN*m/rad, mass: 3 kg}
    dh: {a: 50 mm, alpha: 90 deg}
    link: {rigid: true, mass: 2 kg}
  - joint: {range: [-90 deg, 90 deg], stiffness: 10 kN*m/rad, mass: 1 kg}
    dh: {d: 400 mm, alpha: -90 deg}
    link: {section: {shape: tube, diameter: 60 mm, thickness: 3 mm}, material: steel-s355}
  - joint: {type: prismatic, range: [0 mm, 200 mm], stiffness: 5 MN/m, mass: 2 kg, zero: 20 mm}
    link: {length: 100 mm, section: {shape: circle, diameter: 30 mm}, material: steel-s355}
tool: {xyz: [0 mm, 50 mm, 20 mm]}
payload: {mass: 5 kg}
"""


@pytest.fixture(scope="module")
def spatial():
    """Turns and a slide, elastic and rigid links, masses everywhere."""
    content = parse_yaml(SPATIAL, file="arm.yaml")
    return arm_from(Mapping(content, file="arm.yaml"), load_catalogue())


def poses(arm, count, seed=3):
    """Within the joint ranges."""
    draw = np.random.default_rng(seed)
    return [np.array([draw.uniform(*joint.range) for joint in arm.joints]) for _ in range(count)]


def torques(arm, q):
    """Of gravity about the joints."""
    return [float(joint.drive_load) for joint in solve(arm, list(q), beams_of(arm)).joints]


@pytest.mark.parametrize("turned", [(0.0, 0.0, -9.81), (0.0, -9.81, 0.0), (0.0, 0.0, 9.81), (3.0, 4.0, -8.439)])
def test_a_urdf_reads_back_the_same(spatial, tmp_path, turned):
    """Whichever way gravity pulls; the payload comes back as weight of the last link."""
    arm = replace(spatial, gravity=turned)
    (tmp_path / "arm.urdf").write_text(export_arm(arm, "urdf").text, encoding="utf-8")
    again = import_robot(tmp_path / "arm.urdf", base="base", tip="tip").arm
    for q in poses(arm, 5):
        assert tip_position(again, q)[0] == pytest.approx(tip_position(arm, q)[0], abs=1e-9)
        assert np.array(place(again, q).orientation, float) == pytest.approx(
            np.array(place(arm, q).orientation, float), abs=1e-9
        )
        scale = np.linalg.norm(turned) / 9.81  # a URDF has no gravity of its own
        assert [scale * torque for torque in torques(again, q)] == pytest.approx(torques(arm, q), rel=1e-9, abs=1e-9)


def at_rest(model, arm, q):
    """MuJoCo with q asked of its drives: nominal, and where all springs and servos balance the weight."""
    data = mujoco.MjData(model)
    drives = [int(model.joint(f"joint{number + 1}").qposadr[0]) for number in range(arm.size)]
    stiffness = model.jnt_stiffness.copy()
    stiffness[drives] = model.actuator_gainprm[:, 0]
    data.qpos[drives] = data.ctrl[:] = q
    mujoco.mj_forward(model, data)
    nominal, bias = data.site("tip").xpos.copy(), data.qfrc_bias[drives].copy()
    for _ in range(60):
        rest = data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias
        data.qpos += rest / stiffness
        mujoco.mj_forward(model, data)
    assert np.abs(rest / stiffness).max() < 1e-12
    return nominal, data.site("tip").xpos.copy() - nominal, bias


def compared(arm, count):
    """The greatest difference between MuJoCo's sag and that to first order, over the sag; kinematics and torques on
    the way."""
    model = mujoco.MjModel.from_xml_string(export_arm(arm, "mjcf").text)
    worst = 0.0
    for q in poses(arm, count):
        nominal, sag, bias = at_rest(model, arm, q)
        assert nominal == pytest.approx(tip_position(arm, q)[0], abs=1e-9)
        assert list(-bias) == pytest.approx(torques(arm, q), rel=1e-9, abs=1e-9)
        vector = tip_error(solve(arm, list(q), beams_of(arm)), active_effects(arm)).vector
        expected = np.array([float(component) for component in vector])
        worst = max(worst, np.linalg.norm(sag - expected) / np.linalg.norm(expected))
    return worst


def test_mujoco_sags_as_first_order_says(spatial):
    """A sag of s on an arm of length L differs from first order by some s/L: 5 mm on 1 m. Under a hundredth of the
    weight the difference must be a hundredth, or it would not be of second order."""
    light = replace(spatial, gravity=(0.0, 0.0, -0.0981))
    heavy_by, light_by = compared(spatial, 4), compared(light, 4)
    assert heavy_by < 0.02
    assert light_by < 0.02 * heavy_by


def test_mujoco_and_the_welding_arm():
    """Rigid drives, 0.15 mm on 1.2 m: 1e-4, and what rigid drives give in MuJoCo."""
    arm = read_arm(WELDING)
    assert compared(arm, 4) < 1e-3
    assert HELD < 1e-6 * 0.15e-3 / 0.1


def test_a_simulation_settles(spatial):
    """At the figures that the file proposes, within three seconds."""
    model = mujoco.MjModel.from_xml_string(export_arm(spatial, "mjcf").text)
    q = poses(spatial, 1)[0]
    _, sag, _ = at_rest(model, spatial, q)
    data = mujoco.MjData(model)
    drives = [int(model.joint(f"joint{number + 1}").qposadr[0]) for number in range(spatial.size)]
    data.qpos[drives] = data.ctrl[:] = q
    mujoco.mj_forward(model, data)
    nominal = data.site("tip").xpos.copy()
    for _ in range(6000):
        mujoco.mj_step(model, data)
    assert data.site("tip").xpos - nominal == pytest.approx(sag, abs=0.02 * np.linalg.norm(sag))


def test_what_was_found_is_carried_and_the_rest_told(spatial):
    """A softer drive, a turned zero and a longer link are in the file; friction and play are listed in it."""
    result = replace(
        spatial,
        effects=(
            EffectEntry("joint_compliance", (2,), {"compliance": 1e-5}),
            EffectEntry("encoder_offset", (1,), {"offset": 0.01}),
            EffectEntry("link_length", (2,), {"length": 0.002}),
            EffectEntry("backlash", (3,), {"total": 1e-3}),
        ),
    )
    exported = export_arm(result, "mjcf")
    model = mujoco.MjModel.from_xml_string(exported.text)
    assert model.actuator("drive2").gainprm[0] == pytest.approx(1.0 / (1.0 / 40e3 + 1e-5))
    truth = replace(
        spatial,
        joints=(replace(spatial.joints[0], zero=spatial.joints[0].zero + 0.01), *spatial.joints[1:]),
        links=(spatial.links[0], replace(spatial.links[1], length=0.502), *spatial.links[2:]),
    )
    q = poses(spatial, 1)[0]
    assert at_rest(model, result, q)[0] == pytest.approx(tip_position(truth, q)[0], abs=1e-9)
    for words in ("backlash (joint 2)", "(effect backlash)"):
        assert any(words in item for item in exported.lost)
        assert words in exported.text
    told = export_arm(result, "urdf")
    assert "stiffness of the drives (joint 1, 2, 3, 4, 5)" in told.lost
    assert "joint 2: stiffness of the drive 28.5714 kN*m/rad" in told.text
    with pytest.raises(InputError, match="angles: are absolute"):
        export_arm(replace(spatial, angles="absolute"), "mjcf")
    with pytest.raises(InputError, match="'dxf' is no format; write urdf or mjcf"):
        export_arm(spatial, "dxf")
