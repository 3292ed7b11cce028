"""A search whose own process is killed while others work for it goes on where it was, and leaves nobody behind."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import time
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from linkwright.core.optimize.problem import Problem
from tests.executors.dask_processes import ROOT, joined, two_workers
from tests.optimize.builders import jointed, problem_of, ranged

CHOICE = (
    "choose: {section: [circle, rectangle], material: [aluminium-6061-t6, steel-s355]}\n"
    "subject_to: {mass: '<= 4 kg', section_size: [20 mm, 90 mm]}\n"
)
KILL_AT = 5


def ran(problem: Problem, folder: Path, address: str, kill_at: int) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "tests.executors.killed_search", str(problem.file)]
    command += [str(folder / "search.jsonl"), str(folder / "answer"), address, str(kill_at)]
    given = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(command, cwd=ROOT, env=given, stdout=subprocess.PIPE, text=True, check=False)


def answered(folder: Path) -> Any:
    return pickle.loads((folder / "answer").read_bytes())


def ended(pid: int) -> bool:
    """Whether a process is gone within a while."""
    until = time.monotonic() + 30.0
    while time.monotonic() < until:
        try:
            state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
        except (FileNotFoundError, ProcessLookupError):
            return True
        if state == "Z":
            return True
        time.sleep(0.05)
    return False


@contextmanager
def _two_processes() -> Generator[str]:
    yield ""


@contextmanager
def _dask() -> Generator[str]:
    with two_workers() as made, joined(made):
        yield made.address


@pytest.mark.parametrize("workers", [_two_processes, pytest.param(_dask, marks=pytest.mark.slow)])
def test_killed_midway_with_workers(workers: Any, tmp_path: Path) -> None:
    problem = problem_of(tmp_path, jointed((500, 400), ranged("-100 100", "30 140")), CHOICE)
    whole = tmp_path / "whole"
    whole.mkdir()
    with workers() as address:
        assert ran(problem, whole, address, 0).returncode == 0
        dead = ran(problem, tmp_path, address, KILL_AT)
        assert dead.returncode == -signal.SIGKILL
        assert not (tmp_path / "answer").exists()
        assert all(ended(int(pid)) for pid in dead.stdout.split())
        assert len(dead.stdout.split()) == (0 if address else 2)
        before = (tmp_path / "search.jsonl").read_bytes()
        assert before.count(b"\n") > KILL_AT
        assert ran(problem, tmp_path, address, 0).returncode == 0
    after = (tmp_path / "search.jsonl").read_bytes()
    assert after.startswith(before)
    # Nothing that was known is found again: all that is added stands under keys of its own.
    keys = [line.partition(b', "found"')[0] for line in after.splitlines()[1:]]
    assert len(set(keys)) == len(keys)
    arm, objective, bound, candidates = answered(tmp_path)
    arm_alone, alone, bound_alone, all_candidates = answered(whole)
    assert (objective, bound) == pytest.approx((alone, bound_alone), rel=1e-6)
    assert [candidate.shapes for candidate in candidates] == [candidate.shapes for candidate in all_candidates]
    for link, other in zip(arm.links, arm_alone.links, strict=True):
        assert link.material == other.material
        assert list(link.section.given().values()) == pytest.approx(list(other.section.given().values()), rel=1e-4)
