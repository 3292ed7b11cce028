"""Errors that count from a calibrated state: what does not change cancels, and what does is first principles' own."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Calibrated, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import Circle
from linkwright.core.units.quantities import InputError
from linkwright.json.design import evaluation_json, optimization_json
from linkwright.markdown.described import markdown
from linkwright.results.evaluation import describe
from tests.optimize.builders import problem_of, scanned_error

CATALOGUE = load_catalogue(user=False)
STEEL, ALUMINIUM = CATALOGUE.find("steel-s355"), CATALOGUE.find("aluminium-6061-t6")
WARM, COLD = 323.15, 293.15
ONLY_BENDING = frozenset({"shear_deformation", "axial"})
GROWS = EffectEntry("thermal_expansion")


def rods(*lengths: float, material: object = STEEL, diameter: float = 0.05, **joint: object) -> Arm:
    """Rods whose joints turn by 29 degrees either way."""
    one = replace(Joint(range=(-0.5, 0.5)), **joint)
    links = tuple(Link(length, section=Circle(diameter), material=material) for length in lengths)
    return Arm("rods", (one,) * len(lengths), links, payload=LoadCase(3.0), leave_out=ONLY_BENDING)


def since(mass: float | None = None, temperature: float | None = None, **load: object) -> Calibrated:
    payload = LoadCase(mass or 0.0, **load) if mass is not None else None
    return Calibrated(payload, temperature)


def rigidity(arm: Arm, link: int = 0) -> float:
    return float(beams_of(arm)[link].flexural_rigidity_height)


def test_a_cantilever_gives_under_the_payload_beyond_the_calibrated_one_alone() -> None:
    arm = rods(0.6)
    result = evaluate(arm, load_cases=[replace(arm.payload, relative_to=since(2.0))])
    assert result.max_error == pytest.approx(1.0 * 9.81 * 0.6**3 / (3.0 * rigidity(arm)), rel=1e-9)
    assert result.worst.certified
    assert result.by_effect["link_bending"] == pytest.approx(result.max_error)
    assert evaluation_json(result)["relative_to"] == {
        "payload": {"payload_kg": 2.0, "force_N": [0.0, 0.0, 0.0], "moment_Nm": [0.0, 0.0, 0.0]},
        "temperature_degC": pytest.approx(20.0),
    }
    assert "only what changes from calibration: payload 2 kg, at the temperature of work" in markdown(describe(result))


def test_between_payloads_the_farther_one_counts() -> None:
    arm = rods(0.6)
    cases = [LoadCase(mass, relative_to=since(2.0)) for mass in (0.0, 3.0)]
    result = evaluate(arm, load_cases=cases)
    assert result.max_error == pytest.approx(2.0 * 9.81 * 0.6**3 / (3.0 * rigidity(arm)), rel=1e-9)
    assert result.worst.poses[0].load_case == 0


def test_at_another_temperature_a_sagging_rod_is_off_by_its_growth_alone() -> None:
    """Steel is as stiff at 50 degC as at 20 degC, so that gravity's sag cancels."""
    arm = replace(rods(0.6), temperature=WARM, effects=(GROWS,))
    result = evaluate(arm, load_cases=[replace(arm.payload, relative_to=since(temperature=COLD))])
    alpha = STEEL.at(WARM).need("thermal_expansion")
    assert result.max_error == pytest.approx(alpha * 0.6 * 30.0, rel=1e-9)
    assert result.growth is None
    here = evaluate(arm, load_cases=[LoadCase(4.0, relative_to=since(3.0))])
    assert here.max_error == pytest.approx(9.81 * 0.6**3 / (3.0 * rigidity(arm)), rel=1e-9)


def test_growth_that_the_model_leaves_out_is_told_from_the_calibration_on() -> None:
    arm = replace(rods(0.6), temperature=WARM, gravity=(0.0, 0.0, 0.0))
    told = evaluate(arm, load_cases=[LoadCase(1.0, relative_to=since(temperature=303.15))]).growth
    assert told is not None
    assert told.error == pytest.approx(STEEL.at(WARM).need("thermal_expansion") * 0.6 * 20.0, rel=1e-9)
    assert "+20 K from 30 degC" in told.words(0.0)
    assert evaluate(arm, load_cases=[LoadCase(1.0, relative_to=since(2.0))]).growth is None


def test_a_warming_that_an_effect_is_given_is_of_work_alone() -> None:
    arm = replace(rods(0.6), effects=(EffectEntry("thermal_expansion", (1,), {"warming": 12.0}),))
    grown = evaluate(arm, load_cases=[replace(arm.payload, relative_to=since(temperature=COLD))]).max_error
    assert grown == pytest.approx(STEEL.at(COLD).need("thermal_expansion") * 0.6 * 12.0, rel=1e-9)
    same = evaluate(arm, load_cases=[LoadCase(2.0, relative_to=since(3.0))]).max_error
    assert same == pytest.approx(9.81 * 0.6**3 / (3.0 * rigidity(arm)), rel=1e-9)


def test_an_arm_that_softens_as_it_warms_sags_more_than_when_it_was_calibrated() -> None:
    """Each temperature's own arm, evaluated apart, and their error vectors subtracted."""
    arm = replace(rods(0.5, 0.4, material=ALUMINIUM), temperature=WARM)
    q = np.random.default_rng(3).uniform(-0.5, 0.5, (20, 2))
    load = LoadCase(3.0, relative_to=since(1.0, COLD))
    one = error_model(arm, [load]).cases[0].arrays(q, beam_values(beams_of(arm, [load]))).vector

    def vectors(arm: Arm, mass: float) -> np.ndarray:
        return error_model(arm, [LoadCase(mass)]).cases[0].arrays(q, beam_values(beams_of(arm))).vector

    assert one == pytest.approx(vectors(arm, 3.0) - vectors(replace(arm, temperature=COLD), 1.0), rel=1e-9, abs=1e-15)
    assert np.abs(one).max() > 1.01 * np.abs(vectors(arm, 3.0) - vectors(arm, 1.0)).max()


def test_play_is_not_compensated_but_where_both_loads_push_it_one_way() -> None:
    """Half is left where a calibration takes the mean of both sides; where loads seat it, nothing or all."""
    arm = rods(0.6, backlash=2e-3, clearance=1e-5)
    bend = 9.81 * 0.6**3 / (3.0 * rigidity(arm))
    pushed = LoadCase(3.0, relative_to=since(2.0))
    lifted = LoadCase(0.0, force=(0.0, 200.0, 0.0), relative_to=since(2.0))
    assert evaluate(arm, load_cases=[pushed]).max_error == pytest.approx(bend + 0.6e-3 + 1e-5, rel=1e-6)
    loaded = replace(arm, play="loaded")
    assert evaluate(loaded, load_cases=[pushed]).max_error == pytest.approx(bend, rel=1e-6)
    turned = evaluate(loaded, load_cases=[lifted])
    force = (200.0 + 2.0 * 9.81) / 9.81
    assert turned.max_error == pytest.approx(force * bend + 2.0 * 0.6e-3 + 2.0 * 1e-5, rel=1e-6)
    assert turned.worst.certified
    level = replace(loaded, gravity=(0.0, 0.0, -9.81), joints=(replace(arm.joints[0], clearance=0.0),))
    free = evaluate(level, load_cases=[pushed])  # nothing turns this joint: the middle was taken, half is left
    assert np.linalg.norm(free.worst.poses[0].vector[:2]) == pytest.approx(0.6e-3, rel=1e-6)


def test_what_repeats_at_a_pose_is_calibrated_away() -> None:
    slide = Joint(type="prismatic", axis=(1.0, 0.0, 0.0), range=(0.0, 0.5))
    link = Link(0.3, section=Circle(0.05), material=STEEL)
    off = (
        EffectEntry("rail_straightness", (1,), {"deviation": 5e-5}),
        EffectEntry("encoder_offset", (2,), {"offset": 1e-3}),
    )
    arm = Arm(
        "rail", (slide, Joint(range=(-0.5, 0.5))), (Link(0.1, mass=1.0), link), effects=off, leave_out=ONLY_BENDING
    )
    result = evaluate(arm, load_cases=[LoadCase(3.0, relative_to=since(2.0))])
    beam = beams_of(arm)[1]
    assert result.max_error == pytest.approx(9.81 * 0.3**3 / (3.0 * float(beam.flexural_rigidity_height)), rel=1e-9)


def test_beyond_first_order_is_told_of_what_counts() -> None:
    arm = rods(1.2, 1.0, diameter=0.03)
    whole = evaluate(arm).beyond
    part = evaluate(arm, load_cases=[replace(arm.payload, relative_to=since(2.9))]).beyond
    assert whole.at_worst is not None
    assert part.at_worst is not None
    assert 0.0 < part.at_worst < 0.2 * whole.at_worst


ARM = """
chain:
  - joint: {range: [-40 deg, 40 deg]}
    link: {length: 500 mm, section: {shape: circle, diameter: 60 mm}, material: steel-s355}
  - joint: {range: [-40 deg, 40 deg]}
    link: {length: 300 mm, section: {shape: circle, diameter: 60 mm}, material: steel-s355}
payload: {mass: 5 kg}
leave_out: [shear_deformation, axial]
"""


def test_the_best_rods_for_what_changes_are_those_of_a_weightless_arm(tmp_path: Path) -> None:
    """Under the added load alone c1/A1^2 + c2/A2^2 is least, for a given volume, at areas as (c/L)^(1/3)."""
    problem = problem_of(tmp_path, ARM, "relative_to: {payload: {mass: 2 kg}}\nsubject_to: {mass: '<= 8 kg'}\n")
    result = optimise(problem)
    lengths = np.array([0.5, 0.3])
    c = np.array([0.8**3 - 0.3**3, 0.3**3]) / 3.0
    areas = (c / lengths) ** (1.0 / 3.0)
    areas *= 8.0 / STEEL.need("density") / (areas @ lengths)
    inertia = areas**2 / (4.0 * math.pi)
    assert result.status == "certified"
    assert result.optimum == "global"
    assert result.objective == pytest.approx(
        3.0 * 9.81 * float((c / inertia).sum()) / STEEL.need("elastic_modulus"), rel=2e-4
    )
    assert [link.section.diameter for link in result.arm.links] == pytest.approx(
        np.sqrt(4.0 * areas / math.pi), rel=3e-3
    )
    assert result.objective >= scanned_error(result.arm, problem.load_cases, poses=2000) * (1.0 - 2e-4)
    content = optimization_json(result)
    assert content["relative_to"]["payload"]["payload_kg"] == 2.0
    assert content["before"]["relative_to"] == content["relative_to"]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("{}", "names no calibrated state"),
        ("{payload: {mass: 5 kg}}", "nothing changes"),
        ("{temperature: 20 degC}", "nothing changes"),
        ("{payload: {mass: 2}}", "mass"),
        ("{temprature: 30 degC}", "temperature"),
        ("{temperature: 900 degC}", "elastic_modulus"),
    ],
)
def test_a_calibrated_state_that_says_nothing_is_refused(tmp_path: Path, given: str, told: str) -> None:
    def ask() -> None:
        problem = problem_of(tmp_path, ARM, f"relative_to: {given}\nsubject_to: {{mass: '<= 8 kg'}}\n")
        evaluate(problem.arm, problem.workspace, problem.load_cases)

    with pytest.raises(InputError, match=told) as caught:
        ask()
    assert "\n" not in str(caught.value)
