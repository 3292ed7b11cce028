"""The pose of least first frequency: derivatives of an eigenvalue, and climbs that no scan goes below."""

from __future__ import annotations

import math

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.figures.frequency import Slowness, least_frequency
from linkwright.core.arm.limits.modes import first_frequencies
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import build
from linkwright.core.sections.numeric import Array

STEEL = load_catalogue(user=False).find("steel-s355")
TUBE = build("tube", {"diameter": 0.08, "thickness": 0.004})
FLAT = build("rectangle", {"width": 0.03, "height": 0.09})
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def tangled(slide: bool) -> Arm:
    """Axes all over space, flat sections, one rigid link, drives that give; the third joint may slide."""
    third = Joint("prismatic", X, (0.1, 0.4), stiffness=3e5) if slide else Joint(axis=X, stiffness=2e4)
    joints = (
        Joint(axis=Y, range=(-1.0, 2.0), stiffness=6e4, mass=4.0),
        Joint(axis=Z, stiffness=4e4, mass=3.0),
        third,
        Joint(axis=Y, range=(-2.0, 2.5), mass=1.0),
    )
    sections = (TUBE, FLAT, None, FLAT)
    links = tuple(
        Link(length, section=section, material=None if section is None else STEEL, mass=2.0)
        for length, section in zip((0.5, 0.6, 0.3, 0.4), sections, strict=True)
    )
    return Arm("tangled", joints, links, gravity=(0.0, 0.0, -9.81))


def eigenvalues(arm: Arm, q: Array) -> Array:
    return (2.0 * math.pi * first_frequencies(arm, beams_of(arm), 3.0, q)) ** -2.0


@pytest.mark.parametrize("slide", [False, True])
def test_gradient_with_the_mode_held_is_that_of_the_eigenvalue(slide: bool) -> None:
    arm = tangled(slide)
    q = np.random.default_rng(3).uniform(-0.8, 0.8, (5, 4))
    value, gradient, hessian = Slowness(arm, beams_of(arm), (3.0,)).derivatives(q)
    assert value == pytest.approx(eigenvalues(arm, q), rel=1e-12)
    step = 2e-3
    for j in range(4):
        ahead, behind = q.copy(), q.copy()
        ahead[:, j] += step
        behind[:, j] -= step
        up, down = eigenvalues(arm, ahead), eigenvalues(arm, behind)
        size = float(np.abs(gradient).max())
        assert gradient[:, j] == pytest.approx((up - down) / (2.0 * step), rel=1e-4, abs=1e-4 * size)
        curved = (up + down - 2.0 * value) / step**2
        assert hessian[:, j, j] == pytest.approx(curved, rel=2e-3, abs=2e-3 * float(np.abs(hessian).max()))


@pytest.mark.parametrize("slide", [False, True])
def test_estimates_are_lower_bounds_and_near(slide: bool) -> None:
    arm = tangled(slide)
    q = np.random.default_rng(4).uniform(-1.0, 1.0, (40, 4))
    exact, result = eigenvalues(arm, q), Slowness(arm, beams_of(arm), (3.0,)).estimates(q)
    assert np.all(result <= exact * (1.0 + 1e-9))
    assert result == pytest.approx(exact, rel=1e-2)


@pytest.mark.parametrize("slide", [False, True])
def test_no_pose_of_a_scan_is_slower(slide: bool) -> None:
    arm = tangled(slide)
    cases = (LoadCase(mass=3.0), LoadCase(mass=0.5))
    search, p = WorstSearch(error_model(arm, cases), Workspace()), beam_values(beams_of(arm, cases))
    result = least_frequency(arm, search, beams_of(arm), p, cases)
    assert result is not None
    assert result.load_case == 0
    assert np.all((np.array(result.q) >= search.lower) & (np.array(result.q) <= search.upper))
    assert first_frequencies(arm, beams_of(arm), 3.0, np.array([result.q]))[0] == pytest.approx(result.value, rel=1e-12)
    q = np.random.default_rng(5).uniform(search.lower, search.upper, (800, 4))
    q = np.vstack([q, np.clip(result.q + 0.05 * (q[:300] - q[300:600]), search.lower, search.upper)])
    assert first_frequencies(arm, beams_of(arm), 3.0, q).min() >= result.value * (1.0 - 1e-9)


def test_a_planar_arm_is_slowest_stretched_out() -> None:
    """Two alike links in the plane: stretched, all masses are as far from the drive as they get."""
    joints = (Joint(stiffness=1e4, mass=2.0), Joint(stiffness=1e4, mass=2.0))
    arm = Arm("two", joints, tuple(Link(0.5, mass=3.0, section=TUBE, material=STEEL) for _ in range(2)))
    search, p = WorstSearch(error_model(arm), Workspace()), beam_values(beams_of(arm))
    result = least_frequency(arm, search, beams_of(arm), p, (arm.payload,))
    assert result is not None
    straight = first_frequencies(arm, beams_of(arm), 0.0, np.zeros((1, 2)))[0]
    assert result.value == pytest.approx(straight, rel=1e-9)
    assert math.remainder(result.q[1], 2.0 * math.pi) == pytest.approx(0.0, abs=1e-5)
