"""An encoder's disc sits off its axis: the reading errs once a turn."""

from __future__ import annotations

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, plus, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Parameter, Settings, size
from linkwright.core.arm.effects.traits import RecordingTraits
from linkwright.core.sections.numeric import cos, sin


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    of_sine, of_cosine = settings.values.get("sine", 0.0), settings.values.get("cosine", 0.0)
    angle = state.joints[index].coordinate
    return plus(times(of_sine, sin(angle)), times(of_cosine, cos(angle)))


def _amplitude(name: str) -> Parameter:
    return size(name, "angle", -0.02, 0.02, (0.05e-3, 0.5e-3)).means(
        f"error that goes with the {name} of the joint's angle",
        "eccentricity over grating radius: some 10 um over 20 to 50 mm",
    )


ENCODER_ECCENTRICITY = Effect(
    id="encoder_eccentricity",
    title="eccentricity of an encoder's disc",
    formula="sum J_i (a sin q_i + b cos q_i)",
    place="joint",
    cause="angle errors",
    needs="wide travel of the joint",
    aliases=("encoder_scale", "gear_transmission_error"),
    source="A. H. Slocum, Precision Machine Design (Prentice Hall, 1992), rotary encoders",
    parameters=(_amplitude("sine"), _amplitude("cosine")),
    twists=OfDrives(_moved, "joints that turn"),
    only="joints that turn",
    recording=RecordingTraits(least_travel=1.0),  # over less a wave of one turn is a straight line: the encoder's scale
    rank=120,
    linear=True,
)
