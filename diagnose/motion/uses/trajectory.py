"""Exciting trajectories: finite Fourier series of the joints' coordinates within ranges, speeds and regions to avoid.

The series is that of J. Swevers, C. Ganseman, D. B. Tukel, J. De Schutter & H. Van Brussel, IEEE Trans. Robot. Autom.
13 (1997) 730, doi:10.1109/70.631234; a ramp at both ends lets the arm start and stop at rest.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from linkwright.core.arm.avoid.poses import NoRoom, Room
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.motion.dynamics import model_torque
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
    `acceleration` (n,) at most; rad and m. What the arm takes of a drive stays below `torque` (n,) N*m (N)."""

    centre: Array
    reach: Array
    speed: Array
    acceleration: Array
    torque: Array


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
    return Limits(centre, np.maximum(reach, 0.0), speed, _ACCELERATION * speed, np.full(arm.size, np.inf))


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
        InputError: However small, it takes more of a drive than that gives.
    """
    time = np.arange(round(seconds * rate) + 1) / rate
    q, velocity, acceleration = _series(coefficients, time, seconds)
    fine = [
        np.abs(item).max(axis=0) + 1e-12 for item in _series(coefficients, np.linspace(0.0, seconds, 2001), seconds)
    ]
    scale = np.minimum.reduce([limits.reach / fine[0], limits.speed / fine[1], limits.acceleration / fine[2]])
    step = max(1, round(rate / _LOOKED))
    limited, beyond = bool(np.isfinite(limits.torque).any()), np.zeros(arm.size, dtype=bool)
    for _ in range(_TIMES):
        motion = Motion(arm, time, limits.centre + scale * q, scale * velocity, scale * acceleration)
        taken = np.abs(model_torque(motion)).max(axis=0) if limited else np.zeros(arm.size)
        beyond = taken > (1.0 - _MARGIN) * limits.torque
        if not beyond.any() and room.allows(arm, motion.q[::step]).all():
            return motion
        scale = _SHRUNK * scale
    if beyond.any():
        joint = int(np.argmax(beyond)) + 1
        raise InputError("", "peak_torque", f"of joint {joint} is less than the arm takes of it about its middle pose")
    raise NoRoom("leaves no room for the arm to move in")


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
    """The columns of a motion's file: `time_s`, `q1_deg`, `qd1_deg_s`, `qdd1_deg_s2` ..., of slides in mm."""
    columns = {"time_s": motion.time}
    for each, values in (("q", motion.q), ("qd", motion.velocity), ("qdd", motion.acceleration)):
        for name, factor, column in zip(*_named(motion.arm, each), values.T, strict=True):
            columns[name] = column / factor
    return columns


def _named(arm: Arm, each: str, *, si: bool = False) -> tuple[list[str], list[float]]:
    """The columns of coordinates or their rates (`q`, `qd`, `qdd`), and how large their units are in SI."""
    names, factors = list[str](), list[float]()
    per = {"q": ("", ""), "qd": ("_s", "ps"), "qdd": ("_s2", "ps2")}[each]
    for number, joint in enumerate(arm.joints, start=1):
        small, large = ("deg", "rad") if joint.revolute else ("mm", "m")
        names.append(f"{each.lstrip('q')}q{number}_{large}{per[1]}" if si else f"{each}{number}_{small}{per[0]}")
        factors.append(1.0 if si else math.radians(1.0) if joint.revolute else 1e-3)
    return names, factors


def read_motion(path: Path, arm: Arm) -> Motion:
    """The motion that a file holds, as `motion_columns` names it, or in SI (`t_s`, `q1_rad`, `dq1_radps`,
    `ddq1_radps2`, of slides in m); speeds and accelerations that it lacks are differences of the coordinates. Raises
    `InputError`."""
    table = read_table(path, Layout())
    clock = next((name for name in ("time_s", "t_s") if name in table.names), None)
    if clock is None:
        raise InputError(table.file, "time_s", "is missing; a motion has a clock (time_s) and q1_deg, q2_deg ...")
    time = table.numbers(clock)
    if len(time) < 3 or not (np.diff(time) > 0.0).all():
        raise InputError(table.file, clock, "does not ascend; a motion has three instants or more, each later")

    def each(name: str) -> Array | None:
        names, factors = _named(arm, name)
        if names[0] not in table.names:
            names, factors = _named(arm, name, si=True)
        lacking = [column for column in names if column not in table.names]
        if lacking and name == "q":
            raise InputError(table.file, lacking[0], f"is missing; {arm.name!r} has {arm.size} joints")
        return None if lacking else np.column_stack([table.numbers(column) for column in names]) * np.array(factors)

    q, velocity, acceleration = each("q"), each("qd"), each("qdd")
    assert q is not None
    if not np.isfinite(q).all():
        raise InputError(table.file, "q1_deg", "holds cells that are no numbers")
    velocity = np.gradient(q, time, axis=0) if velocity is None else velocity
    acceleration = np.gradient(velocity, time, axis=0) if acceleration is None else acceleration
    return Motion(arm, time, q, velocity, acceleration)
