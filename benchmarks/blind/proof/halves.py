"""A half as the report needs it: folders, truths, answers, score, and seeded samples of its cases."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.blind.answers import Answer, Truth, load
from benchmarks.blind.run import CORRECTED
from benchmarks.blind.score import Score, score
from benchmarks.blind.seal import digest

_SEED = 20260704


@dataclass(frozen=True)
class Half:
    """All that is known of a half; `given` is the SHA-256 over its answers, in the order of the cases."""

    name: str
    cases: Path
    answers: Path
    truths: tuple[Truth, ...]
    said: Mapping[str, Answer]
    score: Score
    given: str

    def folder(self, case: str) -> Path:
        """Where a case's files lie."""
        return self.cases / "cases" / case

    def corrected(self, case: str) -> Path:
        """The corrected arm that came with the answer."""
        return self.answers / CORRECTED / f"{case}.yaml"

    def key(self, case: str) -> str:
        """What a figure that hangs on this answer is valid for."""
        return digest((self.answers / f"{case}.json").read_bytes())[:16]


def read_half(cases: Path, answers: Path) -> Half:
    """A half whose seal holds; of a disclosed one, the cases that are answered.

    Raises FileNotFoundError and benchmarks.blind.seal.BrokenSealError. A sealed half counts as opened from here on.
    """
    truths, said, half, seal = load(cases, answers, partial=True)
    if not truths:
        raise FileNotFoundError(f"{answers}: no case is answered")
    given = digest("\n".join(digest((answers / f"{t['case']}.json").read_bytes()) for t in truths).encode())
    return Half(half, cases, answers, tuple(truths), said, score(truths, said, half, seal), given)


def sample(half: Half, count: int, wanted: Callable[[Truth, Answer], bool]) -> list[Truth]:
    """At most so many of the cases that are wanted, drawn by a fixed seed, in the order of their names."""
    fit = [t for t in half.truths if wanted(t, half.said[t["case"]])]
    chosen = np.random.default_rng(_SEED).permutation(len(fit))[:count]
    return [fit[k] for k in sorted(int(k) for k in chosen)]


def shown(truth: Truth, kinds: Iterable[str], least: float) -> bool:
    """Whether a case of these kinds can be seen in its recording at this projected signal to noise or more."""
    if truth["kind"] not in kinds or not truth["visible"]:
        return False
    sizes = truth["effect_snr"] if truth["kind"] == "pair" else [truth["projected_snr"]]
    return min(sizes) >= least
