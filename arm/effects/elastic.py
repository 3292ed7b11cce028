"""All that gives in an arm under load, as one response: for effects that are loads the model does not know of.

A payload heavier than declared, hoses along a link or a tilted base move the tip through everything that bends. The
response is linear in the loads, so it is that of the additional loads alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from types import MappingProxyType

from ..chain import LoadCase
from ..statics import PoseState, solve
from ..vectors import ZERO, Scalar, Vector
from .axial import AXIAL
from .effect import Effect, Settings, Twist
from .joint_compliance import JOINT_COMPLIANCE
from .link_bending import LINK_BENDING
from .shear_deformation import SHEAR_DEFORMATION
from .slope_propagation import SLOPE_PROPAGATION
from .torsion import TORSION

ELASTIC: tuple[Effect, ...] = (
    LINK_BENDING,
    SLOPE_PROPAGATION,
    AXIAL,
    TORSION,
    SHEAR_DEFORMATION,
    JOINT_COMPLIANCE,
)
"""What answers to loads in proportion."""


def elastic_twists(state: PoseState) -> Iterator[Twist]:
    """What gives under the loads of `state`: the arm's own physics less `leave_out`, and what its `effects` add."""
    arm = state.arm
    for effect in ELASTIC:
        if effect.id not in arm.leave_out:
            yield from effect.twists(state, Settings())
        for entry in arm.effects:
            if entry.effect == effect.id:
                at = tuple(number - 1 for number in entry.at)
                yield from effect.twists(state, Settings(at, MappingProxyType(dict(entry.parameters))))


def under_other_loads(
    state: PoseState,
    *,
    gravity: Vector | None = None,
    payload_mass: Scalar | None = None,
    tip_force: Vector | None = None,
    point_forces: tuple[Vector, ...] | None = None,
    weightless: bool = False,
) -> PoseState:
    """The same pose under other loads: another gravity (m/s^2), payload (kg), force at the tip (N) or at the links'
    far ends (N).

    With `weightless`, only the loads named here act: links and joints weigh nothing, the payload is `payload_mass` or
    none.
    """
    arm = state.arm
    case = LoadCase() if weightless else state.load
    pull = state.gravity if gravity is None else gravity
    if weightless and payload_mass is not None:
        # The payload's weight is then a force at the tip: nothing else may feel gravity.
        extra = tuple(payload_mass * component for component in pull)
        force = extra if tip_force is None else tuple(a + b for a, b in zip(extra, tip_force, strict=True))
        tip_force, payload_mass = (force[0], force[1], force[2]), None
    return solve(
        arm,
        [joint.coordinate for joint in state.joints],
        [link.beam for link in state.links],
        case,
        gravity=ZERO if weightless else pull,
        conditions=state.conditions,
        payload_mass=payload_mass,
        tip_force=tip_force,
        point_forces=point_forces,
        frames=state.frames,
    )
