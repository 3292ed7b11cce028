"""Processes of this machine, each a pool of one: when a worker is killed, just the step that it had is done again.

On Linux workers are forked, and know what their parent registered; elsewhere they are started anew (`spawn`), so that a
script needs its `if __name__ == "__main__":`.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
import time
from collections.abc import Generator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextvars import ContextVar
from multiprocessing import get_context, parent_process
from typing import Any

from linkwright.core.executors.shared import packed, unpacked
from linkwright.core.units.quantities import InputError

from .executor import Here, Item, Kept, Pulse, Result, Work, WorkersLost, no_pulse
from .shared import Begin, Shared
from .threads import one_thread_for_children

PATIENCE = 2.0
"""Seconds of work that are done in this process before others are started: most work ends sooner."""
TRIES = 3
"""How often a step is begun whose worker is killed."""
FORKED = sys.platform == "linux"
"""Whether workers are forked."""

_PREPARED: ContextVar[tuple[Work[Any, Any, Any], Here]] = ContextVar("prepared")
"""Of a worker: what it was started for, and what it keeps for it."""


def _begin(work: Work[Any, Any, Any] | bytes) -> None:
    """Set a worker up. What ends all processes of a terminal or a service is its parent's to deal with; without its
    parent it ends."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    _PREPARED.set((unpacked(work) if isinstance(work, bytes) else work, Here()))


def _end_with_parent() -> None:
    """Wait until the parent is gone, which a kill allows no last word: nobody would ever give this worker anything."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _step(item: bytes) -> bytes:
    work, here = _PREPARED.get()
    return packed(here.step(work, unpacked(item)))


class _Worker:
    """A pool of one process for one work, started anew where it is killed."""

    def __init__(self, work: Work[Any, Any, Any]) -> None:
        self._given = work if FORKED else packed(work)
        self._start()

    def _start(self) -> None:
        with one_thread_for_children():
            context = get_context("fork" if FORKED else "spawn")
            self._pool = ProcessPoolExecutor(1, mp_context=context, initializer=_begin, initargs=(self._given,))
            self._born = self._pool.submit(os.getpid)
        self._step: Future[bytes] | None = None

    def begin(self, item: bytes) -> Future[bytes]:
        """Begin a step."""
        try:
            self._step = self._pool.submit(_step, item)
        except BrokenProcessPool:  # killed since its last step
            self._pool.shutdown(wait=False)
            self._start()
            self._step = self._pool.submit(_step, item)
        return self._step

    def pid(self) -> int | None:
        """The number of its process; None where that was killed before it could tell."""
        with contextlib.suppress(BrokenProcessPool):
            return self._born.result()
        return None

    def end(self) -> None:
        """End the process, at once where it is at work."""
        # One that is only just being started tells who it is before it begins.
        if self._step is not None and not self._step.done() and (pid := self.pid()) is not None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, getattr(signal, "SIGKILL", signal.SIGTERM))
        self._pool.shutdown(wait=True, cancel_futures=True)


class Processes(Shared):
    """Worker processes of this machine, started once there is work for more than `patience` seconds.

    `workers` is how many (None: as many as there are cores that this process may use), `tries` how often a step is
    begun whose worker is killed. With no `patience` at all nothing is done in this process. Raises `InputError` for
    less than one worker.

    >>> import linkwright as lw
    >>> with lw.Processes(2) as processes:
    ...     processes
    <Processes: 2 workers>
    """

    def __init__(self, workers: int | None = None, *, patience: float = PATIENCE, tries: int = TRIES) -> None:
        if workers is not None and workers < 1:
            raise InputError("", "workers", f"must be 1 or more, not {workers}; leave it out for one each core")
        self._count = workers or cores()
        self._patience, self._tries = patience, tries
        self._here = Here()
        self._work: Work[Any, Any, Any] | None = None
        self._crew: list[_Worker] = []

    @property
    def workers(self) -> int:
        """How many processes there are once there is work for them."""
        return self._count

    @property
    def shares(self) -> bool:
        """It is, but for a worker alone."""
        return self._count > 1 or self._patience <= 0.0

    def __repr__(self) -> str:
        """How many."""
        return f"<Processes: {self._count} workers>"

    def processes(self) -> list[int]:
        """The process numbers of the workers that run."""
        return [pid for worker in self._crew if (pid := worker.pid()) is not None]

    def completed(
        self, work: Work[Kept, Item, Result], items: Sequence[Item], pulse: Pulse = no_pulse
    ) -> Generator[tuple[int, Result]]:
        """The results as they come; the first ones are this process's own."""
        number, began = 0, time.monotonic()
        while number < len(items) and self._stays(work, len(items) - number, time.monotonic() - began):
            pulse()
            yield number, self._here.step(work, items[number])
            number += 1
        for other, result, error in self.outcomes(work, items, pulse, number):
            if error is not None:
                raise error
            yield other, result

    def _stays(self, work: Work[Any, Any, Any], left: int, seconds: float) -> bool:
        """Whether the next step is this process's own: there is one worker alone, or little has been done yet."""
        if self._patience <= 0.0 or self._work is work:
            return False
        return self._count == 1 or left == 1 or seconds < self._patience

    def _open(self, work: Work[Any, Any, Any], steps: int) -> list[Begin]:
        if self._work is not work:
            self.close()
            self._work = work
        while len(self._crew) < min(self._count, steps):
            self._crew.append(_Worker(work))
        return [item.begin for item in self._crew]

    def _error(self, future: Future[bytes], number: int, tries: int) -> BaseException | None:
        error = future.exception()
        if not isinstance(error, BrokenProcessPool):
            return error
        guard = "" if FORKED else "; a script needs its work under `if __name__ == '__main__':`"
        message = f"a process was killed {tries} times at step {number + 1}; one worker needs the least memory"
        return WorkersLost(f"workers: {message}{guard}")

    def _look(self) -> None:
        """A process that ends says so in what it was at."""

    def _give_up(self) -> None:
        self.close()

    def close(self) -> None:
        """End the processes; what they are at is given up."""
        crew, self._crew, self._work = self._crew, [], None
        for item in crew:
            item.end()
        self._here.close()


def cores() -> int:
    """How many cores this process may use; one where it is itself a worker among others."""
    if parent_process() is not None:
        return 1
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
