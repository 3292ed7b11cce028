"""What an arm's model is worth on a recording: its residual, nothing fitted but a free frame and a free tool."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import residual_in_pieces
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

_HAIR = 1e-8
"""rad or m; coordinates no further beyond a range are within it: files round them."""


@dataclass(frozen=True)
class Leaving:
    """A joint (from 1) that leaves `span`, the least and greatest coordinate (rad, m) that the arm was `learned` from
    (else its range), in some rows of the file."""

    joint: int
    span: tuple[float, float]
    rows: tuple[int, ...]
    learned: bool


@dataclass(frozen=True)
class Prediction:
    """`residual` (N, 2 or 3) m is measured less modelled, in the base frame's directions; `rms`, `mean` and `largest`
    (m) are of its length, `nominal_rms` the RMS of the arm's geometry alone, frame and tool fitted alike. `outside`
    are the rows of the file whose joints leave the coordinates that the arm was learned from, `left` the same by
    joint."""

    arm: Arm
    recording: Recording
    residual: Array
    rms: float
    mean: float
    largest: float
    nominal_rms: float
    outside: tuple[int, ...]
    left: tuple[Leaving, ...] = ()


def predict(
    arm: Arm,
    recording: Recording,
    learned: Sequence[tuple[float, float]] | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Prediction:
    """Set a recording against an arm's model; frame and tool are fitted where the recording says `free`.

    `learned` are the least and greatest coordinates (rad, m) of each joint that the arm was learned from; the joint
    ranges by default. `progress(text, share)` hears of the rows. Raises `MissingProperty` where the model lacks a
    figure.
    """

    def heard(begun: float) -> Callable[[int, int], None]:
        def tell(done: int, of: int) -> None:
            if progress is not None:
                progress(f"predicting, {done} of {of} rows", begun + 0.5 * done / of)

        return tell

    residual = residual_under(arm, recording, heard(0.0))
    length = np.linalg.norm(residual, axis=1)
    spans = learned or [joint.range for joint in arm.joints]
    lower, upper = np.array(spans).T
    beyond = (recording.q < lower - _HAIR) | (recording.q > upper + _HAIR)
    return Prediction(
        arm=arm,
        recording=recording,
        residual=residual,
        rms=rms_length(residual),
        mean=float(length.mean()),
        largest=float(length.max()),
        nominal_rms=rms_length(residual_under(nominal(arm), recording, heard(0.5))),
        outside=tuple(recording.row[beyond.any(axis=1)].tolist()),
        left=tuple(
            Leaving(number, (float(span[0]), float(span[1])), tuple(recording.row[rows].tolist()), learned is not None)
            for number, (span, rows) in enumerate(zip(spans, beyond.T, strict=True), start=1)
            if rows.any()
        ),
    )


def residual_under(arm: Arm, recording: Recording, heard: Callable[[int, int], None] | None = None) -> Array:
    """The tip's residual (N, D), m, measured less modelled, nothing fitted but what the recording leaves free; `heard`
    hears how many readings are done, and of how many."""
    bare = replace(recording, orientation=None, joint_side=None, base_target=None)  # commands say what moves the tip
    return residual_in_pieces(arm, bare, rules=RULES, heard=heard)


def nominal(arm: Arm) -> Arm:
    """The arm's geometry alone: rigid and weightless, without play and without what its `effects` name."""
    joints = tuple(replace(joint, clearance=0.0, backlash=0.0, stiffness=None, mass=0.0) for joint in arm.joints)
    links = tuple(replace(link, section=None, material=None, mass=0.0) for link in arm.links)
    return replace(arm, joints=joints, links=links, effects=(), payload=LoadCase())
