"""A motion log of a real arm: joint coordinates and drive torques against time; SI throughout."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.recording import RejectedRow
from linkwright.core.sections.numeric import Array


@dataclass(frozen=True)
class Signal:
    """What a log holds of its drives: the `base` of its columns, in which `unit`, and what several are called.
    `of_voltage`: it goes with the voltage at the motor, of which a motor that turns makes less torque."""

    base: str
    unit: str
    words: str
    of_voltage: bool = False


TORQUE = Signal("tau", "N*m", "torques")
CURRENT = Signal("current", "A", "currents")
VOLTAGE = Signal("voltage", "V", "voltages", of_voltage=True)
DISTANCE = Signal("c", "rad", "distances to the goal", of_voltage=True)
"""How far a servo's goal is ahead, where nobody knows the gain by which its loop makes a voltage of that."""


@dataclass(frozen=True)
class MotionLog:
    """N samples of n joints in the order of time, less those set aside.

    Args:
        file: The file it was read from, for people.
        time: (N,) s from the first sample, strictly ascending; gaps are left as they are.
        q: (N, n) joint coordinates as the arm file counts them, rad (m for slides).
        torque: (N, n) N*m (N for slides) at the joint, positive where it pushes towards increasing q; nan where a drive
            was not logged. Of currents and voltages: times torque constant (times gear ratio where it is of the motor).
        row: (N,) each sample's number in the file (`Table.row`).
        velocity: (N, n) as logged, rad/s (m/s); None where it was not.
        commanded: (N, n) commanded coordinates, None alike.
        joint_side: (N, n) coordinates of a second encoder, None alike.
        temperature: (N,) K, None alike.
        payload_mass: (N,) kg, None alike.
        beyond_drive: Whether `q` is of encoders on the joint's side, behind the drive that gives; else of the motor's.
        drive: What `torque` stems from.
        torque_constants_free: Whether nobody knows the torque constants: `torque` is then the signal as it stands (A,
            V), and every torque is known but for one factor a joint, which a diagnosis finds.
        loop: (n,) V/rad (V/m), the voltage that a servo's loop makes of its distance to the goal; None: nobody says.
        weighed: (n,) N*m/A (N*m/V), torque constants that a diagnosis found by what the arm weighs, nan where that
            tells none (the drive then counts as not logged); `torque` is N*m by them. None: `torque` is as it was read.
        sigma: (n,) N*m, declared standard deviations of the torques; None where nobody declared them.
        cutoff: Hz, of the zero-phase low-pass that settings ask for; None: chosen from the data.
        rejected: Rows set aside, each with the reason.
        aside: From when to when (s) something else acts than the arm's physics, so that no sample counts.
        warnings: Sentences for the report (gaps, jitter, duplicate stamps, missing speeds ...).
        settings: The recording.yaml that was used; empty where there is none.
        unit: Which arm of a type (a serial number); empty where nobody said.
        date: When it was made (`2026-05-16`); empty alike.
        other: Further numeric columns as they are, (N,) by name.
    """

    file: str
    time: Array
    q: Array
    torque: Array
    row: NDArray[np.int64]
    velocity: Array | None = None
    commanded: Array | None = None
    joint_side: Array | None = None
    temperature: Array | None = None
    payload_mass: Array | None = None
    beyond_drive: bool = False
    drive: Signal = TORQUE
    torque_constants_free: bool = False
    loop: tuple[float, ...] | None = None
    weighed: tuple[float, ...] | None = None
    sigma: tuple[float, ...] | None = None
    cutoff: float | None = None
    rejected: tuple[RejectedRow, ...] = ()
    aside: tuple[tuple[float, float], ...] = ()
    warnings: tuple[str, ...] = ()
    settings: str = ""
    unit: str = ""
    date: str = ""
    other: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def size(self) -> int:
        """The number of samples, N."""
        return len(self.time)

    @property
    def interval(self) -> float:
        """s, the median from one sample to the next."""
        return float(np.median(np.diff(self.time)))

    def saying(self, *sentences: str) -> MotionLog:
        """The log with further sentences, but for empty ones."""
        return replace(self, warnings=(*self.warnings, *(each for each in sentences if each)))
