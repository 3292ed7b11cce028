"""Progress, interrupts and executors of long computations: a callable or a bar, Ctrl-C, processes."""

from __future__ import annotations

import signal
from collections.abc import Callable, Generator
from contextlib import contextmanager, nullcontext
from types import FrameType

from linkwright.core.executors import Executor, Processes
from linkwright.core.executors.threads import one_thread
from linkwright.core.units.quantities import InputError

Progress = Callable[[str, float], None]
"""Hears what is being done, and what share of the whole is behind (0 to 1)."""


@contextmanager
def reporting(progress: Progress | None) -> Generator[Progress]:
    """The callable that was given; without one a bar, on a terminal or in a notebook only."""
    if progress is not None:
        yield progress
        return
    from linkwright.screen.console import console
    from linkwright.screen.progress import Steps

    screen = console(errors=True)
    if not (screen.is_terminal or screen.is_jupyter):
        yield _silent
        return
    steps = Steps()
    try:
        yield steps
    finally:
        steps.close()


def _silent(text: str, share: float) -> None:
    del text, share


@contextmanager
def interrupts() -> Generator[Callable[[], None]]:
    """Note the first Ctrl-C and raise it at the next call of what is given, for a solver in between would take it for a
    separate failure; a second one is raised at once."""
    noted: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        if noted:
            signal.default_int_handler(number, frame)
        noted.append(number)

    def check() -> None:
        if noted:
            raise KeyboardInterrupt

    try:
        before = signal.signal(signal.SIGINT, note)
    except ValueError:  # not the main thread, which alone hears of signals
        yield check
        return
    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def at_work(executor: Executor | None, workers: int | None) -> Generator[Executor]:
    """The executor that was given, which stays open; else processes, so many or one for each core. Linear algebra takes
    one thread meanwhile, here too."""
    if executor is not None and workers is not None:
        raise InputError("", "workers", "goes without an executor, which has workers of its own; leave one out")
    with one_thread(), nullcontext(executor) if executor is not None else Processes(workers) as crew:
        yield crew
