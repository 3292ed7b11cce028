"""Angles are read before the arm has settled: what is recorded lacks the rest of the move just made.

The rest is a share of the move from the reading before; where commands are logged too, of what a joint still has to go.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, plus, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Settings, size
from linkwright.core.arm.effects.traits import Readings, RecordingTraits

_DIFFERENT_MOVES = 0.05
"""Moves must differ by as much (rad, m): if all are alike, their share is a zero that is off."""


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    moves, commanded = state.conditions.last_moves, state.conditions.commanded
    if moves is None:
        return 0.0
    amount = times(settings.values.get("share_of_move", 0.0), moves[index])
    if commanded is None:
        return amount
    to_go = plus(commanded[index], times(-1.0, state.joints[index].coordinate))
    return plus(amount, times(settings.values.get("share_of_command", 0.0), to_go))


def _shown(readings: Readings, at: tuple[int, ...], shapes: Mapping[str, float]) -> bool:
    del shapes
    moves = readings.state.conditions.last_moves
    return moves is not None and any(float(np.ptp(moves[index])) > _DIFFERENT_MOVES for index in at)


STALE_READING = Effect(
    id="stale_reading",
    title="angles read before the arm had settled",
    formula="sum J_i (s_i (q_i - q_i of the reading before) + w_i (c_i - q_i))",
    place="joint",
    cause="angle errors",
    needs="readings in the order of measuring, by moves of many sizes; better the commands beside them",
    aliases=("friction_windup", "backlash"),
    source="ISO 9283:1998, 7.4, position stabilisation time: how long a robot takes to come to rest at a pose",
    parameters=(
        size("share_of_move", "dimensionless", -0.1, 0.1, (1e-4, 1e-3), optional=True).means(
            "share of the move since the reading before that was still to come when the angle was read",
            "an exponential settling of 20 to 50 ms, read 0.2 to 0.3 s after the move",
        ),
        size("share_of_command", "dimensionless", -1.0, 2.0, (0.1, 1.0), optional=True, requires=("commanded",)).means(
            "share of what was left to the command that the joint still went before the tip was measured",
            "1 where the joint stood at its command",
        ),
    ),
    twists=OfDrives(_moved),
    requires=("last_moves",),
    recording=RecordingTraits(shown_by=_shown, of_instrument=True),
    rank=305,
    linear=True,
)
