"""All that gives in an arm under load, as one response: for effects that are loads the model does not know of.

A payload heavier than declared, hoses along a link or a tilted base move the tip through everything that bends. The
response is linear in the loads, so it is that of the additional loads alone, drives being as soft as in their softest
zone. What does not answer in proportion (hardening drives, creep) or is seen by the encoder (a servo's droop) does not
take part; friction and play answer to the whole load by themselves (`arm.effects.loads.added_weights`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import LoadCase
from linkwright.core.arm.chain.statics import PoseState, solve, unladen
from linkwright.core.arm.chain.vectors import ZERO, Scalar, Vector
from linkwright.core.arm.effects.effect import Settings, Twist
from linkwright.core.arm.effects.loads.unknown_weight import without_unit_weights
from linkwright.core.arm.effects.registry import EFFECTS


def elastic_twists(state: PoseState) -> Iterator[Twist]:
    """What gives under the loads of `state`: the arm's physics less `leave_out`, and what its `effects` add."""
    arm = state.arm
    state = replace(state, joints=tuple(replace(joint, zones=()) for joint in state.joints))
    for effect in (item for item in EFFECTS.values() if item.link.flexible):
        if effect.automatic and effect.id not in arm.leave_out:
            yield from effect.twists(state, Settings())
        for entry in arm.effects:
            if entry.effect == effect.id:
                yield from effect.twists(state, Settings.of(entry))


def under_other_loads(
    state: PoseState,
    *,
    gravity: Vector | None = None,
    payload_mass: Scalar | None = None,
    tip_force: Vector | None = None,
    tip_moment: tuple[float, float, float] | None = None,
    link_masses: tuple[Scalar, ...] | None = None,
    link_moments: tuple[Scalar, ...] | None = None,
    weightless: bool = False,
) -> PoseState:
    """The same pose under other loads: another gravity (m/s^2), payload (kg), force (N) and moment (N*m) at the tip,
    masses spread along the links in place of their own (kg), and first moments about the links' joints beyond those of
    these masses (kg*m), which load what is below the link.

    With `weightless`, only the loads named here act: links, joints and payload weigh nothing but what is named.
    """
    arm, case, beams = state.arm, replace(state.load, moving=None), [link.beam for link in state.links]
    arm = replace(arm, joints=tuple(replace(joint, counterbalance=None) for joint in arm.joints))
    if weightless or link_masses is not None:
        arm = without_unit_weights(arm)
    carried = state.payload_mass if payload_mass is None else payload_mass
    pushed = state.tip_force if tip_force is None else tip_force
    if weightless:
        case = LoadCase()
        carried = 0.0 if payload_mass is None else payload_mass
        pushed = ZERO if tip_force is None else tip_force
        arm = replace(arm, joints=tuple(replace(joint, mass=0.0) for joint in arm.joints))
        arm = unladen(arm.with_links(tuple(replace(link, masses=()) for link in arm.links)))
        link_masses = link_masses or (0.0,) * len(beams)
    if tip_moment is not None:
        case = replace(case, moment=tip_moment)
    if link_masses is not None:
        beams = [_weighing(beam, mass) for beam, mass in zip(beams, link_masses, strict=True)]
    if link_moments is not None:
        beams = [
            replace(beam, first_moment=(moment, 0.0, 0.0)) for beam, moment in zip(beams, link_moments, strict=True)
        ]
    return solve(
        arm,
        [joint.coordinate for joint in state.joints],
        beams,
        case,
        gravity=state.gravity if gravity is None else gravity,
        conditions=state.conditions,
        payload_mass=carried,
        tip_force=pushed,
        frames=state.frames,
    )


def _weighing(beam: Beam, mass: Scalar) -> Beam:
    """The beam with another mass (kg), spread along it as its own is."""
    if isinstance(mass, float) and mass == 0.0:
        return replace(beam, mass_per_length=0.0, lumped_mass=0.0, first_moment=ZERO, housed=0.0)
    if isinstance(beam.length, float) and beam.length == 0.0:
        return replace(beam, mass_per_length=0.0, lumped_mass=mass, lumped_at=0.0)
    return replace(beam, mass_per_length=mass / beam.length, lumped_mass=0.0, housed=0.0)
