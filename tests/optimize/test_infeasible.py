"""What each limit would have to be, held against formulas; bounds that no design can be better than."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import linkwright as lw
from linkwright.command_line import outcome
from linkwright.core.optimize.choice.chooser import Chooser
from linkwright.core.optimize.choice.combinations import combinations
from linkwright.core.optimize.choice.large_choice import possible
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.infeasible.answer import Infeasibility
from linkwright.core.optimize.infeasible.needed import explained
from linkwright.core.optimize.infeasible.quick import out_of_reach
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import SHAPES
from linkwright.core.units.quantities import NoAnswer
from tests.optimize.builders import problem_of

E, RHO, GRAVITY = 70e9, 2700.0, 9.81
LENGTH, PAYLOAD, STIFFNESS = 0.5, 4.0, 20e3
BAR = (
    "chain:\n  - joint: {type: revolute, range: [-30 deg, 30 deg]%s}\n"
    "    link: {length: 500 mm, section: {shape: circle, diameter: 40 mm},\n"
    "      material: {elastic_modulus: 70 GPa, density: 2700 kg/m^3, poisson_ratio: 0.3, yield_strength: 200 MPa}}\n"
    "payload: {mass: 4 kg}\nleave_out: [shear_deformation]\n"
)
SIZES = "section_size: [5 mm, 200 mm]"


def explain(folder: Path, problem: str, joint: str = "") -> Infeasibility:
    with pytest.raises(NoAnswer) as caught:
        optimise(problem_of(folder, BAR % joint, problem))
    assert isinstance(caught.value.infeasible, Infeasibility)
    assert caught.value.infeasible.text in str(caught.value)
    return caught.value.infeasible


def bar_mass(diameter: float) -> float:
    return RHO * math.pi * diameter**2 / 4.0 * LENGTH


def sag(diameter: float) -> float:
    """A cantilever's sag under a weight at its end and its own: P L^3 / 3 E I + q L^4 / 8 E I."""
    flexural = E * math.pi * diameter**4 / 64.0
    weight = bar_mass(diameter) * GRAVITY
    return PAYLOAD * GRAVITY * LENGTH**3 / (3.0 * flexural) + weight * LENGTH**3 / (8.0 * flexural)


def test_each_limit_alone_is_what_the_formulas_say(tmp_path: Path) -> None:
    asked_mass, asked_error = 0.5, 0.1e-3
    result = explain(tmp_path, f"minimize: mass\nsubject_to: {{mass: '<= 0.5 kg', max_error: '<= 0.1 mm', {SIZES}}}\n")
    needed = {limit.limit.name: limit.needed for limit in result.limits}
    stiff = brentq(lambda d: sag(d) - asked_error, 0.005, 0.2)
    light = brentq(lambda d: bar_mass(d) - asked_mass, 0.005, 0.2)
    assert needed["mass"] == pytest.approx(bar_mass(stiff), rel=1e-3)
    assert needed["max_error"] == pytest.approx(sag(light), rel=1e-3)
    # No looser than it has to be, and no tighter than a design can be.
    assert needed["mass"] >= bar_mass(stiff)
    assert needed["max_error"] >= sag(light)
    assert result.verdict == "infeasible"
    # The sag is about one over the mass squared, so that the least sum of logarithms gives way in mass alone.
    assert [item.limit.name for item in result.joint] == ["mass"]
    assert result.joint_sum == pytest.approx(math.log(bar_mass(stiff) / asked_mass), rel=1e-3)


def test_frequency_is_bounded_by_the_joint_alone(tmp_path: Path) -> None:
    """Rigid and weightless, a link on a spring with a mass at its end has sqrt(k / m L^2) / 2 pi."""
    limit = math.sqrt(STIFFNESS / (PAYLOAD * LENGTH**2)) / (2.0 * math.pi)
    problem = f"minimize: mass\nsubject_to: {{first_frequency: '>= 100 Hz', mass: '<= 9 kg', {SIZES}}}\n"
    result = explain(tmp_path, problem, ", stiffness: 20 kN*m/rad")
    assert [item.limit.name for item in result.out_of_reach] == ["first_frequency"]
    assert result.out_of_reach[0].best == pytest.approx(limit, rel=1e-6)
    assert "rigid, weightless links" in result.text
    # Whatever the mass may be, the frequency stays out of reach; by itself it has to be below the bound.
    needed = {item.limit.name: item for item in result.limits}
    assert needed["mass"].needed is None
    assert needed["mass"].outcome == "none"
    assert needed["first_frequency"].needed is not None
    assert 0.5 * limit < needed["first_frequency"].needed < limit


def test_error_of_the_drive_alone_is_a_bound(tmp_path: Path) -> None:
    """A weight at the end of a rigid link turns its drive by m g L / k: the tip moves by that times L."""
    result = explain(
        tmp_path, f"minimize: mass\nsubject_to: {{max_error: '<= 0.1 mm', {SIZES}}}\n", ", stiffness: 20 kN*m/rad"
    )
    assert result.out_of_reach[0].best == pytest.approx(PAYLOAD * GRAVITY * LENGTH**2 / STIFFNESS, rel=1e-6)


def test_a_sum_would_have_to_be_what_the_smallest_section_weighs(tmp_path: Path) -> None:
    result = explain(tmp_path, "subject_to: {mass: '<= 0.01 kg', section_size: [20 mm, 60 mm]}\n")
    assert result.limits[0].needed == pytest.approx(bar_mass(0.02), rel=1e-3)


@pytest.mark.parametrize("shape", [name for name, kind in SHAPES.items() if kind.variables])
def test_no_section_is_beyond_the_extremes_that_bounds_rest_on(shape: str) -> None:
    kind, ranges = SHAPES[shape], ((0.02, 0.14), (0.002, 0.01))
    least, most = (kind.start(area, *ranges).properties(0.3) for area in (1e-12, 1e3))
    bounds = kind.variable_bounds(*ranges)
    met = 0
    for shares in np.random.default_rng(5).beta(0.4, 0.4, (400, len(bounds))):
        section = kind.from_variables([low * (high / low) ** x for x, (low, high) in zip(shares, bounds, strict=True)])
        rows = (*section.constraints(), *section.bound_constraints(*ranges))
        with np.errstate(invalid="ignore"):
            if any(not float(row.value) <= 0.0 for row in rows) or section.check():
                continue
        met += 1
        own = section.properties(0.3)
        assert own.area >= least.area * (1.0 - 1e-9)
        for name in ("area", "second_moment_y", "second_moment_z", "torsion_constant"):
            assert getattr(own, name) <= getattr(most, name) * (1.0 + 1e-9)
    assert met > 20


def test_bounds_leave_what_can_be_kept(tmp_path: Path) -> None:
    """What a design does is no worse than what the bounds allow it."""
    text = f"minimize: mass\nsubject_to: {{max_error: '<= 1 mm', first_frequency: '>= 12 Hz', {SIZES}}}\n"
    problem = problem_of(tmp_path, BAR % ", stiffness: 20 kN*m/rad", text)
    assert out_of_reach(problem) == ()
    assert optimise(problem).status in ("certified", "converged")


@pytest.mark.parametrize("given", ["steel-s355", "invar-36"])
def test_bounds_let_a_material_grow_by_its_own_coefficient(given: str, tmp_path: Path) -> None:
    """A metre warmed by 30 K: steel by 12e-6 1/K grows 0.36 mm, which 0.2 mm forbids; invar, of 1.6e-6, does not."""
    arm = (
        "chain:\n  - joint: {type: revolute}\n"
        f"    link: {{length: 1 m, section: {{shape: circle, diameter: 80 mm}}, material: {given}}}\n"
        "payload: {mass: 2 kg}\ntemperature: 50 degC\neffects: [{effect: thermal_expansion}]\n"
    )
    limits = "minimize: mass\nsubject_to: {max_error: '<= 0.2 mm', section_size: [10 mm, 150 mm]}\n"
    problem = problem_of(tmp_path, arm, f"{limits}choose: {{material: [steel-s355, invar-36]}}\n")
    assert out_of_reach(problem) == ()
    assert optimise(problem).arm.links[0].material.name == "invar-36"
    steel = problem_of(tmp_path, arm, f"{limits}choose: {{material: [steel-s355]}}\n")
    (beyond,) = out_of_reach(steel)
    assert beyond.best == pytest.approx(0.36e-3, rel=1e-6)


def test_materials_that_grow_either_way_bound_nothing(tmp_path: Path) -> None:
    """Of one that grows and one that shrinks a design may make what cancels another error."""
    metal = "{elastic_modulus: 70 GPa, density: 2700 kg/m^3, poisson_ratio: 0.3, yield_strength: 200 MPa, %s}"
    shrinks, grows = (metal % f"thermal_expansion: {item}e-6 1/K" for item in (-9, 12))
    arm = (
        "chain:\n  - joint: {type: revolute, range: [-30 deg, 30 deg]}\n"
        f"    link: {{length: 1 m, section: {{shape: circle, diameter: 80 mm}}, material: {grows}}}\n"
        "payload: {mass: 2 kg}\ntemperature: 50 degC\neffects: [{effect: thermal_expansion},\n"
        "  {effect: link_length, at: 1, length: -0.3 mm}]\n"
    )
    for stuffs, count in ((f"[{grows}]", 0), (f"[{shrinks}]", 1), (f"[{grows}, {shrinks}]", 0)):
        text = f"minimize: mass\nsubject_to: {{max_error: '<= 0.1 mm', {SIZES}}}\nchoose: {{material: {stuffs}}}\n"
        assert len(out_of_reach(problem_of(tmp_path, arm, text))) == count


def test_a_failure_of_the_solver_is_said_as_such(tmp_path: Path) -> None:
    text = f"subject_to: {{mass: '<= 0.5 kg', safety_factor: '>= 40', {SIZES}}}\n"
    context = context_of(problem_of(tmp_path, BAR % "", text))
    assert explained(context).verdict == "infeasible"
    result = explained(context, unsolved=1)
    assert result.verdict == "undecided"
    assert result.text.startswith("could not be decided: the solver failed on 1 of 1 combinations")


def test_one_relaxation_rules_out_others(tmp_path: Path) -> None:
    """What is ruled out at once is what every combination on its own is found to be."""
    text = (
        f"subject_to: {{mass: '<= 0.35 kg', safety_factor: '>= 20', {SIZES}, thickness: [2 mm, 10 mm]}}\n"
        "choose: {section: [circle, tube, rectangle], material: [aluminium-6061-t6, steel-s355]}\n"
    )
    problem = problem_of(tmp_path, BAR % "", text)
    picks = combinations(problem)
    left = possible(Chooser(context_of(problem), None, None), picks)
    alone = Chooser(context_of(problem), None, None)
    solved = [pick for pick in picks if alone.solve(pick).objective is not None]
    assert set(solved) <= set(left)
    assert len(left) < len(picks)


def test_command_says_why_and_writes_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    problem_of(
        tmp_path, BAR % "", f"minimize: mass\nsubject_to: {{mass: '<= 0.5 kg', max_error: '<= 0.1 mm', {SIZES}}}\n"
    )
    target = tmp_path / "out.json"
    assert outcome(["optimize", str(tmp_path / "problem.yaml"), "--json", str(target)]) == 1
    captured = capsys.readouterr()
    assert captured.err.count("\n") == 1
    assert "would have to be" in captured.err
    assert "in the smallest change, together" in captured.out
    content = json.loads(target.read_text(encoding="utf-8"))
    assert content["status"] == "infeasible"
    entries = content["infeasible"]["limits"]
    assert [item["name"] for item in entries] == ["max_error", "mass"]
    entry = entries[0]
    assert entry["asked"] == pytest.approx(0.1)
    assert entry["needed"] > 0.1
    assert entry["unit"] == "mm"
    assert "combination" in entry["rests_on"]
    assert content["infeasible"]["joint_change"]
    with pytest.raises(lw.NoAnswer) as caught:
        lw.optimize(lw.read_problem(tmp_path / "problem.yaml"))
    assert caught.value.infeasible.limits[0].needed == pytest.approx(1e-3 * entry["needed"])
