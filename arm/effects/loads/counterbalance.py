"""A balancing spring pulls at a link with a torque that goes with the link's angle, and winds up its drive."""

from __future__ import annotations

from collections.abc import Mapping

from linkwright.core.arm.chain.arrays import columns
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, Vector, cross, dot, is_zero, minus, norm, plus, scale, times, unit
from linkwright.core.arm.effects.effect import Effect, OfDrives, Parameter, Settings, size, torque
from linkwright.core.arm.effects.torques import OfEachDrive
from linkwright.core.arm.effects.traits import DriveTraits, RecordingTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.sections.numeric import Array

_UPRIGHT: Vector = (0.0, 0.0, 1.0)


def link_angle(state: PoseState, index: int) -> tuple[Scalar, Scalar]:
    """Cosine and sine of the angle of link `index`: in the plane against x, in space against the vertical, about the
    joint's axis."""
    return _angle(state.links[index].along, state.joints[index].axis, state.arm.gravity, planar=state.planar)


def _angle(along: Vector, axis: Vector, gravity: Vector, *, planar: bool) -> tuple[Scalar, Scalar]:
    if planar:
        return along[0], along[1]
    up = _UPRIGHT if is_zero(gravity) or norm(gravity) == 0.0 else unit(scale(-1.0, gravity))
    # A plumb axis has no such angle: no spring's torque about it goes with the height of its link.
    return minus(dot(along, up), times(dot(axis, along), dot(axis, up))), dot(axis, cross(up, along))


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    of_sine, of_cosine = settings.values.get("sine", 0.0), settings.values.get("cosine", 0.0)
    cosine, sine = link_angle(state, index)
    return plus(times(of_sine, sine), times(of_cosine, cosine))


def _pull(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    """What the drive needs not push, as the spring does."""
    arm: Arm = motion.arm
    frames = place(arm, list(motion.of_links.q.T))
    along, axis = frames.links[joint].along, frames.joints[joint].axis
    angle = columns(_angle(along, axis, arm.gravity, planar=arm.planar()), motion.size)
    return -values.get("torque_cosine", 0.0) * angle[:, 0] - values.get("torque_sine", 0.0) * angle[:, 1]


def _pulling(name: str) -> Parameter:
    return torque(f"torque_{name}", "torque", -1e5, 1e5, (5.0, 500.0)).means(
        f"the spring's torque on the link towards increasing coordinates, the part that goes with the {name} of the "
        "link's angle",
        "balancers of shoulders: 1e2 to 1e3 N*m",
    )


def _torque(name: str) -> Parameter:
    return size(name, "angle", -0.1, 0.1, (0.1e-3, 10e-3)).means(
        f"the spring's torque over the drive's stiffness, the part that goes with the {name} of the link's angle",
        "springs of 1e2 to 1e3 N*m on drives of 1e5 to 1e6 N*m/rad",
    )


COUNTERBALANCE = Effect(
    id="counterbalance",
    title="torque of a counterbalance",
    formula="J_i k sin(phi_i - phi_0)/K_i = J_i (a sin phi_i + b cos phi_i); of a motion -k sin(phi_i - phi_0)",
    place="joint",
    drive=DriveTraits(needed=True),
    cause="loads",
    needs="two payloads",
    aliases=("joint_compliance",),
    source="J. L. Herder, Energy-free Systems (doctoral thesis, Delft University of Technology, 2001): "
    "a balancing spring's torque is a sine of the link's angle",
    parameters=(_torque("sine"), _torque("cosine"), _pulling("sine"), _pulling("cosine")),
    twists=OfDrives(_moved, "joints that turn"),
    torques=OfEachDrive(_pull, "joints that turn"),
    only="joints that turn",
    recording=RecordingTraits(least_travel=0.05),  # a joint that stands only repeats what the joints before it do
    rank=290,
    linear=True,
)
