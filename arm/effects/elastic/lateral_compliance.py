"""A joint's bearing gives across its axis: the moment that it carries beside the drive's tilts all that follows.

It is in the model wherever a joint has a `tilting_stiffness`, of its own or of its drive's catalogue.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from linkwright.core.arm.chain.chain import Joint
from linkwright.core.arm.chain.statics import JointState, PoseState
from linkwright.core.arm.chain.vectors import Scalar, dot, is_zero, scale, subtract
from linkwright.core.arm.effects.effect import Effect, Settings, Twist, size
from linkwright.core.arm.effects.loads.unknown_weight import under_unit_weights, unit_sag
from linkwright.core.arm.effects.traits import DriveTraits, LinkTraits, RecordingTraits


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    product = settings.values.get("unit_sag", 0.0)
    weighed = under_unit_weights(state) if product != 0.0 else None
    size = len(state.joints)
    if weighed is not None:
        yield from _tilted(weighed, settings, [product] * size)
    if "compliance" in settings.values or weighed is not None:
        yield from _tilted(state, settings, [settings.values.get("compliance", 0.0)] * size)
    else:
        yield from _tilted(state, settings, [tilting_compliance(joint) for joint in state.joints])


def tilting_compliance(joint: Joint | JointState) -> float:
    """The compliance (rad/(N*m)) that an arm file gives a joint's bearing across its axis: 0 where it is rigid."""
    return 0.0 if joint.tilting_stiffness is None else 1.0 / joint.tilting_stiffness


def _tilted(state: PoseState, settings: Settings, compliances: Sequence[Scalar]) -> Iterator[Twist]:
    if state.planar:
        # In the plane all moments lie along the axes: what rounding leaves beside them is not physics.
        return
    for index, (joint, compliance) in enumerate(zip(state.joints, compliances, strict=True)):
        if not joint.revolute or not settings.acts_at(index):
            continue
        if isinstance(compliance, float) and compliance == 0.0:
            continue
        across = subtract(joint.moment, scale(dot(joint.axis, joint.moment), joint.axis))
        if not is_zero(across):
            yield Twist("joint", index, rotation=scale(compliance, across))


LATERAL_COMPLIANCE = Effect(
    id="lateral_compliance",
    title="compliance of a joint's bearing",
    formula="sum c_i (M_i - (M_i . a_i) a_i) x (p - o_i), M_i the moment at joint i, a_i its axis",
    place="joint",
    cause="flexibility",
    automatic=True,
    needs="poses out of the plane, two loads",
    aliases=("base_compliance", "axis_misalignment", "link_bending"),
    source="A. Klimchik, A. Pashkevich & D. Chablat, Fundamentals of manipulator stiffness modeling using matrix "
    "structural analysis, Mech. Mach. Theory 133 (2019) 365, doi:10.1016/j.mechmachtheory.2018.11.023: elastic joints",
    parameters=(
        size("compliance", "compliance", 0.0, 1e-2, (1e-7, 1e-5)).means(
            "tilt across the axis for one unit of moment across it",
            "where it is sought: 1e5 to 1e7 N*m/rad, as drives and pedestals of such arms have",
        ),
        unit_sag("the bearing"),
    ),
    twists=_twists,
    enough=(("compliance",), ("unit_sag",)),
    only="joints that turn",
    rank=235,
    linear=True,
    drive=DriveTraits(across=True),
    link=LinkTraits(flexible=True),
    recording=RecordingTraits(weights_named=True),
)
