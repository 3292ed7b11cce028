"""The tip's error at a pose: every effect's twist, carried to the tip and added up; play kept apart as a set.

The deterministic part is one vector. Backlash adds intervals along motions, clearance adds discs; how they count is
the play mode's affair (`arm.errors.lost_motion`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, cast

from linkwright.core.arm.chain.chain import Arm, Zones
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import ZERO, Scalar, Vector, add, cross, dot, minus, plus, scale, times
from linkwright.core.arm.effects import EFFECTS, Disc, Effect, Interval, Settings, Twist


@dataclass(frozen=True)
class ActiveEffect:
    """An effect that is in an arm's model, with where it acts and its parameters."""

    effect: Effect
    settings: Settings


@dataclass(frozen=True)
class TipInterval:
    """Play that moves the tip by anything from -1 to 1 times `vector` (m); `seating` is the load that holds it."""

    effect: str
    joint: int
    vector: Vector
    seating: Scalar
    taken: bool = False
    """What a calibration took of it, where its load had seated it."""


@dataclass(frozen=True)
class TipDisc:
    """Play that moves the tip anywhere within a disc of `radius` (m) normal to `normal`."""

    effect: str
    joint: int
    radius: float
    normal: Vector
    seating: Vector
    taken: bool = False


@dataclass(frozen=True)
class TipKink:
    """A part of the deterministic vector that is piecewise linear in a load: what a drive of these `zones` winds up by
    under `load`, times `vector` (m/rad)."""

    vector: Vector
    load: Scalar
    zones: Zones


@dataclass(frozen=True)
class TipError:
    """The tip's error at a pose: the deterministic vector (m), with the kinks in it, and the play around it."""

    vector: Vector
    intervals: tuple[TipInterval, ...]
    discs: tuple[TipDisc, ...]
    kinks: tuple[TipKink, ...] = ()


def active_effects(arm: Arm) -> tuple[ActiveEffect, ...]:
    """The physics in an arm's model: all that it has data for less `leave_out`, plus its `effects`."""
    active = [
        ActiveEffect(effect, Settings())
        for effect in EFFECTS.values()
        if effect.automatic and effect.id not in arm.leave_out
    ]
    added = (ActiveEffect(EFFECTS[entry.effect], Settings.of(entry)) for entry in arm.effects)
    return (*active, *added)


def carried_to_tip(state: PoseState, twists: Iterable[Twist]) -> Vector:
    """The displacement of the tip (m) that small displacements and turns along the chain add up to."""
    return motions(state, twists)[-1][0]


def rotation_at_tip(state: PoseState, twists: Iterable[Twist]) -> Vector:
    """The rotation of the tip (rad) that small turns along the chain add up to."""
    return motions(state, twists)[-1][1]


def displacements(state: PoseState, twists: Iterable[Twist]) -> tuple[Vector, ...]:
    """The displacements (m) of the links' far ends, from the base out."""
    return tuple(shift for shift, _ in motions(state, twists)[:-1])


def motions(state: PoseState, twists: Iterable[Twist]) -> list[tuple[Vector, Vector]]:
    """Displacement (m) and rotation (rad) of the far end of each link, and last of the tip."""
    at_base: tuple[Vector, Vector] = (ZERO, ZERO)
    at_joint: list[tuple[Vector, Vector]] = [(ZERO, ZERO)] * len(state.joints)
    at_link: list[tuple[Vector, Vector]] = [(ZERO, ZERO)] * len(state.links)
    at_tip: tuple[Vector, Vector] = (ZERO, ZERO)
    for twist in on_the_way(state.arm, twists):
        if twist.node == "tip":
            at_tip = (add(at_tip[0], twist.translation), add(at_tip[1], twist.rotation))
            continue
        if twist.node == "base":
            at_base = (add(at_base[0], twist.translation), add(at_base[1], twist.rotation))
            continue
        where = at_joint if twist.node == "joint" else at_link
        translation, rotation = where[twist.index]
        where[twist.index] = (add(translation, twist.translation), add(rotation, twist.rotation))
    shift, turn = at_base
    walked: list[tuple[Vector, Vector]] = []
    for index, link in enumerate(state.links):
        shift = add(shift, cross(turn, state.leads[index]))
        at_this_joint, followed = at_joint[index], _followed(state, index, at_joint, at_link)
        translation, rotation = add(at_this_joint[0], followed[0]), add(at_this_joint[1], followed[1])
        shift, turn = add(shift, translation), add(turn, rotation)
        shift = add(shift, cross(turn, link.vector))
        translation, rotation = at_link[index]
        shift, turn = add(shift, translation), add(turn, rotation)
        walked.append((shift, turn))
    shift = add(shift, cross(turn, state.tool))
    walked.append((add(shift, at_tip[0]), add(turn, at_tip[1])))
    return walked


def on_the_way(arm: Arm, twists: Iterable[Twist]) -> Iterable[Twist]:
    """Twists of an arm's joints and links, but for those of branches that the tip is not of."""
    if not arm.branches:
        return twists
    return (_on_the_way(arm, twist) if twist.node in ("joint", "link") else twist for twist in twists)


def _on_the_way(arm: Arm, twist: Twist) -> Twist:
    here = minus(1.0, arm.away(twist.index))
    return Twist(twist.node, twist.index, scale(here, twist.translation), scale(here, twist.rotation))


def _followed(
    state: PoseState,
    index: int,
    at_joint: Sequence[tuple[Vector, Vector]],
    at_link: Sequence[tuple[Vector, Vector]],
) -> tuple[Vector, Vector]:
    """The shift and turn of a joint by what moves those that it follows beside their coordinates."""
    follows = state.arm.joints[index].follows
    if follows is None:
        return ZERO, ZERO
    axis, amount = state.joints[index].axis, cast(Scalar, 0.0)
    for tie in follows.ties:
        other, turns = state.joints[tie.joint], state.joints[tie.joint].revolute
        moved = at_joint[tie.joint][1 if turns else 0]
        if tie.along:
            for link in range(tie.joint, tie.joint + other.spans):
                moved = add(moved, at_link[link][1])
            for piece in range(tie.joint + 1, tie.joint + other.spans):
                moved = add(moved, at_joint[piece][1])
        amount = plus(amount, times(tie.weight, dot(other.axis, moved)))
    moved = scale(amount, axis)
    return (ZERO, moved) if state.joints[index].revolute else (moved, ZERO)


Counted = Literal["position", "orientation", "lost_motion"]
"""What is counted of the tip's error: its displacement (m), its rotation (rad), or the displacement (m) that play and
friction alone leave, which is what a pose is not repeated by (ISO 9283, 7.2.2)."""


def tip_error(state: PoseState, effects: Sequence[ActiveEffect], counted: Counted = "position") -> TipError:
    """The tip's error at a pose from the effects of a model; of `orientation` all vectors are rotations (rad), and
    there are no discs, as a pin that shifts in its bore turns nothing."""
    carried = rotation_at_tip if counted == "orientation" else carried_to_tip
    twists = [twist for active in effects for twist in active.effect.twists(state, active.settings)]
    intervals: list[TipInterval] = []
    discs: list[TipDisc] = []
    for active in effects:
        for play in active.effect.play.free(state, active.settings):
            if isinstance(play, Interval):
                vector = carried(state, play.twists)
                intervals.append(TipInterval(active.effect.id, play.twists[0].index, vector, play.seating))
            elif not state.arm.away_wholly(play.index):
                discs.append(_disc(active.effect.id, play))
    kinks = tuple(
        TipKink(carried(state, kink.twists), kink.load, kink.zones)
        for active in effects
        for kink in active.effect.play.kinks(state, active.settings)
    )
    error = TipError(carried(state, twists), tuple(intervals), tuple(discs), kinks)
    if counted == "orientation":
        return replace(error, discs=())
    return _lost_motion(error) if counted == "lost_motion" else error


def _lost_motion(error: TipError) -> TipError:
    """The part of an error that is another each time that the arm comes to a pose."""
    intervals = tuple(interval for interval in error.intervals if not EFFECTS[interval.effect].play.repeats)
    return TipError(ZERO, intervals, tuple(disc for disc in error.discs if not EFFECTS[disc.effect].play.repeats))


def _disc(effect: str, play: Disc) -> TipDisc:
    return TipDisc(effect, play.index, play.radius, play.normal, play.seating)
