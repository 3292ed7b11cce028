"""Who does long work: the executor that was given, or processes made for it."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager, nullcontext

from linkwright.core.executors import Executor, Processes
from linkwright.core.executors.threads import one_thread
from linkwright.core.units.quantities import InputError


@contextmanager
def at_work(executor: Executor | None, workers: int | None) -> Generator[Executor]:
    """The executor that was given, which stays open; else processes, so many or one for each core. Linear algebra takes
    one thread meanwhile, here too."""
    if executor is not None and workers is not None:
        raise InputError("", "workers", "goes without an executor, which has workers of its own; leave one out")
    with one_thread(), nullcontext(executor) if executor is not None else Processes(workers) as crew:
        yield crew
