"""Random planar arms whose designs are held against a small evaluation by hand: materials, loads, warmth and boxes."""

from __future__ import annotations

import os
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import OptimizationResult
from linkwright.core.optimize.run import optimise
from tests.costs import slow_but
from tests.optimize.adversary import hostile as tried
from tests.optimize.adversary.hostile import by_hand, held, hostile, poses
from tests.optimize.builders import one_exchange

PROBLEMS = int(os.environ.get("PROBLEMS", "0"))
"""Random problems of each kind; none is one of each but the kind that takes longest. `make problems` takes more."""
KINDS = [kind for kind in product((2, 3), (False, True), (False, True)) if PROBLEMS or kind != (3, True, True)]


def slow_kinds():
    """The dearest kinds are slow."""
    dear = ((2, False, False), (2, True, False), (2, True, True), (3, False, False), (3, True, False))
    return [pytest.param(*kind, marks=pytest.mark.slow) if kind in dear else kind for kind in KINDS]


@pytest.mark.parametrize("seed", range(max(PROBLEMS, 1)))
@pytest.mark.parametrize(("links", "box", "free"), slow_kinds())
def test_designs_are_what_they_claim_by_hand(links: int, box: bool, free: bool, seed: int, tmp_path: Path) -> None:
    held(hostile(tmp_path, seed, links, box=box, free=free))


def test_problems_are_not_all_alike(tmp_path: Path) -> None:
    """Loads against the weight, growth, materials to choose, and boxes of which the arm as given leaves a part."""
    cases = [hostile(tmp_path, seed, 2, box=True, free=True) for seed in range(8)]
    assert {case.given.warmer != 0.0 for case in cases} == {True, False}
    assert {case.problem.materials is None for case in cases} == {True, False}
    assert any(fy > payload * 9.81 for case in cases for payload, _, fy in case.loads)
    unreached = [poses(case, case.given)[1] for case in cases]
    assert min(unreached) == 0.0 < max(unreached)


@pytest.mark.parametrize("seed", slow_but((0, 1), 0))
def test_hand_and_tool_agree_on_the_arm_as_given(seed: int, tmp_path: Path) -> None:
    """At the tool's own worst pose, of every problem's given arm, and to rounding."""
    for links in (2, 3):
        case = hostile(tmp_path, seed, links, box=False, free=False)
        worst = evaluate(case.problem.arm, case.problem.workspace, case.problem.load_cases).worst
        assert case.given.worst(np.array([worst.poses[0].q]), case.loads) == pytest.approx(worst.error, rel=1e-9)


@pytest.mark.parametrize("figure", ["objective", pytest.param("share", marks=pytest.mark.slow)])
def test_an_answer_that_claims_too_much_is_noticed(
    figure: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = hostile(tmp_path, 1, 2, box=figure == "share", free=False)
    if figure == "share":
        case = replace(case, box=case.box + np.array([0.1, 0.0]))  # type: ignore[operator]

    def better(problem: Problem) -> OptimizationResult:
        result = optimise(problem)
        return replace(result, objective=0.99 * result.objective) if figure == "objective" else result

    monkeypatch.setattr(tried, "optimise", better)
    with pytest.raises(AssertionError):
        held(case)


def test_sizes_by_hand_weigh_what_the_tool_says(tmp_path: Path) -> None:
    case = hostile(tmp_path, 3, 3, box=False, free=False)
    result = evaluate(case.problem.arm, case.problem.workspace, case.problem.load_cases)
    assert by_hand(case.problem.arm, growth=False).mass == pytest.approx(result.mass, rel=1e-12)


@pytest.mark.parametrize("seed", [3, 43])
def test_poses_with_joints_to_spare_stay_within_their_ranges(seed: int, tmp_path: Path) -> None:
    """The elbow of these arms works at the end of its range; a program that lets it go beyond believes designs worse
    than they are, by 5e-4, and stops there, or goes to and fro between two of them."""
    case = hostile(tmp_path, seed, 3, box=True, free=True)
    arm, done = one_exchange(case.problem)
    assert done.converged
    assert done.worst is not None
    assert done.solution.error <= done.worst.error * (1.0 + 1e-4)
    design = by_hand(arm, growth=case.given.warmer != 0.0)
    q, _ = poses(case, design)
    assert design.worst(q, case.loads) <= done.worst.error * (1.0 + 1e-4)
