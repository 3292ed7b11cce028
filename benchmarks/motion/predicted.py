"""What the tool's corrected arms are worth on the log that was held for testing, by `predict` on its command line."""

from __future__ import annotations

import contextlib
import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from benchmarks.blind.run import CORRECTED
from linkwright.core.executors import Processes, plain

FOLDER = "predicted"


def _predict(question: tuple[str, str, str]) -> int:
    from linkwright.command_line import outcome  # the one touch of what is judged

    arm, log, out = question
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        return outcome(["predict", arm, log, "--json", out])


def predict_all(root: Path, answers: Path, jobs: int = 2) -> int:
    """Predicts the test log of each case that is answered and not predicted yet, by the corrected arm where there is
    one, else by the arm as given; returns how many that were."""
    (answers / FOLDER).mkdir(parents=True, exist_ok=True)
    questions = []
    for answer in sorted(answers.glob("*.json")):
        case, out = root / "cases" / answer.stem, answers / FOLDER / answer.name
        if out.exists() or not case.is_dir():
            continue
        corrected = answers / CORRECTED / f"{answer.stem}.yaml"
        arm = corrected if corrected.exists() else case / "arm.yaml"
        questions.append((str(arm), str(case / "test.csv"), str(out)))
    with Processes(jobs, patience=0.0, tries=2) as processes:
        return sum(status == 0 for _, status, _ in processes.outcomes(plain(_predict), questions))


def predictions(answers: Path) -> Mapping[str, Mapping[str, Any]]:
    """What was predicted, by case."""
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in (answers / FOLDER).glob("*.json")}
