"""What instruments read: the model at the poses and conditions of a recording, where play has come to lie somewhere.

The tip's position is the first channel. Others show more physics: an encoder on the joint's own side sees what the
drive does between motor and joint, a target on the base sees the base and the measuring frame move, and where commands
are logged beside encoders their difference shows what the servo lets go. A target that shows how the tool is turned
tells turns from shifts.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .effects import Effect, Settings, Twist
from .error import ActiveEffect, carried_to_tip, rotation_at_tip
from .finite import beyond_first_order
from .statics import PoseState
from .vectors import Scalar, Vector, add, cross, dot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Channels:
    """Displacements that instruments see at N readings, in m and rad.

    `tip` (N, 3); `joint_side` (N, n) how far each joint stands from its encoder's reading; `base` (N, 3) a target on
    the base; `command` (N, n) how far each encoder stands from its command; `turn` (N, 3) how the tool is turned, about
    the base's axes. All but the first are None where nobody asked.
    """

    tip: Array
    joint_side: Array | None = None
    base: Array | None = None
    command: Array | None = None
    turn: Array | None = None


@dataclass(frozen=True)
class Asked:
    """Which channels a recording has beside the tip's place. `base_target` is the target's position (m)."""

    rows: int
    joint_side: bool = False
    base_target: Vector | None = None
    command: bool = False
    turn: bool = False


def seen(state: PoseState, effect: Effect, settings: Settings, asked: Asked) -> Channels:
    """What one effect moves in every channel, at the readings of `state`."""
    twists = [*effect.twists(state, settings), *effect.seated(state, settings)]
    if effect.before_encoder and asked.command:
        # The encoder reads this motion, so a tip computed from its readings lacks nothing.
        nothing = np.zeros((asked.rows, 3))
        return Channels(
            nothing,
            _none(asked, asked.joint_side, len(state.joints)),
            _base((), asked),
            _drives(state, twists, asked),
            _none(asked, asked.turn, 3),
        )
    return Channels(
        _columns(carried_to_tip(state, twists), asked.rows),
        _drives(state, twists, asked) if asked.joint_side else None,
        _base(twists, asked),
        _none(asked, asked.command, len(state.joints)),
        _columns(rotation_at_tip(state, twists), asked.rows) if asked.turn else None,
    )


def seen_of_model(state: PoseState, effects: Sequence[ActiveEffect], asked: Asked) -> Channels:
    """What a whole model moves in every channel; the tip by finite motions where an arm's `effects` have such."""
    found = [seen(state, active.effect, active.settings, asked) for active in effects]
    size = len(state.joints)

    def total(parts: Iterable[Array | None], columns: int, wanted: bool) -> Array | None:
        return sum((part for part in parts if part is not None), np.zeros((asked.rows, columns))) if wanted else None

    further, turned = beyond(state, effects, asked)
    tip = sum((each.tip for each in found), further)
    turn = sum((each.turn for each in found if each.turn is not None), turned)
    return Channels(
        tip,
        total((each.joint_side for each in found), size, asked.joint_side),
        total((each.base for each in found), 3, asked.base_target is not None),
        total((each.command for each in found), size, asked.command),
        turn if asked.turn else None,
    )


def beyond(state: PoseState, effects: Sequence[ActiveEffect], asked: Asked) -> tuple[Array, Array]:
    """What the `effects` that an arm's file lists move and turn the tip by beyond first order, (N, 3), m and rad: a
    zero may be off by degrees. What the model has of itself is small."""
    listed = [a for a in effects if not a.effect.automatic and not (a.effect.before_encoder and asked.command)]
    twists = [
        twist
        for each in listed
        for twist in (*each.effect.twists(state, each.settings), *each.effect.seated(state, each.settings))
    ]
    nothing = np.zeros((asked.rows, 3))
    return beyond_first_order(state, twists, asked.rows) if twists else (nothing, nothing)


def _columns(vector: Sequence[Scalar], rows: int) -> Array:
    return np.stack([np.broadcast_to(np.asarray(part, dtype=float), (rows,)) for part in vector], axis=1)


def _none(asked: Asked, wanted: bool, columns: int) -> Array | None:
    return np.zeros((asked.rows, columns)) if wanted else None


def _drives(state: PoseState, twists: Iterable[Twist], asked: Asked) -> Array:
    """How far each joint moves along its own coordinate."""
    moved = np.zeros((asked.rows, len(state.joints)))
    for twist in twists:
        if twist.node == "joint":
            joint = state.joints[twist.index]
            along = dot(joint.axis, twist.rotation if joint.revolute else twist.translation)
            moved[:, twist.index] += np.broadcast_to(np.asarray(along, dtype=float), (asked.rows,))
    return moved


def _base(twists: Iterable[Twist], asked: Asked) -> Array | None:
    if asked.base_target is None:
        return None
    moved: Vector = (0.0, 0.0, 0.0)
    for twist in twists:
        if twist.node == "base":
            moved = add(moved, add(twist.translation, cross(twist.rotation, asked.base_target)))
    return _columns(moved, asked.rows)
