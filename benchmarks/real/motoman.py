"""Motoman MA2010: an arc-welding robot under a motion-capture system, two days (0516, 0801)."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.real import ladder as ladders
from benchmarks.real import splits
from benchmarks.real.data import MOTOMAN, joined, nominal, read, recording_file
from benchmarks.real.model import (
    Array,
    Part,
    compliance,
    fitted,
    found,
    geometry,
    held_out,
    less_each_cause,
    loose,
    mean_rms_mm,
    moved,
    rms_mm,
    unheld,
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

TARGETS = {"0516": 0.145, "0801": 0.168}
WRITTEN = 0.17
"""mm, of one day's written file on the other day's grid."""
SEEDS = (0, 1, 2, 3, 4)
_IN_A_CELL = 7


@dataclass(frozen=True)
class Day:
    """One day's grid: the recording, set against the arm file, and what the tool found in it."""

    name: str
    recording: Recording
    observed: Observed
    diagnosis: Diagnosis

    @property
    def residual(self) -> Array:
        """What the arm file leaves (N, 3), m, of all readings."""
        return self.observed.residual[:, :3]

    @property
    def cells(self) -> splits.Folds:
        """The grid's cell of each reading: seven neighbouring poses."""
        return (self.recording.row - 2) // _IN_A_CELL  # row 1 is the header

    def folds(self, seed: int) -> splits.Folds:
        """Five folds of whole cells."""
        return splits.dealt(self.cells, seed)


def grid(day: str, *, sides: bool = True, options: Options | None = None) -> Day:
    """A day's grid, diagnosed; without `sides`, as if the order of the rows did not tell where each joint came from."""
    arm = nominal(MOTOMAN)
    recording = read(MOTOMAN, recording_file(MOTOMAN, f"grid_test{day}_R1.csv"))
    if not sides:
        recording = replace(recording, sides=None)
    return Day(day, recording, observe(arm, recording), diagnose(arm, recording, options or Options()))


def by_cell(day: Day, parts: list[Part]) -> float:
    """The mean RMS over five folds of cells, mm, over several ways of dealing the cells."""
    each = [day.folds(seed) for seed in SEEDS]
    return float(np.mean([mean_rms_mm(held_out(day.residual, parts, folds), folds) for folds in each]))


def gravity(observed: Observed) -> list[Part]:
    """Geometry and gravity only: all geometry, and the drives of joints 2 and 3 giving under links of unknown mass."""
    return [loose(observed), *geometry(observed), *compliance(observed, (2, 3))]


def evaluate(day: str, tell: Callable[[str], None] = print, *, inside: bool = False, sides: bool = True) -> None:
    """Print what is said of a day's grid, and how well it predicts."""
    known = grid(day, sides=sides)
    tell(f"## Motoman MA2010, grid {day}{'' if sides else ', without the sides that joints came from'}\n")
    tell(f"{known.diagnosis.sentence}\n")
    everything = [loose(known.observed), *found(known.observed, known.diagnosis)]
    folds = known.folds(0)
    ladders.show(ladders.ladder(known.residual, everything[0], everything[1:], folds), "cells", tell)
    tell("\n| model | by cell, mean RMS of five folds | cell mod 5 | outer cells (blocks) | target |")
    tell("|---|---|---|---|---|")
    models = {
        "frame and tool": everything[:1],
        "geometry": [everything[0], *geometry(known.observed)],
        "geometry and gravity at joints 2 and 3": gravity(known.observed),
        "the same, sizes free": [unheld(item) for item in gravity(known.observed)],
        "what the tool found": everything,
        "geometry, gravity and what the tool found": [*gravity(known.observed), *everything[1:]],
        **less_each_cause(everything),
    }
    count = int(known.cells.max()) + 1
    for name, parts in models.items():
        other = [known.cells % splits.FOLDS, known.cells * splits.FOLDS // count]
        further = [mean_rms_mm(held_out(known.residual, parts, item), item) for item in other]
        figures = " | ".join(f"{value:.3f}" for value in (by_cell(known, parts), *further))
        tell(f"| {name} | {figures} | {TARGETS[day]:.3f} |")
    if inside:
        tell("\nSelection inside the folds:")
        rest = selected_within(nominal(MOTOMAN), known.recording, known.observed, folds, Options(), tell)
        tell(f"  by cell, chosen and fitted without the fold: {mean_rms_mm(rest, folds):.3f} mm")
    if sides:
        lines(known, tell)
        other_day(known, tell)
        tell(
            f"\n| the written file of {known.name}, frame and tool fitted | frame and tool alone | the file | target |"
        )
        tell("|---|---|---|---|")
        for there in TARGETS:
            left = file_on(known.diagnosis, there)
            tell(f"| on the grid of {there} | {1e3 * left.nominal_rms:.4f} | {1e3 * left.rms:.4f} | {WRITTEN:.3f} |")
        wandering(known, tell)


def wandering(day: Day, tell: Callable[[str], None] = print) -> Array:
    """The mean error (mm) of each stretch of 24 cells in the order of the recording, beside geometry and gravity."""
    parts = gravity(day.observed)
    rest = 1e3 * (day.residual - moved(parts, fitted(day.residual, parts)))
    means = np.array([rest[day.cells // 24 == k].mean(axis=0) for k in range(int(day.cells.max()) // 24 + 1)])
    tell("\n| readings | mean error x, y, z beside geometry and gravity |")
    tell("|---|---|")
    for k, mean in enumerate(means):
        first = k * 24 * _IN_A_CELL + 1
        tell(f"| from {first} | {', '.join(f'{value:+.3f}' for value in mean)} |")
    return means


def learned(observed: Observed, name: str, diagnosis: Diagnosis) -> list[Part]:
    """A model by name."""
    free = loose(observed)
    if name == "geometry":
        return [free, *geometry(observed)]
    if name == "gravity at joints 2 and 3":
        return [free, *compliance(observed, (2, 3))]
    if name == "geometry and gravity at joints 2 and 3":
        return gravity(observed)
    return [free, *found(observed, diagnosis)] if name == "what the tool found" else [free]


MODELS = (
    "frame and tool",
    "geometry",
    "gravity at joints 2 and 3",
    "geometry and gravity at joints 2 and 3",
    "what the tool found",
)


def other_day(day: Day, tell: Callable[[str], None] = print) -> dict[str, float]:
    """The other day's grid, predicted by what this day's taught: mm, with frame and tool fitted again."""
    other = next(name for name in TARGETS if name != day.name)
    arm = nominal(MOTOMAN)
    there = observe(arm, read(MOTOMAN, recording_file(MOTOMAN, f"grid_test{other}_R1.csv")))
    residual = there.residual[:, :3]
    said: dict[str, float] = {}
    tell(f"\n| learned on {day.name}, tested on the grid of {other} | RMS, frame and tool fitted again |")
    tell("|---|---|")
    for name in MODELS:
        here, parts = learned(day.observed, name, day.diagnosis), learned(there, name, day.diagnosis)
        rest = residual - moved(parts, fitted(day.residual, here))
        said[name] = rms_mm(rest - moved(parts[:1], fitted(rest, parts[:1])))
        tell(f"| {name} | {said[name]:.3f} |")
    return said


def file_on(diagnosis: Diagnosis, day: str) -> Prediction:
    """A diagnosis's written arm file on a day's grid, frame and tool fitted."""
    return predict(written(diagnosis), read(MOTOMAN, recording_file(MOTOMAN, f"grid_test{day}_R1.csv")))


def lines(day: Day, tell: Callable[[str], None] = print) -> dict[str, tuple[float, float]]:
    """The day's straight lines predicted by what the grid taught, and the other way: mm with frame and tool as taught,
    and with these fitted again. Both are in one frame of the instrument."""
    arm = nominal(MOTOMAN)
    paths = [recording_file(MOTOMAN, f"{kind}_test{day.name}_R1.csv") for kind in ("grid", "line")]
    with tempfile.TemporaryDirectory() as folder:
        recording, file = joined(MOTOMAN, paths, Path(folder))
    observed = observe(arm, recording)
    residual, line = observed.residual[:, :3], file == 1
    said: dict[str, tuple[float, float]] = {}
    for here, there, taught in (("grid", "lines", ~line), ("lines", "grid", line)):
        tell(f"\n| learned on the {here}, tested on the day's {there} | frame and tool as there | fitted again |")
        tell("|---|---|---|")
        for name in MODELS:
            figures = _tried(residual, learned(observed, name, day.diagnosis), taught)
            said[f"{name}: {here} to {there}"] = figures
            tell(f"| {name} | {figures[0]:.3f} | {figures[1]:.3f} |")
    return said


def _tried(residual: Array, parts: list[Part], taught: NDArray[np.bool_]) -> tuple[float, float]:
    """RMS on the rows that taught nothing, mm: with frame and tool as taught, and with these fitted to them."""
    rest = residual - moved(parts, fitted(residual, parts, taught))
    again = rest - moved(parts[:1], fitted(rest, parts[:1], ~taught))
    return rms_mm(rest[~taught]), rms_mm(again[~taught])
