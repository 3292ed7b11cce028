"""The one use of the tool as a library: what an arm file's model leaves of a recording, and its candidates' columns.

Baselines get the very columns that the tool searches, so that they differ from it in method alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.blind.generator.vectors import Array

Name = tuple[str, tuple[int, ...]]  # effect, where (from 1)


@dataclass(frozen=True)
class Patterns:
    """A recording against a model: `residual` (rows, axes) in m, measured less modelled; one matrix (rows * axes, d)
    for each candidate, in m for one unit of each size, `nuisance` likewise; `covariates` (rows, k) and `joints` (rows,
    n) as they are; `visit` (rows,) numbers consecutive readings of one pose."""

    residual: Array
    names: tuple[Name, ...]
    columns: tuple[Array, ...]
    nuisance: Array
    joints: Array
    covariates: Array
    visit: Array
    candidates: tuple[Any, ...]

    @property
    def axes(self) -> int:
        """Measured axes, 2 or 3."""
        return self.residual.shape[1]

    @property
    def vector(self) -> Array:
        """The residual, stacked like the columns."""
        return self.residual.reshape(-1)


def _read(arm: Path, recording: Path, *, known: bool) -> Any:
    from linkwright.core.arm.files.read import read_arm
    from linkwright.core.diagnose.reading.read import read_recording
    from linkwright.core.diagnose.residual.observe import observe
    from linkwright.core.materials.catalogue import load_catalogue

    given = read_arm(arm, load_catalogue())
    read = read_recording(recording, given)
    return observe(given, replace(read, frame="known") if known else read)


def left(arm: Path, recording: Path) -> Array:
    """Measured less modelled (rows, axes), m, in the frame as it is.

    Raises ValueError where the reader sets rows aside: a recording free of noise has none that are wrong.
    """
    observed = _read(arm, recording, known=True)
    if observed.recording.rejected:
        raise ValueError(f"{recording}: {observed.recording.rejected[0].reason}")
    return observed.tip_residual()


def patterns(arm: Path, recording: Path) -> Patterns:
    """All candidates of the library on a recording, as the tool would search them."""
    from linkwright.core.diagnose.patterns.library import candidates

    observed = _read(arm, recording, known=False)
    results = list(candidates(observed))
    return _patterns(observed, [c for c, _ in results], [columns for _, columns in results])


def patterns_at(arm: Path, recording: Path, of: Patterns) -> Patterns:
    """The same candidates, with the same shapes, on another recording of the arm, its frame known."""
    from linkwright.core.diagnose.patterns.library import columns_of

    observed = _read(arm, recording, known=True)
    columns: list[Array] = []
    for candidate, matrix in zip(of.candidates, of.columns, strict=True):
        own = columns_of(observed, candidate)
        empty = np.zeros((*observed.residual.shape, matrix.shape[1]))
        columns.append(empty if own is None else own)
    return _patterns(observed, list(of.candidates), columns)


def _patterns(observed: Any, results: list[Any], columns: list[Array]) -> Patterns:
    from linkwright.core.diagnose.fitting.prepare import nuisances

    recording, width = observed.recording, observed.components
    held = (recording.payload_mass, recording.temperature, recording.time, recording.sides, recording.force)
    beside = [x.reshape(recording.size, -1) for x in held if x is not None]
    return Patterns(
        residual=observed.tip_residual(),
        names=tuple((c.effect, tuple(i + 1 for i in c.at)) for c in results),
        columns=tuple(np.ascontiguousarray(c[:, :width]).reshape(-1, c.shape[2]) for c in columns),
        nuisance=nuisances(observed)[0][:, :width].reshape(recording.size * width, -1),
        joints=recording.q,
        covariates=np.concatenate(beside, axis=1) if beside else np.zeros((recording.size, 0)),
        visit=observed.block,
        candidates=tuple(results),
    )
