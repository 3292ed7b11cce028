"""An encoder reads zero where its joint is not at zero: everything beyond stands turned (or shifted) by the offset."""

from __future__ import annotations

from collections.abc import Iterator

from ..statics import PoseState
from .effect import Effect, Parameter, Settings, Twist, drive_motion


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    offset = settings.values.get("offset", 0.0)
    for index in range(len(state.joints)):
        if offset != 0.0 and settings.acts_at(index):
            yield from drive_motion(state, index, offset)


ENCODER_OFFSET = Effect(
    id="encoder_offset",
    title="offset of an encoder's zero",
    formula="sum J_i delta_i",
    place="joint",
    cause="geometry",
    automatic=False,
    needs="poses that differ in the angles of the other joints",
    aliases=("frame_misalignment", "tool_offset"),
    source="B. W. Mooring, Z. S. Roth & M. R. Driels, Fundamentals of Manipulator Calibration (Wiley, 1991)",
    parameters=(
        Parameter(
            "offset",
            "angle",
            "true coordinate less the encoder's reading",
            -0.2,
            0.2,
            (0.1e-3, 1e-3),
            "homing switches and index marks of industrial robots",
            role="size",
        ),
    ),
    twists=_twists,
)
