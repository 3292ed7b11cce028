"""Encoders are read before the tip is measured: a moving arm has gone on meanwhile."""

from __future__ import annotations

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Settings, size
from linkwright.core.arm.effects.traits import RecordingTraits


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    velocities = state.conditions.velocities
    return 0.0 if velocities is None else times(settings.values.get("delay", 0.0), velocities[index])


LATENCY = Effect(
    id="latency",
    title="delay between encoders and instrument",
    formula="sum J_i (dq_i/dt) dt",
    place="joint",
    cause="angle errors",
    needs="velocities, of more than one size or both ways",
    aliases=("friction_windup",),
    source="B. Siciliano, L. Sciavicco, L. Villani & G. Oriolo, Robotics: Modelling, Planning and Control "
    "(Springer, 2009), differential kinematics, doi:10.1007/978-1-84628-642-1",
    parameters=(
        size("delay", "time", -1.0, 1.0, (1e-3, 20e-3)).means(
            "how much later the tip was measured than the encoders were read", "cycles of controllers and field buses"
        ),
    ),
    twists=OfDrives(_moved),
    together=True,
    requires=("velocities",),
    rank=300,
    linear=True,
    recording=RecordingTraits(of_instrument=True),
    synonyms=("delay", "time_delay"),
)
