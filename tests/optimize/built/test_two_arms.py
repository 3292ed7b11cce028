"""A torso and two arms designed for the worst error of either tip, against all designs of a grid."""

import itertools
import math

import numpy as np
import pytest

import linkwright as lw
from linkwright.core.arm.chain.chain import LoadCase
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.tip import active_effects, tip_error
from linkwright.core.units.quantities import InputError

DENSITY = (7850.0, 7850.0, 2700.0)
ARM = """
name: two arms
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {axis: y, range: [-20 deg, 20 deg], stiffness: 200 kN*m/rad}
    link: {length: 500 mm, direction: [0, 0, 1], section: {shape: circle, diameter: 60 mm}, material: steel-s355}
branches:
  - name: left
    origin: {xyz: [0 m, 0.2 m, 0 m]}
    payload: {mass: 8 kg}
    chain:
      - joint: {axis: y, range: [-60 deg, 60 deg], stiffness: 60 kN*m/rad}
        link: {length: 500 mm, section: {shape: circle, diameter: 40 mm}, material: steel-s355}
  - name: right
    origin: {xyz: [0 m, -0.2 m, 0 m]}
    payload: {mass: 3 kg}
    chain:
      - joint: {axis: y, range: [-60 deg, 60 deg], stiffness: 60 kN*m/rad}
        link: {length: 400 mm, section: {shape: circle, diameter: 30 mm}, material: aluminium-6061-t6}
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(ARM)
    return path


def errors(arm, cases, points=7) -> float:
    """The worst error (m) over a grid of poses and both tips, each pose by itself: no search, no exchange."""
    grid = np.array(list(itertools.product(*(np.linspace(*joint.range, points) for joint in arm.joints))))
    worst = 0.0
    for case in cases:
        state = solve(arm, list(grid.T), beams_of(arm, cases), case)
        vector = tip_error(state, active_effects(arm)).vector
        worst = max(worst, float(np.linalg.norm(np.broadcast_arrays(*vector), axis=0).max()))
    return worst


def test_no_design_of_a_grid_is_better_for_both_tips(file):
    mass = 17.0
    problem = lw.Problem(lw.read_arm(file), subject_to={"mass": f"<= {mass} kg", "section_size": ["10 mm", "120 mm"]})
    best = lw.optimize(problem).found
    assert best.status in ("certified", "converged")
    assert not best.doubts
    # What was found is what an evaluation of the written design has, with both tips.
    again = lw.evaluate(lw.Arm.of(best.arm))
    assert best.objective == pytest.approx(1e-3 * again.max_error_mm, rel=1e-9)
    assert best.objective <= best.before.max_error
    assert best.after.mass <= mass * (1.0 + 1e-6)
    # Both tips hold it: a better left arm would be a worse right one.
    held = {pose.load_case for pose in best.after.worst.poses if pose.error > 0.999 * best.objective}
    assert held == {0, 1}
    given, least = lw.read_arm(file), math.inf
    lengths = (0.5, 0.5, 0.4)
    for torso, left in itertools.product(np.linspace(0.045, 0.062, 9), np.linspace(0.025, 0.06, 9)):
        rest = mass - sum(
            d * length * math.pi * x**2 / 4.0 for d, length, x in zip(DENSITY, lengths, (torso, left), strict=False)
        )
        if rest <= 0.0:
            continue
        right = min(math.sqrt(4.0 * rest / (math.pi * DENSITY[2] * lengths[2])), 0.12)
        made = given
        for key, size in zip(
            ("chain[1]", "branches[1].chain[1]", "branches[2].chain[1]"), (torso, left, right), strict=True
        ):
            made = made.replace(f"{key}.link.section.diameter", size)
        least = min(least, errors(made.model, made.model.cases))
    assert best.objective <= least * (1.0 + 1e-4)
    assert errors(best.arm, best.arm.cases, 25) == pytest.approx(best.objective, rel=1e-3)


@pytest.mark.slow
def test_limits_of_both_arms(file):
    """First frequency, tip stiffness and strength are those of the whole; a lightest design just keeps them."""
    limits = {
        "max_error": "<= 1.2 mm",
        "first_frequency": ">= 13 Hz",
        "tip_stiffness": ">= 60 N/mm",
        "safety_factor": ">= 2",
    }
    cases = [{"payload": {"mass": "6 kg"}}, {"tip": "left", "payload": {"mass": "9 kg"}}]
    problem = lw.Problem(lw.read_arm(file), minimize="mass", load_cases=cases, subject_to=limits)
    assert [(case.tip, case.mass) for case in problem.model.load_cases] == [
        ("left", 6.0),
        ("right", 6.0),
        ("left", 9.0),
    ]
    best = lw.optimize(problem).found
    assert not best.doubts
    after = best.after
    assert after.max_error <= 1.2e-3 * 1.0001
    assert after.frequency.value >= 13.0 * 0.9999
    assert after.stiffness.value >= 60e3 * 0.9999
    assert after.strength.least_safety_factor >= 2.0 * 0.9999
    kept = (after.max_error / 1.2e-3, 13.0 / after.frequency.value, 60e3 / after.stiffness.value)
    assert max(kept) == pytest.approx(1.0, abs=1e-3)
    # The heaviest case: 6 kg right, and left what the arm file gives it.
    assert after.total_mass - after.mass == pytest.approx(14.0)


@pytest.mark.slow
def test_every_design_of_a_front_is_the_worse_of_both_tips(file):
    """A point errs as an evaluation of its arm at either tip, nowhere more over a grid of poses, weighs what its
    bars do, and none is beaten by another."""
    limits = {"mass": "<= 24 kg", "max_error": "<= 3 mm", "section_size": ["10 mm", "120 mm"]}
    problem = lw.Problem(lw.read_arm(file), subject_to=limits)
    front = lw.tradeoff(problem, accuracy=0.5)
    designs = sorted(front.designs, key=lambda design: design.values["mass"])
    assert len(designs) >= 3
    for item in (designs[0], designs[len(designs) // 2], designs[-1]):
        model = item.arm.model
        tips = [lw.evaluate(lw.Arm.of(model.on(tip))).max_error_mm for tip in ("left", "right")]
        assert item.values["max_error"] == pytest.approx(1e-3 * max(tips), rel=1e-4)
        assert errors(model, model.cases) <= item.values["max_error"] * (1.0 + 1e-6)
        own = [
            density * math.pi * link.section.diameter**2 / 4.0 * link.length
            for density, link in zip(DENSITY, model.links, strict=True)
        ]
        assert item.values["mass"] == pytest.approx(sum(own), rel=1e-6)
    results = [(design.values["mass"], design.values["max_error"]) for design in designs]
    assert all(one[1] > other[1] for one, other in itertools.pairwise(results))


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"subject_to": {"reach": "<= 2 m"}}, "reach: is of one tip, and the arm has several; bound the lengths"),
        (
            {"workspace": {"path": [["1 m", "0 m", "0 m"]]}},
            "path: is of one tip, and the arm has several; use the joint",
        ),
        ({"load_cases": [{"tip": "lefd"}]}, "no tip 'lefd', but left, right; did you mean 'left'"),
    ],
)
def test_what_cannot_be_asked_of_two_tips(file, keys, said):
    with pytest.raises(InputError, match=said):
        lw.Problem(lw.read_arm(file), **keys)


def test_a_case_names_a_tip_of_branches_alone():
    with pytest.raises(InputError, match="this one has a single tip"):
        lw.Problem("examples/welding-arm/arm.yaml", load_cases=[{"tip": "left"}])
    assert LoadCase().tip == ""
