"""A drive's lost motion: the joint sits anywhere within half the backlash to either side."""

from __future__ import annotations

from collections.abc import Iterator

from ..statics import PoseState
from .effect import Disc, Effect, Interval, Parameter, Settings, drive_motion


def _play(state: PoseState, settings: Settings) -> Iterator[Interval | Disc]:
    for index, joint in enumerate(state.joints):
        total = settings.values.get("total", joint.backlash)
        if total == 0.0 or not settings.acts_at(index):
            continue
        yield Interval(drive_motion(state, index, 0.5 * total), joint.drive_load)


BACKLASH = Effect(
    id="backlash",
    title="backlash of the drives",
    formula="1/2 sum J_i b_i sgn(tau_i) where the load seats it; -1/2 sum J_i b_i s_i where friction holds it",
    place="joint",
    automatic=True,
    needs="a reversal of torque, or every pose from both sides",
    aliases=("encoder_offset",),
    source="ISO 230-2:2014 (reversal error); ISO 9283:1998 (multi-directional pose accuracy variation)",
    parameters=(
        Parameter(
            "total",
            "angle",
            "total lost motion",
            0.0,
            0.1,
            (0.03e-3, 1e-3),
            "gearbox makers' catalogue figures: below 1 to 3 arcmin",
        ),
    ),
    play=_play,
)
