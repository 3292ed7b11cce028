"""What was found of a moving arm, in other programs' files: MuJoCo takes the torques of the arm's own model."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.descriptions.formats import export_arm
from linkwright.core.arm.motion.dynamics import model_torque
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import INERTIA_PAIRS, PARAMETERS, link_parameters, pseudo_inertia
from tests.arm.motion.by_mujoco import inverse
from tests.arm.motion.test_rigid import random_arm

RUBS = (
    EffectEntry("friction_coulomb", (1, 2), {"torque": 3.0}),
    EffectEntry("friction_viscous", (), {"coefficient": 1.5}),
    EffectEntry("friction_viscous", (3,), {"coefficient": 0.5}),
)
WEIGHS = (
    EffectEntry("link_inertial", (2,), {"mass": -0.4, "first_moment_x": 0.05, "inertia_yy": 0.03, "inertia_xy": 0.004}),
    EffectEntry("payload", (), {"mass": 1.2, "centre_x": 0.03, "centre_z": 0.08, "inertia_xx": 0.002}),
)
ROTORS = (
    EffectEntry("armature", (1, 3), {"inertia": 0.8}),
    EffectEntry("spring", (2,), {"stiffness": 12.0, "rest": 0.2}),
)
WITHOUT_A_WORD = (
    EffectEntry("friction_load", (2,), {"share": 0.05}),
    EffectEntry("torque_offset", (1,), {"torque": 0.3}),
)


def states(size, seed=4):
    """Joints that move: MuJoCo's dry friction, as ours, has a sharp sign, but neither at rest."""
    rng = np.random.default_rng(seed)
    velocity = rng.uniform(0.5, 2.0, (5, size)) * rng.choice([-1.0, 1.0], (5, size))
    return rng.uniform(-1, 1, (5, size)), velocity, rng.uniform(-4, 4, (5, size))


def in_mujoco(text, q, velocity, acceleration):
    return inverse(mujoco.MjModel.from_xml_string(text), q, velocity, acceleration)


def with_effects(effects, *, gravity=None):
    arm = random_arm(31, size=3, slides=False)
    return replace(arm, effects=effects, gravity=gravity or arm.gravity)


def by_model(arm, *states):
    return model_torque(Motion(arm, np.arange(5.0), *states))


@pytest.mark.parametrize("effects", [RUBS, WEIGHS, ROTORS, (*RUBS, *WEIGHS, *ROTORS)])
def test_an_mjcf_moves_as_the_corrected_arm(effects):
    arm = with_effects(effects)
    exported = export_arm(arm, "mjcf")
    np.testing.assert_allclose(in_mujoco(exported.text, *states(3)), by_model(arm, *states(3)), rtol=0, atol=1e-8)
    assert not any("effect" in item for item in exported.lost)


def test_a_urdf_moves_as_the_corrected_arm():
    arm = with_effects((*RUBS, *WEIGHS), gravity=(0.0, 0.0, -9.81))
    exported = export_arm(arm, "urdf")
    np.testing.assert_allclose(in_mujoco(exported.text, *states(3)), by_model(arm, *states(3)), rtol=0, atol=1e-8)
    assert "friction and damping of the joints" in exported.carried


def test_what_a_format_has_no_word_for_is_told():
    arm = with_effects((*RUBS, *ROTORS, *WITHOUT_A_WORD))
    lost = {form: " ".join(export_arm(arm, form).lost) for form in ("mjcf", "urdf")}
    for effect in ("friction_load", "torque_offset"):
        assert all(f"(effect {effect})" in said for said in lost.values())
    for effect in ("armature", "spring"):
        assert f"(effect {effect})" in lost["urdf"]
        assert f"(effect {effect})" not in lost["mjcf"]
    for at, unknown in (((), ""), ((2,), "no armature is known of joint1, joint3")):
        assumed = export_arm(with_effects((EffectEntry("armature", at, {"inertia": 1.0}),)), "mjcf").assumed
        assert [item for item in assumed if "armature" in item] == ([unknown] if unknown else [])


def test_weights_that_no_body_has_are_told_and_left_out():
    hollow = with_effects((EffectEntry("link_inertial", (2,), {"inertia_xx": -50.0}),))
    exported = export_arm(hollow, "mjcf")
    assert "what was found of the weight of link 2: no body has it" in exported.lost
    plain = export_arm(replace(hollow, effects=()), "mjcf").text
    assert exported.text.partition("<compiler")[2] == plain.partition("<compiler")[2]


@pytest.mark.parametrize(("short", "held"), [(-3e-7, True), (-1e-4, False)])
def test_a_link_that_rounding_keeps_from_being_a_body_is_held(short, held):
    """Fits end on the border of what bodies have. A millionth beyond is rounding, and MuJoCo takes the body near it."""
    arm = with_effects(())
    values, vectors = np.linalg.eigh(pseudo_inertia(link_parameters(arm)[1]))
    values[0] = short * values[-1]
    whole = (vectors * values) @ vectors.T
    tensor = np.trace(whole[:3, :3]) * np.eye(3) - whole[:3, :3]
    meant = np.array([whole[3, 3], *whole[:3, 3], *(tensor[pair] for pair in INERTIA_PAIRS)])
    added = dict(zip(PARAMETERS, (meant - link_parameters(arm)[1]).tolist(), strict=True))
    arm = replace(arm, effects=(EffectEntry("link_inertial", (2,), added),))
    exported = export_arm(arm, "mjcf")
    assert any("no body has it" in item for item in exported.lost) != held
    if held:
        ours = by_model(arm, *states(3))
        off = in_mujoco(exported.text, *states(3)) - ours
        assert np.abs(off).max() < 1e-4 * np.abs(ours).max()
