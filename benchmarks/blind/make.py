"""Makes a half: cases in parallel, each from its own seed, then the seal."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from benchmarks.blind.generator.cases import kind_of, make_case
from benchmarks.blind.generator.files import write_case
from benchmarks.blind.seal import write_seal
from linkwright.core.executors import Processes, plain

HALVES = ("disclosed", "sealed")


def sealed(one: Callable[[Any], str], work: Sequence[Any], root: Path, half: str, jobs: int) -> str:
    """Writes the cases of all `work` under root and seals them; returns the seal. Raises FileExistsError on a sealed
    folder."""
    if (root / "seal.txt").exists():
        raise FileExistsError(f"{root} is sealed already; choose another folder")
    root.mkdir(parents=True, exist_ok=True)
    start = time.monotonic()
    with Processes(jobs, patience=0.0) as processes:
        for done, _ in enumerate(processes.completed(plain(one), work), 1):
            if done % 20 == 0 or done == len(work):
                print(f"{done} of {len(work)} cases, {time.monotonic() - start:.0f} s", file=sys.stderr)
    return write_seal(root, half)


def _one(job: tuple[int, int, str, str]) -> str:
    index, seed, half, root = job
    kind, number = kind_of(index)
    name = f"{index:05d}"
    write_case(make_case(name, (seed, HALVES.index(half), index), kind, number), Path(root))
    return name


def make(cases: int, seed: int, half: str, root: Path, jobs: int = 2) -> str:
    """Writes `cases` cases under root and seals them; returns the seal. Raises FileExistsError on a sealed folder."""
    return sealed(_one, [(index, seed, half, str(root)) for index in range(cases)], root, half, jobs)
