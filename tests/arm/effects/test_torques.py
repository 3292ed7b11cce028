"""What effects take of the drives of a moving arm: by their formulas, and by mechanics that does not know them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from linkwright.core.arm.chain.balance import IdealCounterbalance
from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.chain.following import Following, Tie
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.arm.motion.dynamics import drive_power, model_torque
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics, regressor
from tests.arm.builders import arm_of, rod_lines
from tests.arm.motion.test_rigid import random_arm


def swinging(arm, seed=1, instants=200, seconds=4.0):
    rng = np.random.default_rng(seed)
    time = np.linspace(0.0, seconds, instants)
    rate, start, wide = (rng.uniform(*ends, arm.size) for ends in ((1.5, 4.0), (-2.0, 2.0), (0.2, 0.8)))
    phase = np.outer(time, rate) + start
    q = wide * np.sin(phase)
    return Motion(arm, time, q, wide * rate * np.cos(phase), -(rate**2) * q)


ARM = random_arm(21, size=3, slides=False)
MOTION = swinging(ARM)
Q, V, A, T = MOTION.q[:, 1], MOTION.velocity[:, 1], MOTION.acceleration[:, 1], MOTION.time
SIGN = np.tanh(V / 0.01)
LOAD = inverse_dynamics(MOTION)


def of(effect, motion=MOTION, at=(1,), **values):
    return EFFECTS[effect].torques(motion, Settings(at, values))


@pytest.mark.parametrize(
    ("effect", "values", "expected"),
    [
        ("friction_coulomb", {"torque": 3.0}, 3.0 * SIGN),
        ("friction_viscous", {"coefficient": 3.0}, 3.0 * V),
        ("friction_stribeck", {"torque": 2.0, "speed": 0.3}, 2.0 * SIGN * np.exp(-np.abs(V) / 0.3)),
        ("friction_load", {"share": 0.1}, 0.1 * np.abs(LOAD[:, 1]) * SIGN),
        (
            "friction_load_stribeck",
            {"share": 0.1, "speed": 0.3},
            0.1 * np.abs(LOAD[:, 1]) * SIGN * np.exp(-np.abs(V) / 0.3),
        ),
        ("friction_asymmetry", {"torque": 2.0}, 1.0 + SIGN),
        ("friction_warmup", {"torque": -2.0, "time": 5.0}, -2.0 * SIGN * (1.0 - np.exp(-T / 5.0))),
        ("friction_quadratic", {"coefficient": -2.0}, -2.0 * V * np.abs(V)),
        ("friction_place", {"sine": 1.0, "cosine": 2.0}, SIGN * (np.sin(Q) + 2.0 * np.cos(Q))),
        ("armature", {"inertia": 1.5}, 1.5 * A),
        ("torque_constant", {"excess": 0.1}, 0.1 * LOAD[:, 1]),
        ("torque_offset", {"torque": 0.4}, np.full(200, 0.4)),
        ("gear_ripple", {"order": 202, "sine": 1.0, "cosine": -0.5}, np.sin(202 * Q) - 0.5 * np.cos(202 * Q)),
        ("spring", {"stiffness": 12.0, "rest": 0.1}, 12.0 * (Q - 0.1)),
        (
            "torque_curve",
            {f"torque_{angle}": float(np.sin(np.radians(angle))) for angle in range(0, 360, 5)},
            np.interp(np.degrees(Q), np.arange(-180.0, 181.0, 5.0), np.sin(np.radians(np.arange(-180.0, 181.0, 5.0)))),
        ),
    ],
)
def test_what_goes_by_one_joint_is_its_formula_and_acts_there_alone(effect, values, expected):
    result = of(effect, **values)
    assert set(result) == {1}
    np.testing.assert_allclose(result[1], expected, rtol=1e-12, atol=1e-12)
    assert set(of(effect, at=(), **values)) == {0, 1, 2}


def test_a_gears_drive_gives_what_its_efficiency_takes_each_way():
    """Power in times the efficiency is power out: 85 % where the drive lifts, 70 % where the load does the work."""
    losses = {"forward": 1.0 / 0.85 - 1.0, "backward": 1.0 - 0.7}
    drive = LOAD[:, 1] + of("gear_efficiency", **losses)[1]
    lifts, sure = LOAD[:, 1] * V > 0.0, np.abs(V) > 0.1
    np.testing.assert_allclose((drive * V * 0.85)[lifts & sure], (LOAD[:, 1] * V)[lifts & sure], rtol=1e-7)
    np.testing.assert_allclose((drive * V)[~lifts & sure], (LOAD[:, 1] * V * 0.7)[~lifts & sure], rtol=1e-7)
    even = of("gear_efficiency", forward=0.2, backward=0.2)[1]
    np.testing.assert_allclose(even, of("friction_load", share=0.2)[1], rtol=1e-12, atol=1e-12)


def test_friction_falls_by_the_temperature_that_was_logged():
    warm = replace(MOTION, temperature=np.full(200, 313.15))
    np.testing.assert_allclose(of("friction_warmup", warm, per_kelvin=-0.1)[1], -2.0 * SIGN, rtol=1e-12)
    assert not of("friction_warmup", per_kelvin=-0.1)[1].any()


@given(st.integers(0, 10**6), st.floats(1e-3, 0.05))
@settings(max_examples=15, deadline=None)
def test_friction_after_a_reversal_is_dahls_equation(seed, distance):
    """Integrated by the coordinate, as dz/dt = |q'| (sign(q') - z)/x, where the sampled joint goes straight on."""
    rng = np.random.default_rng(seed)
    q = np.cumsum(rng.normal(0.0, 0.02, 12))
    motion = Motion(ARM, np.arange(12.0), *(np.stack([item] * 3, axis=1) for item in (q, np.zeros(12), np.zeros(12))))
    result = of("friction_reversal", motion, torque=1.0, distance=distance)[1]
    state = float(np.sign(q[1] - q[0]))
    for row in range(11):
        step = q[row + 1] - q[row]
        slope = solve_ivp(
            lambda _, z, step=step: abs(step) * (np.sign(step) - z) / distance, (0, 1), [state], rtol=1e-10, atol=1e-12
        )
        state = float(slope.y[0, -1])
        assert result[row + 1] == pytest.approx(state, abs=1e-7)


def test_a_late_torque_is_the_torque_of_before():
    fine = swinging(ARM, instants=4000)
    torque = inverse_dynamics(fine)
    late = torque[:, 1] + of("torque_delay", fine, time=2e-3)[1]
    shifted = np.interp(fine.time - 2e-3, fine.time, torque[:, 1])
    assert np.abs(late - shifted)[10:].max() < 2e-3 * np.abs(torque[:, 1]).max()


def test_a_motor_that_two_joints_turn_rubs_by_the_sum_or_the_difference_of_their_speeds():
    """As a wrist's last motor does: its friction times its speed is the power that the two drives lose."""
    one, two = MOTION.velocity[:, 0], MOTION.velocity[:, 1]
    for name, speed in (("torque", one + two), ("torque_apart", two - one)):
        result = of("joint_coupling", **{name: 0.5})
        power = result[0] * one + result[1] * two
        np.testing.assert_allclose(power, 0.5 * np.tanh(speed / 0.01) * speed, rtol=0, atol=1e-12)
        assert set(result) == {0, 1}
    result = of("joint_coupling", coefficient=2.0)
    for own, speed in ((0, two), (1, one)):
        np.testing.assert_allclose(result[own], 2.0 * speed, rtol=1e-12)


def test_a_links_more_inertia_is_a_column_of_the_regressor():
    names = [parameter.name for parameter in EFFECTS["link_inertial"].parameters]
    columns = regressor(ARM, MOTION.q, MOTION.velocity, MOTION.acceleration)
    for link in range(3):
        for place, name in enumerate(names):
            result = of("link_inertial", at=(link,), **{name: 1.0})
            assert set(result) == set(range(link + 1))
            for joint, torque in result.items():
                np.testing.assert_allclose(torque, columns[:, joint, 10 * link + place], rtol=0, atol=1e-9)


def test_a_payload_off_the_tip_is_a_mass_that_hangs_there():
    bare = replace(ARM, payload=LoadCase(), links=tuple(replace(link, masses=()) for link in ARM.links))
    centre = np.array([0.05, -0.02, 0.11])
    further = replace(bare, tool=tuple(np.array(bare.tool) + centre), payload=LoadCase(2.0))
    motion = replace(MOTION, arm=bare)
    expected = inverse_dynamics(replace(MOTION, arm=further)) - inverse_dynamics(motion)
    radius = (3.0 * 2.0 / (4.0 * np.pi * 7850.0)) ** (1.0 / 3.0)
    ball = dict.fromkeys(("inertia_xx", "inertia_yy", "inertia_zz"), 0.4 * 2.0 * radius**2)
    given_centre = {f"centre_{axis}": value for axis, value in zip("xyz", centre, strict=True)}
    by_moments = {f"first_moment_{axis}": 2.0 * value for axis, value in zip("xyz", centre, strict=True)}
    spread = 2.0 * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    tensor = {f"inertia_{'xyz'[a]}{'xyz'[b]}": spread[a, b] for a in range(3) for b in range(a, 3)}
    tensor = {name: value + ball.get(name, 0.0) for name, value in tensor.items()}
    for values in ({"mass": 2.0, **given_centre, **ball}, {"mass": 2.0, **by_moments, **tensor}):
        result = of("payload", motion, at=(), **values)
        np.testing.assert_allclose(np.stack([result[k] for k in range(3)], axis=1), expected, rtol=0, atol=1e-9)


def test_a_tilted_base_feels_gravity_from_another_side():
    turn = np.array([2e-4, -3e-4, 1e-4])
    gravity = tuple(np.array(ARM.gravity) + np.cross(ARM.gravity, turn))
    tilted = inverse_dynamics(replace(MOTION, arm=replace(ARM, gravity=gravity))) - LOAD
    result = of("base_tilt", at=(), about_x=turn[0], about_y=turn[1], about_z=turn[2])
    np.testing.assert_allclose(np.stack([result[k] for k in range(3)], axis=1), tilted, rtol=0, atol=1e-10)


def test_an_encoders_offset_puts_the_arm_elsewhere():
    offset = 1e-5
    moved = inverse_dynamics(replace(MOTION, q=MOTION.q + np.array([0.0, offset, 0.0]))) - LOAD
    result = of("encoder_offset", offset=offset)
    assert np.abs(np.stack([result[k] for k in range(3)], axis=1) - moved).max() < 1e-4 * np.abs(moved).max()


def test_a_counterbalance_found_is_one_that_the_file_could_hold():
    balanced = IdealCounterbalance(80.0, 0.0)
    plain = Arm("plane", (Joint(), Joint()), (Link(0.5, mass=9.0), Link(0.4, mass=4.0)))
    held = replace(plain, joints=(replace(plain.joints[0], counterbalance=balanced), plain.joints[1]))
    motion = swinging(plain)
    expected = inverse_dynamics(replace(motion, arm=held)) - inverse_dynamics(motion)
    result = of("counterbalance", motion, at=(0,), torque_cosine=80.0)
    np.testing.assert_allclose(result[0], expected[:, 0], rtol=0, atol=1e-10)


def test_joints_without_a_drive_have_no_friction_of_one():
    follows = Following((Tie(0, -1.0),))
    joints = (Joint(), replace(Joint(), passive=True), replace(Joint(), follows=follows))
    arm = Arm("plane", joints, tuple(Link(0.4, mass=2.0) for _ in joints))
    assert set(of("friction_coulomb", swinging(arm), at=(), torque=1.0)) == {0}


def test_a_model_holds_its_effects_and_its_sensors_come_last():
    entries = (
        EffectEntry("torque_constant", (2,), {"excess": 0.1}),
        EffectEntry("friction_load", (2,), {"share": 0.05}),
        EffectEntry("friction_coulomb", (2,), {"torque": 3.0}),
        EffectEntry("torque_offset", (), {"torque": 0.2}),
        EffectEntry("encoder_scale", (2,), {"scale": 1e-4}),
    )
    result = model_torque(replace(MOTION, arm=replace(ARM, effects=entries)))
    driven = LOAD[:, 1] + 0.05 * np.abs(LOAD[:, 1]) * SIGN + 3.0 * SIGN
    np.testing.assert_allclose(result[:, 1], 1.1 * driven + 0.2, rtol=0, atol=1e-9)
    np.testing.assert_allclose(result[:, 0], LOAD[:, 0] + 0.2, rtol=0, atol=1e-9)


@given(st.integers(0, 10**6))
@settings(max_examples=10, deadline=None)
def test_friction_only_ever_takes_power(seed):
    entries = (
        EffectEntry("friction_coulomb", (), {"torque": 3.0}),
        EffectEntry("friction_viscous", (), {"coefficient": 1.0}),
        EffectEntry("friction_stribeck", (), {"torque": 1.0, "speed": 0.1}),
        EffectEntry("friction_load", (), {"share": 0.1}),
    )
    arm = random_arm(seed)
    motion = swinging(arm, seed, instants=30)
    more = model_torque(replace(motion, arm=replace(arm, effects=entries))) - inverse_dynamics(motion)
    assert drive_power(motion, more).min() >= 0.0


def test_effects_of_torque_alone_are_read_and_move_no_tip(tmp_path):
    text = rod_lines([400, 300]) + (
        "effects:\n  - {effect: friction_coulomb, at: 2, torque: 13 N*m}\n"
        "  - {effect: payload, mass: 2 kg, centre: [0 mm, 10 mm, 80 mm]}\n"
    )
    arm = arm_of(text, tmp_path)
    assert dict(arm.effects[1].parameters) == {"mass": 2.0, "centre_x": 0.0, "centre_y": 0.01, "centre_z": 0.08}
    alone = {item.id for item in EFFECTS.values() if not item.moves_tip}
    assert {"friction_coulomb", "armature", "torque_delay", "link_inertial"} < alone
    assert not any(EFFECTS[name].sizes for name in alone)
