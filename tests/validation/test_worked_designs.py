"""The worked designs of examples/worked against what was published, and against beams by hand."""

import math
from pathlib import Path

import pytest

import linkwright as lw

WORKED = Path(__file__).resolve().parents[2] / "examples" / "worked"


def test_the_cantilever_is_lighter_than_the_published_one():
    """0.0798 kg are published (B. Bokser, 2023). By hand the lightest tube has the thinnest wall, and the radius of its
    middle at which F L^3 / (3 E pi r^3 t) and F L / (G A_s) are 1 mm."""
    problem = lw.read_problem(WORKED / "cantilever" / "problem.yaml")
    published = lw.evaluate(problem.arm)
    assert published.mass_kg == pytest.approx(0.0798, rel=0.006)
    best = lw.optimize(problem)
    force, length, wall, modulus, ratio = 30 * 9.80665, 0.3, 0.4064e-3, 70e9, 0.33
    radius, step = 0.02, 0.02
    for _ in range(40):
        bent = force * length**3 / (3 * modulus * math.pi * radius**3 * wall)
        sheared = force * length / (0.5 * modulus / 2 / (1 + ratio) * 2 * math.pi * radius * wall)
        radius, step = radius + (step if bent + sheared > 1e-3 else -step), 0.6 * step
    by_hand = 2710 * length * 2 * math.pi * radius * wall
    assert best.mass_kg == pytest.approx(by_hand, rel=0.01)
    assert best.mass_kg == pytest.approx(0.0661, abs=5e-5)
    assert {limit.name for limit in best.found.binding} == {"max_error", "thickness"}


def test_the_gantry_sags_as_its_beams_do():
    """In the middle, the ram drawn in: P L^3 / (48 E I) on two beams, 5 w L^4 / (384 E I) of each, and their shear."""
    arm = lw.read_arm(WORKED / "gantry" / "arm.yaml")
    assert lw.evaluate(arm).max_error_mm == pytest.approx(0.0691, abs=1e-4)
    for joint in (1, 2):
        arm = arm.replace(f"chain[{joint}].joint.clearance", None)
    arm = arm.replace("leave_out", ["axial"])
    (sag,) = lw.evaluate(arm, pose=["700 mm", "0 mm"]).at_poses["error_mm"]
    metal = lw.materials["aluminium-6061-t6"].at()
    width, height, wall, length = 0.08, 0.12, 0.004, 1.6
    area = width * height - (width - 2 * wall) * (height - 2 * wall)
    second = (width * height**3 - (width - 2 * wall) * (height - 2 * wall) ** 3) / 12
    ram = metal.density * (0.06**2 - 0.052**2) * 0.4
    load, weight = (8 + 4 + 5 + ram) * 9.81, metal.density * area * 9.81
    bent = load * length**3 / 96 / (metal.elastic_modulus * second)
    bent += 5 * weight * length**4 / 384 / (metal.elastic_modulus * second)
    webs = metal.elastic_modulus / 2 / (1 + metal.poisson_ratio) * 2 * wall * height
    sheared = load * length / 8 / webs + weight * length**2 / 8 / webs
    assert sag == pytest.approx(1e3 * (bent + sheared), rel=0.01)
