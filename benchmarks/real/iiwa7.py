"""KUKA LBR iiwa 7 R800: 198 poses each without a payload, with 1.25 kg and with 2.5 kg, joints 1 and 2 moving."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from benchmarks.real.data import IIWA7, nominal, read, recording_file
from benchmarks.real.model import Array, Part, fitted, geometry, loose, moved, rms_mm
from benchmarks.real.written import written
from linkwright.core.diagnose.fitting.prepare import nuisances
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.steps.diagnosis import diagnose

RUNS = {0.0: "run1_0kg.csv", 1.25: "run2_1.25kg.csv", 2.5: "run3_2.5kg.csv"}
"""Files by payload, kg."""
TARGET = 0.35
"""mm, of the written file."""
_AXES = np.array([[0, 0, 1], [0, 1, 0], [0, 0, 1], [0, -1, 0], [0, 0, 1], [0, 1, 0], [0, 0, 1]], dtype=float)
_LENGTHS = {1: 0.34, 2: 0.4, 4: 0.4}
"""m along z, beyond joints 1, 2 and 4."""


@dataclass(frozen=True)
class Foretold:
    """What was found with two payloads, and what the arm file written then leaves (mm) of the third: of `nominal`
    geometry, of the written file, of geometry alone fitted to the two."""

    diagnosis: Diagnosis
    nominal: float
    written: float
    geometry: float


def run(payload: float, seen: NDArray[np.bool_] | None = None) -> pd.DataFrame:
    """A run's table with the columns that the mapping needs. How the target was turned and how far it reached is the
    mean over the rows `seen` (all by default), by nominal geometry."""
    table = pd.read_csv(recording_file(IIWA7, RUNS[payload]), skipinitialspace=True)
    turned = Rotation.from_matrix(table[[f"m_{i}{j}" for i in range(3) for j in range(3)]].to_numpy().reshape(-1, 3, 3))
    wrist, hand = _wrist(table[[f"theta_{k}" for k in range(1, 8)]].to_numpy())
    rows = np.ones(len(table), dtype=bool) if seen is None else seen
    turn = (hand.inv() * turned).as_euler("zyx")[:, 0]
    reach = hand.inv().apply(table[["m_03", "m_13", "m_23"]].to_numpy() - 1e3 * wrist)[:, 2]
    table["payload_kg"] = payload
    table["turn_rad"] = float(np.mean(turn[rows]))
    table["reach_mm"] = float(np.mean(reach[rows]))
    table[["qx", "qy", "qz", "qw"]] = turned.as_quat()
    return table


def _wrist(q: Array) -> tuple[Array, Rotation]:
    """The wrist's centre (N, 3), m, and the last link's orientation, by nominal geometry."""
    at, turned = np.zeros((len(q), 3)), Rotation.identity(len(q))
    for number, (axis, angle) in enumerate(zip(_AXES, q.T, strict=True), start=1):
        turned = turned * Rotation.from_rotvec(angle[:, None] * axis)
        at = at + turned.apply([0.0, 0.0, _LENGTHS.get(number, 0.0)])
    return at, turned


def recorded(tables: Sequence[pd.DataFrame], folder: Path) -> Recording:
    """Tables of runs as one recording."""
    path = folder / "iiwa7.csv"
    pd.concat(list(tables)).to_csv(path, index=False)
    return read(IIWA7, path)


def left_out(payload: float) -> Foretold:
    """Diagnose the other two payloads, write the corrected arm, read it, and set it against the third run: frame and
    tool as the other two runs have them, but where the target sits by one half of the third's poses, tried on the
    other half, both ways."""
    others = [run(item) for item in RUNS if item != payload]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        result = diagnose(nominal(IIWA7), recorded(others, folder))
        corrected = written(result)
        count = len(run(payload))
        said: dict[str, list[Array]] = {"nominal": [], "written": [], "geometry": []}
        for half in (0, 1):
            seen = np.arange(count) % 2 == half
            recording = recorded([*others, run(payload, seen)], folder)
            row = recording.row - 2 - sum(len(item) for item in others)  # row 1 is the header
            here = np.where(row < 0, 0, np.where(seen[np.maximum(row, 0)], 1, 2))
            for kind, arm in (("nominal", nominal(IIWA7)), ("written", corrected), ("geometry", nominal(IIWA7))):
                observed = observe(arm, replace(recording, orientation=None))
                parts = [loose(observed), *(geometry(observed) if kind == "geometry" else ())]
                said[kind].append(_left(observed, parts, here))
    return Foretold(result, **{kind: rms_mm(np.concatenate(item)) for kind, item in said.items()})


def _left(observed: Observed, parts: Sequence[Part], here: NDArray[np.int64]) -> Array:
    """What parts fitted to the readings of `here` 0, and the place of the target by those of 1, leave of those of 2."""
    rest = observed.residual[:, :3]
    rest = rest - moved(parts, fitted(rest, parts, here == 0))
    columns, names = nuisances(observed)
    of_tool = [k for k, name in enumerate(names) if name.startswith("tool_offset")]
    target = [Part("target", "", columns[:, :3, of_tool], np.full(len(of_tool), np.inf))]
    return (rest - moved(target, fitted(rest, target, here == 1)))[here == 2]


def evaluate(tell: Callable[[str], None] = print, out: Path | None = None) -> None:
    """Print what is said of each two payloads and how well it foretells the third; keep all runs in one table."""
    tell("## iiwa 7, one payload left out\n")
    tell("| left out | nominal geometry | all geometry | what the tool wrote | target | findings |")
    tell("|---|---|---|---|---|---|")
    sentences: list[str] = []
    for payload in RUNS:
        said = left_out(payload)
        figures = " | ".join(f"{value:.3f}" for value in (said.nominal, said.geometry, said.written, TARGET))
        tell(f"| {payload:g} kg | {figures} | {len(said.diagnosis.findings)} |")
        sentences.append(f"Without {payload:g} kg: {said.diagnosis.sentence}")
    tell("")
    for sentence in sentences:
        tell(f"{sentence}\n")
    if out is not None:
        path = out / "iiwa7.csv"
        pd.concat([run(payload) for payload in RUNS]).to_csv(path, index=False)
        tell(f"written: {path}")
