"""What must hold of every file, and the processes in which it is held within bounds."""

from __future__ import annotations

import multiprocessing
import os
import resource
import shutil
import tempfile
import time
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from multiprocessing.sharedctypes import Synchronized
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings

from .kind import REFUSED, Kind
from .kinds import kinds
from .odd import odd_files

SECONDS = 10.0
BYTES = 1024**3


class Wrong(Exception):
    """A file that was neither read nor refused in one line."""


def hold(kind: Kind, files: Mapping[str, bytes], folder: Path) -> bool:
    """Read files; tells whether they could be. Raises `Wrong` where a refusal is no line."""
    for name, text in kind.good.items():
        (folder / name).write_text(text, encoding="utf-8")
    for name, content in files.items():
        (folder / name).write_bytes(content)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            kind.read(folder)
    except REFUSED as error:
        line = str(error)
        if not line.strip() or len(line.splitlines()) != 1 or len(line) > 3000:
            raise Wrong(f"not one line: {line[:200]!r}") from error
        return False
    return True


@dataclass(frozen=True)
class _Progress:
    """What a process tells of itself: files begun; since when (`time.monotonic`) one is read, 0 between two."""

    begun: Synchronized[int]
    since: Synchronized[float]


def _held_of(name: str, kind: Kind, count: int, number: int, told: _Progress, folder: Path) -> None:
    """Hold so many odd files of a kind. Raises what the first one raises."""

    @seed(number)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
        print_blob=False,
    )
    @given(odd_files(dict(kind.odd)))
    def every(files: dict[str, bytes]) -> None:
        told.begun.value += 1
        told.since.value = time.monotonic()  # what thinks up the next file takes its own time
        try:
            hold(kind, files, folder)
        finally:
            told.since.value = 0.0

    every.__name__ = name
    every()


def _worker(name: str, count: int, number: int, told: _Progress, folder: str) -> None:
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    most = pages * os.sysconf("SC_PAGE_SIZE") + BYTES
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    _held_of(name, kinds()[name], count, number, told, Path(folder))


class Watched:
    """A process that holds odd files of one kind, ended where one of them takes longer than `SECONDS`."""

    def __init__(self, name: str, count: int, number: int) -> None:
        context = multiprocessing.get_context("fork")
        self.name, self.wrong = name, ""
        self._told = _Progress(context.Value("q", 0, lock=False), context.Value("d", 0.0, lock=False))
        self._folder = tempfile.mkdtemp(prefix=f"fuzz-{name}-")
        self._process = context.Process(target=_worker, args=(name, count, number, self._told, self._folder))
        self._process.start()

    @property
    def held(self) -> int:
        """How many inputs were held."""
        return self._told.begun.value

    def ended(self) -> bool:
        """Whether it has come to its end; `wrong` then tells of what it found, and where the files are that did it."""
        slow = False
        if self._process.is_alive():
            since = self._told.since.value
            slow = since > 0.0 and time.monotonic() - since > SECONDS
            if not slow:
                return False
            self._process.kill()
        self._process.join()
        if self._process.exitcode == 0:
            shutil.rmtree(self._folder, ignore_errors=True)
        else:
            why = f"took longer than {SECONDS:g} s" if slow else "is neither read nor refused in one line (above)"
            self.wrong = f"a file {why}: {self._folder}"
        return True
