"""Recordings whose rows hold different things: each number becomes a separate reading."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwright.core.diagnose.recording import Recording

from .instrument import Slots


def laid_out(recording: Recording) -> Recording:
    """The recording with as many numbers in each row, each of the same kind; where rows hold different ones (`slots` of
    -1 hold none), each number as a separate reading."""
    slots = recording.slots
    if slots is None or not recording.size:
        return recording
    there = slots >= 0
    if (there == there[0]).all():
        present = there[0]
        return replace(recording, tip=recording.tip[:, present], slots=slots[:, present])
    return _apart(recording, slots)


def as_scalars(recording: Recording) -> Recording:
    """The recording with each number as a separate reading, positions too."""
    slots = recording.slots
    if slots is None:
        slots = np.tile(np.arange(recording.tip.shape[1]), (recording.size, 1))
    elif slots.shape[1] == 1:
        return recording
    return _apart(recording, slots)


def _apart(recording: Recording, slots: Slots) -> Recording:
    """Each number a reading; those of one kind stay together in the order of the file, so that repeats are repeats."""
    rows, columns = np.nonzero(slots >= 0)
    order = np.lexsort((rows, slots[rows, columns]))
    rows, columns = rows[order], columns[order]
    taken = {name: value[rows] for name, value in vars(recording).items() if isinstance(value, np.ndarray)}
    taken |= {"tip": recording.tip[rows, columns][:, None], "slots": slots[rows, columns][:, None]}
    other = {name: values[rows] for name, values in recording.other.items()}
    return replace(recording, **taken, other=other)  # pyright: ignore[reportArgumentType]
