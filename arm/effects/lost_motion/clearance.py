"""A pin lies anywhere within its bore: a joint's axis can shift by the radial clearance."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from linkwright.core.arm.chain.statics import JointState, PoseState
from linkwright.core.arm.chain.vectors import dot, scale, subtract
from linkwright.core.arm.effects.effect import NO_LOAD, Disc, Effect, Interval, Settings, Twist, size
from linkwright.core.arm.effects.loads.added_weights import bearing
from linkwright.core.arm.effects.traits import DriveTraits, PlayTraits, WatchTraits


def _loose(state: PoseState, settings: Settings) -> list[tuple[int, JointState, float]]:
    """The joints that have clearance, with all that they bear, and its radius."""
    radii = [settings.values.get("radius", joint.clearance) for joint in state.joints]
    joints = [index for index, radius in enumerate(radii) if radius != 0.0 and settings.acts_at(index)]
    borne = bearing(state).joints if joints else ()
    return [(index, borne[index], radii[index]) for index in joints]


def _play(state: PoseState, settings: Settings) -> Iterator[Interval | Disc]:
    for index, joint, radius in _loose(state, settings):
        if state.planar and not joint.revolute:
            # In the plane a slide can only shift across itself, either way.
            across = (-joint.axis[1], joint.axis[0], 0.0)
            load = joint.force[0] * across[0] + joint.force[1] * across[1]
            yield Interval((Twist("joint", index, scale(radius, across)),), load)
        else:
            yield Disc(index, radius, joint.axis, joint.force)


def _seated(state: PoseState, settings: Settings) -> Iterator[Twist]:
    for index, joint, radius in _loose(state, settings):
        across = subtract(joint.force, scale(dot(joint.axis, joint.force), joint.axis))
        length = np.sqrt(dot(across, across))
        share = np.where(length > NO_LOAD, 1.0 / np.where(length > NO_LOAD, length, 1.0), 0.0)
        yield Twist("joint", index, translation=scale(radius * share, across))


CLEARANCE = Effect(
    id="clearance",
    title="clearance of the joints",
    formula="sum c_i R_i, R_i the direction of the load that joint i carries",
    place="joint",
    cause="play and friction",
    automatic=True,
    needs="a side force, or the arm mounted the other way up",
    aliases=("frame_misalignment",),
    source="O. Altuzarra, J. Aginaga, A. Hernandez & I. Zabalza, Workspace analysis of positioning discontinuities "
    "due to clearances in parallel manipulators, Mechanism and Machine Theory 46 (2011) 577-592: "
    "the load decides where a pin lies",
    parameters=(
        size("radius", "length", 0.0, 5e-3, (10e-6, 100e-6)).means(
            "how far the pin's centre can move from the bore's", "running fits of ISO 286-1 at joint diameters"
        ),
    ),
    play=PlayTraits(free=_play, seated=_seated),
    watch=WatchTraits(lasts="a while"),
    rank=160,
    linear=True,
    drive=DriveTraits(across=True),
)
