"""Sections from lists and drives chosen together, against each choice of drives by itself."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.choice.actuators import assignments, with_actuators
from linkwright.core.optimize.limits import broken
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
    found: dict[tuple[str, ...], float] = {}
    for pick in assignments(problem):
        own = replace(problem, arm=with_actuators(problem.arm, pick), actuators=None)
        try:
            found[tuple(each.name for each in pick if each is not None)] = optimise(own).objective
        except NoAnswer:
            continue
    return found


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
    found = optimise(problem)
    judged = evaluate(found.arm, problem.workspace, problem.load_cases)
    assert problem.objective.value(judged) == pytest.approx(found.objective, rel=1e-6)
    assert found.objective == pytest.approx(value, rel=1e-4)
    assert not broken(problem.limits, found.after)
    assert found.lower_bound <= found.objective
    assert found.before.arm == problem.arm
    assert len(each) > 2
    if most > 4:
        assert found.exhaustive
        assert found.drives_exhaustive
        assert len(found.drives) == 4
        assert found.lower_bound >= value * (1.0 - 3e-4)
    if minimize == "max_error":
        assert tuple(joint.actuator.name for joint in found.arm.joints if joint.actuator is not None) == drives
        assert found.drives[0].actuators == drives


@pytest.mark.slow
def test_without_a_design_it_says_so(tmp_path: Path) -> None:
    with pytest.raises(NoAnswer, match="no combination of the sizes listed keeps all limits"):
        optimise(choosing(tmp_path, "mass", "max_error: '<= 1 um'"))
