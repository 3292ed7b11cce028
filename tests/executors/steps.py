"""Steps for workers to do: functions that they can import."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

from linkwright.core.units.quantities import NoAnswer


def square(item: int) -> int:
    return item * item


def place(kept: object, item: int) -> tuple[int, int]:
    """Where it was done, and which object was kept."""
    del item
    time.sleep(0.02)
    return os.getpid(), id(kept)


def refuse(item: int) -> int:
    if item == 3:
        raise NoAnswer("three has none")
    return item


def wait(item: float) -> float:
    time.sleep(item)
    return item


def die_once(item: tuple[str, int]) -> int:
    """Kill the worker that does the third for the first time."""
    folder, number = item
    mark = Path(folder) / str(number)
    if number == 3 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(0.02)
    return number


def die(item: int) -> int:
    if item == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return item


def threads(item: int) -> list[int]:
    """How many threads each library of linear algebra that is loaded would take."""
    from linkwright.core.executors.threads import threads as counted

    del item
    return counted()
