"""Effects of geometry and measurement: the planar formulas, and exact perturbed kinematics in space."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.arm.errors.recorded import Asked, seen
from linkwright.core.sections.numeric import Array
from tests.arm.effects.effect_states import Plane, Posed, exact_change, in_space, moved, planar, spatial
from tests.random_chains import rotation_about

# ---- in the plane, by hand


def test_joint_errors_in_the_plane_turn_what_follows() -> None:
    """J_i times: the offset, e q, a sin q + b cos q, a sin kq + b cos kq, k q_(i-1), dq/dt dt."""
    posed = planar()
    plane, q, held = Plane(posed), posed.q, posed.held
    assert held.velocities is not None
    assert held.last_moves is not None
    assert held.commanded is not None
    for i in range(3):
        motions: list[tuple[str, dict[str, float], Array]] = [
            ("encoder_offset", {"offset": 2e-4}, np.full(len(q), 2e-4)),
            ("encoder_scale", {"scale": 3e-4}, 3e-4 * q[:, i]),
            (
                "encoder_eccentricity",
                {"sine": 1e-4, "cosine": -2e-4},
                1e-4 * np.sin(q[:, i]) - 2e-4 * np.cos(q[:, i]),
            ),
            (
                "gear_transmission_error",
                {"sine": 1e-4, "cosine": 3e-4, "order": 17.0},
                1e-4 * np.sin(17.0 * q[:, i]) + 3e-4 * np.cos(17.0 * q[:, i]),
            ),
            ("latency", {"delay": 4e-3}, 4e-3 * held.velocities[i]),
            (
                "stale_reading",
                {"share_of_move": 5e-4, "share_of_command": 0.3},
                5e-4 * held.last_moves[i] + 0.3 * (held.commanded[i] - q[:, i]),
            ),
            (
                "counterbalance",
                {"sine": 2e-3, "cosine": 1e-3},
                2e-3 * np.sin(plane.phi[:, i]) + 1e-3 * np.cos(plane.phi[:, i]),
            ),
        ]
        if i > 0:
            motions.append(("joint_coupling", {"coupling": 2e-3}, 2e-3 * q[:, i - 1]))
        for effect, values, angle in motions:
            expected = in_space(plane.j(i) * angle[:, None])
            assert moved(posed.state, effect, values, (i,)) == pytest.approx(expected, rel=1e-12, abs=1e-16), effect


def test_nothing_couples_the_first_joint() -> None:
    assert np.all(moved(planar().state, "joint_coupling", {"coupling": 1e-2}, (0,)) == 0.0)


def test_lengths_tool_frame_and_scale_in_the_plane() -> None:
    posed = planar()
    plane = Plane(posed)
    state, p = posed.state, plane.p
    for i in range(3):
        assert moved(state, "link_length", {"length": 1e-3}, (i,)) == pytest.approx(in_space(1e-3 * plane.u(i)))
    tool = in_space(1e-3 * plane.u(2) - 2e-3 * plane.n(2))
    assert moved(state, "tool_offset", {"along": 1e-3, "across": -2e-3, "out": 5e-3}) == pytest.approx(tool)
    turn = np.stack([-p[:, 1], p[:, 0]], axis=1)
    frame = {"x": 1e-3, "y": -2e-3, "about_z": 4e-4, "z": 1.0, "about_x": 0.1, "about_y": 0.1}
    expected = in_space(np.array([1e-3, -2e-3]) + 4e-4 * turn)
    assert moved(state, "frame_misalignment", frame) == pytest.approx(expected)
    time = posed.held.time
    assert time is not None
    assert moved(state, "frame_drift", frame) == pytest.approx(expected * time[:, None])
    assert moved(state, "instrument_scale", {"scale": 2e-4}) == pytest.approx(in_space(2e-4 * p))


def test_the_tools_axes_do_not_turn_with_the_section() -> None:
    """A last link whose section lies flat still has `across` in the plane."""
    posed = planar()
    flat = replace(
        posed.arm, links=(*posed.arm.links[:2], replace(posed.arm.links[2], height_direction=(0.0, 0.0, 1.0)))
    )
    values = {"along": 1e-3, "across": -2e-3}
    assert moved(posed.solved(flat), "tool_offset", values) == pytest.approx(moved(posed.state, "tool_offset", values))


# ---- in space, against exact kinematics


def coordinates_moved(posed: Posed, i: int, motion: Callable[[Array], Array]) -> Callable[[float], tuple[Arm, Array]]:
    def change(h: float) -> tuple[Arm, Array]:
        q = posed.q.copy()
        q[:, i] += h * motion(posed.q)
        return posed.arm, q

    return change


SPATIAL = [spatial(3), spatial(4, slide=False), planar(6, absolute=True)]


@pytest.mark.parametrize("posed", SPATIAL, ids=["slide", "turning", "absolute"])
@pytest.mark.parametrize(
    ("effect", "values", "motion"),
    [
        ("encoder_offset", {"offset": 1.0}, lambda q, i: np.ones_like(q[:, i])),
        ("encoder_scale", {"scale": 1.0}, lambda q, i: q[:, i]),
        ("encoder_eccentricity", {"sine": 1.0}, lambda q, i: np.sin(q[:, i])),
        ("encoder_eccentricity", {"cosine": 1.0}, lambda q, i: np.cos(q[:, i])),
        ("gear_transmission_error", {"sine": 1.0, "order": 7.0}, lambda q, i: np.sin(7.0 * q[:, i])),
        ("gear_transmission_error", {"cosine": 1.0, "order": 7.0}, lambda q, i: np.cos(7.0 * q[:, i])),
        ("joint_waviness", {"sine_5": 1.0}, lambda q, i: np.sin(5.0 * q[:, i])),
        (
            "joint_waviness",
            {"cosine_2": 1.0, "sine_32": -0.5, "sine_9": 7.0, "orders": 8.0},
            lambda q, i: np.cos(2.0 * q[:, i]),
        ),
        ("joint_coupling", {"coupling": 1.0}, lambda q, i: q[:, i - 1]),
    ],
)
def test_joint_errors_are_those_of_exact_kinematics(
    posed: Posed, effect: str, values: dict[str, float], motion: Callable[[Array, int], Array]
) -> None:
    """Central differences of the perturbed chain miss the first order by h^2, some 1e-10 of it."""
    for i in range(posed.arm.size):
        slides = not posed.arm.joints[i].revolute
        if not EFFECTS[effect].can_act(i, revolute=not slides):
            assert np.all(moved(posed.state, effect, values, (i,)) == 0.0)
            continue
        if slides and effect == "gear_transmission_error":
            exact = coordinates_moved(posed, i, lambda q, i=i: motion(2.0 * np.pi * q, i))  # seven waves a metre
        else:
            exact = coordinates_moved(posed, i, partial(motion, i=i))
        expected = exact_change(exact)
        assert moved(posed.state, effect, values, (i,)) == pytest.approx(expected, abs=1e-8)


def put(arm: Arm, index: int, joint: Joint) -> Arm:
    return replace(arm, joints=(*arm.joints[:index], joint, *arm.joints[index + 1 :]))


@pytest.mark.parametrize("posed", SPATIAL[:2], ids=["slide", "turning"])
def test_a_misaligned_axis_is_a_joint_set_askew(posed: Posed) -> None:
    """Tilts turn the joint's place on the link before it, shifts move it there, slides as they stand."""
    for index in range(1, posed.arm.size):
        joint = posed.arm.joints[index]
        hint = np.array([1.0, 0.0, 0.0] if abs(joint.axis[0]) < 0.9 else [0.0, 1.0, 0.0])
        first = np.cross(joint.axis, hint)
        first /= np.linalg.norm(first)
        for name, axis in (("u", first), ("v", np.cross(joint.axis, first))):

            def tilted(h: float, axis: Array = axis, index: int = index, joint: Joint = joint) -> tuple[Arm, Array]:
                turn = np.array(joint.origin_rotation) @ rotation_about(axis, h)
                new = replace(joint, origin_rotation=tuple(tuple(row) for row in turn.tolist()))
                return put(posed.arm, index, new), posed.q

            def shifted(h: float, axis: Array = axis, index: int = index, joint: Joint = joint) -> tuple[Arm, Array]:
                by = np.array(joint.origin_translation) + h * np.array(joint.origin_rotation) @ axis
                new = replace(joint, origin_translation=tuple(by.tolist()))
                return put(posed.arm, index, new), posed.q

            for kind, exact in (("tilt", tilted), ("shift", shifted)):
                result = moved(posed.state, "axis_misalignment", {f"{kind}_{name}": 1.0}, (index,))
                assert result == pytest.approx(exact_change(exact), abs=1e-8), (index, kind, name)


@pytest.mark.parametrize("posed", SPATIAL, ids=["slide", "turning", "absolute"])
def test_latency_is_where_the_arm_has_gone_meanwhile(posed: Posed) -> None:
    held = posed.held
    assert held.velocities is not None
    speeds = np.stack(list(held.velocities), axis=1)
    expected = exact_change(lambda h: (posed.arm, posed.q + h * speeds))
    assert moved(posed.state, "latency", {"delay": 1.0}) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("posed", SPATIAL, ids=["slide", "turning", "absolute"])
def test_a_longer_link_is_the_arm_with_a_longer_link(posed: Posed) -> None:
    for i in range(posed.arm.size):

        def change(h: float, i: int = i) -> tuple[Arm, Array]:
            links = list(posed.arm.links)
            links[i] = replace(links[i], length=links[i].length + h)
            return posed.arm.with_links(tuple(links)), posed.q

        assert moved(posed.state, "link_length", {"length": 1.0}, (i,)) == pytest.approx(exact_change(change), abs=1e-9)


def test_a_tool_offset_is_another_tool() -> None:
    """The last joint's axis is (0.6, 0.8, 0) and its link runs along x: across is the axis cross x, out completes."""
    posed = spatial(3)
    across, out = np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0])
    for name, direction in (("along", np.array([1.0, 0.0, 0.0])), ("across", across), ("out", out)):

        def change(h: float, direction: Array = direction) -> tuple[Arm, Array]:
            tool = np.array(posed.arm.tool) + h * direction
            return replace(posed.arm, tool=(float(tool[0]), float(tool[1]), float(tool[2]))), posed.q

        assert moved(posed.state, "tool_offset", {name: 1.0}) == pytest.approx(exact_change(change), abs=1e-9)


def test_the_frame_moves_as_a_rigid_body() -> None:
    posed = spatial(3)
    p = tip_position(posed.arm, posed.q)
    for index, axis in enumerate("xyz"):
        unit = np.eye(3)[index]
        shift = moved(posed.state, "frame_misalignment", {axis: 1e-3})
        assert shift == pytest.approx(np.tile(1e-3 * unit, (len(p), 1)))
        h = 1e-5
        turned = (p @ rotation_about(unit, h).T - p @ rotation_about(unit, -h).T) / (2.0 * h)
        assert moved(posed.state, "frame_misalignment", {f"about_{axis}": 1.0}) == pytest.approx(turned, abs=1e-9)
        drift = moved(posed.state, "frame_drift", {f"about_{axis}": 1.0})
        assert posed.held.time is not None
        assert drift == pytest.approx(turned * posed.held.time[:, None], rel=1e-8, abs=1e-6)


def test_the_instruments_scale_stretches_positions() -> None:
    posed = spatial(3)
    p = tip_position(posed.arm, posed.q)
    assert p + moved(posed.state, "instrument_scale", {"scale": 1e-3}) == pytest.approx(1.001 * p, rel=1e-12)


def test_a_counterbalance_goes_with_the_angle_against_the_vertical() -> None:
    """The link's angle from the vertical about its shoulder, which lies along y; gravity is along -z."""
    posed = spatial(3)
    upright = replace(posed.arm, gravity=(0.0, 0.0, -9.81))
    state = posed.solved(upright)
    # Joint 2 turns about y from a link that lies level: at q2 + zero = -90 deg the link points up.
    angle = posed.q[:, 1] + posed.arm.joints[1].zero + 0.5 * np.pi
    offset = moved(state, "encoder_offset", {"offset": 1.0}, (1,))
    sine, cosine = (moved(state, "counterbalance", {name: 1.0}, (1,)) for name in ("sine", "cosine"))
    assert sine == pytest.approx(offset * np.sin(angle)[:, None], abs=1e-12)
    assert cosine == pytest.approx(offset * np.cos(angle)[:, None], abs=1e-12)


def test_an_upright_joint_has_nothing_to_balance() -> None:
    """Its link's angle against the vertical never changes, so that the torque could only be constant."""
    posed = spatial(3)
    state = posed.solved(replace(posed.arm, gravity=(0.0, 0.0, -9.81)))
    assert moved(state, "counterbalance", {"sine": 1.0, "cosine": 1.0}, (0,)) == pytest.approx(0.0, abs=1e-12)


# ---- exact aliases


def test_an_offset_of_the_first_encoder_is_a_turn_of_the_frame() -> None:
    posed = planar()
    assert moved(posed.state, "encoder_offset", {"offset": 3e-4}, (0,)) == pytest.approx(
        moved(posed.state, "frame_misalignment", {"about_z": 3e-4}), rel=1e-12
    )


def test_an_offset_of_the_last_encoder_is_a_tool_offset() -> None:
    posed = planar()
    across = 3e-4 * posed.arm.lengths[2]
    assert moved(posed.state, "encoder_offset", {"offset": 3e-4}, (2,)) == pytest.approx(
        moved(posed.state, "tool_offset", {"across": across}), rel=1e-12
    )


def test_the_last_links_length_is_a_tool_offset() -> None:
    posed = planar()
    assert moved(posed.state, "link_length", {"length": 3e-4}, (2,)) == pytest.approx(
        moved(posed.state, "tool_offset", {"along": 3e-4}), rel=1e-12
    )


def test_lengths_in_proportion_are_the_instruments_scale() -> None:
    posed = planar()
    grown = sum(moved(posed.state, "link_length", {"length": 2e-4 * length}, (i,))
                for i, length in enumerate(posed.arm.lengths))  # fmt: skip
    assert grown == pytest.approx(moved(posed.state, "instrument_scale", {"scale": 2e-4}), rel=1e-11)


# ---- channels


def test_a_target_on_the_base_sees_the_frame_and_not_the_encoders() -> None:
    posed = spatial(3)
    target = (0.3, -0.2, 0.1)
    asked = Asked(len(posed.q), joint_side=True, base_target=target)
    frame = seen(posed.state, EFFECTS["frame_misalignment"], Settings((), {"x": 1e-3, "about_z": 2e-3}), asked)
    assert frame.base is not None
    assert frame.base == pytest.approx(np.tile([1e-3 + 2e-3 * 0.2, 2e-3 * 0.3, 0.0], (len(posed.q), 1)), abs=1e-15)
    assert frame.joint_side == pytest.approx(0.0)
    scale = seen(posed.state, EFFECTS["encoder_scale"], Settings((2,), {"scale": 1e-3}), asked)
    assert scale.base == pytest.approx(0.0)
    assert scale.joint_side is not None
    assert scale.joint_side[:, 2] == pytest.approx(1e-3 * posed.q[:, 2], rel=1e-12)
