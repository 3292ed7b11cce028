"""What an executor costs: python -m benchmarks.executors_efficiency [--tasks N --workers N --seconds S --compute]

Tasks of a second, by processes and by a dask scheduler with as many workers, all of them processes of this machine.
The efficiency per worker is the tasks' own time over the workers' whole time, starting of processes included where
they are ours (a cluster is there before). Tasks sleep, so that another load on the machine says nothing; with
`--compute` they spend a second of their core's time. Exit status 1 where an efficiency is below 0.8.
"""

from __future__ import annotations

import argparse
import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager

from linkwright.core.executors import Cluster, Executor, Processes, plain

TARGET = 0.8
Task = Callable[[float], float]


def slept(seconds: float) -> float:
    """A task that waits."""
    time.sleep(seconds)
    return seconds


def computed(seconds: float) -> float:
    """A task that computes for so long, by the time of its own core."""
    began, x = time.thread_time(), 0.0
    while time.thread_time() - began < seconds:
        for number in range(1000):
            x += number**0.5
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
    running = [subprocess.Popen(each, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for each in started]
    try:
        with Cluster(address, patience=60.0) as made:
            while made.workers < workers:
                time.sleep(0.1)
        yield address
    finally:
        for each in reversed(running):
            each.terminate()
            each.wait()


def measured(name: str, executor: Executor, workers: int, tasks: list[float], task: Task) -> float:
    """The efficiency, printed."""
    began = time.perf_counter()
    found = executor.map(plain(task), tasks)
    seconds = time.perf_counter() - began
    if found != tasks:
        raise SystemExit(f"{name}: the results are not those of the tasks")
    efficiency = sum(tasks) / (workers * seconds)
    print(f"  {name:26} {seconds:7.2f} s, efficiency per worker {efficiency:.3f}")
    return efficiency


def main() -> int:
    """Measure and print; 1 where a target is missed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.executors_efficiency")
    parser.add_argument("--tasks", type=int, default=64)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=1.0, help="of each task")
    parser.add_argument("--compute", action="store_true", help="compute instead of sleeping")
    asked = parser.parse_args()
    from benchmarks.executors_efficiency import computed, slept  # as workers find them

    task = computed if asked.compute else slept
    tasks = [asked.seconds] * asked.tasks
    print(f"{asked.tasks} tasks of {asked.seconds:g} s, {asked.workers} workers, {os.cpu_count()} cores")
    with Processes(asked.workers, patience=0.0) as processes:
        found = [measured("processes", processes, asked.workers, tasks, task)]
    with cluster(asked.workers) as address, Cluster(address) as workers:
        found.append(measured("dask, separate processes", workers, asked.workers, tasks, task))
    return 0 if min(found) >= TARGET else 1


if __name__ == "__main__":
    raise SystemExit(main())
