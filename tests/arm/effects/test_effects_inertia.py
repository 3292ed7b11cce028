"""The inertia of a moving arm: the textbook's two links, and Lagrange's equations for any chain."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linkwright.core.arm.chain.beam import Beam, Taper
from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.chain.conditions import Conditions
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.effects.loads.dynamic_deflection import inertial_loads
from linkwright.core.sections.numeric import Array
from tests.arm.effects.effect_states import ROWS, Posed, moved, planar, spatial


@given(st.integers(0, 10**6))
@settings(max_examples=30, deadline=None)
def test_two_turning_links_are_the_textbooks(seed: int) -> None:
    """The planar 2R arm of Spong, Hutchinson & Vidyasagar, Robot Modeling and Control (Wiley, 2006), section 7.4.

    Rods: centre of mass halfway, I = m l^2/12; a point mass at the elbow and one at the tip are added to it.
    """
    rng = np.random.default_rng(seed)
    l1, l2 = rng.uniform(0.2, 1.0, 2)
    m1, m2, elbow, tip = rng.uniform(0.5, 9.0, 4)
    q, v, a = rng.uniform(-3.0, 3.0, (3, 2))
    c2, s2 = np.cos(q[1]), np.sin(q[1])
    i1, i2 = m1 * l1**2 / 12.0, m2 * l2**2 / 12.0
    m11 = m1 * l1**2 / 4 + i1 + m2 * (l1**2 + l2**2 / 4 + l1 * l2 * c2) + i2
    m11 += elbow * l1**2 + tip * (l1**2 + l2**2 + 2 * l1 * l2 * c2)
    m12 = m2 * (l2**2 / 4 + 0.5 * l1 * l2 * c2) + i2 + tip * (l2**2 + l1 * l2 * c2)
    m22 = m2 * l2**2 / 4 + i2 + tip * l2**2
    h = -(0.5 * m2 + tip) * l1 * l2 * s2
    torque = np.array(
        [
            m11 * a[0] + m12 * a[1] + h * (2.0 * v[0] * v[1] + v[1] ** 2),
            m12 * a[0] + m22 * a[1] - h * v[0] ** 2,
        ]
    )
    arm = Arm("2R", (Joint(), Joint(mass=elbow)), (Link(l1), Link(l2)), payload=LoadCase(tip))
    beams = (Beam(l1, mass_per_length=m1 / l1), Beam(l2, mass_per_length=m2 / l2))
    held = Conditions(velocities=tuple(v.tolist()), accelerations=tuple(a.tolist()))
    state = solve(arm, q.tolist(), beams, conditions=held)
    assert np.array(inertial_loads(state, tuple(v), tuple(a))) == pytest.approx(-torque, rel=1e-9, abs=1e-9)
    p = np.array(state.tip())
    o2 = np.array([l1 * np.cos(q[0]), l1 * np.sin(q[0]), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    expected = -3e-6 * (torque[0] * np.cross(up, p) + torque[1] * np.cross(up, p - o2))
    assert moved(state, "dynamic_deflection", {"compliance": 3e-6}) == pytest.approx(expected, rel=1e-9, abs=1e-14)


GAUSS = [(0.5 * (1.0 + x), 0.5 * w) for x, w in zip(*np.polynomial.legendre.leggauss(3), strict=True)]


def heavy_at_the_joint(share: float, beam: Beam) -> float:
    """A tapered link's mass per length over its mean: 1.5 at its joint, 0.5 at its end."""
    return 1.5 - share if beam.taper.density else 1.0


TAPER = Taper(balance=5.0 / 12.0, density=(1.5, 1.25, 1.0, 0.75, 0.5))
"""That law's centre of mass, (integral of s (1.5 - s)) = 3/4 - 1/3, and its values at the quarters."""


def lagrange(posed: Posed, row: int) -> Array:
    """d/dt dT/dq' - dT/dq by differentiating the kinetic energy of the arm's places (Gauss along rods: exact)."""
    arm = posed.arm
    q, v, a = (ca.SX.sym(name, arm.size) for name in "qva")
    frames = place(arm, [q[i] for i in range(arm.size)], [beam.length for beam in posed.beams])
    energy, at = 0.0, ca.SX.zeros(3)

    def of(mass: float, point: ca.SX) -> ca.SX:
        speed = ca.jtimes(point, q, v)
        return 0.5 * mass * ca.dot(speed, speed)

    for index, (frame, link, beam) in enumerate(zip(frames.joints, frames.links, posed.beams, strict=True)):
        at = at + ca.vertcat(*frame.lead)
        mass, vector = float(beam.mass_per_length) * float(beam.length), ca.vertcat(*link.vector)
        energy += of(arm.joints[index].mass, at)
        for share, weight in GAUSS:
            energy += of(weight * heavy_at_the_joint(share, beam) * mass, at + share * vector)
        energy += of(float(beam.lumped_mass), at + float(beam.lumped_at) * ca.vertcat(*link.along))
        at = at + vector
    energy += of(arm.payload.mass, at + ca.vertcat(*frames.tool))
    momentum = ca.gradient(energy, v)
    torque = ca.jtimes(momentum, q, v) + ca.jtimes(momentum, v, a) - ca.gradient(energy, q)
    held = posed.held
    assert held.velocities is not None
    assert held.accelerations is not None
    values = [np.array([item[row] for item in column]) for column in (held.velocities, held.accelerations)]
    return np.array(ca.Function("t", [q, v, a], [torque])(posed.q[row], *values)).ravel()


@pytest.mark.parametrize(
    "posed",
    [planar(2), planar(3, absolute=True), spatial(3), spatial(4, slide=False)],
    ids=["plane", "absolute", "slide", "space"],
)
def test_inertia_is_lagranges(posed: Posed) -> None:
    beams = (
        posed.beams[0],
        replace(posed.beams[1], taper=TAPER),
        *posed.beams[2:-1],
        replace(posed.beams[-1], lumped_mass=3.0, lumped_at=0.1),
    )
    posed = replace(posed, beams=beams)
    held = posed.held
    assert held.velocities is not None
    assert held.accelerations is not None
    result = np.stack(
        [np.broadcast_to(load, ROWS) for load in inertial_loads(posed.state, held.velocities, held.accelerations)],
        axis=1,
    )
    expected = np.stack([-lagrange(posed, row) for row in range(ROWS)])
    assert result == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_an_arm_at_rest_has_no_inertia() -> None:
    posed = planar()
    still = tuple(np.zeros(ROWS) for _ in range(3))
    resting = replace(posed, held=replace(posed.held, velocities=still, accelerations=still))
    assert np.all(moved(resting.state, "dynamic_deflection", {"compliance": 1e-4}) == 0.0)
