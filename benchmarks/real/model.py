"""Models of a recording as sums of the library's patterns, fitted to some readings and tried on others.

Sizes are fitted; what is found (which effects, at which orders, lags) is given. A diagnosis inside each fold is made by
`benchmarks.real.within`.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from benchmarks.real.splits import Folds
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.answer.sentences import name_of
from linkwright.core.diagnose.fitting.prepare import nuisances
from linkwright.core.diagnose.patterns.library import Candidate, columns_of
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.result import Diagnosis, Finding
from linkwright.core.sections.numeric import Array

GEOMETRY = ("axis_misalignment", "encoder_offset", "link_length", "tool_offset", "frame_misalignment")
_CUT, _NOTHING = 1e-11, 1e-9
_USUAL_WEIGHT = 1e-3
"""rad: how far a drive of 1e6 N*m/rad sags under 100 kg at a metre. Where masses are unknown the product is all."""


@dataclass(frozen=True)
class Part:
    """A term of a model: `columns` (N, 3, d) in m for one unit of each size, `usual` (d,) the size that is usual for it
    (infinite: any)."""

    name: str
    effect: str
    columns: Array
    usual: Array


def loose(observed: Observed) -> Part:
    """Where the instrument and its target stand."""
    columns, _ = nuisances(observed)
    return Part("frame and tool", "", columns[:, :3], np.full(columns.shape[2], np.inf))


def part(observed: Observed, candidate: Candidate) -> Part | None:
    """A candidate of the library as a part, None where it moves nothing."""
    columns = columns_of(observed, candidate)
    if columns is None:
        return None
    at = tuple(index + 1 for index in candidate.at)
    return Part(name_of(candidate.effect, at), candidate.effect, columns[:, :3], _usual(candidate, columns.shape[2]))


def _usual(candidate: Candidate, count: int) -> Array:
    """The upper end of what the library calls typical, of each size."""
    if candidate.share:
        return np.full(count, np.inf)
    if count != len(candidate.sizes):
        return np.full(count, _USUAL_WEIGHT)
    typical = {parameter.name: parameter.typical for parameter in EFFECTS[candidate.effect].parameters}
    return np.array([max(abs(limit) for limit in typical[name]) for name in candidate.sizes])


def unheld(given: Part) -> Part:
    """The part with sizes that may be anything."""
    return replace(given, usual=np.full(len(given.usual), np.inf))


def geometry(observed: Observed) -> list[Part]:
    """All that the library knows of geometry: each axis, each encoder's zero, each link's length."""
    parts: list[Part] = []
    for effect in ("axis_misalignment", "encoder_offset", "link_length"):
        sizes = tuple(p.name for p in EFFECTS[effect].parameters if p.role == "size")
        candidates = [Candidate(effect, (i,), sizes, MappingProxyType({})) for i in range(observed.arm.size)]
        parts += [made for candidate in candidates if (made := part(observed, candidate)) is not None]
    return parts


def compliance(observed: Observed, joints: Sequence[int]) -> list[Part]:
    """Drives (joints from 1) that give under gravity."""
    candidates = [Candidate("joint_compliance", (j - 1,), ("compliance",), MappingProxyType({})) for j in joints]
    return [made for candidate in candidates if (made := part(observed, candidate)) is not None]


def candidate_of(finding: Finding) -> Candidate:
    """The candidate that a finding came from."""
    roles = {parameter.name: parameter for parameter in EFFECTS[finding.effect].parameters}
    values = {parameter.parameter: parameter.value for parameter in finding.parameters}
    sizes = tuple(name for name in values if name in roles and roles[name].role == "size")
    shapes = {name: 0.0 for name, role in roles.items() if role.role == "shape" and role.grid}
    shapes |= {name: value for name, value in values.items() if name in roles and roles[name].role == "shape"}
    at = tuple(number - 1 for number in finding.at)
    share = "share" in values
    sizes = ("share",) if share else sizes or ("compliance",)  # of links of unknown mass only the sag is told
    return Candidate(finding.effect, at, sizes, MappingProxyType(shapes), shared=len(at) > 1, share=share)


def found(observed: Observed, diagnosis: Diagnosis) -> list[Part]:
    """What a diagnosis found, on any recording of the arm."""
    made = [part(observed, candidate_of(finding)) for finding in diagnosis.findings]
    return [item for item in made if item is not None]


class Equations:
    """The normal equations of some parts, kept for each fold: any choice of parts and rows is then solved at once.

    `residual` (N, 3) in m. Each size is held to what is usual for it: the most likely sizes where each is drawn from a
    normal distribution of that width. It matters where the rows do not tell.
    """

    def __init__(self, residual: Array, parts: Sequence[Part], folds: Folds | None = None) -> None:
        self.residual, self.parts = residual, list(parts)
        self.folds = np.zeros(len(residual), dtype=np.int64) if folds is None else folds
        self.edges = np.cumsum([0, *(part.columns.shape[2] for part in parts)])
        self.design = np.concatenate([part.columns for part in parts], axis=2)
        self.usual = np.concatenate([part.usual for part in parts])
        self.of_fold = {int(fold): self._products(self.folds == fold) for fold in np.unique(self.folds)}

    def _products(self, rows: NDArray[np.bool_]) -> tuple[Array, Array, float, int]:
        design, target = self.design[rows].reshape(-1, len(self.usual)), self.residual[rows].reshape(-1)
        return design.T @ design, design.T @ target, float(target @ target), len(target)

    def taken(self, which: Sequence[int] | None) -> NDArray[np.int64]:
        """The columns of some parts, of all by default."""
        numbers = range(len(self.parts)) if which is None else which
        return np.concatenate([np.arange(*self.edges[k : k + 2]) for k in numbers])

    def solved(self, which: Sequence[int] | None = None, but: int | None = None) -> tuple[Array, float]:
        """Sizes of the parts' columns, and the scatter of a component, m; `but` leaves a fold out."""
        kept = [products for fold, products in self.of_fold.items() if fold != but]
        at = self.taken(which)
        gram, against = sum(k[0][np.ix_(at, at)] for k in kept), sum(k[1][at] for k in kept)
        whole, count = sum(k[2] for k in kept), sum(k[3] for k in kept)
        scatter, sizes = 0.0, np.zeros(len(at))
        for _ in range(3):  # first with nothing held, then held by the scatter that is left
            held = (scatter / self.usual[at]) ** 2
            norm = np.sqrt(np.diag(gram) + held)
            norm = np.where(norm > _NOTHING * norm.max(), norm, np.inf)
            values, vectors = np.linalg.eigh((gram + np.diag(held)) / np.outer(norm, norm))
            good = values > _CUT * values[-1]
            sizes = ((vectors[:, good] / values[good]) @ (vectors[:, good].T @ (against / norm))) / norm
            left = whole - 2.0 * float(sizes @ against) + float(sizes @ gram @ sizes)
            scatter = float(np.sqrt(max(left, 0.0) / count))
        return sizes, scatter

    def left(self, which: Sequence[int] | None = None) -> Array:
        """What a fit to all rows leaves, (N, 3), m."""
        return self.residual - self.design[:, :, self.taken(which)] @ self.solved(which)[0]

    def held_out(self, which: Sequence[int] | None = None) -> Array:
        """What is left (N, 3), m, of each reading by a fit that has not seen its fold."""
        result = self.residual.copy()
        for fold in self.of_fold:
            out = self.folds == fold
            result[out] -= self.design[out][:, :, self.taken(which)] @ self.solved(which, fold)[0]
        return result


def fitted(residual: Array, parts: Sequence[Part], rows: NDArray[np.bool_] | None = None) -> list[Array]:
    """The sizes of each part, fitted to some rows of a residual (N, 3), m (all by default)."""
    keep = np.ones(len(residual), dtype=bool) if rows is None else rows
    known = Equations(residual, parts, np.where(keep, 0, 1))
    sizes, _ = known.solved(but=1)
    return [sizes[a:b] for a, b in itertools.pairwise(known.edges.tolist())]


def moved(parts: Sequence[Part], sizes: Sequence[Array]) -> Array:
    """What parts of these sizes add to the model, (N, 3), m."""
    return np.sum([part.columns @ size for part, size in zip(parts, sizes, strict=True)], axis=0)


def held_out(residual: Array, parts: Sequence[Part], folds: Folds) -> Array:
    """What is left (N, 3), m, of each reading by a fit of the parts that has not seen its fold."""
    return Equations(residual, parts, folds).held_out()


def less_each_cause(parts: Sequence[Part]) -> dict[str, list[Part]]:
    """The model without all that is of one kind of physics, for every kind in it, by a name for the table."""
    causes = {item.effect: EFFECTS[item.effect].cause for item in parts if item.effect}
    return {
        f"what the tool found, less {cause}": [item for item in parts if causes.get(item.effect) != cause]
        for cause in dict.fromkeys(causes.values())
    }


def rms_mm(residual: Array) -> float:
    """The RMS length in mm."""
    return 1e3 * float(np.sqrt(np.mean(np.sum(residual**2, axis=1))))


def mean_rms_mm(residual: Array, folds: Folds) -> float:
    """The mean over folds of their RMS length in mm."""
    return float(np.mean([rms_mm(residual[folds == fold]) for fold in np.unique(folds)]))
