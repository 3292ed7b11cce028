"""Sections from lists and drives chosen together, against each choice of drives by itself."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import broken
from linkwright.core.optimize.choice.actuators import assignments, with_actuators
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import NoAnswer
from tests.optimize.builders import jointed, problem_of, ranged

ARM = jointed([400, 300], ranged("-120 120", "-150 150", more=""))
DRIVES = "[[CSG-25-100-2UH, RV-6E], [CSG-17-100-2UH, CSG-25-100-2UH]]"


def choosing(folder: Path, minimize: str, limits: str) -> Problem:
    text = (
        f"minimize: {minimize}\nsubject_to: {{{limits}}}\nchoose: {{sizes: {{width: [30 mm, 40 mm, 50 mm], "
        f"height: [40 mm, 60 mm, 90 mm]}}, section: [rectangle], actuator: {DRIVES}}}\n"
    )
    return problem_of(folder, ARM, text)


def best_of_each(problem: Problem) -> dict[tuple[str, ...], float]:
    """The least objective (SI) with each choice of drives by itself."""
    results: dict[tuple[str, ...], float] = {}
    for pick in assignments(problem):
        own = replace(problem, arm=with_actuators(problem.arm, pick), actuators=None)
        try:
            results[tuple(item.name for item in pick if item is not None)] = optimise(own).objective
        except NoAnswer:
            continue
    return results


@pytest.mark.parametrize(
    ("minimize", "limits", "most"),
    [
        pytest.param("max_error", "total_mass: '<= 16 kg'", 64, marks=pytest.mark.slow),
        pytest.param("mass", "max_error: '<= 1.2 mm', first_frequency: '>= 12 Hz'", 2, marks=pytest.mark.slow),
    ],
)
def test_best_is_that_of_every_choice_of_drives(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, minimize: str, limits: str, most: int
) -> None:
    monkeypatch.setattr("linkwright.core.optimize.choice.actuators.MOST_ASSIGNMENTS", most)
    problem = choosing(tmp_path, minimize, limits)
    each = best_of_each(problem)
    value, drives = min((value, drives) for drives, value in each.items())
    result = optimise(problem)
    judged = evaluate(result.arm, problem.workspace, problem.load_cases)
    assert problem.objective.value(judged) == pytest.approx(result.objective, rel=1e-6)
    assert result.objective == pytest.approx(value, rel=1e-4)
    assert not broken(problem.limits, result.after)
    assert result.lower_bound <= result.objective
    assert result.before.arm == problem.arm
    assert len(each) > 2
    if most > 4:
        assert result.exhaustive
        assert result.drives_exhaustive
        assert len(result.drives) == 4
        assert result.lower_bound >= value * (1.0 - 3e-4)
    if minimize == "max_error":
        assert tuple(joint.actuator.name for joint in result.arm.joints if joint.actuator is not None) == drives
        assert result.drives[0].actuators == drives


@pytest.mark.slow
def test_without_a_design_it_says_so(tmp_path: Path) -> None:
    with pytest.raises(NoAnswer, match="no combination of the sizes listed keeps all limits"):
        optimise(choosing(tmp_path, "mass", "max_error: '<= 1 um'"))
