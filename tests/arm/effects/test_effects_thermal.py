"""Effects of temperature and time: by hand in the plane, their exact aliases, their lag, and what a design makes of
them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from linkwright.core.arm.chain.conditions import Conditions
from linkwright.core.arm.chain.statics import solve
from linkwright.core.sections.numeric import Array
from tests.arm.effects.effect_states import ROWS, Plane, Posed, in_space, moved, planar, spatial, turned

LAG = 2400.0


def lagged(posed: Posed, link: int) -> Array:
    """lag y' = u - y by a general integrator, u linear between the readings, y at rest at the first."""
    time, warming = posed.held.time, posed.held.warming
    assert time is not None
    assert warming is not None

    def slope(t: float, y: Array) -> Array:
        return (np.interp(t, time, warming[link]) - y) / LAG

    run = solve_ivp(slope, (time[0], time[-1]), [warming[link][0]], t_eval=time, rtol=1e-9, atol=1e-10, max_step=50.0)
    return run.y[0]


def test_warm_links_lengthen_bend_and_turn_their_joints_behind_their_lag() -> None:
    posed = planar()
    plane = Plane(posed)
    for i in range(3):
        warm, length = lagged(posed, i), posed.arm.lengths[i]
        longer = in_space(plane.u(i) * (2e-5 * length * warm)[:, None])
        # The integrator's 1e-9 a step, over some hundreds of steps of a warming of 20 K.
        result = moved(posed.state, "thermal_expansion", {"expansion": 2e-5, "lag": LAG}, (i,))
        assert result == pytest.approx(longer, rel=1e-6, abs=1e-10)
        bent = plane.n(i) * (3e-5 * warm * length**2 / 2.0)[:, None]
        bent += turned(plane.p - plane.o(i + 1)) * (3e-5 * warm * length)[:, None]
        result = moved(posed.state, "thermal_bending", {"curvature": 3e-5, "lag": LAG}, (i,))
        assert result == pytest.approx(in_space(bent), rel=1e-6, abs=1e-10)
        turning = in_space(plane.j(i) * (5e-6 * warm)[:, None])
        result = moved(posed.state, "gearbox_thermal", {"per_kelvin": 5e-6, "lag": LAG}, (i,))
        assert result == pytest.approx(turning, rel=1e-6, abs=1e-10)


def test_a_warm_screw_carries_its_slide_too_far() -> None:
    """a dT q along the slide's axis, and nothing at joints that turn."""
    posed = spatial()
    unit = moved(posed.state, "encoder_offset", {"offset": 1.0}, (2,))
    travel = 2e-5 * lagged(posed, 2) * posed.q[:, 2]
    result = moved(posed.state, "screw_expansion", {"expansion": 2e-5, "lag": LAG}, (2,))
    assert result == pytest.approx(unit * travel[:, None], rel=1e-6, abs=1e-12)
    assert np.all(moved(posed.state, "screw_expansion", {"expansion": 2e-5}, (1,)) == 0.0)


def test_thermal_bending_is_thermal_motion_of_both_joints_half_each() -> None:
    """z x (p - o_i) + z x (p - o_(i+1)) = 2 z x (p - o_(i+1)) + L n, with both joints as warm as the link."""
    posed = planar()
    warm = posed.held.warming
    assert warm is not None
    even = replace(posed, held=replace(posed.held, warming=(warm[0], warm[0], warm[2])))
    bending = moved(even.state, "thermal_bending", {"curvature": 3e-5}, (0,))
    half = {"per_kelvin": 0.5 * 3e-5 * posed.arm.lengths[0]}
    joints = moved(even.state, "gearbox_thermal", half, (0, 1))
    assert bending == pytest.approx(joints, rel=1e-10)


def test_even_warming_is_the_instruments_scale() -> None:
    posed = planar()
    even = replace(posed, held=replace(posed.held, warming=(np.full(ROWS, 8.0),) * 3))
    grown = moved(even.state, "thermal_expansion", {"expansion": 2e-5})
    assert grown == pytest.approx(moved(even.state, "instrument_scale", {"scale": 8.0 * 2e-5}), rel=1e-10)


def test_bending_in_space_follows_the_sections_height() -> None:
    """The bent end moves along the height; the slope turns the rest about the axis that lays the link there."""
    posed = spatial(3)
    state = posed.state
    assert posed.held.warming is not None
    link, warm = state.links[1], posed.held.warming[1]

    def rows(vector: object) -> Array:
        assert isinstance(vector, tuple)
        return np.stack([np.broadcast_to(np.asarray(item, dtype=float), ROWS) for item in vector], axis=1)

    beyond = sum((rows(item.vector) for item in state.links[2:]), rows(state.tool))
    beyond = beyond + sum((rows(lead) for lead in state.leads[2:]), np.zeros((ROWS, 3)))
    length = float(link.beam.length)
    turn = np.cross(rows(link.along), rows(link.height)) * (3e-5 * warm * length)[:, None]
    expected = rows(link.height) * (3e-5 * warm * length**2 / 2.0)[:, None] + np.cross(turn, beyond)
    assert moved(state, "thermal_bending", {"curvature": 3e-5}, (1,)) == pytest.approx(expected, rel=1e-10)


def test_a_slide_lengthens_with_its_gearbox() -> None:
    posed = spatial(3)
    assert posed.held.warming is not None
    along = moved(posed.state, "encoder_offset", {"offset": 1.0}, (2,))
    result = moved(posed.state, "gearbox_thermal", {"per_kelvin": 5e-6}, (2,))
    assert result == pytest.approx(along * (5e-6 * posed.held.warming[2])[:, None], rel=1e-12)


def test_a_design_is_as_warm_as_its_arm() -> None:
    posed = planar()
    warm = replace(posed.arm, temperature=293.15 + 30.0)
    state = solve(warm, posed.q[0].tolist(), posed.beams)
    pose = Plane(replace(posed, q=posed.q[:1]))
    expected = 12e-6 * 30.0 * pose.p[0]
    assert moved(state, "thermal_expansion", {})[:2] == pytest.approx(expected, rel=1e-9)
    turning = moved(state, "gearbox_thermal", {"per_kelvin": 1e-6, "lag": LAG}, (0,))
    assert turning[:2] == pytest.approx(3e-5 * pose.j(0)[0], rel=1e-9)
    given = moved(state, "thermal_expansion", {"expansion": 12e-6, "warming": 10.0})
    assert given[:2] == pytest.approx(expected / 3.0, rel=1e-9)


def test_nothing_moves_for_want_of_what_only_a_recording_knows() -> None:
    bare = replace(planar(), held=Conditions())
    for effect, values in (
        ("creep", {"compliance": 1e-5, "time_constant": 60.0}),
        ("frame_drift", {"x": 1e-6, "about_z": 1e-6}),
        ("latency", {"delay": 0.1}),
        ("dynamic_deflection", {"compliance": 1e-5}),
        ("friction_windup", {"windup": 1e-3, "windup_per_load": 1e-3}),
    ):
        assert np.all(moved(bare.state, effect, values) == 0.0), effect
    without = replace(bare, held=Conditions(velocities=planar().held.velocities))
    assert np.all(moved(without.state, "dynamic_deflection", {"compliance": 1e-5}) == 0.0)
