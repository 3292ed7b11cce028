"""Effects of loads: by hand in the plane, and against the whole arm solved again, by another solver too."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.arm.errors.recorded import Asked, seen
from linkwright.core.arm.errors.tip import active_effects, tip_error
from linkwright.core.sections.numeric import Array
from tests.arm.builders import chain_arm, elastic_motion
from tests.arm.effects.effect_states import GRAVITY, ROWS, Plane, in_space, moved, planar, spatial
from tests.random_chains import RandomChain, random_planar_chain, random_spatial_chain, rotation_about, tip_motion

# ---- drives, in the plane by hand


def test_drives_that_give_in_the_plane() -> None:
    """J_i times what each drive does under tau_i, which is summed up here from gravity, payload and force."""
    posed = planar()
    plane, held = Plane(posed), posed.held
    assert held.sides is not None
    assert held.loaded_for is not None
    for i in range(3):
        tau = plane.tau(i)
        zones = {"stiffness_1": 1e4, "stiffness_2": 2e4, "stiffness_3": 4e4, "torque_1": 20.0, "torque_2": 60.0}
        size = np.abs(tau)
        zoned = np.where(
            size < 20.0,
            size / 1e4,
            np.where(size < 60.0, 20.0 / 1e4 + (size - 20.0) / 2e4, 20.0 / 1e4 + 40.0 / 2e4 + (size - 60.0) / 4e4),
        )
        cases: list[tuple[str, dict[str, float], Array]] = [
            ("joint_compliance", {"compliance": 2e-5}, 2e-5 * tau),
            ("servo_droop", {"compliance": 2e-5}, 2e-5 * tau),
            ("joint_hardening", {"compliance": 2e-5, "knee": 30.0}, 2e-5 * 30.0 * np.tanh(tau / 30.0)),
            ("joint_hardening", zones, np.sign(tau) * zoned),
            ("friction_windup", {"windup": 1e-4}, -1e-4 * held.sides[i]),
            ("friction_windup", {"windup_per_load": 1e-6}, -1e-6 * size * held.sides[i]),
            (
                "creep",
                {"compliance": 1e-6, "time_constant": 900.0},
                1e-6 * tau * (1.0 - np.exp(-held.loaded_for / 900.0)),
            ),
        ]
        for effect, values, angle in cases:
            result = moved(posed.state, effect, values, (i,))
            assert result == pytest.approx(in_space(plane.j(i) * angle[:, None]), rel=1e-9), effect


def test_the_zones_are_met_by_the_loads_tried_above() -> None:
    tau = np.abs([Plane(planar()).tau(i) for i in range(3)])
    assert (tau < 20.0).any()
    assert ((tau > 20.0) & (tau < 60.0)).any()
    assert (tau > 60.0).any()


def test_the_base_gives_in_the_plane() -> None:
    """z x p tau_1 / K_0: what the compliance of the first joint's drive does, exactly."""
    posed = planar()
    plane = Plane(posed)
    result = moved(posed.state, "base_compliance", {"compliance": 3e-6, "compliance_about_z": 1.0})
    assert result == pytest.approx(in_space(plane.j(0) * (3e-6 * plane.tau(0))[:, None]), rel=1e-9)
    assert result == pytest.approx(moved(posed.state, "joint_compliance", {"compliance": 3e-6}, (0,)), rel=1e-9)


def test_the_base_in_space_tilts_alike_about_both_of_its_axes() -> None:
    """M_0 summed up from weights and lever arms; the first joint stands 0.3 m above the base's origin."""
    posed = spatial(3)
    state, g = posed.state, np.array(posed.arm.gravity)
    moment, at = np.zeros((ROWS, 3)), np.zeros((ROWS, 3))
    for link, lead, joint, beam in zip(state.links, state.leads, posed.arm.joints, posed.beams, strict=True):
        at = at + rows(lead)
        moment += np.cross(at, joint.mass * g)
        middle = at + 0.5 * rows(link.vector)
        moment += np.cross(middle, float(beam.mass_per_length) * float(beam.length) * g)
        at = at + rows(link.vector)
    tip, load = at + rows(state.tool), posed.arm.payload
    moment += np.cross(tip, load.mass * g + np.array(load.force)) + np.array(load.moment)
    tilt = np.cross(moment * [2e-6, 2e-6, 0.0], tip)
    assert moved(state, "base_compliance", {"compliance": 2e-6}) == pytest.approx(tilt, rel=1e-9)
    turn = np.cross(moment * [0.0, 0.0, 1e-6], tip)
    assert moved(state, "base_compliance", {"compliance_about_z": 1e-6}) == pytest.approx(turn, rel=1e-9)


def rows(vector: object) -> Array:
    assert isinstance(vector, tuple)
    return np.stack([np.broadcast_to(np.asarray(item, dtype=float), ROWS) for item in vector], axis=1)


def test_friction_that_knows_no_load_is_side_held_backlash() -> None:
    posed = spatial(3)
    friction = moved(posed.state, "friction_windup", {"windup": 2e-4})
    assert friction == pytest.approx(moved(posed.state, "backlash", {"total": 4e-4, "held_below": 1e6}), rel=1e-12)


def test_friction_counts_as_play_where_no_side_is_known() -> None:
    """A design's joint stands anywhere between both sides."""
    posed = planar()
    arm = replace(posed.arm, effects=(EffectEntry("friction_windup", (2,), {"windup": 1e-4, "windup_per_load": 1e-6}),))
    state = solve(arm, posed.q[0].tolist(), posed.beams)
    (interval,) = tip_error(state, active_effects(arm)).intervals
    plane = Plane(posed)
    expected = plane.j(1)[0] * (1e-4 + 1e-6 * np.abs(plane.tau(1)[0]))
    assert np.array(interval.vector[:2]) == pytest.approx(expected, rel=1e-9)
    assert interval.seating == 0.0
    assert np.all(moved(state, "friction_windup", {"windup": 1e-4}) == 0.0)


def test_droop_of_the_servo_is_seen_by_the_encoder() -> None:
    posed = planar()
    asked = Asked(ROWS, command=True)
    result = seen(posed.state, EFFECTS["servo_droop"], Settings((1,), {"compliance": 1e-5}), asked)
    assert np.all(result.tip == 0.0)
    assert result.command is not None
    assert result.command[:, 1] == pytest.approx(1e-5 * Plane(posed).tau(1), rel=1e-9)


# ---- through all that gives, against the whole arm solved again


def chains(planar_only: bool = False) -> list[RandomChain]:
    made = [random_planar_chain(np.random.default_rng(seed), 3) for seed in range(3)]
    return made if planar_only else made + [random_spatial_chain(np.random.default_rng(seed), 4) for seed in range(5)]


def one_pose(chain: RandomChain) -> PoseState:
    arm, beams, q = chain_arm(chain, shear=True)
    return solve(arm, q, beams)


@pytest.mark.parametrize("chain", chains())
def test_a_heavier_payload_is_the_frame_with_a_heavier_payload(chain: RandomChain) -> None:
    """By the stiffness-method solver, which knows nothing of effects."""
    heavier = tip_motion(replace(chain, payload_mass=chain.payload_mass + 1.7))[0] - tip_motion(chain)[0]
    result = moved(one_pose(chain), "payload", {"mass": 1.7})
    assert result == pytest.approx(heavier, rel=1e-6, abs=1e-6 * np.abs(heavier).max())


@pytest.mark.parametrize("chain", chains())
def test_mass_along_a_link_is_the_frame_with_a_denser_link(chain: RandomChain) -> None:
    for i, link in enumerate(chain.links):
        denser = list(chain.links)
        denser[i] = replace(link, density=link.density + 2.0 / (link.area * link.length))
        change = tip_motion(replace(chain, links=tuple(denser)))[0] - tip_motion(chain)[0]
        result = moved(one_pose(chain), "link_mass", {"mass": 2.0}, (i,))
        assert result == pytest.approx(change, rel=1e-6, abs=1e-6 * max(np.abs(change).max(), 1e-9))


@pytest.mark.parametrize("chain", chains())
def test_another_modulus_is_the_frame_with_another_modulus(chain: RandomChain) -> None:
    for i, link in enumerate(chain.links):
        softer = list(chain.links)
        softer[i] = replace(link, elastic_modulus=0.7 * link.elastic_modulus)
        change = tip_motion(replace(chain, links=tuple(softer)))[0] - tip_motion(chain)[0]
        result = moved(one_pose(chain), "link_modulus", {"excess": -0.3}, (i,))
        assert result == pytest.approx(change, rel=1e-6, abs=1e-6 * max(np.abs(change).max(), 1e-9))


@pytest.mark.parametrize("chain", chains())
def test_a_tilted_base_is_the_frame_under_turned_gravity(chain: RandomChain) -> None:
    """A base turned by a sees gravity turned by -a; the central difference misses the first order by a^2."""
    state = one_pose(chain)
    for index in (2,) if state.planar else range(3):
        axis = np.eye(3)[index]

        def tilted(angle: float, axis: Array = axis) -> Array:
            g = rotation_about(axis, -angle) @ np.array(chain.gravity)
            return tip_motion(replace(chain, gravity=(float(g[0]), float(g[1]), float(g[2]))))[0]

        expected = (tilted(1e-2) - tilted(-1e-2)) / 2e-2
        result = moved(state, "base_tilt", {f"about_{'xyz'[index]}": 1.0})
        assert result == pytest.approx(expected, rel=1e-3, abs=1e-4 * max(np.abs(expected).max(), 1e-9))


@pytest.mark.parametrize("chain", chains())
def test_a_leaning_base_is_pulled_at_by_what_is_added_too(chain: RandomChain) -> None:
    """The frame with a heavier payload and a denser link under turned gravity, less the frame as it was."""
    tilt = (0.0, 0.0, 0.03) if one_pose(chain).planar else (0.02, -0.01, 0.03)
    lean = {f"about_{axis}": turn for axis, turn in zip("xyz", tilt, strict=True)}
    arm, beams, q = chain_arm(chain, shear=True)
    payload, on_link = EffectEntry("payload", (), {"mass": 1.7}), EffectEntry("link_mass", (2,), {"mass": 2.0})
    state = solve(replace(arm, effects=(EffectEntry("base_tilt", (), lean), payload, on_link)), q, beams)
    x, y, z = np.array(chain.gravity) + np.cross(chain.gravity, tilt)
    link = chain.links[1]
    denser = replace(link, density=link.density + 2.0 / (link.area * link.length))
    heavier = replace(
        chain,
        gravity=(float(x), float(y), float(z)),
        payload_mass=chain.payload_mass + 1.7,
        links=(chain.links[0], denser, *chain.links[2:]),
    )
    expected = tip_motion(heavier)[0] - tip_motion(chain)[0]
    added = moved(state, "payload", {"mass": 1.7}) + moved(state, "link_mass", {"mass": 2.0}, (1,))
    result = added + moved(state, "base_tilt", lean)
    assert result == pytest.approx(expected, rel=1e-6, abs=1e-6 * np.abs(expected).max())
    alone = added + moved(one_pose(chain), "base_tilt", lean)
    assert np.abs(alone - expected).max() > 1e-3 * np.abs(expected).max()


def test_a_planar_arm_feels_no_tilt_out_of_its_plane() -> None:
    assert np.all(moved(planar().state, "base_tilt", {"about_x": 0.1, "about_y": 0.1}) == 0.0)


def test_extra_loads_meet_the_arms_own_payloads_masses_and_findings() -> None:
    """An arm in space with slide, tool, a base that gives and a drive corrected: all rows, the payload of each row."""
    posed = spatial(3)
    corrected = replace(
        posed.arm,
        effects=(
            EffectEntry("joint_compliance", (2,), {"compliance": 1e-5}),
            EffectEntry("base_compliance", (), {"compliance": 1e-6}),
            EffectEntry("link_modulus", (2,), {"excess": -0.2}),
        ),
    )
    masses = np.linspace(0.0, 4.0, ROWS)

    def motion(extra: float, gravity: tuple[float, float, float] | None = None) -> tuple[Array, PoseState]:
        columns = [posed.q[:, index] for index in range(4)]
        state = solve(corrected, columns, posed.beams, payload_mass=masses + extra, gravity=gravity)
        return elastic_motion(corrected, state)[0].T, state

    before, state = motion(0.0)
    assert moved(state, "payload", {"mass": 1.3}) == pytest.approx(motion(1.3)[0] - before, rel=1e-9)
    g = np.array(corrected.gravity)
    change = np.cross(g, [1e-3, -2e-3, 5e-4])
    tilted = motion(0.0, tuple((g + change).tolist()))[0] - before
    tilt = {"about_x": 1e-3, "about_y": -2e-3, "about_z": 5e-4}
    assert moved(state, "base_tilt", tilt) == pytest.approx(tilted, rel=1e-7)


def test_physics_left_out_answers_to_no_extra_load() -> None:
    posed = planar()
    rigid = replace(
        posed.arm,
        joints=tuple(replace(joint, stiffness=None) for joint in posed.arm.joints),
        leave_out=frozenset({"link_bending", "slope_propagation", "axial", "shear_deformation", "torsion"}),
    )
    assert np.all(moved(posed.solved(rigid), "payload", {"mass": 1.0}) == 0.0)
    assert np.all(moved(posed.solved(rigid), "link_modulus", {"excess": 0.1}) == 0.0)


def test_mass_along_a_rigid_link_lies_along_it_too() -> None:
    """A rigid arm on an elastic drive: theta = c m g l/2 cos q."""
    arm = Arm("one", (Joint(stiffness=1e4),), (Link(0.8, mass=5.0),))
    state = solve(arm, [0.4], (Beam(0.8, lumped_mass=5.0, lumped_at=0.1),))
    sag = -2.0 * GRAVITY * 0.4 * np.cos(0.4) / 1e4
    expected = sag * 0.8 * np.array([-np.sin(0.4), np.cos(0.4), 0.0])
    assert moved(state, "link_mass", {"mass": 2.0}) == pytest.approx(expected, rel=1e-12)


# ---- drives of the same kind


def test_servo_droop_is_the_drives_compliance_where_commands_move_the_arm() -> None:
    posed = spatial(3)
    for i in range(4):
        droop = moved(posed.state, "servo_droop", {"compliance": 1e-6}, (i,))
        assert droop == pytest.approx(moved(posed.state, "joint_compliance", {"compliance": 1e-6}, (i,)), rel=1e-12)


def test_little_load_meets_the_full_compliance_of_a_hardening_drive() -> None:
    """tanh x = x - x^3/3: at a knee 1000 times the load, 3e-7 are missing."""
    posed = planar()
    largest = max(float(np.abs(load.drive_load).max()) for load in posed.state.joints)
    soft = moved(posed.state, "joint_hardening", {"compliance": 1e-6, "knee": 1e3 * largest})
    full = moved(posed.state, "joint_compliance", {"compliance": 1e-6})
    assert np.abs(soft - full).max() <= 1e-6 * np.abs(full).max()
