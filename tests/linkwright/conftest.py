"""An arm, problems and results that the tests of the command line and of the reports share."""

import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

from linkwright.cli import run
from linkwright.core.arm.chain.chain import LoadCase
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.optimize.result import BindingLimit, Candidate, Iteration, OptimizationResult
from linkwright.core.sections import Circle, Tube
from tests.linkwright.samples import arm_of, mapped

ROOT = Path(__file__).resolve().parents[2]

ARM = """\
name: bench <arm> & co
chain:
  - joint: {type: revolute, range: [-90 deg, 90 deg], backlash: 3 arcmin}
    link: {length: 400 mm, section: {shape: circle, diameter: 60 mm}, material: aluminium-6061-t6}
  - joint: {type: revolute, range: [-100 deg, 100 deg], stiffness: 50 kN*m/rad, mass: 3 kg}
    link: {length: 300 mm, section: {shape: tube, diameter: 50 mm, thickness: 4 mm}, material: steel-s355}
payload: {mass: 2 kg}
"""

PROBLEM = """\
arm: arm.yaml
workspace: {path: [[500 mm, 200 mm], [400 mm, 300 mm]]}
subject_to: {mass: "<= 3 kg", section_size: [20 mm, 80 mm], thickness: [2 mm, 10 mm]}
choose: {section: [tube], material: [aluminium-6061-t6]}
load_cases:
  - {payload: {mass: 1 kg}}
  - {payload: {mass: 0 kg}, force: [20 N, 0 N, 0 N]}
"""


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A working folder with arm.yaml and problem.yaml; the user's own catalogue is out of the way."""
    (tmp_path / "arm.yaml").write_text(ARM, encoding="utf-8")
    (tmp_path / "problem.yaml").write_text(PROBLEM, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "no-configuration"))
    monkeypatch.delenv("LINKWRIGHT_CATALOGUE", raising=False)
    return tmp_path


@pytest.fixture
def linkwright(bench, capsys):  # noqa: ARG001 - the command runs in that folder
    """Run the command line there; gives (exit status, standard output, standard error)."""

    def command(*arguments):
        status = run([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return command


@pytest.fixture
def process(bench):
    """Run the command line there as a process of its own, through a shell where a pipe is wanted."""

    def command(line):
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHON": sys.executable}
        return subprocess.run(
            ["bash", "-c", f"set -o pipefail; {line}"],
            cwd=bench,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )

    return command


@pytest.fixture(scope="session")
def evaluation():
    """A planar arm of two solid bars, under two load cases."""
    return evaluate(arm_of((Circle(0.05), Circle(0.04))), load_cases=(LoadCase(1.0), LoadCase(0.0, (20.0, 0.0, 0.0))))


@pytest.fixture(scope="session")
def result(evaluation):
    """An optimisation as it could have ended: tubes in place of the bars, all lengths kept."""
    after = evaluate(arm_of((Tube(0.08, 0.003), Tube(0.07, 0.002))), load_cases=evaluation.load_cases)
    error = after.max_error
    return OptimizationResult(
        problem_file="folder/problem.yaml",
        minimize="max_error",
        limits=("mass <= 3 kg", "section_size 5 mm to 500 mm"),
        choices=("section: circle, tube",),
        status="certified",
        arm=after.arm,
        before=evaluation,
        after=after,
        objective=error,
        lower_bound=0.999 * error,
        binding=(BindingLimit("mass", "mass <= 3 kg", 3.0, 3.0, "kg", -0.0042, "mm/kg"),),
        iterations=(
            Iteration(1, 0.8 * error, math.nan, 4, 0.25, False),
            Iteration(2, error, 0.1, 5, 0.0, True),
        ),
        candidates=(
            Candidate(("tube", "tube"), ("aluminium-6061-t6",) * 2, error, "best"),
            Candidate(("circle", "tube"), ("aluminium-6061-t6",) * 2, 1.1 * error, "bounded out"),
            Candidate(("circle", "circle"), ("steel-s355",) * 2, None, "infeasible"),
        ),
        exhaustive=True,
        seconds=0.5,
        before_map=mapped(evaluation),
        after_map=mapped(after),
    )
