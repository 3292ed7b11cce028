"""One answer, whoever does the work: this process, processes, or a cluster one of whose workers is killed."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from linkwright.core.arm.figures import FIGURES
from linkwright.core.executors import Processes
from linkwright.core.executors.shared import packed, unpacked
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import OptimizationResult
from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import InputError
from tests.executors.dask_processes import Dask, joined, two_workers
from tests.optimize.builders import jointed, problem_of, ranged

ARM = jointed((500, 400), ranged("-100 100", "30 140"))
SIZES = "section_size: [20 mm, 90 mm], thickness: [2 mm, 8 mm]"
LIMITS = f"subject_to: {{mass: '<= 4 kg', max_error: '<= 1.5 mm', {SIZES}}}\n"
FREE = "choose: {section: [circle, rectangle]}\n"
ALIKE = "choose: {section: circle}\n"


@pytest.fixture(scope="module")
def dask() -> Iterator[Dask]:
    with two_workers() as made:
        yield made


def killed_in_the_midst(dask: Dask) -> None:
    """Kill one of the workers, which is found again later."""
    os.kill(dask.workers.pop(0).pid, signal.SIGKILL)
    dask.add()


def same(one: OptimizationResult, other: OptimizationResult) -> bool:
    """Whether two runs came to the same, to a certificate's gap."""
    figures = [(item.objective, item.lower_bound, item.after.max_error) for item in (one, other)]
    assert figures[0] == pytest.approx(figures[1], rel=1e-4)
    kinds = [[(link.section.shape, link.material.name) for link in item.arm.links] for item in (one, other)]
    tried = [{(candidate.shapes, candidate.materials) for candidate in found.candidates} for found in (one, other)]
    return (one.status, kinds[0], tried[0]) == (other.status, kinds[1], tried[1])


@pytest.mark.slow
def test_choice_among_combinations(dask: Dask, tmp_path: Path):
    problem = problem_of(tmp_path, ARM, FREE + LIMITS)
    alone = optimise(problem)
    with Processes(2, patience=0.0) as processes:
        assert same(optimise(problem, executor=processes), alone)
        assert len(processes.processes()) == 2
    texts: list[str] = []

    def kill(done: int, total: int, text: str) -> None:
        del total
        if not texts and done and text == "bounding combinations":
            texts.append(text)
            killed_in_the_midst(dask)

    with joined(dask) as cluster:
        assert same(optimise(problem, executor=cluster, progress=kill), alone)
    assert texts


def sent(problem: Problem) -> Problem:
    return unpacked(packed(problem))


def test_problem_arrives_as_it_was_sent(tmp_path: Path):
    """What is registered by its name, so that it is the same object there."""
    problem = problem_of(tmp_path, ARM, FREE + LIMITS)
    assert sent(problem) == problem
    assert sent(problem).figures is FIGURES
    assert sent(problem).objective is problem.objective


def test_limit_that_a_worker_does_not_know_is_named(tmp_path: Path):
    problem = problem_of(tmp_path, ARM, LIMITS)
    own = replace(FIGURES["mass"], name="own_mass", key="own_mass_kg", follows=FIGURES["wall_slenderness"].follows)
    FIGURES.register(own)
    try:
        there = packed(replace(problem, limits=(replace(problem.limits[0], figure=own),)))
    finally:
        FIGURES.withdraw("own_mass")
    with pytest.raises(InputError, match="own_mass: is a limit of one's own that a worker does not know"):
        unpacked(there)


def test_short_work_takes_no_processes(tmp_path: Path):
    with Processes(2, patience=600.0) as processes:
        optimise(problem_of(tmp_path, ARM, ALIKE + LIMITS), executor=processes)
        assert processes.processes() == []
