"""UR10: 11,911 poses in five days under a laser tracker (series A), and 1,495 months later (series B)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.real import ladder as ladders
from benchmarks.real import splits
from benchmarks.real.data import UR10, nominal, read, recording_file
from benchmarks.real.model import (
    GEOMETRY,
    Array,
    Part,
    compliance,
    fitted,
    found,
    geometry,
    held_out,
    less_each_cause,
    loose,
    moved,
    rms_mm,
)
from benchmarks.real.within import selected_within
from benchmarks.real.written import written
from linkwright.core.diagnose.judge.predict import Prediction, predict
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.steps.diagnosis import diagnose

CELL = 15.0
WITH_TIME = ("thermal_expansion", "thermal_bending", "gearbox_thermal", "frame_drift", "creep")
TARGETS = {"random rows": 0.115, "15-degree cells": 0.140, "time blocks": 0.135, "A to B": 0.30, "file of A on B": 0.33}


@dataclass(frozen=True)
class Series:
    """Series A: the recording, set against the arm file, and what the tool found in it."""

    recording: Recording
    observed: Observed
    diagnosis: Diagnosis

    @property
    def residual(self) -> Array:
        """What the arm file leaves (N, 3), m, of all readings."""
        return self.observed.residual[:, :3]

    @property
    def parts(self) -> list[Part]:
        """Frame, tool, and all that was found."""
        return [loose(self.observed), *found(self.observed, self.diagnosis)]


def series_a(options: Options | None = None) -> Series:
    """Series A, diagnosed."""
    arm = nominal(UR10)
    recording = read(UR10, recording_file(UR10, "series_A.csv"))
    return Series(recording, observe(arm, recording), diagnose(arm, recording, options or Options()))


def ways(recording: Recording) -> dict[str, splits.Folds]:
    """The splits of series A. Cells are of joints 1 to 3; the coarser one of joints 1 and 2."""
    count = recording.size
    return {
        "random rows": splits.rows(count, 0),
        "15-degree cells": splits.angle_cells(recording.q, (0, 1, 2), CELL, 0),
        "15-degree cells of joints 1 and 2": splits.angle_cells(recording.q, (0, 1), CELL, 0),
        "time blocks": splits.blocks(count),
        "50 time blocks": splits.blocks(count, 50),
    }


def without_geometry(parts: Sequence[Part]) -> list[Part]:
    """The parts that are not geometry."""
    return [part for part in parts if part.effect and part.effect not in GEOMETRY]


def on_b(known: Series) -> dict[str, float]:
    """Learned on A, tested on B, mm: all but geometry keeps the sizes that A gave it; geometry (each axis, zero and
    length), frame and tool are fitted to B, all at once or, in the second figure, without the fold in question."""
    recording = read(UR10, recording_file(UR10, "series_B.csv"), "recording-b")
    observed = observe(nominal(UR10), recording)
    residual = observed.residual[:, :3]
    again = [loose(observed), *geometry(observed)]
    folds = splits.rows(recording.size, 0)
    figures = {"geometry alone": rms_mm(residual - moved(again, fitted(residual, again)))}
    own = [*known.parts, *geometry(known.observed)]
    kept = {item.name: sizes for item, sizes in zip(own, fitted(known.residual, own), strict=True)}
    there = [item for item in without_geometry(found(observed, known.diagnosis)) if item.name in kept]
    if there:
        residual = residual - moved(there, [kept[item.name] for item in there])
    figures["learned on A, geometry fitted to B"] = rms_mm(residual - moved(again, fitted(residual, again)))
    figures["the same, geometry on held-out rows"] = rms_mm(held_out(residual, again, folds))
    return figures


def file_on_b(diagnosis: Diagnosis) -> Prediction:
    """The written arm file of A on B, frame and tool alone fitted."""
    return predict(written(diagnosis), read(UR10, recording_file(UR10, "series_B.csv"), "recording-b"))


def evaluate(tell: Callable[[str], None] = print, *, inside: bool = False) -> None:
    """Print what is said of series A, and how well it predicts."""
    known = series_a()
    tell("## UR10, series A\n")
    tell(f"{known.diagnosis.sentence}\n")
    parts = known.parts
    each = ways(known.recording)
    cells = each["15-degree cells"]
    ladders.show(ladders.ladder(known.residual, parts[0], parts[1:], cells), "15-degree cells", tell)
    tell(f"\n| model | {' | '.join(each)} |")
    tell(f"|{'---|' * (1 + len(each))}")
    all_geometry = geometry(known.observed)
    models = {
        "frame and tool": parts[:1],
        "geometry": [parts[0], *all_geometry],
        "what the tool found": parts,
        **less_each_cause(parts),
        "all geometry and what the tool found": [*parts, *all_geometry],
        "the same and the give of drives 2 and 3": [*parts, *all_geometry, *compliance(known.observed, (2, 3))],
    }
    for name, chosen in models.items():
        figures = " | ".join(f"{rms_mm(held_out(known.residual, chosen, f)):.3f}" for f in each.values())
        tell(f"| {name} | {figures} |")
    tell(f"| target | {' | '.join(f'{TARGETS[n]:.3f}' if n in TARGETS else '' for n in each)} |")
    if inside:
        tell("\nSelection inside the folds, 15-degree cells:")
        rest = selected_within(nominal(UR10), known.recording, known.observed, cells, Options(), tell)
        tell(f"  chosen and fitted without the fold: {rms_mm(rest):.3f} mm")
    tell("\n| learned on A, tested on B | RMS, mm |")
    tell("|---|---|")
    for name, value in on_b(known).items():
        tell(f"| {name} | {value:.3f} |")
    tell(f"| target | {TARGETS['A to B']:.3f} |")
    left = file_on_b(known.diagnosis)
    tell("\n| the written file of A on B, frame and tool fitted | frame and tool alone | the file | target |")
    tell("|---|---|---|---|")
    tell(f"| | {1e3 * left.nominal_rms:.3f} | {1e3 * left.rms:.3f} | {TARGETS['file of A on B']:.2f} |")
    drift(known, tell)


def drift(known: Series, tell: Callable[[str], None] = print) -> float:
    """How far the mean error has moved between the first hour and the time after 16 h, mm, beside everything found
    that has nothing to do with time and temperature, all geometry, and the give of drives 2 and 3."""
    hours = np.zeros(known.recording.size) if known.recording.time is None else known.recording.time / 3600.0
    steady = [part for part in known.parts if part.effect not in WITH_TIME]
    parts = [*steady, *geometry(known.observed), *compliance(known.observed, (2, 3))]
    rest = known.residual - moved(parts, fitted(known.residual, parts))
    change = 1e3 * float(np.linalg.norm(rest[hours < 1.0].mean(axis=0) - rest[hours > 16.0].mean(axis=0)))
    tell(f"\nDrift: the mean error of the first hour and that after 16 h are {1e3 * change:.0f} um apart,")
    tell(f"beside {1e3 * rms_mm(rest):.0f} um RMS that remain in all.")
    return change
