"""How far a corrected arm is from the truth at poses that nobody recorded, and how far the model as given is."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.aliases import frame_columns
from benchmarks.blind.generator.cases import Case
from benchmarks.blind.generator.concealed import Scene
from benchmarks.blind.generator.mechanics import nominal_inputs, solve
from benchmarks.blind.generator.vectors import Array
from benchmarks.blind.proof.library import tellable, true_arm
from benchmarks.blind.proof.model import left
from benchmarks.blind.proof.remade import REGIONS, Session, remade, rng_of, session, table_of
from benchmarks.blind.run import CORRECTED, ask
from benchmarks.blind.staging import exact, nominal_without, stage

CLEAR = 0.6
"""Share of a displacement's squares that lies in one direction, for the direction to have a name."""


def predicted(truth: dict[str, Any], folder: str, corrected: str, may_ask: bool) -> dict[str, Any]:
    """RMS of what each way leaves of the true tip, free of noise, over the RMS of the noise, by region.

    Under `free` frames the frame is set by the rows inside, for all alike. Where the answer left no corrected arm and
    `may_ask`, the tool is asked again for it.
    """
    case = remade(truth, Path(folder))
    made = session(case, rng_of(truth, 1))
    given, noise = Path(folder) / "arm.yaml", float(truth["noise_rms_mm"]) * 1e-3
    rest: dict[str, Array] = {}
    with tempfile.TemporaryDirectory() as place:
        new, arm = Path(place) / "recording.csv", Path(corrected)
        table_of(case, made).to_csv(new, index=False, lineterminator="\n")
        rest["model as given"] = left(given, new)
        if not arm.exists() and may_ask:
            answers = Path(place) / "answers"
            (answers / "diagnosis").mkdir(parents=True)
            ask(folder, str(answers / "diagnosis" / "asked.json"), 120.0)
            arm = answers / CORRECTED / "asked.yaml"
        if arm.exists():
            rest["linkwright"] = left(arm, new)
        if tellable(truth):
            true_arm(case, Path(folder), Path(place) / "true.yaml")
            rest["true parameters"] = left(Path(place) / "true.yaml", new)
    return {
        "ratios": {name: _by_region(case, made, vectors, noise) for name, vectors in rest.items()},
        "direction": direction(case),
    }


def _by_region(case: Case, made: Session, vectors: Array, noise: float) -> dict[str, float | None]:
    inside = np.array([name == "inside" for name in made.region])
    if case.design.frame_free:
        vectors = vectors - _frame(case, made, vectors, inside)
    results: dict[str, float | None] = {}
    for region in REGIONS:
        rows = np.array([name == region for name in made.region])
        results[region] = float(np.sqrt(np.mean(np.sum(vectors[rows] ** 2, axis=1)))) / noise if rows.any() else None
    return results


def _frame(case: Case, made: Session, vectors: Array, inside: NDArray[np.bool_]) -> Array:
    """The shift and rotation of the frame that suit the rows inside best, at all rows."""
    design = made.design
    nominal = solve(case.arm, nominal_inputs(case.arm, design.q, design.payload, design.force), 3)
    scene = Scene(case.arm, design, nominal)
    axes = vectors.shape[1]
    columns = np.stack([column[:axes].T for column in frame_columns(scene)], axis=2)  # (rows, axes, columns)
    own = columns[inside].reshape(-1, columns.shape[2])
    return columns @ np.linalg.lstsq(own, vectors[inside].reshape(-1), rcond=1e-9)[0]


def direction(case: Case) -> str:
    """Where the concealed displacement points at recorded poses: radial, tangential, vertical (in space) or mixed."""
    _, response = stage(case.arm, case.design)
    change = exact(case.arm, case.design, case.effects) - nominal_without(case.arm, case.design, case.effects, response)
    axes = case.readings.shape[0]
    outward = response.nominal.tip.copy()
    outward[2] = 0.0
    outward /= np.maximum(np.linalg.norm(outward, axis=0), 1e-9)
    total = float(np.sum(change[:axes] ** 2))
    shares = {"radial": float(np.sum(np.sum(change[:2] * outward[:2], axis=0) ** 2)) / total}
    shares["vertical"] = float(np.sum(change[2] ** 2)) / total if axes == 3 else 0.0
    shares["tangential"] = 1.0 - sum(shares.values())
    best = max(shares, key=lambda name: shares[name])
    return best if shares[best] > CLEAR else "mixed"
