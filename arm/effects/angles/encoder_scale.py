"""An encoder counts too much or too little: the error grows with the coordinate. On a slide: the lead of its screw."""

from __future__ import annotations

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Settings, size


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    return times(settings.values.get("scale", 0.0), state.joints[index].coordinate)


ENCODER_SCALE = Effect(
    id="encoder_scale",
    title="scale of an encoder or of a gear ratio",
    formula="sum J_i e_i q_i",
    place="joint",
    cause="angle errors",
    needs="wide travel of the joint",
    aliases=("encoder_eccentricity", "joint_coupling"),
    source="B. W. Mooring, Z. S. Roth & M. R. Driels, Fundamentals of Manipulator Calibration (Wiley, 1991)",
    parameters=(
        size("scale", "dimensionless", -0.1, 0.1, (1e-5, 1e-3)).means(
            "share of its reading by which the joint stands farther than the encoder reads",
            "gratings and screws: 1e-5 to 1e-4; belts and wrong ratios: more",
        ),
    ),
    twists=OfDrives(_moved),
    rank=180,
    linear=True,
)
