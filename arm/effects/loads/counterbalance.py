"""A balancing spring pulls at a link with a torque that goes with the link's angle, and winds up its drive."""

from __future__ import annotations

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, Vector, cross, dot, is_zero, norm, plus, scale, times, unit
from linkwright.core.arm.effects.effect import Effect, OfDrives, Parameter, Settings, size

_UPRIGHT: Vector = (0.0, 0.0, 1.0)


def link_angle(state: PoseState, index: int) -> tuple[Scalar, Scalar]:
    """Cosine and sine of the angle of link `index`: in the plane against x, in space against the vertical, about the
    joint's axis."""
    along = state.links[index].along
    if state.planar:
        return along[0], along[1]
    up = _UPRIGHT if is_zero(state.gravity) or norm(state.gravity) == 0.0 else unit(scale(-1.0, state.gravity))
    return dot(along, up), dot(state.joints[index].axis, cross(up, along))


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    of_sine, of_cosine = settings.values.get("sine", 0.0), settings.values.get("cosine", 0.0)
    cosine, sine = link_angle(state, index)
    return plus(times(of_sine, sine), times(of_cosine, cosine))


def _torque(name: str) -> Parameter:
    return size(name, "angle", -0.1, 0.1, (0.1e-3, 10e-3)).means(
        f"the spring's torque over the drive's stiffness, the part that goes with the {name} of the link's angle",
        "springs of 1e2 to 1e3 N*m on drives of 1e5 to 1e6 N*m/rad",
    )


COUNTERBALANCE = Effect(
    id="counterbalance",
    title="torque of a counterbalance",
    formula="J_i k sin(phi_i - phi_0)/K_i = J_i (a sin phi_i + b cos phi_i)",
    place="joint",
    needs_drive=True,
    cause="loads",
    needs="two payloads",
    aliases=("joint_compliance",),
    source="J. L. Herder, Energy-free Systems (doctoral thesis, Delft University of Technology, 2001): "
    "a balancing spring's torque is a sine of the link's angle",
    parameters=(_torque("sine"), _torque("cosine")),
    twists=OfDrives(_moved, "joints that turn"),
    only="joints that turn",
    least_travel=0.05,  # a joint that stands only repeats what the joints before it do
    rank=290,
    linear=True,
)
