"""What instruments read: the model at the poses and conditions of a recording, where play has come to lie somewhere.

The tip's position is the first channel. Others show more physics: an encoder on the joint's side sees what the
drive does between motor and joint, a target on the base sees the base and the measuring frame move, and where commands
are logged beside encoders their difference shows what the servo lets go. A target that shows how the tool is turned
tells turns from shifts, and a level on the base or a link what turns that against the plumb line.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.arrays import columns
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Vector, add, cross, dot
from linkwright.core.arm.effects import Effect, Settings, Twist

from .exact import Deformed, deformed
from .tip import ActiveEffect, motions

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Channels:
    """Displacements that instruments see at N readings, in m and rad.

    `tip` (N, 3); `joint_side` (N, n) how far each joint stands from its encoder's reading; `base` (N, 3) a target on
    the base; `command` (N, n) how far each encoder stands from its command; `turn` (N, 3) how the tool is turned, about
    the base's axes; `level` (N, 3) the same of what a level stands on, zero where none does. All but the first are
    None where nobody asked.
    """

    tip: Array
    joint_side: Array | None = None
    base: Array | None = None
    command: Array | None = None
    turn: Array | None = None
    level: Array | None = None


@dataclass(frozen=True)
class Asked:
    """Which channels a recording has beside the tip's place. `base_target` is the target's position (m), `levels` (N,)
    on which link, from 1, a level stands at each reading: 0 on the base, -1 there is none."""

    rows: int
    joint_side: bool = False
    base_target: Vector | None = None
    command: bool = False
    turn: bool = False
    levels: NDArray[np.int64] | None = None


def seen(state: PoseState, effect: Effect, settings: Settings, asked: Asked) -> Channels:
    """What one effect moves in every channel, at the readings of `state`."""
    twists = [*effect.twists(state, settings), *effect.play.seated(state, settings)]
    if effect.drive.before_encoder and asked.command:
        # The encoder reads this motion, so a tip computed from its readings lacks nothing.
        return replace(seen_of_links(state, (), asked), command=_drives(state, twists, asked))
    result, level = seen_of_links(state, twists, asked), None
    if result.level is not None and asked.levels is not None:
        # What an instrument of the tip is off by turns no level; a base that does not stand plumb turns everything.
        of_tip = effect.recording.of_instrument and effect.place in ("base", "tip")
        plumb = columns(effect.recording.against_plumb(settings), asked.rows)
        level = result.level * (not of_tip) + np.where((asked.levels >= 0)[:, None], plumb, 0.0)
    joint_side = _drives(state, twists, asked) if asked.joint_side else None
    return replace(result, joint_side=joint_side, base=_base(twists, asked), level=level)


def seen_by_drives(state: PoseState, effect: Effect, settings: Settings, loads: Array) -> Array:
    """How far each joint (N, n) stands from its motor's encoder by an effect of drives, under loads (N, n), N*m (N),
    that push towards increasing coordinates, in place of those of a pose `state`."""
    pairs = zip(state.joints, loads.T, strict=True)
    loaded = tuple(replace(joint, drive_load=load, whole_load=1.0) for joint, load in pairs)
    asked = Asked(len(loads), joint_side=True)
    twists = [
        *effect.twists(replace(state, joints=loaded), settings),
        *effect.play.seated(replace(state, joints=loaded), settings),
    ]
    return _drives(state, twists, asked)


def seen_of_links(state: PoseState, twists: Sequence[Twist], asked: Asked) -> Channels:
    """What twists of the arm's body (how its parts are put together) move in every channel: no drive, no command and no
    base knows of them."""
    shift, turn = motions(state, twists)[-1]
    return Channels(
        columns(shift, asked.rows),
        _none(asked, asked.joint_side, len(state.joints)),
        _base((), asked),
        _none(asked, asked.command, len(state.joints)),
        columns(turn, asked.rows) if asked.turn else None,
        None if asked.levels is None else turned_levels(state, twists, asked.levels),
    )


def turned_levels(state: PoseState, twists: Sequence[Twist], levels: NDArray[np.int64]) -> Array:
    """How small turns along the chain turn what levels stand on (N, 3), rad: the far end of the links (from 1) that
    `levels` (N,) names, the base for 0, nothing for -1."""
    rows = len(levels)
    levels_turned = np.zeros((rows, 3))
    base = [twist.rotation for twist in twists if twist.node == "base"]
    walked = motions(state, twists)
    for link in np.unique(levels[levels >= 0]).tolist():
        turns = base if link == 0 else [walked[link - 1][1]]
        turned = sum((columns(turn, rows) for turn in turns), np.zeros((rows, 3)))
        levels_turned = np.where((levels == link)[:, None], turned, levels_turned)
    return levels_turned


def levels_of(shape: Deformed, effects: Sequence[ActiveEffect], asked: Asked) -> Array:
    """How a whole model turns what levels stand on (N, 3), rad, about the base's axes, from where the links would stand
    undeformed."""
    levels = asked.levels
    assert levels is not None
    turns = np.zeros((asked.rows, 3))
    plumb = sum(
        (columns(effect.effect.recording.against_plumb(effect.settings), 1) for effect in effects), np.zeros((1, 3))
    )
    for link in np.unique(levels[levels >= 0]).tolist():
        turned = Rotation.from_rotvec(plumb) * Rotation.from_matrix(shape.turned[link])
        turns = np.where((levels == link)[:, None], turned.as_rotvec(), turns)
    return turns


def seen_of_model(state: PoseState, effects: Sequence[ActiveEffect], asked: Asked) -> Channels:
    """What a whole model moves in every channel, by finite motions and loads on the deformed shape
    (`arm.errors.exact`). `state` is the arm at the undeformed pose."""
    return on_shape(shape_of(state, effects, asked), effects, asked)


def shape_of(state: PoseState, effects: Sequence[ActiveEffect], asked: Asked) -> Deformed:
    """The arm as it stands at the readings; what an encoder sees of its drives is in the coordinates already."""
    moving = [effect for effect in effects if not (effect.effect.drive.before_encoder and asked.command)]
    return deformed(state, moving, asked.rows)


def on_shape(shape: Deformed, effects: Sequence[ActiveEffect], asked: Asked) -> Channels:
    """What a whole model moves in every channel, once the shape that it gives the arm is known."""
    size = len(shape.state.joints)
    further = asked.joint_side or asked.base_target is not None or asked.command
    displacements = [seen(shape.state, active.effect, active.settings, asked) for active in effects] if further else []

    def total(parts: Iterable[Array | None], columns: int, wanted: bool) -> Array | None:
        return sum((part for part in parts if part is not None), np.zeros((asked.rows, columns))) if wanted else None

    return Channels(
        shape.tip,
        total((displacement.joint_side for displacement in displacements), size, asked.joint_side),
        total((displacement.base for displacement in displacements), 3, asked.base_target is not None),
        total((displacement.command for displacement in displacements), size, asked.command),
        shape.turn if asked.turn else None,
        None if asked.levels is None else levels_of(shape, effects, asked),
    )


def _none(channels: Asked, wanted: bool, columns: int) -> Array | None:
    return np.zeros((channels.rows, columns)) if wanted else None


def _drives(state: PoseState, twists: Iterable[Twist], channels: Asked) -> Array:
    """How far each joint moves along its coordinate."""
    moved = np.zeros((channels.rows, len(state.joints)))
    for twist in twists:
        if twist.node == "joint":
            joint = state.joints[twist.index]
            along = dot(joint.axis, twist.rotation if joint.revolute else twist.translation)
            moved[:, twist.index] += np.broadcast_to(np.asarray(along, dtype=float), (channels.rows,))
    return moved


def _base(twists: Iterable[Twist], channels: Asked) -> Array | None:
    if channels.base_target is None:
        return None
    moved: Vector = (0.0, 0.0, 0.0)
    for twist in twists:
        if twist.node == "base":
            moved = add(moved, add(twist.translation, cross(twist.rotation, channels.base_target)))
    return columns(moved, channels.rows)
