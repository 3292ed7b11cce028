"""Tips: machines whose places were measured, each learned on some recordings and judged on others.

Frame and tool are fitted to the recording that judges, for all three alike, as `predict` does.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np

from benchmarks.real import iiwa7
from benchmarks.real.data import (
    EXAMPLES,
    IRB120,
    MOTOMAN,
    PRINTER,
    SERVO,
    UR10,
    nominal,
    read,
    recording_file,
)
from benchmarks.real.printer import FILES as PRINTED
from benchmarks.real.public.where import public_folder
from benchmarks.real.table.row import Figures, Row
from benchmarks.real.textbook import single, tips
from benchmarks.real.textbook.chain import Array, Chain, from_arm_file
from benchmarks.real.written import written
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.judge.predict import Prediction, predict
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.several.recordings import together
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.units.quantities import InputError

POSES = 3000
"""Poses of the UR10's series A that are learned on, drawn by a fixed seed: 11,911 tell no more of these models."""
MM = 1e3


def poses_of(recording: Recording) -> tips.Poses:
    """A recording as the textbook reads it."""
    return tips.Poses(recording.q, recording.tip[:, :3], recording.payload_mass)


def _said(diagnosis: Diagnosis) -> str:
    return f"{diagnosis.verdict}, {len(diagnosis.findings)} names"


def compared(
    machine: str, arm: Arm, chain: Chain, learned: Mapping[str, Recording], judged: Mapping[str, Recording]
) -> Iterator[Row]:
    """Rows of one machine.

    Args:
        machine: Its name.
        arm: The given arm.
        chain: The same as the textbook reads it.
        learned: Recordings by name that both are fitted to, together.
        judged: Recordings by name that judge.
    """
    parts = list(learned.values())
    book = tips.calibrated(chain, [poses_of(item) for item in parts])
    file, said, promised = _ours(arm, parts)
    seen = _together([predict(file, item) for item in parts])
    for name, recording in judged.items():
        ours = predict(file, recording)
        held = Figures(MM * ours.nominal_rms, MM * tips.rms(tips.seated(book, poses_of(recording))[1]), MM * ours.rms)
        own = Figures(MM * seen[0], MM * book.rms, MM * seen[1])
        yield Row(machine, " + ".join(learned), name, held, own, said, file is not arm, promised)


def _ours(arm: Arm, parts: Sequence[Recording]) -> tuple[Arm, str, float]:
    """The written file, what was said, and the promise (mm); the given arm where there is no answer."""
    try:
        result = diagnose(arm, parts[0] if len(parts) == 1 else together(list(parts), arm))
        file = written(result) if result.corrected.effects != arm.effects else arm
    except InputError as error:
        return arm, f"refused: {error}", float("nan")
    return file, _said(result), MM * result.rms_promised


def _together(left: Sequence[Prediction]) -> tuple[float, float]:
    """RMS (m) of all readings, nominal and with the file."""
    sizes = np.array([len(item.residual) for item in left], dtype=float)
    return (
        float(np.sqrt(sizes @ np.array([item.nominal_rms for item in left]) ** 2 / sizes.sum())),
        float(np.sqrt(sizes @ np.array([item.rms for item in left]) ** 2 / sizes.sum())),
    )


def motoman() -> Iterator[Row]:
    """Each day's grid, and grid and lines, on the other day; the grid on its own day's lines."""
    arm, chain = nominal(MOTOMAN), from_arm_file(EXAMPLES / MOTOMAN / "arm.yaml")
    days = ("0516", "0801")
    each = {
        f"{kind} {day}": read(MOTOMAN, recording_file(MOTOMAN, f"{kind}_test{day}_R1.csv"))
        for day in days
        for kind in ("grid", "line")
    }
    for day, other in zip(days, reversed(days), strict=True):
        there = {name: item for name, item in each.items() if name.endswith(other)}
        grid, line = f"grid {day}", f"line {day}"
        yield from compared("Motoman MA2010", arm, chain, {grid: each[grid]}, {line: each[line], **there})
        yield from compared("Motoman MA2010", arm, chain, {grid: each[grid], line: each[line]}, there)


def ur10() -> Iterator[Row]:
    """Series A on B, months later, and B on A."""
    arm, chain = nominal(UR10), from_arm_file(EXAMPLES / UR10 / "arm.yaml")
    a = read(UR10, recording_file(UR10, "series_A.csv"))
    b = read(UR10, recording_file(UR10, "series_B.csv"), "recording-b")
    drawn = np.zeros(a.size, dtype=bool)
    drawn[np.random.default_rng(0).permutation(a.size)[:POSES]] = True
    name = f"series A ({POSES} poses)"
    yield from compared("UR10", arm, chain, {name: a.kept(drawn)}, {"series B": b})
    yield from compared("UR10", arm, chain, {"series B": b}, {name: a.kept(drawn)})


def irb120() -> Iterator[Row]:
    """700 poses on 300 others, by both kinds of angles."""
    arm, chain = nominal(IRB120), from_arm_file(EXAMPLES / "irb120" / "arm.yaml")
    for name, how in (("read back", "recording"), ("commanded", "recording-commanded")):
        recording = read(IRB120, recording_file(IRB120, "recording_both_angles.csv"), how)
        first = recording.row <= 701  # row 1 is the header
        yield from compared(
            "IRB 120", arm, chain, {f"700 poses, {name}": recording.kept(first)}, {"300 poses": recording.kept(~first)}
        )


def iiwa() -> Iterator[Row]:
    """Two payloads on the third: frame as the two have it, the target by half of the third's poses, both ways. The
    textbook's drives give under the measured torques."""
    chain = from_arm_file(EXAMPLES / "iiwa7" / "arm.yaml")
    for payload in iiwa7.RUNS:
        said = iiwa7.left_out(payload)
        others = [iiwa7.run(item) for item in iiwa7.RUNS if item != payload]
        left: list[Array] = []
        with tempfile.TemporaryDirectory() as folder:
            known = iiwa7.recorded(others, Path(folder))
            book = tips.calibrated(chain, [_with_torque(known)])
            count = len(iiwa7.run(payload))
            for half in (0, 1):
                seen = np.arange(count) % 2 == half
                third = _with_torque(iiwa7.recorded([iiwa7.run(payload, seen)], Path(folder)))
                left.append(tips.retargeted(book, third, seen))
            file = written(said.diagnosis)
            own = predict(file, known)
        held = Figures(said.nominal, MM * tips.rms(np.concatenate(left)), said.written)
        mine = Figures(MM * own.nominal_rms, MM * book.rms, MM * own.rms)
        names = " + ".join(f"{item:g} kg" for item in iiwa7.RUNS if item != payload)
        words, promised = _said(said.diagnosis), MM * said.diagnosis.rms_promised
        yield Row("iiwa 7", names, f"{payload:g} kg", held, mine, words, True, promised)


def _with_torque(recording: Recording) -> tips.Poses:
    return tips.Poses(recording.q, recording.tip[:, :3], None, recording.torque)


def servo() -> Iterator[Row]:
    """Every other pull on the pulls between them; the textbook is a spring and a middle."""
    arm = nominal(SERVO)
    recording = read(SERVO, recording_file(SERVO, "motor_telemetry_single.csv"))
    assert recording.force is not None
    pull = np.cumsum(np.diff(np.sign(recording.force[:, 0]), prepend=0.0) != 0.0)
    first = pull // 2 % 2 == 0
    seen, other = recording.kept(first), recording.kept(~first)
    file, said, promised = _ours(arm, [seen])
    force = recording.force
    book = single.spring(seen.q[:, 0], seen.tip, force[first], 0.1)
    left = [book.left(item.q[:, 0], item.tip, force[rows]) for item, rows in ((other, ~first), (seen, first))]
    ours, own = predict(file, other), predict(file, seen)
    yield Row(
        "STS3215 servo",
        "every other pair of pulls",
        "the pairs between",
        Figures(MM * ours.nominal_rms, MM * tips.rms(left[0]), MM * ours.rms),
        Figures(MM * own.nominal_rms, MM * tips.rms(left[1]), MM * own.rms),
        said,
        file is not arm,
        promised,
    )


def printer() -> Iterator[Row]:
    """One day's warming on the other's; the textbook is one coefficient of the frame's temperature."""
    arm = nominal(PRINTER)
    days = {day: read(PRINTER, recording_file(PRINTER, file), how) for day, (file, how) in PRINTED.items()}
    for day, other in zip(days, reversed(list(days)), strict=True):
        here, there = days[day], days[other]
        file, said, promised = _ours(arm, [here])
        slope = single.slope(_warmth(here), here.tip[:, 2])
        left = [single.left(_warmth(item), item.tip[:, 2], slope) for item in (there, here)]
        ours, own = predict(file, there), predict(file, here)
        yield Row(
            "Voron frame",
            day,
            other,
            Figures(MM * ours.nominal_rms, MM * left[0], MM * ours.rms),
            Figures(MM * own.nominal_rms, MM * left[1], MM * own.rms),
            said,
            file is not arm,
            promised,
        )


def _warmth(recording: Recording) -> Array:
    assert recording.link_temperature is not None
    return recording.link_temperature[:, 0]


def fanuc() -> Iterator[Row]:
    """24 poses of three reflectors, each with a frame and tool of its own, on the 12 others: every third, in turn."""
    folder = public_folder("fanuc")
    arm, chain = read_arm(folder / "arm.yaml"), from_arm_file(folder / "arm.yaml")
    each = [read_recording(folder / f"reflector{k}.csv", arm, folder / "recording.yaml") for k in (1, 2, 3)]
    for third in range(3):
        out = [item.row % 3 == third for item in each]
        names = [f"reflector {k}" for k in (1, 2, 3)]
        learned = {name: item.kept(~rows) for name, item, rows in zip(names, each, out, strict=True)}
        judged = {name: item.kept(rows) for name, item, rows in zip(names, each, out, strict=True)}
        rows = list(compared("FANUC", arm, chain, learned, judged))
        nominal_left, textbook, ours = (
            _mean([getattr(row.held, name) for row in rows]) for name in ("nominal", "textbook", "ours")
        )
        yield replace(
            rows[0],
            learned="24 poses, three reflectors",
            judged=f"12 others ({third + 1} of 3)",
            held=Figures(nominal_left, textbook, ours),
        )


def _mean(values: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


MACHINES: Mapping[str, Callable[[], Iterator[Row]]] = MappingProxyType(
    {
        "motoman": motoman,
        "ur10": ur10,
        "irb120": irb120,
        "iiwa7": iiwa,
        "servo": servo,
        "printer": printer,
        "fanuc": fanuc,
    }
)
