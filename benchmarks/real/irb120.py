"""ABB IRB 120: 1,000 random poses under a laser tracker, angles as read back and as commanded."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from arm.files.read import read_arm
from arm.files.write import write_arm
from benchmarks.real.data import IRB120, nominal, read, recording_file
from diagnose.diagnosis import diagnose
from diagnose.predict import Prediction, predict
from diagnose.result import Diagnosis

LEARNED = 700
"""Rows of the file to learn from; the rest is foretold."""
ANGLES = {"as read back": "recording", "as commanded": "recording-commanded"}


@dataclass(frozen=True)
class Learned:
    """What was found in the first rows, and what the arm file written then is worth on the others."""

    diagnosis: Diagnosis
    on_others: Prediction


def learned(how: str, rows: int = LEARNED) -> Learned:
    """Diagnose the first rows by a mapping of the recording; write the corrected arm, read it, try it on the rest."""
    arm = nominal(IRB120)
    recording = read(IRB120, recording_file(IRB120, "recording_both_angles.csv"), how)
    first = recording.row <= rows
    found = diagnose(arm, recording.kept(first))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.yaml"
        write_arm(found.corrected, path)
        written = read_arm(path)
    return Learned(found, predict(written, recording.kept(~first)))


def evaluate(tell: Callable[[str], None] = print) -> None:
    """Print what is said of both kinds of angles, and what the written files are worth."""
    tell(f"## IRB 120, learned on {LEARNED} poses, foretold on the others\n")
    tell("| angles | frame and tool | what the tool wrote | findings |")
    tell("|---|---|---|---|")
    for name, how in ANGLES.items():
        both = learned(how)
        figures = f"{1e3 * both.on_others.nominal_rms:.3f} | {1e3 * both.on_others.rms:.3f}"
        tell(f"| {name} | {figures} | {len(both.diagnosis.findings)} |")
        tell("")
        tell(both.diagnosis.sentence)
        for finding in both.diagnosis.findings:
            if finding.effect == "stale_reading":
                sizes = ", ".join(f"{each.parameter} {each.value:.3g}" for each in finding.parameters)
                tell(f"- joint {finding.at[0]}: {sizes}")
