"""STS3215 servo: backlash as its publishers read it, in encoder counts (4096 a turn)."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.real.data import SERVO, nominal, read, recording_file
from benchmarks.real.pulls import with_pulls
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.result import Diagnosis, Finding
from linkwright.core.diagnose.steps.diagnosis import diagnose

COUNT = 2.0 * np.pi / 4096.0
PUBLISHED = {"loaded": 14.78, "unloaded": 7.03}
_PLAY = {"backlash": ("total", 1.0), "friction_windup": ("windup", 2.0)}
"""Effects whose displacement changes sign with the load or the side, and how much of the whole their parameter is."""


def loaded(options: Options | None = None) -> Diagnosis:
    """The servo pulled one way and the other."""
    recording = read(SERVO, recording_file(SERVO, "motor_telemetry_single.csv"))
    return diagnose(nominal(SERVO), recording, options or Options())


def unloaded(options: Options | None = None) -> Diagnosis:
    """The servo after each pull, both bands slack."""
    with tempfile.TemporaryDirectory() as folder:
        path = with_pulls(recording_file(SERVO, "motor_telemetry_single.csv"), Path(folder))
        recording = read(SERVO, path, "recording-unloaded")
    return diagnose(nominal(SERVO), recording, options or Options())


def counts(found: Diagnosis) -> float:
    """The whole play that was found, in counts; nan where none was."""
    plays = [finding for finding in found.findings if finding.effect in _PLAY]
    return sum(_total(play) for play in plays) / COUNT if plays else float("nan")


def _total(finding: Finding) -> float:
    name, factor = _PLAY[finding.effect]
    return factor * next(parameter.value for parameter in finding.parameters if parameter.parameter == name)


def averages() -> dict[str, float]:
    """Plain averages, in counts from side to side: pulled, by how far a puller's own lever must be from its rest (of
    394 counts), and after the pull, with both pullers within 20 counts of theirs."""
    with tempfile.TemporaryDirectory() as folder:
        table: Any = pd.read_csv(with_pulls(recording_file(SERVO, "motor_telemetry_single.csv"), Path(folder)))
    table = table[(table["target pos (5)"] == 2047) & (table["moving (5)"] == 0)]
    out = table["pos (3)"] - table["pos (4)"] + 599
    results: dict[str, float] = {}
    now: Any = pd.Series(np.sign(4095 - table["pos (3)"] - table["pos (4)"]), table.index)
    for least in (200, 300, 380):
        results[f"pulled, {least} counts and more"] = _apart(table, now.where(out >= least))
    results["after the pull"] = _apart(table, table["pulled"].where((out < 20) & (table["pulled"] != 0)))
    return results


def _apart(table: Any, way: Any) -> float:
    means = table.groupby(way)["pos (5)"].mean()
    return float(means[1] - means[-1])


def evaluate(tell: Callable[[str], None] = print, out: Path | None = None) -> None:
    """Print what is said of the servo; with `out`, write the telemetry with its pulls there."""
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        tell(f"written: {with_pulls(recording_file(SERVO, 'motor_telemetry_single.csv'), out)}\n")
    tell("## STS3215 servo\n")
    for name, value in averages().items():
        tell(f"plain averages, {name}: {value:.2f} counts")
    tell("")
    for name, run in (("loaded", loaded), ("unloaded", unloaded)):
        said = run()
        tell(f"{name}: {said.sentence}")
        tell(f"  {counts(said):.2f} counts; published {PUBLISHED[name]:.2f}\n")
