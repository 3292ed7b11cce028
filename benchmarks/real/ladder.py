"""The ladder of models: mean, RMS and largest error of each, and of what it predicts without having seen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.real.model import Array, Equations, Part, rms_mm
from benchmarks.real.splits import Folds


@dataclass(frozen=True)
class Rung:
    """One model; mm."""

    name: str
    mean: float
    rms: float
    largest: float
    held_out: float


def rung(name: str, known: Equations, which: Sequence[int]) -> Rung:
    """A model fitted to all readings, and fold by fold to the others."""
    rest = known.left(which)
    length = 1e3 * np.sqrt(np.sum(rest**2, axis=1))
    return Rung(name, float(length.mean()), rms_mm(rest), float(length.max()), rms_mm(known.held_out(which)))


def ladder(residual: Array, base: Part, findings: Sequence[Part], folds: Folds) -> list[Rung]:
    """The base, then each finding that takes off most of what is left, then each left out of the whole in turn."""
    known = Equations(residual, [base, *findings], folds)
    rungs = [rung("frame and tool", known, [0])]
    taken, waiting = [0], list(range(1, 1 + len(findings)))
    while waiting:
        best = min(waiting, key=lambda k: known.solved([*taken, k])[1])
        waiting.remove(best)
        taken.append(best)
        rungs.append(rung(f"+ {known.parts[best].name}", known, taken))
    if len(findings) > 1:
        for out in taken[1:]:
            rest = [k for k in taken if k != out]
            rungs.append(rung(f"without {known.parts[out].name}", known, rest))
    return rungs


def show(rungs: Sequence[Rung], held: str, tell: Callable[[str], None] = print) -> None:
    """The ladder as a table of Markdown; `held` names the split."""
    tell(f"| model | mean | RMS | max | held out ({held}) |")
    tell("|---|---|---|---|---|")
    for item in rungs:
        tell(f"| {item.name} | {item.mean:.3f} | {item.rms:.3f} | {item.largest:.2f} | {item.held_out:.3f} |")
