"""Makes a half of the second proof: cases in parallel, each from its own seed, then the seal."""

from __future__ import annotations

import sys
import time
from pathlib import Path

from benchmarks.blind.seal import write_seal
from benchmarks.multibody.cases import HALVES, REMOUNTS, kind_of, make_case
from benchmarks.multibody.files import write_case
from linkwright.core.executors import Processes, plain

SEALED_AS = ("disclosed", "sealed")
"""What the runner calls the halves: a sealed one it asks once."""


def _one(job: tuple[int, int, str, str, float]) -> str:
    index, seed, half, root, remounts = job
    kind, number = kind_of(index)
    name = f"{index:05d}"
    write_case(make_case(name, (seed, HALVES.index(half), index), half, kind, number, remounts), Path(root))
    return name


def make(cases: int, seed: int, half: str, root: Path, jobs: int = 2, remounts: float = REMOUNTS) -> str:
    """Writes `cases` cases under root and seals them; returns the seal. Raises FileExistsError on a sealed folder."""
    if (root / "seal.txt").exists():
        raise FileExistsError(f"{root} is sealed already; choose another folder")
    root.mkdir(parents=True, exist_ok=True)
    work = [(index, seed, half, str(root), remounts) for index in range(cases)]
    start = time.monotonic()
    with Processes(jobs, patience=0.0) as processes:
        for done, _ in enumerate(processes.completed(plain(_one), work), 1):
            if done % 20 == 0 or done == cases:
                print(f"{done} of {cases} cases, {time.monotonic() - start:.0f} s", file=sys.stderr)
    return write_seal(root, SEALED_AS[HALVES.index(half)])
