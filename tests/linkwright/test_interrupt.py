"""Ctrl-C while a design is sought: what was found is written, and said to be no more than that."""

import itertools
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import linkwright as lw
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.read import read_arm
from linkwright.core.optimize.problem import read_problem
from tests.costs import slow_but

ROOT = Path(__file__).resolve().parents[2]

WAITS_AT = """
import sys
from linkwright.cli import main
from linkwright.screen import progress

told = progress.Steps.__call__


def heard(self, text, share):
    if text.startswith(sys.argv[1]):
        print("reached", flush=True)
        sys.stdin.readline()  # by now the signal is sent
    told(self, text, share)


progress.Steps.__call__ = heard
main(sys.argv[2:])
"""
"""A run that says when it has come so far, and goes on once it is answered."""


def interrupted_at(folder, word, *arguments, how=signal.SIGINT):
    """Run the command until its progress tells of `word`, send a signal; exit status and standard error."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", WAITS_AT, word, *arguments]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, cwd=folder, env=environment, text=True, **pipes) as run:
        assert any(line.startswith("reached") for line in run.stdout)
        run.send_signal(how)
        _, error = run.communicate("go on\n")
        return run.returncode, error


@pytest.mark.parametrize("how", slow_but([signal.SIGINT, signal.SIGTERM, signal.SIGHUP], signal.SIGINT))
def test_the_best_so_far_is_written_and_called_that(bench, how):
    """While further starts are tried the first design is finished: its files are there, as sure as they say."""
    status, error = interrupted_at(bench, "solving from further", "optimize", "problem.yaml", "--out", "out", how=how)
    assert status == 130
    assert "stopped: this is the best design so far" in error
    result = json.loads((bench / "out" / "result.json").read_text())
    assert result["status"] == "interrupted"
    assert result["interrupted"]
    assert result["optimum"] == "local"
    problem = read_problem(bench / "problem.yaml")
    made = evaluate(read_arm(bench / "out" / "arm.yaml"), problem.workspace, problem.load_cases)
    assert 1e3 * made.max_error == pytest.approx(result["max_error_mm"], rel=1e-5)
    assert made.mass <= 3.0 * (1.0 + 1e-6)
    assert result["max_error_mm"] < result["before"]["max_error_mm"]
    page = (bench / "out" / "report.html").read_text()
    assert "Interrupted: the best design so far" in page
    assert "its own worst case certified" in page


@pytest.mark.slow
def test_an_interrupt_while_sizes_are_compared_leaves_the_optimum(bench):
    """The optimum was finished, and says so; the sizes were not."""
    arguments = ("optimize", "problem.yaml", "--round", "1 mm", "--out", "out")
    status, error = interrupted_at(bench, "comparing rounded sizes, 0 designs", *arguments)
    assert status == 130
    assert "stopped: this is the best design so far" in error
    result = json.loads((bench / "out" / "result.json").read_text())
    assert result["status"] == "certified"
    assert result["interrupted"]
    assert result["rounded"] is None
    assert result["not_rounded"]["reason"] == "interrupted before a design of them was found"
    assert read_arm(bench / "out" / "arm.yaml").size == 2


def test_an_interrupt_of_a_plan_leaves_the_best_so_far(bench, linkwright, monkeypatch):
    """While poses at random are tried the visits are chosen: they are written, promised, and said to be no more."""
    tried = itertools.count()

    def interrupted(_, text, __):
        if text.startswith("comparing with poses") and next(tried) == 1:
            raise KeyboardInterrupt

    monkeypatch.setattr("linkwright.screen.progress.Steps.__call__", interrupted)
    arguments = ("plan", "arm.yaml", "--poses", "8", "--repeats", "1", "--for", "backlash:1", "--payload", "0 kg")
    status, _, error = linkwright(*arguments, "--out", "out.csv", "--json", "out.json")
    assert status == 130
    assert error == "stopped: this is the best plan so far\n"
    result = json.loads((bench / "out.json").read_text())
    assert result["interrupted"]
    assert result["random_plans"] == 1
    assert result["shown"][0]["smallest"] > 0.0
    assert len((bench / "out.csv").read_text().splitlines()) == 9


def test_before_any_design_there_is_nothing_to_keep(bench, linkwright, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(lw, "optimize", interrupted)
    status, _, error = linkwright("optimize", "problem.yaml", "--out", "out")
    assert status == 130
    assert error == "stopped: no design was finished yet, so there is none to keep\n"
    assert not (bench / "out").exists()


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("diagnose", ("arm.yaml", "recording.csv", "--out", "out")),
        ("plan", ("arm.yaml", "--poses", "4", "--for", "backlash", "--out", "out.csv")),
    ],
)
def test_what_has_no_best_so_far_says_where_it_was_stopped(bench, linkwright, monkeypatch, name, arguments):
    def interrupted(*_, progress=None, **__):
        if progress is not None:
            progress("choosing", 0.5)
        raise KeyboardInterrupt

    status, _, _ = linkwright("simulate", "arm.yaml", "--poses", "4", "--out", "recording.csv")
    assert status == 0
    monkeypatch.setattr("linkwright.screen.progress._PATIENCE", 0.0)
    for face in ("diagnose", "plan"):
        monkeypatch.setattr(lw, face, interrupted)
    status, out, error = linkwright(name, *arguments)
    assert (status, out) == (130, "")
    assert error == "stopped at: choosing; no answer was finished yet, so there is none to keep\n"
    assert not (bench / "out.csv").exists()
    assert not (bench / "out" / "result.json").exists()
