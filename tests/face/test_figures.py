"""Every design result of the face: its log and files, its figures that everybody asks for, and a table of all."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

import linkwright as lw
from linkwright.core.arm.figures import FIGURES
from tests.face.test_contract import a_result

LIMITS = {"mass": "<= 30 kg", "max_error": "<= 0.5 mm", "section_size": ["40 mm", "120 mm"]}


@pytest.fixture(scope="module")
def problem() -> lw.Problem:
    """A small problem of one free size."""
    return lw.Problem(
        arm="examples/welding-arm/arm.yaml",
        workspace={"path": [["600 mm", "300 mm"], ["700 mm", "300 mm"]]},
        subject_to=LIMITS,
        choose={"section": ["circle"], "same": ["size"]},
    )


def test_an_evaluation_has_all_that_its_json_has(problem: lw.Problem) -> None:
    result = lw.evaluate(problem.arm, problem)
    written = json.loads(result.to_json())
    table = result.figures
    assert list(table.columns) == ["title", "value", "unit"]
    for name, figure in FIGURES.items():
        if written.get(figure.key) is not None:
            assert table.loc[name, "value"] == pytest.approx(written[figure.key], rel=1e-12), name
            assert table.loc[name, "unit"] == figure.unit
    assert table.loc["max_error", "value"] == result.max_error_mm == written["max_error_mm"]
    assert table.loc["upper_bound", "value"] == result.upper_bound_mm == written["upper_bound_mm"]
    assert table.loc["mass", "value"] == result.mass_kg == written["mass_kg"]


@pytest.fixture(scope="module")
def heard() -> list[float]:
    """The shares that were heard while the best design was found."""
    return []


@pytest.fixture(scope="module")
def best(problem: lw.Problem, heard: list[float]) -> Any:
    """The best design, its sizes rounded."""
    return lw.optimize(problem, round_to="1 mm", progress=lambda _, share: heard.append(share))


def test_optimization(best: Any, heard: list[float], tmp_path: Path) -> None:
    """A better arm with its log; the folder is that of the command."""
    assert best.found.after.max_error < best.before.found.max_error
    assert len(best.log) == len(best.found.iterations)
    assert "objective_mm" in best.log
    assert not best.interrupted
    assert heard
    assert all(0.0 <= share <= 1.0 for share in heard)
    best.save(tmp_path / "out")
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"arm.yaml", "report.html", "result.json"}
    assert (tmp_path / "out" / "arm.yaml").read_text(encoding="utf-8") == best.arm.to_yaml()
    assert (tmp_path / "out" / "result.json").read_text(encoding="utf-8") == best.to_json()
    a_result(best)


def test_a_design_has_its_own_figures_beside_those_of_the_arm_as_given(problem: lw.Problem, best: Any) -> None:
    table = best.figures
    assert list(table.columns) == ["title", "before", "after", "rounded", "unit"]
    assert table.loc["max_error", "before"] == best.before.max_error_mm
    assert table.loc["max_error", "after"] == best.after.max_error_mm
    # The arm is the rounded one, and so are the figures that are the result's.
    assert best.max_error_mm == table.loc["max_error", "rounded"] == lw.evaluate(best.arm, problem).max_error_mm
    assert best.mass_kg == table.loc["mass", "rounded"]
    assert best.lower_bound_mm == json.loads(best.to_json())["lower_bound_mm"]
    assert best.lower_bound_mm <= best.max_error_mm <= best.upper_bound_mm


@pytest.mark.slow
def test_a_lightest_design_has_no_bound_on_its_error(problem: lw.Problem) -> None:
    best, lightest = lw.optimize(problem), lw.optimize(problem.replace("minimize", "mass"))
    assert lightest.lower_bound_mm is None
    assert "lower_bound" not in lightest.figures.index
    assert lightest.mass_kg < best.mass_kg


@pytest.mark.slow
def test_the_designs_of_a_front_have_them_too(problem: lw.Problem) -> None:
    front = lw.tradeoff(problem, accuracy=0.3)
    for design, (_, row) in zip(front.designs, front.table.iterrows(), strict=True):
        assert design.max_error_mm == pytest.approx(row["max_error_mm"], rel=1e-9)
        assert design.mass_kg == pytest.approx(row["mass_kg"], rel=1e-9)
        assert design.upper_bound_mm == pytest.approx(row["upper_bound_mm"], rel=1e-9)
        assert design.lower_bound_mm is None
        assert math.isfinite(design.figures.loc["total_mass", "value"])
