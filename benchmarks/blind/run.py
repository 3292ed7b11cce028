"""Asks the tool about each recording, in worker processes, by its public command line alone."""

from __future__ import annotations

import contextlib
import io
import json
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path
from types import FrameType
from typing import Any

from benchmarks.blind.seal import digest, half_of
from linkwright.core.executors import Processes, plain

FAILED = -1
CORRECTED = "corrected"
"""Folder of the answers' corrected arms, kept from the one asking for what they predict."""


class SealedTwiceError(ValueError):
    """A sealed half has been asked already."""


class _LateError(Exception):
    """No answer in time. Not a TimeoutError: that is an OSError, for which the tool blames a file."""


def _late(number: int, frame: FrameType | None) -> None:
    raise _LateError(f"signal {number}, {frame is not None}")


def ask(case: str, answer: str, seconds: float) -> tuple[int, float, str]:
    """One question: exit status, seconds, the last line that the tool printed as an error. Of one that is not answered
    in time: FAILED, the seconds that it had, and a line that says so."""
    from linkwright.command_line import outcome  # the one touch of what is judged

    folder, corrected = Path(case), Path(answer).parent.parent / CORRECTED
    start = time.perf_counter()
    words = io.StringIO()
    with tempfile.TemporaryDirectory() as out:
        recordings = [str(path) for path in sorted(folder.glob("recording*.csv"))]
        asked = ["diagnose", str(folder / "arm.yaml"), *recordings, "--json", answer, "--out", out]
        signal.signal(signal.SIGALRM, _late)
        signal.setitimer(signal.ITIMER_REAL, seconds)
        try:
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(words):
                status = outcome(asked)
        except _LateError:
            return FAILED, time.perf_counter() - start, f"no answer in {seconds:g} s"
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        if (Path(out) / "arm.yaml").exists():
            corrected.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(Path(out) / "arm.yaml", corrected / f"{Path(answer).stem}.yaml")
    lines = words.getvalue().strip().splitlines()
    return status, time.perf_counter() - start, lines[-1] if lines else ""


def _ask(question: tuple[str, str, float]) -> tuple[int, float, str]:
    return ask(*question)


def _write(answers: Path, name: str, status: int, seconds: float | None, error: str) -> None:
    raw = answers / "diagnosis" / f"{name}.json"
    diagnosis: Any = json.loads(raw.read_text(encoding="utf-8")) if status == 0 and raw.exists() else None
    record = {"case": name, "status": status, "seconds": seconds, "error": error, "diagnosis": diagnosis}
    (answers / f"{name}.json").write_text(json.dumps(record) + "\n", encoding="utf-8")


def _claim(root: Path, answers: Path) -> None:
    """A sealed half is asked once: the first folder of answers owns it, and no answer is given twice."""
    names = {path.name for path in (root / "cases").iterdir()}
    if half_of(root) != "sealed":
        return
    owner = root / "asked.txt"
    if (root / "scored.txt").exists():
        raise SealedTwiceError(f"{root}: its truths have been opened; there is no second run")
    if owner.exists() and owner.read_text(encoding="utf-8").strip() != answers.name:
        raise SealedTwiceError(f"{root}: asked already, its answers lie in {owner.read_text(encoding='utf-8').strip()}")
    if answers.exists() and names <= {path.stem for path in answers.glob("*.json")}:
        raise SealedTwiceError(f"{answers}: all answers are given; a sealed half is not asked twice")
    owner.write_text(answers.name + "\n", encoding="utf-8")


def run(root: Path, answers: Path, jobs: int = 2, limit: int | None = None, seconds: float = 120.0) -> int:
    """Answers what is not answered yet; returns how many that were. Raises SealedTwiceError."""
    _claim(root, answers)
    (answers / "diagnosis").mkdir(parents=True, exist_ok=True)
    names = sorted(path.name for path in (root / "cases").iterdir())
    left = [name for name in names if not (answers / f"{name}.json").exists()][:limit]
    start, done = time.monotonic(), 0
    questions = [(str(root / "cases" / n), str(answers / "diagnosis" / f"{n}.json"), seconds) for n in left]
    with Processes(jobs, patience=0.0, tries=2) as processes:
        # A case whose worker dies is asked once more, and fails alone.
        for number, answer, error in processes.outcomes(plain(_ask), questions):
            if answer is not None:
                _write(answers, left[number], *answer)
            else:
                _write(answers, left[number], FAILED, None, f"{type(error).__name__}: {error}"[:500])
            done += 1
            if done % (16 * jobs) == 0 or done == len(left):
                print(f"{done} of {len(left)} answered, {time.monotonic() - start:.0f} s", file=sys.stderr)
    if all((answers / f"{name}.json").exists() for name in names):
        lines = [f"{digest((answers / f'{n}.json').read_bytes())}  {n}.json" for n in names]
        (answers / "seal.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return done
