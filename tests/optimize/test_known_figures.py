"""Figures known from outside: the reference arm's optimum, and geometric programs solved by another method."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize

from linkwright.core.optimize.run import optimise
from linkwright.core.sections.numeric import Array
from tests.optimize.builders import PAPER_ARM, problem_of

E, RHO, G, PAYLOAD, REACH, MASS = 71e9, 2700.0, 9.81, 0.77472, 1.240, 26.296
FREE = (
    "subject_to: {mass: '<= 26.296 kg', reach: '== 1240 mm', link_length: [200 mm, 700 mm],"
    " section_size: [10 mm, 300 mm]}\n"
)
FIXED = "subject_to: {mass: '<= 26.296 kg', section_size: [10 mm, 300 mm]}\n"


def sag(diameters: Array, lengths: Array) -> float:
    """Tip deflection (m) of the stretched horizontal arm by the unit-load theorem, integral of M m / EI (exact)."""
    nodes, weights = np.polynomial.legendre.leggauss(4)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    line = RHO * math.pi / 4.0 * diameters**2 * G
    total = 0.0
    for k, diameter in enumerate(diameters):
        rigidity = E * math.pi / 64.0 * diameter**4
        for node, weight in zip(nodes, weights, strict=True):
            x = ends[k] + 0.5 * lengths[k] * (1.0 + node)
            moment = PAYLOAD * G * (ends[-1] - x) + 0.5 * line[k] * (ends[k + 1] - x) ** 2
            moment += sum(
                line[j] * lengths[j] * (0.5 * (ends[j] + ends[j + 1]) - x) for j in range(k + 1, len(lengths))
            )
            total += 0.5 * lengths[k] * weight * moment * (ends[-1] - x) / rigidity
    return total


def mass(diameters: Array, lengths: Array) -> float:
    return float(RHO * math.pi / 4.0 * np.sum(diameters**2 * lengths))


def least_sag(lengths: Array | None) -> float:
    """The least sag (mm) at the allowed mass in logarithms of the dimensions, from random starts."""
    free = lengths is None
    generator = np.random.default_rng(5)

    def split(x: Array) -> tuple[Array, Array]:
        return np.exp(x[:3]), np.exp(x[3:]) if lengths is None else lengths

    rows: list[dict[str, object]] = [{"type": "ineq", "fun": lambda x: math.log(MASS / mass(*split(x)))}]
    bounds = [(math.log(0.01), math.log(0.3))] * 3
    if free:
        rows.append({"type": "eq", "fun": lambda x: math.log(float(np.exp(x[3:]).sum()) / REACH)})
        bounds += [(math.log(0.2), math.log(0.7))] * 3
    results: list[float] = []
    for _ in range(6):
        start = np.log(np.concatenate([generator.uniform(0.03, 0.2, 3), generator.uniform(0.3, 0.5, 3 if free else 0)]))
        result = minimize(
            lambda x: math.log(1e3 * sag(*split(x))),
            start,
            bounds=bounds,
            constraints=rows,
            method="SLSQP",
            options={"ftol": 1e-13, "maxiter": 500},
        )
        if result.success:
            results.append(math.exp(float(result.fun)))
    assert len(results) >= 3
    return min(results)


def test_reference_arm_reaches_the_known_optimum(tmp_path: Path) -> None:
    result = optimise(problem_of(tmp_path, PAPER_ARM, FREE))
    assert 1e3 * result.before.max_error == pytest.approx(0.19026, abs=5e-6)
    assert 1e3 * result.objective == pytest.approx(0.05890, abs=1e-5)
    assert 1e3 * result.objective == pytest.approx(least_sag(None), rel=1e-5)
    assert result.status == "certified"
    assert result.after.mass <= MASS * (1.0 + 1e-6)
    assert result.after.reach == pytest.approx(REACH, rel=1e-9)
    assert all(0.2 - 1e-9 <= link.length <= 0.7 + 1e-9 for link in result.arm.links)


def test_fixed_lengths_are_a_geometric_program(tmp_path: Path) -> None:
    """Convex in the logarithms, so that any method that converges must end at the same figure."""
    result = optimise(problem_of(tmp_path, PAPER_ARM, FIXED))
    assert 1e3 * result.objective == pytest.approx(least_sag(np.array([0.4, 0.42, 0.42])), rel=1e-6)
    assert result.objective >= result.lower_bound * (1.0 - 1e-9)


def test_stepped_cantilever_of_thanedar_and_vanderplaats(tmp_path: Path) -> None:
    """Five segments of 1 m under 50 kN, a sag of at most 27 mm, 140 MPa, height at most 20 widths: 63,108.75 cm^3.

    Thanedar and Vanderplaats, Survey of discrete variable optimization for structural design, J. Struct. Eng. 121
    (1995) 301-306; here a litre weighs a kilogram, and joints that do not turn stand between the segments.
    """
    material = "{elastic_modulus: 200 GPa, poisson_ratio: 0.3, density: 1000 kg/m^3, yield_strength: 140 MPa}"
    segment = (
        "  - joint: {type: revolute, range: [0 deg, 0 deg]}\n    link: {length: 1 m, material: "
        f"{material}, section: {{shape: rectangle, width: 40 mm, height: 600 mm}}}}\n"
    )
    arm = (
        f"gravity: [0 m/s^2, 0 m/s^2, 0 m/s^2]\nchain:\n{5 * segment}payload: {{force: [0 N, -50 kN, 0 N]}}\n"
        "leave_out: [shear_deformation]\n"
    )
    limits = "max_error: '<= 27 mm', safety_factor: '>= 1', aspect: '<= 20', section_size: [10 mm, 800 mm]"
    result = optimise(problem_of(tmp_path, arm, f"minimize: mass\nsubject_to: {{{limits}}}\n"))
    assert 1e3 * result.objective == pytest.approx(63108.75, rel=1e-5)
    widths = [1e2 * link.section.given()["width"] for link in result.arm.links if link.section is not None]
    assert widths == pytest.approx([3.06, 2.81, 2.52, 2.20, 1.75], abs=0.006)
