"""A motor nearer the base that turns its link by rods, as a choice: arms by hand, a scan of sizes in closed form."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import problem_of

E, RHO, G = 71e9, 2700.0, 9.81
L1, L2, K, K_RODS, PAYLOAD, MOTOR, ROD, MOST = 0.5, 0.45, 60e3, 30e3, 4.0, 6.0, 1.0, 4.0
METAL = "{elastic_modulus: 71 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3}"
AT_JOINT = "{on: joint, mass: 6 kg}"
RODS = "{on: 1, mass: 7 kg, parallelogram: 1, range: [-100 deg, 0 deg], rod: 1 kg, stiffness: 30 kN*m/rad}"
BEFORE, BY_RODS = "range: [-130 deg, -20 deg]", 'follows: "q2 - q1", range: [-100 deg, 0 deg]'
LEVEL, SIZES = '"-(q1 + q2)"', "subject_to: {mass: '<= 4 kg', section_size: [20 mm, 120 mm]}\n"


def lifter(folder: Path, second: str, problem: str, *, stiffness: int = 60, hung: str = "", wrist: str = "") -> Problem:
    """Two links and, with `wrist`, a third that follows them."""
    third = f"  - joint: {{follows: {wrist}}}\n    link: {{length: 150 mm, rigid: true, mass: 1 kg}}\n"
    last = third if wrist else ""
    text = f"""chain:
  - joint: {{type: revolute, range: [30 deg, 100 deg], stiffness: 60 kN*m/rad}}
    link: {{length: 500 mm, section: {{shape: circle, diameter: 60 mm}}, material: {METAL}{hung}}}
  - joint: {{type: revolute, stiffness: {stiffness} kN*m/rad, {second}}}
    link: {{length: 450 mm, section: {{shape: circle, diameter: 50 mm}}, material: {METAL}}}
{last}payload: {{mass: 4 kg}}
leave_out: [shear_deformation, axial]
"""
    folder.mkdir(exist_ok=True)
    return problem_of(folder, text, problem + SIZES)


def choosing(*places: str, workspace: str = "") -> str:
    return f"{workspace}choose: {{motor: [{{joint: 2, places: [{', '.join(places)}]}}]}}\n"


@pytest.mark.slow
def test_places_with_and_without_rods_are_arms_written_by_hand(tmp_path: Path) -> None:
    """A wrist that was level stays level: what it follows is written anew."""
    result = optimise(lifter(tmp_path, BEFORE, choosing(AT_JOINT, RODS), wrist=LEVEL))
    hung = ", masses: [{mass: 0.5 kg}, {mass: 0.5 kg, on: end}]"
    second = f"{BY_RODS}, motor: {{mass: 7 kg, on: 1}}"
    by_hand = {
        "of joint 2 at its joint": optimise(lifter(tmp_path / "a", f"{BEFORE}, mass: 6 kg", "", wrist=LEVEL)),
        "of joint 2 on link 1, by rods along link 1": optimise(
            lifter(tmp_path / "b", second, "", stiffness=30, hung=hung, wrist='"-q2"')
        ),
    }
    results = {place.places[0]: place.objective for place in result.motor_places}
    assert result.objective == pytest.approx(min(item.objective for item in by_hand.values()), rel=1e-5)
    assert results.keys() == by_hand.keys()
    for words, objective in results.items():
        assert objective is None or objective == pytest.approx(by_hand[words].objective, rel=1e-5)
    path = tmp_path / "found.yaml"
    path.write_text(arm_to_yaml(result.arm), encoding="utf-8")
    assert evaluate(read_arm(path)).max_error == pytest.approx(result.after.max_error, rel=1e-6)


def least_by_scan(*, rods: bool) -> float:
    """The least worst error (m) over the two diameters that the mass allows, by virtual work: with rods each drive
    holds its own link's turn against the base, and the forearm's moment goes by the rods, not by the first link."""
    second = np.radians(np.linspace(-100.0, 0.0, 101) if rods else np.linspace(-130.0, -20.0, 111))
    q1, other = (item.ravel() for item in np.meshgrid(np.radians(np.linspace(30.0, 100.0, 71)), second))
    phi1, phi2 = q1, other if rods else q1 + other
    low, high, least = 0.5, MOST - 0.5, math.inf
    for _ in range(3):
        masses = np.linspace(low, high, 50)
        errors = [_worst(mass, MOST - mass, phi1, phi2, rods=rods) for mass in masses]
        best, step = int(np.argmin(errors)), masses[1] - masses[0]
        low, high, least = masses[best] - step, masses[best] + step, min(least, errors[best])
    return least


def _worst(m1: float, m2: float, phi1: Array, phi2: Array, *, rods: bool) -> float:
    second1, second2 = ((m / (RHO * length)) ** 2 / (4.0 * math.pi) for m, length in ((m1, L1), (m2, L2)))
    c1, c2 = -np.cos(phi1), -np.cos(phi2)  # what of a weight lies along each link's normal
    n1, n2 = (np.array([-np.sin(phi), np.cos(phi)]) for phi in (phi1, phi2))
    on_elbow = G * (PAYLOAD + m2 + (0.5 * ROD if rods else MOTOR))
    about2 = G * (PAYLOAD + 0.5 * m2) * L2 * c2
    about1 = on_elbow * L1 * c1 + 0.5 * G * m1 * L1 * c1
    bent2 = G * c2 * (PAYLOAD * L2**3 / 3.0 + m2 * L2**3 / 8.0) / (E * second2)
    bent1 = c1 * (on_elbow * L1**3 / 3.0 + G * m1 * L1**3 / 8.0) / (E * second1)
    if rods:
        tip = n1 * (bent1 + L1 * about1 / K) + n2 * (bent2 + L2 * about2 / K_RODS)
    else:
        bent1 = bent1 + about2 * L1**2 / (2.0 * E * second1)
        slope = c1 * (on_elbow * L1**2 / 2.0 + G * m1 * L1**2 / 6.0) / (E * second1) + about2 * L1 / (E * second1)
        turn1 = (about1 + about2) / K
        tip = n1 * (bent1 + L1 * turn1) + n2 * (bent2 + L2 * (turn1 + slope + about2 / K))
    return float(np.hypot(*tip).max())


@pytest.mark.slow
def test_the_best_place_is_that_of_a_scan(tmp_path: Path) -> None:
    places = (AT_JOINT, RODS)
    scans = {item: least_by_scan(rods=item == RODS) for item in places}
    both = optimise(lifter(tmp_path, BEFORE, choosing(*places)))
    assert both.objective == pytest.approx(min(scans.values()), rel=2e-4)
    for place, least in scans.items():
        own = optimise(lifter(tmp_path, BEFORE, choosing(place)))
        assert own.objective == pytest.approx(least, rel=2e-4)
        assert own.status == "certified"
        assert not own.doubts


@pytest.mark.slow
def test_a_place_that_reaches_less_of_a_path_is_left_out(tmp_path: Path) -> None:
    path = "workspace: {path: [[700 mm, 300 mm], [700 mm, 100 mm]]}\n"
    narrow = RODS.replace("[-100 deg, 0 deg]", "[-40 deg, -30 deg]")
    result = optimise(lifter(tmp_path, BEFORE, choosing(AT_JOINT, narrow, workspace=path)))
    assert [place.outcome for place in result.motor_places] == ["best", "reaches less"]
    with pytest.raises(InputError, match="wider range"):
        optimise(lifter(tmp_path, BEFORE, choosing(narrow, workspace=path)))


BAD = {
    "no range": (RODS.replace(", range: [-100 deg, 0 deg]", ""), "range"),
    "beyond the joint": (RODS.replace("parallelogram: 1", "parallelogram: 2"), "1 to 1"),
    "rods of nothing": (AT_JOINT.replace("}", ", rod: 1 kg}"), "parallelogram: 2"),
    "below nothing": (RODS.replace("rod: 1 kg", "rod: -1 kg"), "negative"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_line(tmp_path: Path, name: str) -> None:
    place, told = BAD[name]
    with pytest.raises(InputError) as caught:
        lifter(tmp_path, BEFORE, choosing(place))
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_poses_listed_by_coordinates_do_not_go_with_rods(tmp_path: Path) -> None:
    workspace = "workspace: {joints: [[30 deg, 60 deg], [-90 deg, -30 deg]]}\n"
    with pytest.raises(InputError, match="joints: range"):
        lifter(tmp_path, BEFORE, choosing(AT_JOINT, RODS, workspace=workspace))
