"""Who does long work: the executor that was given, or processes made for it."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager

from executors import Executor, Processes
from units.quantities import InputError


@contextmanager
def at_work(executor: Executor | None, workers: int | None) -> Generator[Executor]:
    """The executor that was given, which stays open; else processes, so many or one for each core."""
    if executor is not None:
        if workers is not None:
            raise InputError("", "workers", "goes without an executor, which has workers of its own; leave one out")
        yield executor
        return
    with Processes(workers) as made:
        yield made
