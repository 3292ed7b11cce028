"""An encoder reads zero where its joint is not at zero: everything beyond stands turned (or shifted) by the offset."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar
from linkwright.core.arm.effects.effect import Effect, OfDrives, Settings, size
from linkwright.core.arm.effects.traits import WatchTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics
from linkwright.core.sections.numeric import Array

_STEP = 1e-4
"""rad, m; over such a step a torque is straight to nine digits."""


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    del state, index
    return settings.values.get("offset", 0.0)


def _torques(motion: Motion, settings: Settings) -> Mapping[int, Array]:
    """To first order what other postures take: the slope of the torque over the coordinates, times the offset."""
    offset = settings.values.get("offset", 0.0)
    moved = offset * np.array([settings.acts_at(index) for index in range(motion.arm.size)], dtype=float)
    size = float(np.abs(moved).max())
    if size == 0.0:
        return {}
    step = moved * (_STEP / size)
    moves = motion.of_links
    ahead, behind = (inverse_dynamics(replace(moves, q=moves.q + way * step)) for way in (1.0, -1.0))
    return dict(enumerate((ahead - behind).T * (size / (2.0 * _STEP))))


ENCODER_OFFSET = Effect(
    id="encoder_offset",
    title="offset of an encoder's zero",
    formula="sum J_i delta_i; of a motion dtau/dq_i delta_i",
    place="joint",
    cause="geometry",
    needs="poses that differ in the angles of the other joints",
    aliases=("frame_misalignment", "tool_offset"),
    source="B. W. Mooring, Z. S. Roth & M. R. Driels, Fundamentals of Manipulator Calibration (Wiley, 1991)",
    parameters=(
        size("offset", "angle", -0.5, 0.5, (0.1e-3, 1e-3)).means(
            "true coordinate less the encoder's reading", "homing switches and index marks of industrial robots"
        ),
    ),
    twists=OfDrives(_moved),
    torques=_torques,
    watch=WatchTraits(lasts="a while", always=True),
    rank=20,
    linear=True,
    synonyms=("zero_offset", "joint_offset", "home_offset", "zero", "offset"),
)
