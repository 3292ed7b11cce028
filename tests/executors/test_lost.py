"""What does the work is lost in the midst of it: the best so far is kept, one line says so, and it can go on."""

from __future__ import annotations

import io
import json
import logging
import signal
from collections.abc import Generator, Sequence
from pathlib import Path
from typing import Any

import pytest

import linkwright as lw
from linkwright.browser.server import work
from linkwright.cli import run
from linkwright.core.executors import Here, Work, WorkersLost, plain
from linkwright.core.executors.executor import Pulse, no_pulse
from linkwright.core.optimize.run import optimise
from tests.executors import steps
from tests.executors.dask_processes import joined, two_workers
from tests.optimize.builders import jointed, problem_of, ranged

ARM = jointed((500, 400), ranged("-100 100", "30 140"))
SIZES = "section_size: [20 mm, 90 mm], thickness: [2 mm, 8 mm]"
LIMITS = f"subject_to: {{mass: '<= 4 kg', max_error: '<= 1.5 mm', {SIZES}}}\n"
FREE = "choose: {section: [circle, rectangle]}\n"
ALIKE = "choose: {section: circle}\n"
GONE = "the scheduler at tcp://10.0.0.1:8786 is gone; start it and its workers again"


class Lossy(Here):
    """Workers that are there for so many steps, and then gone."""

    def __init__(self, good: int) -> None:
        super().__init__()
        self.good = good

    @property
    def shares(self) -> bool:
        """As others do."""
        return True

    def completed(
        self, work: Work[Any, Any, Any], items: Sequence[Any], pulse: Pulse = no_pulse
    ) -> Generator[tuple[int, Any]]:
        """The results until they are gone."""
        for item in super().completed(work, items, pulse):
            if not self.good:
                raise WorkersLost(GONE)
            self.good -= 1
            yield item


def test_the_best_design_so_far_is_the_answer(tmp_path: Path):
    crew = Lossy(0)
    result = optimise(problem_of(tmp_path, ARM, FREE + LIMITS), executor=crew)
    assert result.interrupted
    assert result.status == "interrupted"
    assert result.after.max_error < result.before.max_error
    assert str(crew.lost) == GONE


def ignored(*_: object) -> None:
    return None


def lost_at_once(_: int | None) -> Lossy:
    return Lossy(0)


@pytest.fixture
def lossy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which the command line's workers are lost at once."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("linkwright.core.executors.Processes", lost_at_once)
    return tmp_path


@pytest.mark.slow
def test_a_command_writes_the_best_so_far(lossy: Path, capsys: pytest.CaptureFixture[str]):
    problem_of(lossy, ARM, FREE + LIMITS)
    assert run(["optimize", "problem.yaml", "--out", "out"]) == 1
    assert capsys.readouterr().err == f"{GONE}; this is the best design so far\n"
    assert json.loads((lossy / "out" / "result.json").read_text())["interrupted"]


@pytest.mark.slow
def test_a_page_shows_the_best_so_far_and_why_it_is_no_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    problem_of(tmp_path, ARM, FREE + LIMITS)
    (tmp_path / "out").mkdir()
    asked = {"kind": "optimize", "root": str(tmp_path), "out": str(tmp_path / "out"), "problem": "problem.yaml"}
    monkeypatch.setattr("sys.stdin", io.StringIO(json.dumps(asked)))
    monkeypatch.setattr(lw, "Processes", lambda: Lossy(0))
    # Signals are this process's own, whose tests go on.
    monkeypatch.setattr(signal, "signal", ignored)
    assert work.main() == 0
    answers = [told for line in capsys.readouterr().out.splitlines() if "answer" in (told := json.loads(line))]
    assert [answer["complete"] for answer in answers] == [False]
    assert answers[0]["answer"].startswith("Optimization: interrupted, ")
    assert answers[0]["answer"].endswith(f"; {GONE}")
    assert (tmp_path / "out" / "arm.yaml").exists()


@pytest.mark.slow
def test_a_scheduler_that_is_killed_ends_the_work_at_once(caplog: pytest.LogCaptureFixture):
    """In the midst of a work, and again before the next one; dask's client says nothing more of it."""
    got: list[float] = []
    before = {name: list(logging.getLogger(name).filters) for name in logging.root.manager.loggerDict}
    with two_workers() as dask, joined(dask) as cluster:
        loggers = [logging.getLogger(name) for name in ("distributed.client", "distributed.utils")]
        for logger in loggers:
            logger.addHandler(caplog.handler)

        def kill(number: int, result: float) -> None:
            del number
            got.append(result)
            if len(got) == 2:
                dask.scheduler.kill()
                dask.scheduler.wait()

        try:
            for _ in range(2):
                with pytest.raises(WorkersLost, match=f"the scheduler at {dask.address} is gone"):
                    cluster.map(plain(steps.wait), [0.2] * 20, each=kill)
            assert 2 <= len(got) < 20
            assert cluster.lost is not None
            cluster.close()
        finally:
            for item in loggers:
                item.removeHandler(caplog.handler)
    assert caplog.records == []
    assert all(logging.getLogger(name).filters == filters for name, filters in before.items())
