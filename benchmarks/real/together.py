"""Several recordings of one machine in one fit: Motoman's grid and lines of a day, UR10's series A and B."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from benchmarks.real.data import MOTOMAN, UR10, nominal, read, recording_file
from benchmarks.real.written import written
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.judge.predict import predict
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.several.recordings import together
from linkwright.core.diagnose.steps.diagnosis import diagnose

DAYS = ("0516", "0801")
KINDS = ("grid", "line")


def motoman(day: str) -> dict[str, Recording]:
    """A day's grid and lines, each as a recording of its own."""
    return {kind: read(MOTOMAN, recording_file(MOTOMAN, f"{kind}_test{day}_R1.csv")) for kind in KINDS}


def found(arm: Arm, recordings: list[Recording], *, units: bool = False) -> Diagnosis:
    """What is found in some recordings together."""
    one = recordings[0] if len(recordings) == 1 else together(recordings, arm, units=units)
    return diagnose(arm, one)


def on_other_days(tell: Callable[[str], None] = print) -> dict[tuple[str, str, str], float]:
    """RMS (mm) of the files written from a day's grid, lines and both, on the other day's grid and lines, frame and
    tool fitted there: by day learned on, what was learned from, and what it was held against."""
    arm = nominal(MOTOMAN)
    read_of = {day: motoman(day) for day in DAYS}
    said: dict[tuple[str, str, str], float] = {}
    tell("## Motoman MA2010, a day's grid and lines together\n")
    tell("| learned on | tested on | frame and tool alone | file of the grid | file of the lines | file of both |")
    tell("|---|---|---|---|---|---|")
    for day, other in zip(DAYS, reversed(DAYS), strict=True):
        own = read_of[day]
        files = {kind: written(found(arm, [own[kind]])) for kind in KINDS}
        files["both"] = written(found(arm, list(own.values())))
        for kind in KINDS:
            left = {name: predict(file, read_of[other][kind]) for name, file in files.items()}
            said |= {(day, name, kind): 1e3 * item.rms for name, item in left.items()}
            lengths = (left["grid"].nominal_rms, *(item.rms for item in left.values()))
            figures = " | ".join(f"{1e3 * value:.3f}" for value in lengths)
            tell(f"| {day} | {kind} of {other} | {figures} |")
    return said


def ur10_a_and_b(tell: Callable[[str], None] = print) -> Diagnosis:
    """Series A and B as two units of one type: what is left of each, with what was found in both and in the other."""
    arm = nominal(UR10)
    series = [
        read(UR10, recording_file(UR10, "series_A.csv")),
        read(UR10, recording_file(UR10, "series_B.csv"), "recording-b"),
    ]
    # Each is handed over as an arm of its own, as `--units` does.
    result = found(arm, [replace(item, unit=name) for name, item in zip("AB", series, strict=True)], units=True)
    tell("## UR10, series A and B as two units\n")
    tell(f"{result.sentence}\n")
    tell("| series | readings | mismatch | with what was found | held out | learned on the other | file of the unit |")
    tell("|---|---|---|---|---|---|---|")
    for recording in result.recordings:
        file = "-" if recording.written is None else f"{1e3 * recording.written.rms:.3f}"
        lengths = (recording.rms_before, recording.rms_after, recording.rms_held_out, recording.rms_from_others)
        figures = " | ".join(f"{1e3 * value:.3f}" for value in lengths)
        tell(f"| {recording.name} | {recording.rows} | {figures} | {file} |")
    tell(f"\nNot the same in both: {', '.join(difference.effect for difference in result.differences) or 'nothing'}.")
    return result


def evaluate(tell: Callable[[str], None] = print) -> None:
    """Print both."""
    on_other_days(tell)
    tell("")
    ur10_a_and_b(tell)
