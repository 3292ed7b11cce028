"""Sections chosen from lists: a published problem, every combination evaluated, stock sizes, wrong input."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.arm.figures import broken
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.optimize.run import optimise
from linkwright.core.optimize.sizes import search
from linkwright.core.optimize.sizes.options import link_lists
from linkwright.core.units.quantities import InputError, NoAnswer
from tests.costs import slow_but
from tests.optimize.builders import jointed, problem_of, ranged

_ELASTIC = "{name: steel, elastic_modulus: 200 GPa, poisson_ratio: 0.3, density: 1000 kg/m^3, yield_strength: 140 MPa}"


@pytest.mark.parametrize(
    ("steps", "above"),
    [
        (("0.1 mm", "2 mm", "0.1 mm", "1 mm"), 1.002),
        pytest.param(("0.01 mm", "0.2 mm", "0.05 mm", "0.5 mm"), 1.0002, marks=pytest.mark.slow),
    ],
    ids=["coarse", "fine"],
)
def test_stepped_cantilever_of_thanedar_and_vanderplaats(
    tmp_path: Path, steps: tuple[str, str, str, str], above: float
) -> None:
    """Five segments of 1 m under 50 kN at the tip: deflection up to 27 mm, stress up to 140 MPa, height up to 20 times
    the width; the first segment in whole centimetres, the next two from lists, the others free. Thanedar and
    Vanderplaats 1995, doi:10.1061/(ASCE)0733-9445(1995)121:2(301); the best known volume is 64,578.19 cm^3, with
    sections of 3 x 60, 3.1 x 55 and 2.6 x 50 cm."""
    segment = "  - joint: {type: revolute}\n    link: {length: 1 m, section: {shape: rectangle, width: 50 mm, "
    segment += f"height: 600 mm}}, material: {_ELASTIC}}}\n"
    arm = "gravity: [0 m/s^2, 0 m/s^2, 0 m/s^2]\nleave_out: [shear_deformation]\nchain:\n" + 5 * segment
    arm += "payload: {mass: 0 kg, force: [0 N, -50 kN, 0 N]}\n"
    listed = "{width: [24 mm, 26 mm, 28 mm, 31 mm], height: [450 mm, 500 mm, 550 mm, 600 mm]}"
    whole = "{width: {from: 10 mm, to: 50 mm, step: 10 mm}, height: {from: 300 mm, to: 650 mm, step: 10 mm}}"
    width, height, of_fifth, high = (f"step: {step}" for step in steps)
    fourth = f"{{width: {{from: 22 mm, to: 24 mm, {width}}}, height: {{from: 440 mm, to: 470 mm, {height}}}}}"
    fifth = f"{{width: {{from: 17 mm, to: 18.5 mm, {of_fifth}}}, height: {{from: 330 mm, to: 360 mm, {high}}}}}"
    stretched = ", ".join(["[-0.0001 deg, 0 deg]"] * 5)
    problem = problem_of(
        tmp_path,
        arm,
        f"minimize: mass\nworkspace: {{joints: [{stretched}]}}\n"
        f"choose: {{sizes: [{whole}, {listed}, {listed}, {fourth}, {fifth}]}}\n"
        "subject_to: {max_error: '<= 27 mm', safety_factor: '>= 1', aspect: '<= 20', wall_slenderness: off}\n",
    )
    result = optimise(problem)
    cubic_centimetres = 1e3 * result.objective
    assert result.combinations > 1e8
    assert result.basis == "certified"
    # Steps of the last two segments leave it a little above the optimum of free ones.
    assert 64_578.19 <= cubic_centimetres <= 64_578.19 * above
    assert result.lower_bound <= result.objective <= result.lower_bound * 1.0002
    sections = [link.section for link in result.arm.links[:3]]
    assert [None if section is None else list(section.given().values()) for section in sections] == [
        [0.03, 0.6],
        [0.031, 0.55],
        [0.026, 0.5],
    ]


@pytest.mark.parametrize("seed", slow_but(range(3), 0))
def test_best_is_that_of_every_combination_evaluated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    monkeypatch.setattr(search, "_MOST_COMPARED", 1)
    monkeypatch.setattr(search, "_TRIED", 4)
    generator = np.random.default_rng(seed)
    minimize = ("max_error", "mass", "cost")[seed]
    joints = ranged("-60 45", "-20 80", more=", mass: 1 kg, stiffness: 200 kN*m/rad, backlash: 0.2 arcmin")
    arm = jointed([round(x) for x in generator.uniform(250, 550, 2)], joints)
    diameters = ", ".join(f"{x:.1f} mm" for x in generator.uniform(35, 90, 3))
    text = (
        f"minimize: {minimize}\nchoose: {{section: [tube], material: [aluminium-6061-t6, steel-s355], "
        f"sizes: {{diameter: [{diameters}], thickness: 3 mm}}}}\n"
    )
    first = problem_of(tmp_path, arm, text + "subject_to: {mass: '<= 99 kg', max_error: '<= 1 m'}\n")
    every: list[Evaluation] = []
    for pick in itertools.product(*[link_list.options for link_list in link_lists(first)]):
        links = [
            replace(link, section=own.section, material=own.material)
            for link, own in zip(first.arm.links, pick, strict=True)
        ]
        every.append(evaluate(first.arm.with_links(tuple(links)), first.workspace, first.load_cases))
    middle = every[int(np.argsort([item.max_error for item in every])[len(every) // 3])]
    assert middle.frequency is not None
    assert middle.cost is not None
    assert middle.mass is not None
    assert middle.strength.least_safety_factor is not None
    limits = {
        "max_error": f"'<= {1.1e3 * middle.max_error:.5f} mm'",
        "mass": f"'<= {1.1 * middle.mass:.4f} kg'",
        "cost": f"'<= {1.2 * middle.cost:.4f} EUR'",
        "safety_factor": f"'>= {0.8 * middle.strength.least_safety_factor:.4f}'",
        "first_frequency": f"'>= {0.97 * middle.frequency.value:.4f} Hz'",
    }
    if minimize == "mass":
        assert middle.stiffness is not None
        limits["tip_stiffness"] = f"'>= {0.97e-3 * middle.stiffness.value:.4f} N/mm'"
    del limits[minimize]
    told = ", ".join(f"{name}: {limit}" for name, limit in limits.items())
    problem = problem_of(tmp_path, arm, f"{text}subject_to: {{{told}}}\n")
    best = min(problem.objective.value(item) or math.inf for item in every if not broken(problem.limits, item))
    result = optimise(problem)
    assert 1 < sum(not broken(problem.limits, item) for item in every) < len(every)
    assert result.objective == pytest.approx(best, rel=2e-4)
    assert result.lower_bound <= best * (1.0 + 1e-6)
    assert result.lower_bound >= best * (1.0 - 2e-4)
    assert not result.doubts


def test_stock_sizes_of_materials_that_they_come_in(tmp_path: Path) -> None:
    text = (
        "minimize: mass\nchoose: {section: [tube, rectangular_tube], material: [steel-s355, aluminium-6082-t6], "
        "sizes: stock, same: [material]}\nsubject_to: {max_error: '<= 1.2 mm', section_size: [20 mm, 120 mm]}\n"
    )
    arm = jointed((400, 420), ranged("-90 90", "-90 90", more=", mass: 2 kg, stiffness: 300 kN*m/rad"))
    problem = problem_of(tmp_path, arm, text)
    result = optimise(problem)
    assert result.after.max_error <= 1.2e-3
    assert {link.material.name for link in result.arm.links if link.material is not None} == {"aluminium-6082-t6"}
    (tmp_path / "new.yaml").write_text(arm_to_yaml(result.arm), encoding="utf-8")
    again = read_arm(tmp_path / "new.yaml")
    assert [link.section_name for link in again.links] == [link.section_name for link in result.arm.links]
    assert all(link.section_name is not None for link in again.links)
    assert evaluate(again, problem.workspace, problem.load_cases).mass == pytest.approx(result.after.mass)


def test_no_answer_names_the_limit(tmp_path: Path) -> None:
    text = "choose: {sizes: {diameter: [20 mm, 30 mm]}}\nsubject_to: {mass: '<= 9 kg', first_frequency: '>= 99 Hz'}\n"
    problem = problem_of(tmp_path, jointed((400, 420), ranged("-90 90", "-90 90")), text)
    with pytest.raises(
        NoAnswer, match=r"no combination of the sizes listed keeps all limits.* first_frequency >= 99 Hz"
    ):
        optimise(problem)


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        ("sizes: {diametre: [20 mm]}", "needs values for the diameter of circle"),
        ("sizes: {diameter: [20 mm], wall: [2 mm]}", "unknown key 'wall'"),
        ("sizes: {diameter: [20]}", "needs a unit"),
        ("sizes: {diameter: {from: 20 mm, to: 10 mm, step: 1 mm}}", "from below to"),
        ("sizes: IPE 81", "did you mean 'IPE 80'"),
        ("sizes: [{diameter: 20 mm}]", "one for each of the 2 links"),
    ],
)
def test_wrong_lists_are_told_in_one_line(tmp_path: Path, choice: str, message: str) -> None:
    arm = jointed((400, 420), ranged("-90 90", "-90 90"))
    with pytest.raises(InputError, match=message) as told:
        problem_of(tmp_path, arm, f"choose: {{{choice}}}\nsubject_to: {{mass: '<= 9 kg'}}\n")
    assert "choose" in str(told.value)
    assert "\n" not in str(told.value)
