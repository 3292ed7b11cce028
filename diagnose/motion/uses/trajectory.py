"""Exciting trajectories: finite Fourier series of the joints' coordinates within ranges, speeds and regions to avoid.

The series is that of J. Swevers, C. Ganseman, D. B. Tukel, J. De Schutter & H. Van Brussel, IEEE Trans. Robot. Autom.
13 (1997) 730, doi:10.1109/70.631234; a ramp at both ends lets the arm start and stop at rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from linkwright.core.arm.avoid.poses import NoRoom, Room
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.diagnose.reading.files import read_table
from linkwright.core.diagnose.reading.table import Layout
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

HARMONICS = 5
"""Of the whole motion's frequency; more shake what flexes, and tell little else."""
_MARGIN = 0.05
"""The share of a joint's range that is kept free at each end, and of its speed."""
_SPEED, _SLIDING = 1.0, 0.25
"""rad/s and m/s, where the arm file tells no greatest speed."""
_ACCELERATION = 3.0
"""Times the greatest speed in a second that a joint speeds up by at most."""
_RAMP = 0.1
"""The share of the motion in which it sets in, and in which it dies away."""
_SHRUNK, _TIMES = 0.8, 24
"""By how much a motion that meets a region is made smaller, and how often."""
_NEAREST, _ABOUT, _DRAWS = 40, 0.2, 40
"""Of so many poses next to the middle of the ranges that one is the centre about which, within that share of the
ranges, most of some draws are free."""
_LOOKED = 5.0
"""Hz at which it is looked whether a motion meets a region."""


@dataclass(frozen=True)
class Limits:
    """What a motion keeps to: `centre` (n,) about which the joints move, `reach` (n,) how far at most, `speed` and
    `acceleration` (n,) at most; rad and m."""

    centre: Array
    reach: Array
    speed: Array
    acceleration: Array


def limits_of(arm: Arm, room: Room, draw: np.random.Generator) -> Limits:
    """The limits of an arm's joints. Raises `NoRoom` where no pose is out of the regions to avoid."""
    low, high = (np.array([joint.range[end] for joint in arm.joints]) for end in (0, 1))
    centre = 0.5 * (low + high)
    if not room.everywhere:
        tried = np.vstack((centre, low + (high - low) * draw.uniform(0.1, 0.9, (400, arm.size))))
        free = tried[room.allows(arm, tried)]
        if not len(free):
            raise NoRoom("leaves no pose about which the arm could move")
        nearest = free[np.argsort((((free - centre) / (high - low)) ** 2).sum(axis=1))[:_NEAREST]]
        about = _ABOUT * (high - low) * draw.uniform(-1.0, 1.0, (_DRAWS, arm.size))
        centre = nearest[np.argmax([room.allows(arm, item + about).mean() for item in nearest])]
    reach = np.minimum(centre - low, high - centre) - _MARGIN * (high - low)
    usual = [_SPEED if joint.revolute else _SLIDING for joint in arm.joints]
    known = [joint.velocity or default for joint, default in zip(arm.joints, usual, strict=True)]
    speed = (1.0 - _MARGIN) * np.array(known)
    return Limits(centre, np.maximum(reach, 0.0), speed, _ACCELERATION * speed)


def moved(arm: Arm, coefficients: Array, limits: Limits, seconds: float, rate: float, room: Room) -> Motion:
    """The motion of a series, as large as the limits let it be.

    Args:
        arm: The arm that moves.
        coefficients: (n, HARMONICS, 2) of sine and cosine.
        limits: What it keeps to.
        seconds: How long.
        rate: Hz at which it is sampled.
        room: Where poses may put the arm.

    Raises:
        NoRoom: However small, it meets a region to avoid.
    """
    time = np.arange(round(seconds * rate) + 1) / rate
    q, velocity, acceleration = _series(coefficients, time, seconds)
    fine = [
        np.abs(item).max(axis=0) + 1e-12 for item in _series(coefficients, np.linspace(0.0, seconds, 2001), seconds)
    ]
    scale = np.minimum.reduce([limits.reach / fine[0], limits.speed / fine[1], limits.acceleration / fine[2]])
    step = max(1, round(rate / _LOOKED))
    for _ in range(_TIMES):
        if room.allows(arm, (limits.centre + scale * q)[::step]).all():
            break
        scale = _SHRUNK * scale
    else:
        raise NoRoom("leaves no room for the arm to move in")
    return Motion(arm, time, limits.centre + scale * q, scale * velocity, scale * acceleration)


def _series(coefficients: Array, time: Array, seconds: float) -> tuple[Array, Array, Array]:
    """Coordinates about the centre, speeds and accelerations (N, n) of a series before it is scaled."""
    order = np.arange(1, coefficients.shape[1] + 1)
    turn = 2.0 * np.pi * order / seconds
    angle = np.outer(time, turn)
    sine, cosine = coefficients[:, :, 0].T, coefficients[:, :, 1].T
    value = np.sin(angle) @ sine + np.cos(angle) @ cosine
    first = (turn * np.cos(angle)) @ sine - (turn * np.sin(angle)) @ cosine
    second = -(turn**2 * np.sin(angle)) @ sine - (turn**2 * np.cos(angle)) @ cosine
    ramp, slope, bend = (item[:, None] for item in _ramp(time, seconds))
    return (
        ramp * value,
        slope * value + ramp * first,
        bend * value + 2.0 * slope * first + ramp * second,
    )


def _ramp(time: Array, seconds: float) -> tuple[Array, Array, Array]:
    """What sets a motion in and lets it die away: from 0 to 1 and back, with its first two derivatives, continuous."""
    width = _RAMP * seconds
    from_end = np.minimum(time, seconds - time)
    x = np.clip(from_end / width, 0.0, 1.0)
    sign = np.where(time < 0.5 * seconds, 1.0, -1.0)
    value = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    slope = sign * 30.0 * x**2 * (1.0 - x) ** 2 / width
    bend = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / width**2
    return value, slope, bend


def random_series(arm: Arm, draw: np.random.Generator, count: int) -> Sequence[Array]:
    """Series drawn at random, (n, HARMONICS, 2) each."""
    falling = 1.0 / np.arange(1, HARMONICS + 1)[None, :, None] ** 0.5
    return [falling * draw.standard_normal((arm.size, HARMONICS, 2)) for _ in range(count)]


def motion_columns(motion: Motion) -> dict[str, Array]:
    """The columns of a motion's file: `t_s`, `q1_rad`, `dq1_radps`, `ddq1_radps2` ..., of slides in m."""
    columns = {"t_s": motion.time}
    for name, values, per in (("q", motion.q, ""), ("dq", motion.velocity, "ps"), ("ddq", motion.acceleration, "ps2")):
        for number, (joint, column) in enumerate(zip(motion.arm.joints, values.T, strict=True), start=1):
            columns[f"{name}{number}_{'rad' if joint.revolute else 'm'}{per}"] = column
    return columns


def read_motion(path: Path, arm: Arm) -> Motion:
    """The motion that a file holds, as `motion_columns` names it; speeds and accelerations that it lacks are
    differences of the coordinates. Raises `InputError`."""
    table = read_table(path, Layout())
    if "t_s" not in table.names:
        raise InputError(table.file, "t_s", "is missing; a motion has a clock (t_s) and q1_rad, q2_rad ...")
    time = table.numbers("t_s")
    if len(time) < 3 or not (np.diff(time) > 0.0).all():
        raise InputError(table.file, "t_s", "does not ascend; a motion has three instants or more, each later")

    def each(name: str, per: str) -> Array | None:
        units = ["rad" if joint.revolute else "m" for joint in arm.joints]
        names = [f"{name}{number}_{unit}{per}" for number, unit in enumerate(units, start=1)]
        lacking = [column for column in names if column not in table.names]
        if lacking and name == "q":
            raise InputError(table.file, lacking[0], f"is missing; {arm.name!r} has {arm.size} joints")
        return None if lacking else np.column_stack([table.numbers(column) for column in names])

    q, velocity, acceleration = each("q", ""), each("dq", "ps"), each("ddq", "ps2")
    assert q is not None
    if not np.isfinite(q).all():
        raise InputError(table.file, "q1_rad", "holds cells that are no numbers")
    velocity = np.gradient(q, time, axis=0) if velocity is None else velocity
    acceleration = np.gradient(velocity, time, axis=0) if acceleration is None else acceleration
    return Motion(arm, time, q, velocity, acceleration)
