"""Wrong input: one line that names the file, the key and what would do."""

from __future__ import annotations

from pathlib import Path

import pytest

from linkwright.core.arm.figures import FIGURES, RANGES_CALLED
from linkwright.core.materials.material import MissingProperty
from linkwright.core.optimize.reading.called import CHOICES_CALLED, PROBLEM_CALLED
from linkwright.core.optimize.run import optimise
from linkwright.core.sections.shapes import SHAPES
from linkwright.core.units.quantities import InputError
from tests.arm.builders import rod_lines
from tests.optimize.builders import PAPER_ARM, problem_of

LIMITS = "subject_to: {{{}}}\n"

BAD = {
    "unknown key": ("minimise: mass\n", "minimise", "minimize"),
    "unknown limit": (LIMITS.format("masses: '<= 3 kg'"), "masses", "mass"),
    "unknown objective": ("minimize: weight\n", "minimize", "mass"),
    "missing unit": (LIMITS.format("mass: '<= 26'"), "mass", "kg"),
    "bare number": (LIMITS.format("mass: 26"), "mass", "kg"),
    "wrong unit": (LIMITS.format("mass: '<= 26 mm'"), "mass", "kg"),
    "no relation": (LIMITS.format("mass: 26 kg"), "mass", "<="),
    "wrong relation": (LIMITS.format("safety_factor: '<= 2'"), "safety_factor", ">="),
    "limit of nothing": (LIMITS.format("mass: '<= 0 kg'"), "mass", "above zero"),
    "range reversed": (LIMITS.format("link_length: [700 mm, 200 mm]"), "link_length", "200 mm"),
    "range with three ends": (LIMITS.format("section_size: [1 mm, 2 mm, 3 mm]"), "section_size", "mm"),
    "range below zero": (LIMITS.format("section_size: [-1 mm, 20 mm]"), "section_size", "above zero"),
    "reach too long": (LIMITS.format("reach: '== 2500 mm', link_length: [200 mm, 700 mm]"), "reach", "2100 mm"),
    "reach too short": (LIMITS.format("reach: '<= 500 mm', link_length: [200 mm, 700 mm]"), "reach", "600 mm"),
    "reach of fixed lengths": (LIMITS.format("reach: '== 1300 mm'"), "reach", "1240 mm"),
    "contradictory limits": (LIMITS.format("mass: ['>= 30 kg', '<= 20 kg']"), "mass", "loosen"),
    "unknown shape": ("choose: {section: [circel]}\n", "section[1]", "circle"),
    "shape without variables": ("choose: {section: polygon}\n", "section[1]", "polygon"),
    "unknown material": ("choose: {material: [aluminium-6061-t66]}\n", "material[1]", "aluminium-6061-t6"),
    "empty materials": ("choose: {material: []}\n", "material", "at least one"),
    "agreeing in what": ("choose: {same: [shape]}\n", "same", "section"),
    "walls too thick for the outside": (
        "choose: {section: tube}\n" + LIMITS.format("section_size: [5 mm, 20 mm], thickness: [12 mm, 15 mm]"),
        "thickness",
        "20 mm",
    ),
    "workspace of two kinds": ("workspace: {joints: range, box: [[0 m, 0 m], [1 m, 1 m]]}\n", "workspace", "one of"),
    "mixed points": ("workspace: {path: [[400 mm, 300 mm], [400 mm, 300 mm, 0 mm]]}\n", "path", "two and of three"),
    "point out of the plane": ("workspace: {path: [[400 mm, 300 mm, 10 mm]]}\n", "path", "plane"),
    "point without units": ("workspace: {path: [[400, 300]]}\n", "path[1][1]", "mm"),
    "box of three corners": ("workspace: {box: [[0 m, 0 m], [1 m, 0 m], [1 m, 1 m]]}\n", "box", "two corners"),
    "ranges for two of three joints": ("workspace: {joints: [[0 deg, 1 deg], [0 deg, 1 deg]]}\n", "joints", "3"),
    "no load cases": ("load_cases: []\n", "load_cases", "leave it out"),
    "force given twice": (
        "load_cases: [{payload: {mass: 1 kg, force: [1 N, 0 N, 0 N]}, force: [2 N, 0 N, 0 N]}]\n",
        "force",
        "twice",
    ),
    "unknown key in a load case": ("load_cases: [{payloads: {mass: 1 kg}}]\n", "payloads", "payload"),
    "mass alone": ("minimize: mass\n", "minimize", "max_error"),
}


@pytest.mark.parametrize("name", BAD)
def test_wrong_input_is_one_line_with_file_key_and_remedy(name: str, tmp_path: Path) -> None:
    text, key, remedy = BAD[name]
    with pytest.raises(InputError) as caught:
        problem_of(tmp_path, PAPER_ARM, text)
    message = str(caught.value)
    assert "\n" not in message
    assert "problem.yaml" in message
    assert key in f"{caught.value.key}: {caught.value.message}"
    assert remedy in caught.value.message


SAID = {
    "minimize: weight": "mass",
    "minimize: deflection": "max_error",
    "objective: max_error": "minimize",
    "constraints: {mass: '<= 3 kg'}": "subject_to",
    "limits: {mass: '<= 3 kg'}": "subject_to",
    "subject_to: {weight: '<= 3 kg'}": "mass",
    "subject_to: {Wieght: '<= 3 kg'}": "mass",
    "subject_to: {deflection: '<= 3 mm'}": "max_error",
    "subject_to: {stress: '<= 100 MPa'}": "safety_factor",
    "subject_to: {diameter: [20 mm, 80 mm]}": "section_size",
    "subject_to: {wall thickness: [2 mm, 8 mm]}": "thickness",
    "subject_to: {natural-frequency: '>= 20 Hz'}": "first_frequency",
    "choose: {shape: [tube]}": "section",
    "choose: {section: [pipe]}": "tube",
    "choose: {section: [round]}": "circle",
    "choose: {section: [I-beam]}": "i_section",
    "choose: {section: [box]}": "rectangular_tube",
}
"""What people write first, and what they mean."""


@pytest.mark.parametrize("text", SAID)
def test_what_people_write_first_is_guessed(text: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=f"did you mean '{SAID[text]}'"):
        problem_of(tmp_path, PAPER_ARM, f"{text}\n")


def test_no_word_means_two_things() -> None:
    """A synonym is no name of another, nor another's synonym, among what can stand in the same place."""
    places = [
        {name: kind.synonyms for name, kind in SHAPES.items()},
        {**RANGES_CALLED, **{name: figure.synonyms for name, figure in FIGURES.items()}},
        PROBLEM_CALLED,
        CHOICES_CALLED,
    ]
    for called in places:
        words = [word for item in called.values() for word in item]
        assert len(words) == len(set(words))
        assert not set(words) & set(called)


def test_arm_file_that_is_not_there(tmp_path: Path) -> None:
    path = tmp_path / "problem.yaml"
    problem_of(tmp_path, PAPER_ARM, "")
    (tmp_path / "arm.yaml").unlink()
    from linkwright.core.optimize.problem import read_problem

    with pytest.raises(InputError, match=r"arm\.yaml"):
        read_problem(path)


def test_arm_of_rigid_links_has_nothing_to_design(tmp_path: Path) -> None:
    arm = "chain:\n  - joint: {type: revolute}\n    link: {length: 200 mm, rigid: true, mass: 4 kg}\n"
    with pytest.raises(InputError, match="nothing to design"):
        problem_of(tmp_path, arm, "subject_to: {mass: '<= 4 kg'}\n")


def test_missing_price_of_a_material_is_wrong_input(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cost"):
        optimise(problem_of(tmp_path, PAPER_ARM, "subject_to: {cost: '<= 40 EUR'}\n"))


def test_what_every_material_lacks_is_said_before_the_arm_is_evaluated(tmp_path: Path) -> None:
    """For an arm in space the evaluation alone may take a minute."""
    text = "subject_to: {safety_factor: '>= 5'}\nchoose: {material: [cfrp-quasi-isotropic]}\n"
    with pytest.raises(InputError, match=r"choose\.material.*cfrp-quasi-isotropic: its yield strength.*safety_factor"):
        problem_of(tmp_path, PAPER_ARM, text)
    without = rod_lines([400, 420], material="cfrp-quasi-isotropic")
    evaluated: list[object] = []
    with pytest.raises(MissingProperty, match=r"cfrp-quasi-isotropic.*yield_strength"):
        optimise(problem_of(tmp_path, without, "subject_to: {safety_factor: '>= 5'}\n"), begun=evaluated.append)
    assert evaluated == []


def test_three_components_serve_a_planar_arm_in_its_plane(tmp_path: Path) -> None:
    problem = problem_of(tmp_path, PAPER_ARM, "workspace: {path: [[400 mm, 300 mm, 0 mm]]}\n")
    assert problem.workspace.points == ((0.4, 0.3, 0.0),)


def test_load_case_takes_force_beside_payload(tmp_path: Path) -> None:
    text = "load_cases:\n  - {payload: {mass: 3 kg}, force: [0 N, 5 N, 0 N]}\n  - {force: [43 N, 0 N, 0 N]}\n"
    first, second = problem_of(tmp_path, PAPER_ARM, text).load_cases
    assert (first.mass, first.force) == (3.0, (0.0, 5.0, 0.0))
    assert (second.mass, second.force) == (0.0, (43.0, 0.0, 0.0))
