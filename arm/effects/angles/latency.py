"""Encoders are read before the tip is measured: a moving arm has gone on meanwhile."""

from __future__ import annotations

from collections.abc import Iterator

from ..statics import PoseState
from ..vectors import times
from .effect import Effect, Parameter, Settings, Twist, drive_motion


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
    automatic=False,
    needs="velocities, of more than one size or both ways",
    aliases=("friction_windup",),
    source="B. Siciliano, L. Sciavicco, L. Villani & G. Oriolo, Robotics: Modelling, Planning and Control "
    "(Springer, 2009), differential kinematics, doi:10.1007/978-1-84628-642-1",
    parameters=(
        Parameter(
            "delay",
            "time",
            "how much later the tip was measured than the encoders were read",
            -1.0,
            1.0,
            (1e-3, 20e-3),
            "cycles of controllers and field buses",
            role="size",
        ),
    ),
    twists=_twists,
    together=True,
    requires=("velocities",),
)
