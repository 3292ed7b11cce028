"""What cannot be right in a recording that observes in part, looked at before it is believed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.mistakes.row_lists import rows_text
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError, format_quantity
from linkwright.core.units.reading import refusal

from .instrument import ALONG, BAR, CAMERA, DISTANCE, NAMES, PLANE, Slots
from .level import stand_of, tilts
from .view import View, touched_planes, viewed

_SCALES = ((1e3, "1000 times larger"), (1e-3, "1000 times smaller"), (1e-6, "a million times smaller"))


def sights_checked(recording: Recording, arm: Arm, *, rules: Rules = RULES) -> Recording:
    """The recording less rows far off, where numbers contradict the joints. Raises `InputError` where they do so as a
    whole, where any anchor would fit, and for planes that were touched on a line."""
    slots = recording.slots
    if slots is None:
        return recording
    tips, axes = nominal(arm, recording.q, 3)
    _refuse_lines(recording, tips, slots, flat=arm.planar(), share=rules.residual.level_places)
    _refuse_any_anchor(recording, tips, slots, flat=arm.planar(), share=rules.residual.level_places)
    if recording.size < rules.residual.enough_freedom or not np.ptp(recording.q, axis=0).any():
        return recording

    stand = stand_of(recording, arm)

    def view(tried: Recording) -> View:
        return viewed(tried, tips, axes, stand, flat=arm.planar(), rules=rules.residual)

    view_ = view(recording)
    _refuse_other_camera(recording, view_, view, rules)
    off, extent = np.abs(view_.residual), float(np.linalg.norm(np.ptp(tips, axis=0)))
    numbers = (slots <= DISTANCE) | (slots >= CAMERA)
    misfit = float(np.median(off[numbers])) if numbers.any() else 0.0
    if misfit > rules.reading.elsewhere * extent:
        _say_why(recording, view, numbers, misfit, extent, rules)
    _refuse_other_tilts(recording, off, rules)
    _refuse_other_bars(recording, view, off, rules)
    limit = max(rules.mistakes.far * float(np.median(off)), rules.mistakes.gross * extent)
    far = (off > limit).any(axis=1)
    if not far.any() or far.mean() > rules.mistakes.few_rows:
        return recording
    bad: list[RejectedRow] = []
    for index in np.flatnonzero(far).tolist():
        column = int(np.argmax(off[index]))
        by = format_quantity(float(off[index, column]), "length", digits=3)
        what = NAMES[int(slots[index, column])]
        bad.append(RejectedRow(int(recording.row[index]), f"{what} is {by} from what its joints say"))
    return recording.without(bad)


def _refuse_other_camera(recording: Recording, view_: View, view: Callable[[Recording], View], rules: Rules) -> None:
    """A camera that is where its target is said to be."""
    if view_.sight is None:
        return
    camera = recording.instrument.camera
    other = "fixed" if camera == "on_tool" else "on_tool"
    tried = view(replace(recording, instrument=replace(recording.instrument, camera=other)))
    off, instead = (float(np.median(np.linalg.norm(item.residual, axis=1))) for item in (view_, tried))
    if instead < rules.mistakes.better * off:
        far, near = (format_quantity(item, "length", digits=2) for item in (off, instead))
        message = f"is {camera}, which leaves {far} in the middle reading; {other} leaves {near}"
        raise refusal(recording.file, "camera", message, {"camera": other})


def _refuse_other_tilts(recording: Recording, off: Array, rules: Rules) -> None:
    """Tilts that are not what the joints say, wherever the level sits."""
    read_tilts = tilts(recording)
    if not read_tilts.any() or float(np.median(off[read_tilts])) <= rules.reading.elsewhere:
        return
    link = recording.instrument.tilt_link or "base"
    by = format_quantity(float(np.arcsin(min(1.0, float(np.median(off[read_tilts]))))), "angle", digits=2)
    message = f"the middle tilt is {by} from what a level would read there, however it sits"
    raise InputError(
        recording.file, "tilt_x", f"{message}: check `tilt_link: {link}`, the unit in the header and signs"
    )


def _refuse_other_bars(recording: Recording, view: Callable[[Recording], View], off: Array, rules: Rules) -> None:
    """Bars of another length than the tips' places have."""
    assert recording.slots is not None
    bars = (recording.slots >= BAR) & (recording.slots < CAMERA)
    if recording.bar_at is None or not bars.any():
        return
    there = bars.any(axis=1)
    length = float(np.sqrt(np.mean((recording.bar_at[there] - recording.bar_at[there].mean()) ** 2)))
    misfit = float(np.sqrt(np.mean(off[bars] ** 2)))
    apart = max(length, float(np.sqrt(np.mean((view(recording).at[there] - view(recording).at[there].mean()) ** 2))))
    if misfit <= rules.reading.elsewhere * apart:
        return
    for scale, words in _SCALES:
        other = np.abs(view(replace(recording, bar_at=recording.bar_at * scale)).residual)[bars]
        if float(np.sqrt(np.mean(other**2))) < rules.mistakes.better * misfit:
            message = (
                f"looks as if its numbers were {words} than the header's unit says; correct the unit in the header"
            )
            raise InputError(recording.file, "bar_mm", message)


def _say_why(
    recording: Recording,
    view: Callable[[Recording], View],
    numbers: NDArray[np.bool_],
    misfit: float,
    extent: float,
    rules: Rules,
) -> None:
    """Raise the error that says what is wrong with all of a recording."""
    slots = np.unique(np.asarray(recording.slots)).tolist()
    read = ", ".join(NAMES[slot] for slot in slots if slot <= DISTANCE or slot >= CAMERA)
    for scale, words in _SCALES:
        other = float(np.median(np.abs(view(replace(recording, tip=recording.tip * scale)).residual[numbers])))
        if other < rules.mistakes.better * misfit and other < rules.reading.elsewhere * extent:
            message = (
                f"looks as if its numbers were {words} than the header's unit says; correct the unit in the header"
            )
            raise InputError(recording.file, read, message)
    off = format_quantity(misfit, "length", digits=3)
    free = "" if recording.frame == "free" else "; `frame: free` fits where it was measured from"
    along = ", `direction`" if ALONG in slots else ""
    anchor = ", `anchor`" if DISTANCE in slots else ""
    raise InputError(
        recording.file,
        read,
        f"the middle reading is {off} from what the arm file's geometry gives: check the arm, the order of the joints, "
        f"signs and zeros{along}{anchor}{free}",
    )


def _refuse_lines(recording: Recording, tips: Array, slots: Slots, *, flat: bool, share: float) -> None:
    """Planes that were touched on a line (in the plane: lines touched at a spot) could be turned about it."""
    if recording.touches is None or not (slots == PLANE).any():
        return
    touched = np.where((slots == PLANE).any(axis=1), recording.touches, -1)
    _, _, reach = touched_planes(tips, touched, len(recording.instrument.labels), flat=flat)
    size = float(np.linalg.norm(np.ptp(tips, axis=0)))
    for label, name in enumerate(recording.instrument.labels):
        rows = touched == label
        narrow = reach[label, 1] <= share * max(reach[label, 0], share * size)
        if rows.any() and narrow:
            where = "at one spot" if flat else "on a line"
            raise InputError(
                recording.file,
                "plane",
                f"'{name}' is touched {where} only ({rows_text(recording.row[rows])}): it could be turned about it; "
                "touch it elsewhere too",
            )


def _refuse_any_anchor(recording: Recording, tips: Array, slots: Slots, *, flat: bool, share: float) -> None:
    """An anchor that nobody knows needs more distances than its place has numbers."""
    distances = (slots == DISTANCE).any(axis=1)
    alone = not (slots <= ALONG).any()
    free = recording.instrument.anchor is None or (recording.frame == "free" and alone)
    if not distances.any() or not free:
        return
    at = tips[distances]
    apart = max(share * float(np.linalg.norm(np.ptp(at, axis=0))), 1e-6)
    places = len(np.unique(np.round(at / apart), axis=0))
    least = 3 if flat else 4
    if places < least:
        raise InputError(
            recording.file,
            "anchor",
            f"is free, and the distances are from {places} place{'s' if places != 1 else ''}: every reading would be "
            f"met by some anchor; measure from {least} places or more, or say where it is",
        )
