"""ABB IRB 120: 1,000 random poses under a laser tracker, angles as read back and as commanded."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from benchmarks.real.data import IRB120, nominal, read, recording_file
from benchmarks.real.model import fitted, found, loose, moved, rms_mm
from benchmarks.real.written import written
from linkwright.core.diagnose.judge.predict import Prediction, predict
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.steps.diagnosis import diagnose

LEARNED = 700
"""Rows of the file to learn from; the rest is foretold."""
TARGETS = (0.075, 10)
"""As commanded: mm held out by pose blocks, and how many findings are too many."""
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
    first = recording.row <= 1 + rows  # row 1 is the header
    result = diagnose(arm, recording.kept(first))
    return Learned(result, predict(written(result), recording.kept(~first)))


def each_left_out(how: str, diagnosis: Diagnosis, tell: Callable[[str], None] = print) -> None:
    """Print what the findings in the first rows leave of the others, frame and tool fitted there: all of them, and all
    but each in turn, fitted to the first rows anew."""
    observed = observe(nominal(IRB120), read(IRB120, recording_file(IRB120, "recording_both_angles.csv"), how))
    residual, first = observed.residual[:, :3], observed.recording.row <= 1 + LEARNED
    everything = [loose(observed), *found(observed, diagnosis)]

    def left(places: Sequence[int]) -> float:
        parts = [everything[place] for place in places]
        rest = residual - moved(parts, fitted(residual, parts, first))
        return rms_mm((rest - moved(parts[:1], fitted(rest, parts[:1], ~first)))[~first])

    places = range(len(everything))
    tell(f"\n| {how}, on the other poses | mm |\n|---|---|\n| all findings | {left(places):.4f} |")
    for out in places[1:]:
        tell(f"| without {everything[out].name} | {left([place for place in places if place != out]):.4f} |")


def all_poses(how: str) -> Diagnosis:
    """Diagnose all rows by a mapping of the recording."""
    return diagnose(nominal(IRB120), read(IRB120, recording_file(IRB120, "recording_both_angles.csv"), how))


def evaluate(tell: Callable[[str], None] = print) -> None:
    """Print what is said of both kinds of angles, and what the written files are worth."""
    tell(f"## IRB 120, learned on {LEARNED} poses, foretold on the others\n")
    tell("| angles | frame and tool | what the tool wrote | findings | all poses: held out by pose blocks | findings |")
    tell("|---|---|---|---|---|---|")
    diagnosises: list[Diagnosis] = []
    for name, how in ANGLES.items():
        both, whole = learned(how), all_poses(how)
        figures = f"{1e3 * both.on_others.nominal_rms:.3f} | {1e3 * both.on_others.rms:.3f}"
        blocks = f"{1e3 * whole.rms_after_held_out:.3f} | {_count(whole)}"
        tell(f"| {name} | {figures} | {_count(both.diagnosis)} | {blocks} |")
        diagnosises += [both.diagnosis, whole]
    tell(f"| asked for, as commanded | | | | {TARGETS[0]:.3f} | fewer than {TARGETS[1]} |")
    for how, diagnosis in zip(ANGLES.values(), diagnosises[::2], strict=True):
        each_left_out(how, diagnosis, tell)
    for diagnosis in diagnosises:
        tell("")
        tell(f"{diagnosis.recording.size} poses: {diagnosis.sentence}")
        for finding in diagnosis.findings:
            at = f" (joint or link {finding.at[0]})" if finding.at else ""
            sizes = ", ".join(f"{parameter.parameter} {parameter.value:.3g}" for parameter in finding.parameters)
            tell(f"- {finding.effect}{at}: {sizes}; {1e3 * finding.rms_explained:.3f} mm")


def _count(diagnosis: Diagnosis) -> str:
    """How many findings there are, and of how many effects."""
    return f"{len(diagnosis.findings)} of {len({finding.effect for finding in diagnosis.findings})} effects"
