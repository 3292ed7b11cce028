"""A motion log smoothed for a comparison with the arm's torques: coordinates and torques alike."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from linkwright.core.arm.effects.torques import direction as directions
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.rules.log_rules import LogRules
from linkwright.core.sections.numeric import Array


class Smoothed(NamedTuple):
    """Coordinates (rad; m of slides), speeds (rad/s), accelerations (rad/s^2), directions of motion (-1 to 1) and
    torques (N*m; N) of a log, each (N, n)."""

    q: Array
    velocity: Array
    acceleration: Array
    direction: Array
    torque: Array


def smoothed(log: MotionLog, rules: LogRules) -> tuple[Smoothed, NDArray[np.int64]]:
    """A log by moving averages over `convention_window`, and the samples (M,) whose averages hold no gap.

    Torques are averaged as often as the coordinates that accelerations come from: one filter on one side alone would
    take what accelerates off it. Where samples are further apart than the window, they stay as logged, at rest, and
    all count; so they do where no sample is clear of gaps.
    """
    steps = np.diff(log.time)
    interval = float(np.median(steps))
    torque, every = np.nan_to_num(bridged(log.torque, log.time)[0]), np.arange(log.size)
    if interval > rules.convention_window:
        still = np.zeros(log.q.shape)
        velocity = still if log.velocity is None else log.velocity
        return Smoothed(log.q, velocity, still, directions(velocity), torque), every
    width = max(1, round(rules.convention_window / interval))
    # Speeds are averaged before they are differentiated, angles before that where no speeds were logged.
    times = 2 if log.velocity is None else 1
    velocity = log.velocity
    if velocity is None:
        velocity = np.gradient(moving_average(log.q, width), log.time, axis=0)
    direction = moving_average(directions(velocity), width, times)
    velocity = moving_average(velocity, width)
    acceleration = np.gradient(velocity, log.time, axis=0)
    q, torque = (moving_average(each, width, times) for each in (log.q, torque))
    gaps = np.append(steps > rules.gap * interval, False).astype(np.int8)
    clear = np.flatnonzero(maximum_filter1d(gaps, 4 * width + 1, mode="constant") == 0)
    return Smoothed(q, velocity, acceleration, direction, torque), clear if len(clear) else every


def bridged(torque: Array, time: Array) -> tuple[Array, Array]:
    """Torques (N, n) with single samples that are not known (nan) put between those beside them, and which these are
    (1, else 0); a drive of which none is known stays so."""
    unknown = ~np.isfinite(torque) & np.isfinite(torque).any(axis=0)
    torque = torque.copy()
    for joint in np.flatnonzero(unknown.any(axis=0)).tolist():
        bad = unknown[:, joint]
        torque[bad, joint] = np.interp(time[bad], time[~bad], torque[~bad, joint])
    return torque, unknown.astype(float)


def moving_average(values: Array, width: int, times: int = 1) -> Array:
    """Means of values (N, ...) over `width` samples about each, so many times over."""
    for _ in range(times):
        values = uniform_filter1d(values, width, axis=0, mode="nearest")
    return values
