"""Limits on the error that load cases have of their own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import jointed, problem_of, ranged

ARM = jointed((400, 300), ranged("-60 90", "-90 90", more=", mass: 2 kg, stiffness: 60 kN*m/rad, backlash: 1 arcmin"))
REST = "choose: {section: [tube]}\nsubject_to: {section_size: [20 mm, 90 mm], thickness: [2 mm, 8 mm]"


def cases(folder: Path, *said: str, more: str = "", aim: str = "mass") -> Problem:
    listed = "".join(f"  - {{{item}}}\n" for item in said)
    return problem_of(folder, ARM, f"minimize: {aim}\nload_cases:\n{listed}{REST}{more}}}\n")


def alone(problem: Problem, case: int) -> float:
    """The worst error (m) of an arm under one load case."""
    return evaluate(problem.arm, problem.workspace, (problem.load_cases[case],)).max_error


LIGHT = "payload: {mass: 1 kg}"
HEAVY = "payload: {mass: 12 kg}"


def test_one_limited_case_is_as_if_it_were_the_only_one(tmp_path: Path) -> None:
    """The heavy one has no limit, and rules nothing."""
    limited = cases(tmp_path, f"{LIGHT}, subject_to: {{max_error: '<= 0.6 mm'}}", HEAVY)
    result = optimise(limited)
    only = optimise(cases(tmp_path, LIGHT, more=", max_error: '<= 0.6 mm'"))
    assert result.doubts == ()
    assert result.objective == pytest.approx(only.objective, rel=2e-4)
    assert alone(replace(limited, arm=result.arm), 0) == pytest.approx(6e-4, rel=2e-4)
    assert result.after.max_error > 6e-4
    (binding,) = (item for item in result.binding if item.name == "max_error of load case 1")
    assert binding.value == pytest.approx(0.6, rel=2e-4)
    assert binding.text == "max_error of load case 1 <= 0.6 mm"


def test_each_case_keeps_its_own_limit(tmp_path: Path) -> None:
    problem = cases(
        tmp_path,
        f"{LIGHT}, subject_to: {{max_error: '<= 0.5 mm'}}",
        f"{HEAVY}, subject_to: {{max_error: '<= 3 mm'}}",
        more=", max_error: '<= 8 mm'",
    )
    result = optimise(problem)
    designed = replace(problem, arm=result.arm)
    assert result.doubts == ()
    assert alone(designed, 0) <= 5e-4 * (1.0 + 2e-4)
    assert alone(designed, 1) <= 3e-3 * (1.0 + 2e-4)
    one, other = (
        optimise(cases(tmp_path, load, more=f", max_error: '<= {most} mm'")).objective
        for load, most in ((LIGHT, 0.5), (HEAVY, 3))
    )
    assert result.objective >= max(one, other) * (1.0 - 2e-4)


def test_the_worst_error_is_least_within_the_limit_of_a_case(tmp_path: Path) -> None:
    """A limit that the best design breaks costs error elsewhere."""
    free = cases(tmp_path, LIGHT, HEAVY, more=", mass: '<= 4 kg'", aim="max_error")
    best = optimise(free)
    light = alone(replace(free, arm=best.arm), 0)
    text = f"{LIGHT}, subject_to: {{max_error: '<= {0.995e3 * light:.6f} mm'}}"
    held = cases(tmp_path, text, HEAVY, more=", mass: '<= 4 kg'", aim="max_error")
    result = optimise(held)
    assert result.doubts == ()
    assert alone(replace(held, arm=result.arm), 0) <= 0.995 * light * (1.0 + 2e-4)
    assert result.objective >= best.objective * (1.0 - 2e-4)


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("subject_to: {max_error: '>= 1 mm'}", r"load_cases\[1\]\.subject_to\.max_error: needs a limit from above"),
        ("subject_to: {mass: '<= 1 kg'}", r"subject_to\.max_error: is missing; write a limit"),
        ("subject_to: {max_error: '<= 1 mm', mass: '<= 1 kg'}", r"load_cases\[1\]\.subject_to: unknown key 'mass'"),
        ("subject_to: {max_error: 1}", r"load_cases\[1\]\.subject_to\.max_error: "),
    ],
)
def test_one_line_tells_what_is_wrong(said: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=told):
        cases(tmp_path, f"{LIGHT}, {said}")
