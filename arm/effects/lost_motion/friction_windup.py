"""Friction beyond the encoder holds a joint back on the side that it came from, and winds up its drive.

A recording knows the sides. A design does not: there the joint stands anywhere between both, as with backlash.
"""

from __future__ import annotations

from collections.abc import Iterator

from linkwright.core.arm.chain.statics import JointState, PoseState
from linkwright.core.arm.chain.vectors import Scalar, plus, times
from linkwright.core.arm.effects.effect import Disc, Effect, Interval, Settings, Twist, drive_motion, size
from linkwright.core.arm.effects.loads.added_weights import bearing
from linkwright.core.arm.effects.traits import DriveTraits, PlayTraits, WatchTraits
from linkwright.core.sections.numeric import absolute


def _windup(joint: JointState, settings: Settings) -> Scalar:
    per_load = settings.values.get("windup_per_load", 0.0)
    grown = 0.0 if per_load == 0.0 else times(per_load, absolute(joint.drive_load))
    return plus(settings.values.get("windup", 0.0), grown)


def _any(settings: Settings) -> bool:
    return any(settings.values.get(name, 0.0) != 0.0 for name in ("windup", "windup_per_load"))


def _play(state: PoseState, settings: Settings) -> Iterator[Interval | Disc]:
    for index, joint in enumerate(bearing(state).joints):
        if _any(settings) and settings.acts_at(index):
            # Friction works against the last motion, whatever the load: nothing seats it.
            yield Interval(drive_motion(state, index, _windup(joint, settings)), 0.0)


def _seated(state: PoseState, settings: Settings) -> Iterator[Twist]:
    sides = state.conditions.sides
    if sides is None or not _any(settings):
        return
    for index, joint in enumerate(bearing(state).joints):
        if settings.acts_at(index):
            yield from drive_motion(state, index, times(-1.0, times(sides[index], _windup(joint, settings))))


FRICTION_WINDUP = Effect(
    id="friction_windup",
    title="wind-up of the drives by friction",
    formula="sum -J_i s_i (tau_c + mu |tau_i|)/K_i",
    place="joint",
    drive=DriveTraits(needed=True),
    cause="play and friction",
    needs="every pose from both sides, with two payloads",
    aliases=("backlash",),
    source="B. Armstrong-Helouvry, P. Dupont & C. Canudas de Wit, A survey of models, analysis tools and compensation "
    "methods for the control of machines with friction, Automatica 30 (1994) 1083-1138",
    parameters=(
        size("windup", "angle", 0.0, 0.1, (0.02e-3, 0.3e-3)).means(
            "Coulomb friction over the drive's stiffness, tau_c/K",
            "friction of a few per cent of the rated torque, on a drive that winds up 1 to 5 mrad at it",
        ),
        size("windup_per_load", "compliance", 0.0, 1e-2, (1e-8, 1e-5), optional=True).means(
            "share of the load that friction takes, over the drive's stiffness, mu/K",
            "a tenth of the drive's compliance",
        ),
    ),
    play=PlayTraits(free=_play, seated=_seated),
    watch=WatchTraits(lasts="a while"),
    rank=200,
    linear=True,
)
