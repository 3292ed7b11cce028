"""A dask scheduler and two workers, each a process of its own, on the loopback."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from linkwright.core.executors import Cluster

FEW = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"}
"""One worker may die of a step, as when somebody kills it; two are the step's own doing."""
ROOT = Path(__file__).resolve().parents[2]


@dataclass
class Dask:
    """The address and the processes."""

    address: str
    scheduler: subprocess.Popen[bytes]
    workers: list[subprocess.Popen[bytes]]

    def add(self) -> None:
        """One more worker."""
        self.workers.append(_started("worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard"))


def _started(*arguments: str) -> subprocess.Popen[bytes]:
    paths = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH", ""))))
    given = {**os.environ, "PYTHONPATH": paths, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", **FEW}
    command = [sys.executable, "-m", "dask", *arguments]
    return subprocess.Popen(command, env=given, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        return int(taken.getsockname()[1])


@contextmanager
def two_workers() -> Generator[Dask]:
    """The scheduler with its workers, ended at the end."""
    port = free_port()
    scheduler = _started("scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
    made = Dask(f"tcp://127.0.0.1:{port}", scheduler, [])
    try:
        made.add()
        made.add()
        yield made
    finally:
        for process in (*made.workers, scheduler):
            process.kill()
            process.wait()


@contextmanager
def joined(dask: Dask) -> Generator[Cluster]:
    """The cluster, once it has two workers."""
    with Cluster(dask.address, patience=60.0) as made:
        until = time.monotonic() + 60.0
        while made.workers < 2 and time.monotonic() < until:
            time.sleep(0.05)
        yield made
