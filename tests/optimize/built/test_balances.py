"""Counterweights, counterbalances and motors' places that are chosen: against closed forms, and arms by hand."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from scipy.optimize import minimize_scalar

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.infeasible.quick import out_of_reach
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.tradeoff.question import question
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import problem_of

E, RHO, G, LENGTH, STIFFNESS, PAYLOAD = 71e9, 2700.0, 9.81, 0.8, 50e3, 3.0
METAL = "{elastic_modulus: 71 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3, yield_strength: 200 MPa, cost: 4 EUR/kg}"
SPRING = "balancer: {stiffness: 0.5 N/mm, on_link: 100 mm, on_base: 300 mm, base_at: 90 deg}"
SIZES = "section_size: [5 mm, 300 mm]"


def lifting(folder: Path, choose: str, limits: str, *, joint: str = "", link: str = "") -> Problem:
    """One link on a drive that gives; only bending and the drive count."""
    arm = (
        f"chain:\n  - joint: {{type: revolute, range: [-50 deg, 50 deg], stiffness: 50 kN*m/rad{joint}}}\n"
        f"    link: {{length: 800 mm, section: {{shape: circle, diameter: 60 mm}}, material: {METAL}{link}}}\n"
        f"payload: {{mass: {PAYLOAD} kg}}\nleave_out: [shear_deformation, axial]\n"
    )
    return problem_of(folder, arm, f"choose: {{{choose}}}\nsubject_to: {{mass: '<= 6 kg', {SIZES}{limits}}}\n")


def sag(mass: float, balance: float) -> float:
    """The tip's drop (m) with the link level: F L^3/(3 E I) + w L^4/(8 E I), and the drive's turn, less a torque."""
    area = mass / (RHO * LENGTH)
    second = area**2 / (4.0 * math.pi)
    bent = G * (PAYLOAD * LENGTH**3 / 3.0 + mass * LENGTH**3 / 8.0) / (E * second)
    return bent + LENGTH * (G * LENGTH * (PAYLOAD + 0.5 * mass) - balance) / STIFFNESS


def least_sag(balance: float) -> float:
    """With the mass that is best: a heavier link bends less and loads its drive more."""

    def of_mass(mass: float) -> float:
        return sag(float(mass), balance)

    result: Any = minimize_scalar(of_mass, bounds=(0.5, 6.0), method="bounded")
    return float(result.fun)


def test_the_torque_of_a_balancer(tmp_path: Path) -> None:
    problem = lifting(tmp_path, "balancer: [{joint: 1, torque: [0 N*m, 30 N*m]}]", "")
    result = optimise(problem)
    assert result.after.max_error == pytest.approx(least_sag(30.0), rel=1e-5)
    assert result.balance[0].value == pytest.approx(30.0, rel=1e-6)
    assert result.balance[0].bound == "greatest"
    (price,) = (item for item in result.binding if item.name == "balancer")
    slope = (least_sag(30.1) - least_sag(29.9)) / 0.2
    assert price.unit == "N*m"
    assert price.price == pytest.approx(1e3 * slope, rel=1e-3)
    assert result.status == "certified"
    assert result.optimum == "local"


@pytest.mark.slow
def test_a_balancer_that_could_do_too_much(tmp_path: Path) -> None:
    """The torque that lifts the tip by as much as the link bends leaves nothing at any pose."""
    result = optimise(lifting(tmp_path, "balancer: [{joint: 1, torque: [0 N*m, 300 N*m]}]", ""))
    assert result.after.mass is not None
    balanced = G * LENGTH * (PAYLOAD + 0.5 * result.after.mass)
    turn = STIFFNESS * sag(result.after.mass, balanced) / LENGTH
    assert result.balance[0].value == pytest.approx(balanced + turn, rel=1e-3)
    assert result.after.max_error < 1e-3 * sag(6.0, 0.0)
    assert not result.doubts


def test_the_stiffness_of_a_spring(tmp_path: Path) -> None:
    """Of no length of its own and held above the joint, it pulls with k a b cos q."""
    text = "balancer: [{joint: 1, stiffness: [0 N/mm, 1.2 N/mm]}]"
    result = optimise(lifting(tmp_path, text, "", joint=f", {SPRING}"))
    assert result.after.max_error == pytest.approx(least_sag(1200.0 * 0.1 * 0.3), rel=1e-5)
    path = tmp_path / "found.yaml"
    path.write_text(arm_to_yaml(result.arm), encoding="utf-8")
    again = evaluate(read_arm(path))
    assert again.max_error == pytest.approx(result.after.max_error, rel=1e-6)


def test_a_counterweight_as_heavy_as_the_total_mass_allows(tmp_path: Path) -> None:
    choose = "counterweight: [{link: 1, mass: [0 kg, 40 kg], at: [-300 mm, -100 mm]}]"
    problem = lifting(tmp_path, choose, ", total_mass: '<= 15 kg'")
    result = optimise(problem)
    mass, place = (item.value for item in result.balance)
    assert result.after.mass is not None
    assert place == pytest.approx(-0.3, rel=1e-5)
    assert result.after.mass + mass + PAYLOAD == pytest.approx(15.0, rel=1e-5)
    assert result.after.max_error == pytest.approx(sag(result.after.mass, mass * G * 0.3), rel=1e-5)
    # Either takes from the other: no other share of the 12 kg does better.
    shares = [min(6.0, 0.1 * k) for k in range(5, 61)]
    assert result.after.max_error <= min(sag(own, (12.0 - own) * G * 0.3) for own in shares) * (1.0 + 1e-5)
    assert any(limit.name == "total_mass" for limit in result.binding)


def test_a_given_counterweight_is_the_one_that_is_chosen(tmp_path: Path) -> None:
    choose = "counterweight: [{link: 1, mass: [2 kg, 9 kg], at: -200 mm}]"
    problem = lifting(tmp_path, choose, "", link=", masses: [{mass: 5 kg, at: [-200 mm, 0 mm, 0 mm]}]")
    result = optimise(problem)
    assert [item.before for item in result.balance] == [5.0]
    (hung,) = result.arm.links[0].masses
    assert result.after.mass is not None
    assert hung.mass == pytest.approx(9.0, rel=1e-5)
    assert result.after.total_mass == pytest.approx(result.after.mass + 9.0 + PAYLOAD, rel=1e-9)


@pytest.mark.parametrize("limit", ["total_mass: '<= 15 kg'", "first_frequency: '>= 16 Hz'"])
def test_a_heavy_counterweight_as_given_puts_no_limit_out_of_reach(limit: str, tmp_path: Path) -> None:
    """Half a tonne given, of which all may go: neither its mass nor its inertia bounds what designs can be."""
    choose = "counterweight: [{link: 1, mass: [0 kg, 600 kg], at: -700 mm}]"
    given = ", masses: [{mass: 500 kg, at: [-700 mm, 0 mm, 0 mm]}]"
    problem = lifting(tmp_path, choose, f", {limit}", link=given)
    assert out_of_reach(problem) == ()
    result = optimise(problem)
    assert {item.name for item in result.binding} >= {limit.partition(":")[0]}


def test_what_it_slows_the_arm_by_counts(tmp_path: Path) -> None:
    """A counterweight's inertia lowers the first frequency: the limit binds before the range does."""
    choose = "counterweight: [{link: 1, mass: [0 kg, 40 kg], at: -100 mm}]"
    free = optimise(lifting(tmp_path, choose, ""))
    assert free.after.frequency is not None
    asked = 1.03 * free.after.frequency.value
    result = optimise(lifting(tmp_path, choose, f", first_frequency: '>= {asked:.6f} Hz'"))
    assert result.after.frequency is not None
    assert result.after.frequency.value == pytest.approx(asked, rel=2e-5)
    assert 0.0 < result.balance[0].value < 39.0
    assert not result.doubts


def test_its_place_is_chosen_beside_a_limit_on_the_frequency(tmp_path: Path) -> None:
    """Its moment helps and its inertia slows: fixed where it was put it does the same, on either side worse."""
    limits = ", first_frequency: '>= 16.6 Hz'"
    chosen = "counterweight: [{link: 1, mass: [0 kg, 9 kg], at: PLACE}]"
    result = optimise(lifting(tmp_path, chosen.replace("PLACE", "[-300 mm, -100 mm]"), limits))
    assert result.doubts == ()
    assert result.after.frequency is not None
    assert result.after.frequency.value == pytest.approx(16.6, rel=1e-4)
    place = result.arm.links[0].masses[0].at[0]
    assert -0.29 < place < -0.11

    def fixed(share: float) -> float:
        return optimise(lifting(tmp_path, chosen.replace("PLACE", f"{1e3 * share * place:.6f} mm"), limits)).objective

    assert fixed(1.0) == pytest.approx(result.objective, rel=2e-4)
    assert min(fixed(0.9), fixed(1.1)) > 1.001 * result.objective


def test_nothing_of_use_is_left_out_of_the_arm(tmp_path: Path) -> None:
    """On the side of the payload a counterweight only harms."""
    choose = "counterweight: [{link: 1, mass: [0 kg, 10 kg], at: 200 mm}]"
    result = optimise(lifting(tmp_path, choose, ""))
    assert result.balance[0].bound == "least"
    assert result.arm.links[0].masses == ()


def two_joints(folder: Path, problem: str, *joints: str) -> Problem:
    lines = "".join(
        f"  - joint: {{type: revolute, range: [-60 deg, 60 deg]{keys}}}\n"
        f"    link: {{length: 400 mm, section: {{shape: circle, diameter: 60 mm}}, material: {METAL}}}\n"
        for keys in joints
    )
    text = f"chain:\n{lines}payload: {{mass: 3 kg}}\n"
    return problem_of(folder, text, f"{problem}subject_to: {{mass: '<= 6 kg', {SIZES}}}\n")


def test_places_of_a_motor_are_arms_written_by_hand(tmp_path: Path) -> None:
    plain, softer = ", stiffness: 50 kN*m/rad, mass: 1 kg", ", stiffness: 20 kN*m/rad, mass: 1 kg"
    written = {
        "of joint 2 at its joint": ", stiffness: 50 kN*m/rad, mass: 5 kg",
        "of joint 2 on link 1": f"{plain}, motor: {{mass: 5 kg, on: 1}}",
        "of joint 2 on the base": f"{softer}, motor: {{mass: 6 kg, on: base}}",
    }
    places = "[{on: joint, mass: 4 kg}, {on: 1, mass: 5 kg}, {on: base, mass: 6 kg, stiffness: 20 kN*m/rad}]"
    result = optimise(two_joints(tmp_path, f"choose: {{motor: [{{joint: 2, places: {places}}}]}}\n", plain, plain))
    values = {place.places[0]: place for place in result.motor_places}
    by_hand = {words: optimise(two_joints(tmp_path, "", plain, keys)).objective for words, keys in written.items()}
    best = min(by_hand, key=lambda words: by_hand[words])
    assert result.motor_places[0].places == (best,)
    assert result.motor_places[0].outcome == "best"
    assert result.objective == pytest.approx(by_hand[best], rel=1e-5)
    for words, value in values.items():
        if value.objective is not None:
            assert value.objective == pytest.approx(by_hand[words], rel=1e-5)


BAD = {
    "joint that is not there": ("balancer: [{joint: 3, torque: [0 N*m, 9 N*m]}]", "1 to 2"),
    "nothing to choose of it": ("balancer: [{joint: 1}]", "torque"),
    "no spring": ("balancer: [{joint: 1, stiffness: [0 N/mm, 1 N/mm]}]", "none"),
    "one value": ("balancer: [{joint: 1, torque: [9 N*m, 9 N*m]}]", "one value"),
    "twice": ("balancer: [{joint: 1, torque: [0 N*m, 9 N*m]}, {joint: 1, torque: [0 N*m, 8 N*m]}]", "once"),
    "without a unit": ("counterweight: [{link: 1, mass: [0, 9], at: -100 mm}]", "kg"),
    "without a place": ("counterweight: [{link: 1, mass: [0 kg, 9 kg]}]", "at"),
    "below nothing": ("counterweight: [{link: 1, mass: [-1 kg, 9 kg], at: -100 mm}]", "negative"),
    "unknown key": ("counterweight: [{link: 1, mass: [0 kg, 9 kg], at: -100 mm, aft: 3}]", "aft"),
    "nowhere": ("motor: [{joint: 1, mass: 4 kg, on: [roof]}]", "base"),
    "no place": ("motor: [{joint: 1, mass: 4 kg}]", "on"),
    "no mass": ("motor: [{joint: 1, on: [joint, base]}]", "mass"),
    "actuator too": ("motor: [{joint: 1, mass: 4 kg, on: [base]}], actuator: [RV-20E]", "actuator"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_line(tmp_path: Path, name: str) -> None:
    text, told = BAD[name]
    with pytest.raises(InputError) as caught:
        two_joints(tmp_path, f"choose: {{{text}}}\n", "", "")
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_does_not_go_together_says_so(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="sizes"):
        lifting(tmp_path, "balancer: [{joint: 1, torque: [0 N*m, 9 N*m]}], sizes: stock", "")
    with pytest.raises(InputError, match="front"):
        question(lifting(tmp_path, "balancer: [{joint: 1, torque: [0 N*m, 9 N*m]}]", ""), "mass", "max_error")
    with pytest.raises(InputError, match="optimize"):
        context_of(lifting(tmp_path, "motor: [{joint: 1, mass: 4 kg, on: [joint, base]}]", ""))
