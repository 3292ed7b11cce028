"""Visits that may be chosen: poses within the joint ranges that keep to their room, each payload, sides of approach."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.avoid.poses import NoRoom, Room, approach, drawn
from linkwright.core.arm.chain.arrays import nominal
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.following import completed
from linkwright.core.diagnose.instruments.touching import touched
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .plan_request import Asked

_CORNERS = 64
"""Poses at the ends of the joint ranges, beside those spread over them."""


_WRITTEN_ANGLE, _WRITTEN_LENGTH = math.radians(1e-3), 1e-6
_TOUCHES = 6
"""Visits for each point or place of a bar that is touched again, and half as many as for each plane."""


class TooFewPostures(Exception):
    """There are not so many postures from which points or planes can be touched again."""


@dataclass(frozen=True)
class Tried:
    """V visits: joint coordinates `q` (V, n), `sides` (V, n) of +1 and -1, `payload` (V,) kg. `random` (V,) marks those
    at poses spread over the ranges, the others being corners. `label` (V,) numbers the point, plane or bar that is
    touched, None where nothing is, and `along` (V,) is where along its bar, m, None without bars."""

    q: Array
    sides: Array
    payload: Array
    random: NDArray[np.bool_]
    label: NDArray[np.int64] | None = None
    along: Array | None = None

    @property
    def size(self) -> int:
        """How many there are."""
        return len(self.q)


def tried_visits(arm: Arm, asked: Asked) -> Tried:
    """Poses spread over the joint ranges (a Sobol sequence) and at their corners, each under every payload and from two
    opposite sides, each joint's drawn by itself.

    Raises `NoRoom` where that leaves fewer poses than are asked for, `TooFewPostures` for what touches.
    """
    rules, rng = asked.rules.plan, np.random.default_rng(asked.seed)
    low = np.array([joint.range[0] for joint in arm.joints])
    high = np.array([joint.range[1] for joint in arm.joints])
    from scipy.stats import qmc  # here, for it loads all of scipy's statistics, and few diagnoses try poses

    run = approach(arm)
    low, high = asked.room.of_box(low + run, high - run)
    sobol = qmc.Sobol(arm.size, scramble=True, rng=rng)
    count = 2 ** math.ceil(math.log2(rules.tried))
    poses = drawn(
        asked.room,
        (low, high),
        lambda least, most: least + (most - least) * sobol.random(count),
        lambda q: _clear(arm, q, run, asked.room),
        rules.tried,
    )
    spread = len(poses)
    moving = np.flatnonzero(high > low)
    ends = itertools.islice(itertools.product((0.0, 1.0), repeat=len(moving)), 2 * _CORNERS * len(moving) + 2)
    corners = np.array(list(ends)).reshape(-1, len(moving))
    corners = corners[rng.permutation(len(corners))[:_CORNERS]]
    at_ends = np.tile(0.5 * (low + high), (len(corners), 1))
    at_ends[:, moving] = low[moving] + (high - low)[moving] * corners
    ends_clear = _clear(arm, at_ends, run, asked.room)
    q = np.concatenate([poses, ends_clear])
    random, label, along = np.arange(len(q)) < spread, np.zeros(len(q), dtype=np.int64), np.zeros(len(q))
    if asked.touches and len(q):
        q, random, label, along = _touching(arm, q, random, run, asked)
        if len(q) < asked.poses:
            within = f"in {len(q)} postures only of {asked.poses} asked for{_opened(asked)}"
            raise TooFewPostures(f"touches something again {within}")
    if len(q) < asked.poses:
        reason = "what is to be avoided leaves" if asked.room.within is None else "where the arm was recorded there are"
        raise NoRoom(f"{reason} {len(q)} poses of the {asked.poses} asked for, of many tried")
    sides = rng.choice([-1.0, 1.0], (len(q), arm.size))
    by_payload = [
        (q, sign * sides, np.full(len(q), payload), random, label, along)
        for payload in asked.payloads
        for sign in (1.0, -1.0)
    ]
    parts = [np.concatenate(part) for part in zip(*by_payload, strict=True)]
    touched_there = parts[4].astype(np.int64) if asked.touches else None
    return Tried(parts[0], parts[1], parts[2], parts[3].astype(bool), touched_there, parts[5] if asked.bar else None)


def _touching(
    arm: Arm, q: Array, random: NDArray[np.bool_], run: Array, request: Asked
) -> tuple[Array, NDArray[np.bool_], NDArray[np.int64], Array]:
    """Postures near some poses (P, n) in which the arm touches one of some points, planes or bars again, which of them
    are near poses spread over the ranges, what each touches (from 0) and how far along its bar, m."""
    ends = request.room.of_box(*np.array([joint.range for joint in arm.joints]).T)
    joints = zip(arm.joints, *(end.tolist() for end in ends), strict=True)
    there = replace(arm, joints=tuple(replace(joint, range=(least, most)) for joint, least, most in joints))
    planes = request.instrument == "plane"
    least = (2 if planes else 1) * _TOUCHES
    count = request.bars or max(1, request.poses // least)
    try:
        touches = touched(
        there, q, np.arange(len(q)), np.zeros((len(q), 3)), lambda at: nominal(arm, at, 3)[0],
        np.random.default_rng(request.seed), planes=planes, bar=request.bar, count=count, reached=True,
    )  # fmt: skip
    except InputError:
        raise TooFewPostures(
            f"touches nothing again within the joint ranges{'; a shorter one may do' if request.bar else ''}"
            + _opened(request)
        ) from None
    clear = touches.keep & _may_be_come_to(touches.q, run, arm, request)
    whole = _clear(arm, touches.q[clear], run, Room())
    return whole, random[clear], touches.label[clear], touches.along[clear]


def _opened(request: Asked) -> str:
    """How there is more room, where poses keep to what was recorded."""
    return "" if request.room.within is None else "; with regions to `avoid` the whole of the joint ranges is open"


def _may_be_come_to(q: Array, run: Array, arm: Arm, request: Asked) -> NDArray[np.bool_]:
    """Which poses keep to their room and can be come to from both sides."""
    low, high = (np.array([joint.range[end] for joint in arm.joints]) for end in (0, 1))
    low, high = request.room.of_box(low + run, high - run)
    inside = np.asarray(((q >= low - 1e-9) & (q <= high + 1e-9)).all(axis=1), dtype=np.bool_)
    for sign in () if request.room.everywhere else (0.0, 1.0, -1.0):
        inside &= request.room.allows(arm, completed(arm, q + sign * run))
    return inside


def _clear(arm: Arm, q: Array, run: Array, room: Room) -> Array:
    """Whole poses (P, n) as they are written, without those where the arm, there or where it is come from, leaves its
    room."""
    step = np.array([_WRITTEN_ANGLE if joint.revolute else _WRITTEN_LENGTH for joint in arm.joints])
    whole = completed(arm, np.round(q / step) * step)
    return room.kept(arm, whole, run)
