"""An encoder reads zero where its joint is not at zero: everything beyond stands turned (or shifted) by the offset."""

from __future__ import annotations

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar
from linkwright.core.arm.effects.effect import Effect, OfDrives, Settings, size


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    del state, index
    return settings.values.get("offset", 0.0)


ENCODER_OFFSET = Effect(
    id="encoder_offset",
    title="offset of an encoder's zero",
    formula="sum J_i delta_i",
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
    lasts="a while",
    rank=20,
    linear=True,
    watched=True,
)
