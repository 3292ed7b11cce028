"""Designs of arms with a housing, a flange, and a slide on a beam: against each combination singly."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.run import optimise
from tests.costs import slow_but
from tests.optimize.builders import best_value, problem_of, taken_for_many

MATERIALS = ("aluminium-6061-t6", "steel-s355")
SHAPES = ("circle", "tube")
ROWS = (
    "[[1e5, 0, 0, 0, 0, 0], [0, 2e4, 0, 0, 0, -4e6], [0, 0, 2e4, 0, 4e6, 0], [0, 0, 0, 1e9, 0, 0], "
    "[0, 0, 4e6, 0, 2e9, 0], [0, -4e6, 0, 0, 0, 2e9]]"
)
LINK = "{length: 350 mm, section: {shape: circle, diameter: 40 mm}, material: steel-s355%s}"
FLANGE = ", flange: {tilting_stiffness: 30 kN*m/rad, mass: 0.5 kg}"
DRIVE = "range: [-60 deg, 80 deg], stiffness: 60 kN*m/rad, mass: 2 kg"
HOUSED = (
    f"chain:\n  - joint: {{{DRIVE}, rated_torque: 120 N*m}}\n"
    f"    link: {{length: 300 mm, stiffness: {ROWS}, mass: 3 kg, center_of_mass: 120 mm}}\n"
    f"  - joint: {{{DRIVE}}}\n    link: {LINK % FLANGE}\n  - joint: {{{DRIVE}}}\n    link: {LINK % ''}\n"
    "payload: {mass: 3 kg}\n"
)
BEAM = (
    "{length: 900 mm, section: {shape: rectangular_tube, width: 60 mm, height: 80 mm, thickness: 3 mm}, "
    "material: aluminium-6061-t6, supports: clamped}"
)
SLIDING = (
    f"chain:\n  - joint: {{type: prismatic, range: [0 mm, 700 mm], mass: 4 kg, beam: {BEAM}}}\n"
    "    link: {length: 100 mm, rigid: true, mass: 1 kg}\n"
    f"  - joint: {{{DRIVE}}}\n    link: {LINK % ''}\npayload: {{mass: 3 kg}}\n"
)


def asked(shapes: tuple[str, ...], materials: tuple[str, ...]) -> str:
    limits = "mass: '<= 6 kg', section_size: [10 mm, 70 mm], thickness: [2 mm, 8 mm], first_frequency: '>= 4 Hz'"
    chosen = f"section: [{', '.join(shapes)}], material: [{', '.join(materials)}], same: [section, material]"
    return f"subject_to: {{{limits}}}\nchoose: {{{chosen}}}\n"


@pytest.mark.parametrize("arm", slow_but([HOUSED, SLIDING], HOUSED), ids=["housing", "slide"])
def test_the_best_is_that_of_each_combination(arm: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    singly = min(
        best_value(problem_of(tmp_path, arm, asked((shape,), (material,))))
        for shape, material in itertools.product(SHAPES, MATERIALS)
    )
    problem = problem_of(tmp_path, arm, asked(SHAPES, MATERIALS))
    result = optimise(problem)
    assert result.doubts == ()
    assert 1e3 * result.objective == pytest.approx(singly, rel=2e-4)
    again = evaluate(result.arm, problem.workspace, problem.load_cases)
    assert again.max_error == pytest.approx(result.objective, rel=2e-4)
    assert result.arm.joints == problem.arm.joints
    assert [link.flange for link in result.arm.links] == [link.flange for link in problem.arm.links]
    taken_for_many(monkeypatch)
    assert optimise(problem).objective == pytest.approx(result.objective, rel=2e-4)
