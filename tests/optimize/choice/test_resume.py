"""A search that was stopped goes on where it was: the same design, to the last digit, as without the stop."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest

import linkwright as lw
from linkwright.command_line import outcome
from linkwright.core.optimize.choice.solution_cache import search_journal
from linkwright.core.optimize.exchange.program import Program
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import OptimizationResult
from linkwright.core.optimize.rounding.options import read_rounding
from linkwright.core.optimize.rounding.rounding import optimise_rounded
from linkwright.core.optimize.run import optimise
from tests.costs import slow_but
from tests.optimize.builders import jointed, problem_of, ranged, taken_for_many

VERSION = "linkwright 0"
ARM = jointed((500, 400), ranged("-60 60", "0 60")) + "leave_out: [shear_deformation]\n"
LIMITS = "{mass: '<= 4 kg', cost: '<= 40 EUR', section_size: [10 mm, 90 mm]%s}\n"
STUFFS = ", ".join(
    f"{{name: m{k}, elastic_modulus: {70 + 37 * k % 90} GPa, poisson_ratio: 0.3, density: {2700 + 1013 * k % 4000} "
    f"kg/m^3, cost: {3 + 7 * k % 11} EUR/kg}}"
    for k in range(5)
)
CHOICE = "choose: {section: [circle, rectangle], material: [aluminium-6061-t6, steel-s355]}\n"
UNCERTAIN = "robust: %s\nuncertain: {elastic_modulus: 10 %%, stiffness: [20 %%, 40 %%]}\n"
PROBLEMS = {
    "every one": CHOICE + f"subject_to: {LIMITS % ''}",
    "bounds": f"choose: {{section: [circle], material: [{STUFFS}]}}\nsubject_to: {LIMITS % ''}",
    "all at once": CHOICE + f"subject_to: {LIMITS % ', link_length: [300 mm, 600 mm], reach: == 900 mm'}",
    "drives": (
        "choose: {section: [circle], material: [aluminium-6061-t6, steel-s355], actuator: [RV-6E, RV-20E]}\n"
        "subject_to: {mass: '<= 4 kg', section_size: [10 mm, 90 mm]}\n"
    ),
    "worst": CHOICE + UNCERTAIN % "worst" + f"subject_to: {LIMITS % ''}",
    "share": "choose: {section: [circle]}\n" + UNCERTAIN % "90 %" + f"subject_to: {LIMITS % ''}",
}


def searched(problem: Problem, path: Path | None, stop_at: int | None = None) -> tuple[OptimizationResult | None, int]:
    """The answer of a search (None where it had none) and how often it told how far it is; an interrupt stops it the
    time of that number."""
    told = 0

    def tell(*_: object) -> None:
        nonlocal told
        told += 1
        if told == stop_at:
            raise KeyboardInterrupt

    with search_journal(problem, path, VERSION) or nullcontext() as journal:
        try:
            return optimise(problem, progress=tell, journal=journal), told
        except KeyboardInterrupt:
            return None, told


@pytest.mark.parametrize("kind", slow_but(PROBLEMS, "bounds"))
def test_the_answer_is_that_of_no_stop(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if kind == "bounds":
        taken_for_many(monkeypatch)
    problem = problem_of(tmp_path, ARM, PROBLEMS[kind])
    solved = 0
    solve = Program.solve

    def counted(program: Program, *given: Any, **more: Any) -> Any:
        nonlocal solved
        solved += 1
        return solve(program, *given, **more)

    monkeypatch.setattr(Program, "solve", counted)
    whole, steps = searched(problem, None)
    assert whole is not None
    alone, solved = solved, 0
    path = tmp_path / "search.jsonl"
    searched(problem, path, stop_at=max(2, 2 * steps // 3))
    before = solved
    content = path.read_bytes()
    path.write_bytes(content[:-20])  # as a kill leaves it: the last line cut short
    known = content[:-20].count(b"\n") - 1
    resumed, _ = searched(problem, path)
    assert resumed is not None
    assert known > 0
    assert solved - before < alone
    solved = 0
    again, _ = searched(problem, path)
    # All that is left are solutions that no combination stands for: prices of limits, say.
    assert solved == 0
    assert again is not None
    for other in (resumed, again):
        assert other.arm == whole.arm
        assert (other.objective, other.lower_bound, other.gap) == (whole.objective, whole.lower_bound, whole.gap)
        assert other.status == whole.status
        assert other.candidates == whole.candidates
        assert other.drives == whole.drives
        assert [iteration.objective for iteration in other.iterations] == [
            iteration.objective for iteration in whole.iterations
        ]
        assert [tie.arm for tie in other.near_ties] == [tie.arm for tie in whole.near_ties]
        assert other.binding == whole.binding
        assert other.robust == whole.robust


def rounded(problem: Problem, path: Path, stop_at: int | None = None) -> tuple[OptimizationResult | None, list[str]]:
    """As `searched`, with the stock sizes after it; what was told."""
    told: list[str] = []

    def tell(done: int, total: int, text: str) -> None:
        del done, total
        told.append(text)
        if len(told) == stop_at:
            raise KeyboardInterrupt

    with search_journal(problem, path, VERSION) or nullcontext() as journal:
        try:
            return optimise_rounded(problem, read_rounding("stock"), progress=tell, journal=journal), told
        except KeyboardInterrupt:
            return None, told


@pytest.mark.slow
def test_rounding_goes_on_too(tmp_path: Path) -> None:
    text = "choose: {section: [tube], material: [aluminium-6061-t6]}\n"
    problem = problem_of(tmp_path, ARM, text + f"subject_to: {LIMITS % ', thickness: [1 mm, 8 mm]'}")
    whole, told = rounded(problem, tmp_path / "whole.jsonl")
    assert whole is not None
    assert whole.rounded is not None
    for number, stop_at in enumerate((len(told) // 2, len(told))):
        path = tmp_path / f"stopped{number}.jsonl"
        stopped, _ = rounded(problem, path, stop_at)
        assert stopped is None or stopped.interrupted or (stopped.rounded is not None and stopped.rounded.interrupted)
        known = path.read_bytes()
        result, _ = rounded(problem, path)
        assert known.count(b"\n") > 1
        assert path.read_bytes().startswith(known)
        assert result is not None
        assert result.arm == whole.arm
        assert result.rounded is not None
        assert result.rounded.arm == whole.rounded.arm
        assert result.rounded.objective == whole.rounded.objective
        assert result.rounded.exhaustive == whole.rounded.exhaustive


def test_what_is_of_another_problem_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    problem = problem_of(tmp_path, ARM, PROBLEMS["every one"])
    path = tmp_path / "search.jsonl"
    searched(problem, path, stop_at=3)
    content = path.read_bytes()
    with pytest.raises(lw.InputError, match="another question"):
        search_journal(problem, path, "linkwright 1")
    other = PROBLEMS["every one"].replace("4 kg", "5 kg")
    (tmp_path / "problem.yaml").write_text("arm: arm.yaml\n" + other, encoding="utf-8")
    command = ["optimize", str(tmp_path / "problem.yaml"), "--resume"]
    assert outcome([*command, str(path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "search.jsonl: is of another question (problem or version differ); name another file" in error
    with pytest.raises(lw.InputError, match="another question"):
        lw.optimize(tmp_path / "problem.yaml", resume=path)
    assert path.read_bytes() == content
    for strange in ("arm.yaml", "problem.yaml"):
        own = (tmp_path / strange).read_bytes()
        assert outcome([*command, str(tmp_path / strange)]) == 2
        assert capsys.readouterr().err.count("\n") == 1
        assert (tmp_path / strange).read_bytes() == own
