"""What the clock does to an arm: the air of a hall, links that follow it with a lag, creep under load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from benchmarks.blind.generator.vectors import Array


@dataclass(frozen=True)
class Air:
    """Air temperature over time, degC on an even, fine clock in s; linear between."""

    clock: Array
    temperature: Array

    def at(self, time: Array) -> Array:
        """Temperature at given times."""
        return np.interp(time, self.clock, self.temperature)


def draw_air(duration: float, swing: float, rng: np.random.Generator) -> Air:
    """A day's wave, a slow wander and a door that opens: about +-swing K about something near 20 degC."""
    clock = np.linspace(0.0, max(duration, 60.0), 1500)
    period = duration * float(rng.uniform(0.6, 1.6))
    wave = np.sin(2 * np.pi * (clock / period + float(rng.random())))
    wander = np.cumsum(rng.standard_normal(clock.size)) / np.sqrt(clock.size)
    opened = float(rng.uniform(0.2, 0.7)) * duration
    door = -np.exp(-np.clip(clock - opened, 0.0, None) / (0.15 * duration)) * (clock > opened)
    shape = wave + 0.5 * (wander - wander.mean()) + 0.5 * door
    mean = 20.0 + float(rng.uniform(-0.3, 0.6)) * swing
    return Air(clock, mean + swing * shape / max(1.0, float(np.abs(shape).max())))


def lagged(air: Air, lag: float, time: Array) -> Array:
    """Temperature of a body that follows the air by T' = (T_air - T)/lag, in equilibrium at the start.

    Exact for air that is linear between its clock's ticks; lag in s, 0 for none.
    """
    if lag <= 0.0:
        return air.at(time)
    step = float(air.clock[1] - air.clock[0])
    decay = float(np.exp(-step / lag))
    behind = np.diff(air.temperature) / step * lag  # how far a ramp's follower trails it
    feed = (air.temperature[1:] - behind) - decay * (air.temperature[:-1] - behind)
    body = lfilter([1.0], [1.0, -decay], np.concatenate([air.temperature[:1], feed]))
    return np.interp(time, air.clock, body)


def crept(time: Array, constant: float) -> Array:
    """Share of creep that has come, 1 - exp(-t/constant), t in s since loading began with the recording."""
    return 1.0 - np.exp(-(time - time[0]) / constant)
