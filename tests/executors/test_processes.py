"""What processes do: every step once, wherever; a killed one again; nothing left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from types import MappingProxyType

import pytest
from threadpoolctl import threadpool_limits

from linkwright.core.executors import Here, Processes, Work, WorkersLost, plain
from linkwright.core.executors.shared import packed, unpacked
from linkwright.core.executors.threads import threads
from linkwright.core.units.quantities import InputError, NoAnswer
from linkwright.face.progress import at_work
from tests.executors import steps

ROOT = Path(__file__).resolve().parents[2]
KILLED = """
import os, signal
from linkwright.core.executors import Processes, plain
from tests.executors import steps

def kill(number, result):
    print(*two.processes(), flush=True)
    os.kill(os.getpid(), signal.SIGKILL)

with Processes(2, patience=0.0) as two:
    two.map(plain(steps.wait), [0.01] + [30.0] * 8, each=kill)
"""
"""It is killed while both of its workers are at work."""


def test_results_come_in_the_order_of_the_items_whoever_does_them():
    work = plain(steps.square)
    expected = [number * number for number in range(20)]
    with Processes(2, patience=0.0) as two:
        assert two.map(work, range(20)) == expected
        assert two.map(work, range(5)) == expected[:5]
    assert Here().map(work, range(20)) == expected


def test_each_worker_prepares_once():
    work = Work(object, steps.place)
    with Processes(2, patience=0.0) as two:
        places = set(two.map(work, range(12)) + two.map(work, range(12)))
        assert {pid for pid, _ in places} == set(two.processes())
    assert len(places) == 2
    assert os.getpid() not in {pid for pid, _ in places}


def test_short_work_stays_in_this_process():
    with Processes(2) as two:
        assert {pid for pid, _ in two.map(Work(object, steps.place), range(4))} == {os.getpid()}
        assert two.processes() == []


def test_step_whose_worker_is_killed_is_done_again(tmp_path: Path):
    with Processes(2, patience=0.0) as two:
        items = [(str(tmp_path), number) for number in range(8)]
        assert two.map(plain(steps.die_once), items) == list(range(8))


def test_worker_that_is_killed_while_others_work_loses_nothing():
    work = plain(steps.wait)
    with Processes(2, patience=0.0) as two:
        killed: list[int] = []

        def kill(number: int, result: float) -> None:
            del number, result
            if not killed:
                killed.extend(two.processes()[:1])
                os.kill(killed[0], signal.SIGKILL)

        assert two.map(work, [0.05] * 8, each=kill) == [0.05] * 8
        assert killed
        assert killed[0] not in two.processes()


def test_step_that_kills_every_worker_ends_in_one_line():
    with Processes(2, patience=0.0) as two, pytest.raises(WorkersLost, match="killed 3 times at step 4"):
        two.map(plain(steps.die), range(6))


def test_outcomes_hold_results_and_failures_alike():
    with Processes(1, patience=0.0, tries=2) as one:
        raised = sorted((n, r, type(e)) for n, r, e in one.outcomes(plain(steps.refuse), range(5)))
        killed = sorted((n, r, type(e)) for n, r, e in one.outcomes(plain(steps.die), range(5)))
    fine = [(n, n, type(None)) for n in (0, 1, 2, 4)]
    assert raised == [*fine[:3], (3, None, NoAnswer), fine[3]]
    assert killed == [*fine[:3], (3, None, WorkersLost), fine[3]]


def test_what_a_step_raises_is_raised():
    with Processes(2, patience=0.0) as two:
        with pytest.raises(NoAnswer, match="three has none"):
            two.map(plain(steps.refuse), range(8))
        assert two.map(plain(steps.square), [4]) == [16]


def test_interrupt_leaves_what_is_done_and_no_process():
    got: list[float] = []
    with Processes(2, patience=0.0) as two:

        def stop() -> None:
            if got:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            two.map(plain(steps.wait), [0.0, 600.0, 600.0], stop, lambda _, result: got.append(result))
    assert got == [0.0]
    assert two.processes() == []


def test_workers_end_with_a_parent_that_is_killed():
    # Its standard output ends when the last of its processes has.
    made = subprocess.run(
        [sys.executable, "-c", KILLED], cwd=ROOT, stdout=subprocess.PIPE, text=True, timeout=20.0, check=False
    )
    assert made.returncode == -signal.SIGKILL
    assert len(made.stdout.split()) == 2


def test_number_of_workers_is_checked():
    with pytest.raises(InputError, match="must be 1 or more, not 0"):
        Processes(0)
    assert Processes().workers >= 1


def test_workers_take_one_thread_each_and_their_parent_keeps_its_own():
    import numpy as np

    assert np.linalg.det(np.eye(3)) == 1.0  # the library is loaded
    with threadpool_limits(2, user_api="blas"):
        before = threads()
        assert set(before) == {2}
        with Processes(2, patience=0.0) as two:
            assert two.map(plain(steps.threads), range(2)) == [[1] * len(before)] * 2
        assert threads() == before


def test_long_work_takes_one_thread_here_too():
    with threadpool_limits(2, user_api="blas"):
        before = threads()
        with at_work(Here(), None) as given:
            assert isinstance(given, Here)
            assert set(threads()) == {1}
        assert threads() == before


def test_read_only_mappings_are_sent():
    got = unpacked(packed({"a": MappingProxyType({"b": 1.0})}))
    assert got == {"a": {"b": 1.0}}
    assert isinstance(got["a"], MappingProxyType)
