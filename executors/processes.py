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
from collections import deque
from collections.abc import Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextvars import ContextVar
from dataclasses import dataclass, field
from multiprocessing import get_context, parent_process
from typing import Any

from linkwright.core.units.quantities import InputError

from .executor import Executor, Here, Item, Kept, Pulse, Result, Work, WorkersLost, no_pulse
from .packing import packed, unpacked
from .threads import one_thread_for_children

PATIENCE = 2.0
"""Seconds of work that are done in this process before others are started: most work ends sooner."""
TRIES = 3
"""How often a step is begun whose worker is killed."""
FORKED = sys.platform == "linux"
"""Whether workers are forked."""
_BEAT = 0.1
"""Seconds between two signs of life while results are waited for."""


class _Prepared:
    """What a worker has to do, and what it keeps for it."""

    def __init__(self, work: Work[Any, Any, Any]) -> None:
        self._work, self._here = work, Here()

    def step(self, item: bytes) -> bytes:
        """One step."""
        return packed(self._here.step(self._work, unpacked(item)))


_PREPARED: ContextVar[_Prepared] = ContextVar("prepared")
"""Of a worker: what it was started for."""


def _begin(work: Work[Any, Any, Any] | bytes) -> None:
    """Set a worker up. What ends all processes of a terminal or a service is its parent's to deal with; without its
    parent it ends."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    _PREPARED.set(_Prepared(unpacked(work) if isinstance(work, bytes) else work))


def _end_with_parent() -> None:
    """Wait until the parent is gone, which a kill allows no last word: nobody would ever give this worker anything."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _step(item: bytes) -> bytes:
    return _PREPARED.get().step(item)


@dataclass(eq=False)
class _Worker:
    """One process, and the number of the item that it has."""

    pool: ProcessPoolExecutor
    pid: int | None = None
    future: Future[bytes] | None = None
    number: int = -1
    born: Future[int] | None = field(default=None, repr=False)

    def give(self, number: int, item: bytes) -> None:
        """Give it an item."""
        self.born = self.born or self.pool.submit(os.getpid)
        self.number, self.future = number, self.pool.submit(_step, item)

    def end(self) -> None:
        """End the process, at once where it is at work."""
        if self.future is not None and not self.future.done() and self.born is not None:
            with contextlib.suppress(ProcessLookupError, BrokenProcessPool):
                # One that is only just being started tells who it is before it begins.
                os.kill(self.born.result(), getattr(signal, "SIGKILL", signal.SIGTERM))
        self.pool.shutdown(wait=True, cancel_futures=True)


class Processes(Executor):
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
        found: list[int] = []
        for each in self._crew:
            with contextlib.suppress(BrokenProcessPool):
                found += [] if each.born is None else [each.born.result()]
        return found

    def completed(
        self, work: Work[Kept, Item, Result], items: Sequence[Item], pulse: Pulse = no_pulse
    ) -> Generator[tuple[int, Result]]:
        """The results as they come; the first ones are this process's own."""
        number, began = 0, time.monotonic()
        while number < len(items) and self._stays(work, len(items) - number, time.monotonic() - began):
            pulse()
            yield number, self._here.step(work, items[number])
            number += 1
        for other, result, error in self._shared(work, items, range(number, len(items)), pulse):
            if error is not None:
                raise error
            yield other, result

    def outcomes(
        self, work: Work[Kept, Item, Result], items: Sequence[Item], pulse: Pulse = no_pulse
    ) -> Generator[tuple[int, Result | None, BaseException | None]]:
        """Each item's number with its result, or with what its step raised (`WorkersLost` where it killed its
        workers), as they come; all in processes of their own."""
        yield from self._shared(work, items, range(len(items)), pulse)

    def _stays(self, work: Work[Any, Any, Any], left: int, seconds: float) -> bool:
        """Whether the next step is this process's own: there is one worker alone, or little has been done yet."""
        if self._patience <= 0.0 or self._work is work:
            return False
        return self._count == 1 or left == 1 or seconds < self._patience

    def _shared(
        self, work: Work[Any, Any, Any], items: Sequence[Any], numbers: Sequence[int], pulse: Pulse
    ) -> Generator[tuple[int, Any, BaseException | None]]:
        if self._work is not work and numbers:
            self.close()
            self._work = work
        left = deque(numbers)
        tried = dict.fromkeys(numbers, 0)
        while len(self._crew) < min(self._count, len(left)):
            self._crew.append(self._worker())
        try:
            busy = [each for each in self._crew if self._next(each, left, items, tried)]
            while busy:
                pulse()
                ended, _ = wait([each.future for each in busy if each.future is not None], _BEAT, FIRST_COMPLETED)
                for worker in [each for each in busy if each.future in ended]:
                    number, future = worker.number, worker.future
                    assert future is not None
                    worker.future, error = None, future.exception()
                    if isinstance(error, BrokenProcessPool):
                        self._replace(worker)
                        error = self._lost(number, tried[number])
                    again = isinstance(error, WorkersLost) and tried[number] < self._tries
                    if again:
                        left.appendleft(number)
                    # The worker has its next item before anybody works on this one's result.
                    if not self._next(worker, left, items, tried):
                        busy.remove(worker)
                    if not again:
                        yield number, None if error else unpacked(future.result()), error
        finally:
            if any(each.future is not None for each in self._crew):
                self.close()

    def _next(self, worker: _Worker, left: deque[int], items: Sequence[Any], tried: dict[int, int]) -> bool:
        """Give a worker the next item; False where there is none left."""
        while left:
            number = left.popleft()
            tried[number] += 1
            try:
                worker.give(number, packed(items[number]))
            except BrokenProcessPool:  # killed while it had nothing to do
                tried[number] -= 1
                left.appendleft(number)
                self._replace(worker)
                continue
            return True
        return False

    def _lost(self, number: int, tries: int) -> WorkersLost:
        guard = "" if FORKED else "; a script needs its work under `if __name__ == '__main__':`"
        message = f"a process was killed {tries} times at step {number + 1}; one worker needs the least memory"
        return WorkersLost(f"workers: {message}{guard}")

    def _replace(self, worker: _Worker) -> None:
        worker.pool.shutdown(wait=False)
        fresh = self._worker()
        worker.pool, worker.born, worker.future = fresh.pool, None, None

    def _worker(self) -> _Worker:
        assert self._work is not None
        given = self._work if FORKED else packed(self._work)
        with one_thread_for_children():
            pool = ProcessPoolExecutor(
                1, mp_context=get_context("fork" if FORKED else "spawn"), initializer=_begin, initargs=(given,)
            )
            return _Worker(pool, born=pool.submit(os.getpid))

    def close(self) -> None:
        """End the processes; what they are at is given up."""
        crew, self._crew, self._work = self._crew, [], None
        for each in crew:
            each.end()
        self._here.close()


def cores() -> int:
    """How many cores this process may use; one where it is itself a worker among others."""
    if parent_process() is not None:
        return 1
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
