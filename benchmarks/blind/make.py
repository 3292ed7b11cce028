"""Makes a half: cases in parallel, each from its own seed, then the seal."""

from __future__ import annotations

import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from benchmarks.blind.generator.cases import kind_of, make_case
from benchmarks.blind.generator.files import write_case
from benchmarks.blind.seal import write_seal

HALVES = ("disclosed", "sealed")


def _one(job: tuple[int, int, str, str]) -> str:
    index, seed, half, root = job
    kind, number = kind_of(index)
    name = f"{index:05d}"
    write_case(make_case(name, (seed, HALVES.index(half), index), kind, number), Path(root))
    return name


def make(cases: int, seed: int, half: str, root: Path, jobs: int = 2) -> str:
    """Writes `cases` cases under root and seals them; returns the seal. Raises FileExistsError on a sealed folder."""
    if (root / "seal.txt").exists():
        raise FileExistsError(f"{root} is sealed already; choose another folder")
    root.mkdir(parents=True, exist_ok=True)
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    work = [(index, seed, half, str(root)) for index in range(cases)]
    start = time.monotonic()
    with ProcessPoolExecutor(jobs) as pool:
        for done, _ in enumerate(pool.map(_one, work, chunksize=4), 1):
            if done % 50 == 0 or done == cases:
                print(f"{done} of {cases} cases, {time.monotonic() - start:.0f} s", file=sys.stderr)
    return write_seal(root, half)
