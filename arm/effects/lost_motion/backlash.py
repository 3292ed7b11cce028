"""A drive's lost motion: the joint sits anywhere within half the backlash to either side."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from linkwright.core.arm.chain.statics import JointState, PoseState
from linkwright.core.arm.effects.effect import (
    NO_LOAD,
    Disc,
    Effect,
    Interval,
    Settings,
    Twist,
    drive_motion,
    shape,
    size,
)
from linkwright.core.arm.effects.loads.added_weights import bearing
from linkwright.core.arm.effects.traits import DriveTraits, PlayTraits, WatchTraits


def _loose(state: PoseState, settings: Settings) -> list[tuple[int, JointState, float]]:
    """The joints that have play, with all that they bear, and how much of it."""
    totals = [settings.values.get("total", joint.backlash) for joint in state.joints]
    joints = [index for index, total in enumerate(totals) if total != 0.0 and settings.acts_at(index)]
    borne = bearing(state).joints if joints else ()
    return [(index, borne[index], totals[index]) for index in joints]


def _play(state: PoseState, settings: Settings) -> Iterator[Interval | Disc]:
    for index, joint, total in _loose(state, settings):
        yield Interval(drive_motion(state, index, 0.5 * total), joint.drive_load)


def _seated(state: PoseState, settings: Settings) -> Iterator[Twist]:
    held_below = settings.values.get("held_below", 0.0)
    sides = state.conditions.sides
    for index, joint, total in _loose(state, settings):
        # What nothing loads the least friction holds.
        held = (np.abs(joint.drive_load) <= NO_LOAD) | (np.abs(joint.drive_load) < held_below)
        pushed = np.where(held, 0.0, np.sign(joint.drive_load))
        dragged = 0.0 if sides is None else np.where(held, -sides[index], 0.0)
        yield from drive_motion(state, index, 0.5 * total * (pushed + dragged))


BACKLASH = Effect(
    id="backlash",
    title="backlash of the drives",
    formula="1/2 sum J_i b_i sgn(tau_i) where the load seats it; -1/2 sum J_i b_i s_i where friction holds it",
    place="joint",
    drive=DriveTraits(needed=True, by_load=True),
    cause="play and friction",
    automatic=True,
    needs="a reversal of torque, or every pose from both sides; in motion encoders on both sides",
    aliases=("encoder_offset",),
    source="ISO 230-2:2014 (reversal error); ISO 9283:1998 (multi-directional pose accuracy variation)",
    parameters=(
        size("total", "angle", 0.0, 0.1, (0.03e-3, 15e-3)).means(
            "total lost motion", "makers' figures: gearboxes below 1 to 8 arcmin, bus servos to 0.87 deg"
        ),
        shape(
            "held_below",
            "torque",
            0.0,
            1e6,
            (0.0, 50.0),
            grid=(0.0, 0.1, 0.25, 0.5, 1.01),
            relative_to_load=True,
            threshold=True,
            requires=("sides",),
        ).means(
            "load below which friction holds the joint on the side that it came from",
            "friction of gearboxes: a few per cent of their rated torque",
        ),
    ),
    play=PlayTraits(free=_play, seated=_seated),
    watch=WatchTraits(lasts="a while", always=True),
    rank=40,
    linear=True,
    synonyms=("play", "lost_motion", "hysteresis"),
)
