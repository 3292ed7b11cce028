"""The page of measured figures, and a small sample of the scans against bounds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.results import random_problems
from benchmarks.results.__main__ import SECTIONS, page
from benchmarks.results.row import Row, at_least, at_most
from linkwright.core.optimize.run import optimise

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("seed", [1, 6])
def test_no_scanned_pose_is_worse_than_the_bound(seed: int) -> None:
    result = random_problems.run(seed)
    assert result is not None
    assert result.bound is not None
    assert result.worst <= result.bound * (1.0 + 1e-9)
    assert result.worst >= result.bound * (1.0 - 1e-3)  # a scan that saw nothing would say nothing


def test_a_bound_that_is_too_low_is_beaten(tmp_path: Path) -> None:
    problem = random_problems.random_problem(tmp_path, 1)
    result = optimise(problem)
    longer = result.arm.with_links(tuple(replace(link, length=1.01 * link.length) for link in result.arm.links))
    assert result.after.worst.upper_bound is not None
    assert random_problems.scanned(longer, problem.load_cases, 1)[0] > result.after.worst.upper_bound


def test_page_says_what_misses_its_target() -> None:
    rows = [
        at_least("fast", 7.0, 5.0),
        at_least("slow", 3.0, 5.0, "why"),
        at_most("light", 1.0, "s", 2.0),
        Row("x", "1"),
    ]
    text = page({next(iter(SECTIONS)): rows}, quick=True)
    assert [row.met for row in rows] == [True, False, True, None]
    assert "Targets missed: slow (3 times)." in text
    assert "| slow | 3 times | at least 5 | **missed** | why |" in text


def test_sections_that_are_not_measured_anew_stay() -> None:
    first, second = list(SECTIONS)[:2]
    before = page({first: [at_least("fast", 7.0, 5.0)], second: [at_least("slow", 3.0, 5.0)]}, quick=False)
    text = page({first: [at_least("fast", 8.0, 5.0)]}, before, quick=False)
    assert "| fast | 8 times |" in text
    assert "| slow | 3 times | at least 5 | **missed** |  |" in text
    assert "Targets missed: slow (3 times)." in text
    assert text.index("fast") < text.index("## " + SECTIONS[second][0])
