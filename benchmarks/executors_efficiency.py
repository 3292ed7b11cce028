"""What an executor costs.

Tasks of a second, by processes and by a dask scheduler with as many workers, all of them processes of this machine.
The efficiency per worker is the tasks' own time over the workers' whole time, starting of processes included where
they are ours (a cluster is there before). Tasks sleep, so that another load on the machine says nothing.
"""

from __future__ import annotations

import socket
import subprocess
import sys
import time
from collections.abc import Generator
from contextlib import contextmanager

from linkwright.core.executors import Cluster, Executor, plain

TARGET = 0.8


def slept(seconds: float) -> float:
    """A task that waits."""
    time.sleep(seconds)
    return seconds


@contextmanager
def cluster(workers: int) -> Generator[str]:
    """The address of a scheduler with so many workers of one thread each."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    dask = [sys.executable, "-m", "dask"]
    started = [[*dask, "scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]]
    started += [[*dask, "worker", address, "--nthreads", "1", "--no-dashboard"]] * workers
    running = [subprocess.Popen(item, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for item in started]
    try:
        with Cluster(address, patience=60.0) as made:
            while made.workers < workers:
                time.sleep(0.1)
        yield address
    finally:
        for each in reversed(running):
            each.terminate()
            each.wait()


def measured(name: str, executor: Executor, workers: int, tasks: list[float]) -> float:
    """The efficiency per worker of tasks that sleep so many seconds each."""
    began = time.perf_counter()
    result = executor.map(plain(slept), tasks)
    seconds = time.perf_counter() - began
    if result != tasks:
        raise SystemExit(f"{name}: the results are not those of the tasks")
    return sum(tasks) / (workers * seconds)
