"""Encoders are read before the tip is measured: a moving arm has gone on meanwhile."""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import times
from linkwright.core.arm.effects.effect import Effect, Settings, Twist, drive_motion, size


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    delay, velocities = settings.values.get("delay", 0.0), state.conditions.velocities
    if delay == 0.0 or velocities is None:
        return
    for index in range(len(state.joints)):
        if settings.acts_at(index):
            yield from drive_motion(state, index, times(delay, velocities[index]))


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
    twists=_twists,
    together=True,
    requires=("velocities",),
    rank=300,
    linear=True,
    of_instrument=True,
)
