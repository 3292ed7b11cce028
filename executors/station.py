"""What runs on a dask worker; the one module that needs dask."""

from __future__ import annotations

import threading
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from distributed import WorkerPlugin, get_worker

from linkwright.core.executors.shared import packed, unpacked

from .executor import Here, Work

PROGRAM = "linkwright"


class Station(WorkerPlugin):
    """What a worker keeps for one piece of work, as a plug-in of its: one that joins later has it as well.

    A worker may have several threads; each prepares for itself.
    """

    def __init__(self, name: str, work: bytes) -> None:
        self.name, self._work = name, work
        self._lock, self._per_thread = threading.Lock(), threading.local()
        self._opened: Work[Any, Any, Any] | None = None

    def __reduce__(self) -> tuple[object, ...]:
        """Send what was given alone."""
        return Station, (self.name, self._work)

    def step(self, item: bytes) -> bytes:
        """One step."""
        with self._lock:
            if self._opened is None:
                self._opened = unpacked(self._work)
        here: Here | None = getattr(self._per_thread, "here", None)
        if here is None:
            here = self._per_thread.here = Here()
        assert self._opened is not None
        return packed(here.step(self._opened, unpacked(item)))


def step(name: str, item: bytes) -> bytes:
    """One step of the work of that name."""
    station: Any = get_worker().plugins[name]
    return station.step(item)


def installed() -> str:
    """The version of this program here; empty where it only lies there."""
    try:
        return version(PROGRAM)
    except PackageNotFoundError:
        return ""
