"""Makes a half of the second proof: cases in parallel, each from its own seed, then the seal."""

from __future__ import annotations

from pathlib import Path

from benchmarks.blind.make import HALVES as SEALED_AS
from benchmarks.blind.make import sealed
from benchmarks.multibody.cases import HALVES, REMOUNTS, kind_of, make_case
from benchmarks.multibody.files import write_case


def _one(job: tuple[int, int, str, str, float]) -> str:
    index, seed, half, root, remounts = job
    kind, number = kind_of(index)
    name = f"{index:05d}"
    write_case(make_case(name, (seed, HALVES.index(half), index), half, kind, number, remounts), Path(root))
    return name


def make(cases: int, seed: int, half: str, root: Path, jobs: int = 2, remounts: float = REMOUNTS) -> str:
    """Writes `cases` cases under root and seals them; returns the seal. Raises FileExistsError on a sealed folder."""
    work = [(index, seed, half, str(root), remounts) for index in range(cases)]
    return sealed(_one, work, root, SEALED_AS[HALVES.index(half)], jobs)
