"""Random problems whose every design is evaluated: the tool's answer is the best of them that keeps all limits."""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import OptimizationResult
from linkwright.core.optimize.run import optimise
from tests.optimize.adversary import enumerated
from tests.optimize.adversary.enumerated import drawn, held

PROBLEMS = int(os.environ.get("PROBLEMS", "0"))
"""Random problems of each kind; `make problems` takes more than the few that hypothesis draws."""


@settings(max_examples=2, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 10_000), listed=st.booleans())
def test_a_few_are_the_best_of_all_designs(seed: int, listed: bool) -> None:
    with TemporaryDirectory() as folder:
        held(drawn(Path(folder), seed, listed=listed, few=True))


@pytest.mark.slow
@pytest.mark.parametrize("listed", [True, False])
@pytest.mark.parametrize("seed", range(PROBLEMS or 3))
def test_answers_are_the_best_of_all_designs(seed: int, listed: bool, tmp_path: Path) -> None:
    held(drawn(tmp_path, seed, listed=listed, links=3 if seed % 5 == 4 else 2, few=seed % 5 == 4))


@pytest.mark.slow
def test_problems_say_all_that_can_be_said(tmp_path: Path) -> None:
    """By link, by material, by load case, poses with weights, figures to maximise."""
    seen: Counter[str] = Counter()
    for seed in range(12):
        case = drawn(tmp_path, seed, listed=seed % 2 == 0, few=True)
        problem = case.problem
        seen[problem.workspace.kind] += 1
        seen["maximised"] += problem.objective.more_is_better
        seen["weights"] += bool(problem.workspace.weights)
        for limit in problem.limits:
            seen["by link"] += limit.demands is not None and bool(limit.demands.links)
            seen["by material"] += limit.demands is not None and bool(limit.demands.materials)
            seen["by case"] += limit.name.startswith("max_error of")
            seen[limit.name] += 1
        seen["none keeps"] += not case.keeping
    assert all(seen[name] for name in ("joints", "poses", "weights", "maximised", "by link", "by material", "by case"))
    assert all(seen[name] for name in ("average_error", "inner_size", "safety_factor"))


def test_an_answer_that_is_not_the_best_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    case = next(each for seed in range(20) if len((each := drawn(tmp_path, seed, listed=True, few=True)).keeping) > 1)

    def worse(problem: Problem) -> OptimizationResult:
        result = optimise(problem)
        return replace(result, objective=1.01 * result.objective)

    monkeypatch.setattr(enumerated, "optimise", worse)
    with pytest.raises(AssertionError):
        held(case)
