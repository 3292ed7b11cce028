"""Makes a half of the proof of motion logs: cases in parallel, each from its own seed, then the seal."""

from __future__ import annotations

from pathlib import Path

from benchmarks.blind.make import HALVES as SEALED_AS
from benchmarks.blind.make import sealed
from benchmarks.motion.generator.cases import HALVES, kind_of, make_case
from benchmarks.motion.generator.files import write_case


def _one(job: tuple[int, int, str, str]) -> str:
    index, seed, half, root = job
    kind, family = kind_of(index)
    name = f"{index:05d}"
    write_case(make_case(name, (seed, HALVES.index(half), index), half, kind, family), Path(root))
    return name


def make(cases: int, seed: int, half: str, root: Path, jobs: int = 2) -> str:
    """Writes `cases` cases under root and seals them; returns the seal. Raises FileExistsError on a sealed folder."""
    work = [(index, seed, half, str(root)) for index in range(cases)]
    return sealed(_one, work, root, SEALED_AS[HALVES.index(half)], jobs)
