"""A dask cluster: a scheduler and two workers, each a process of its own, on the loopback."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Iterator

import pytest

from linkwright.core.executors import Cluster, Work, WorkersLost, plain
from linkwright.core.units.quantities import InputError, NoAnswer
from tests.executors import steps
from tests.executors.dask_processes import Dask, free_port, joined, two_workers


@pytest.fixture(scope="module")
def dask() -> Iterator[Dask]:
    with two_workers() as made:
        yield made


@pytest.fixture
def cluster(dask: Dask) -> Iterator[Cluster]:
    with joined(dask) as made:
        yield made


def test_results_come_in_the_order_of_the_items(cluster: Cluster):
    assert cluster.workers == 2
    assert cluster.map(plain(steps.square), range(20)) == [number * number for number in range(20)]


def test_each_worker_prepares_once_for_each_work(cluster: Cluster, dask: Dask):
    work = Work(object, steps.place)
    places = set(cluster.map(work, range(12)) + cluster.map(work, range(12)))
    assert {pid for pid, _ in places} == {worker.pid for worker in dask.workers}
    assert len(places) == 2


def test_what_a_step_raises_is_raised(cluster: Cluster):
    with pytest.raises(NoAnswer, match="three has none"):
        cluster.map(plain(steps.refuse), range(8))


def test_worker_that_is_killed_loses_nothing(cluster: Cluster, dask: Dask):
    killed: list[int] = []

    def kill(number: int, result: float) -> None:
        del number, result
        if not killed:
            killed.append(dask.workers[0].pid)
            os.kill(killed[0], signal.SIGKILL)

    assert cluster.map(plain(steps.wait), [0.1] * 12, each=kill) == [0.1] * 12
    assert dask.workers.pop(0).wait() == -signal.SIGKILL
    dask.add()


def test_interrupt_gives_up_what_is_under_way(cluster: Cluster):
    got: list[float] = []

    def stop() -> None:
        if got:
            raise KeyboardInterrupt

    work = plain(steps.wait)
    with pytest.raises(KeyboardInterrupt):
        cluster.map(work, [0.0, 1.0, 1.0, 1.0, 600.0], stop, lambda _, result: got.append(result))
    assert got == [0.0]
    assert cluster.map(work, [0.0]) == [0.0]


def test_nobody_there_is_one_line_within_seconds():
    began = time.monotonic()
    for address in (f"tcp://127.0.0.1:{free_port()}", "nonsense", "tcp://"):
        with pytest.raises(InputError, match=f"--dask: no dask scheduler answers at {address}"):
            Cluster(address, patience=1.0)
    assert time.monotonic() - began < 30.0


def test_an_address_of_no_scheme_that_dask_knows_makes_no_client(monkeypatch: pytest.MonkeyPatch):
    """A client that could not start says so a second time, in a traceback, when it is collected."""
    monkeypatch.setattr("distributed.Client", lambda *_, **__: pytest.fail("a client was made"))
    with pytest.raises(InputError, match="no dask scheduler answers at x://y"):
        Cluster("x://y", patience=0.1)


def test_without_dask_one_line_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"pip install 'dask>=[0-9.]+' 'distributed>=[0-9.]+'"):
        Cluster("tcp://127.0.0.1:8786")


def test_step_that_kills_every_worker_ends_in_one_line(cluster: Cluster):
    """The last test: no worker is left after it."""
    with pytest.raises(WorkersLost, match="ended every worker that took it"):
        cluster.map(plain(steps.die), [3])
