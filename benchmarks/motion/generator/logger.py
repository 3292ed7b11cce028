"""What drives and a logger make of a motion: noise with a memory, filters, quanta, uneven clocks, speeds by difference.

All channels of a log pass the same filter, so that none lags the others by it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, lfilter, lfiltic, sosfilt, sosfilt_zi

from benchmarks.blind.generator.vectors import Array
from benchmarks.motion.generator.arms import STEP, Arm
from benchmarks.motion.generator.world import Track

SPEEDS = ("logged", "differentiated", "none")


@dataclass(frozen=True)
class Logger:
    """How a case is logged; noise is in shares of each joint's RMS torque."""

    rate: float  # Hz
    cutoff: float  # Hz, of the logger's filter of second order; 0: none
    white: float
    slow: float
    memory: float  # s, of the slow noise
    quantum: float
    ripple: float
    counts: int  # of an encoder's turn
    jitter: float  # of the sampling interval
    speeds: str
    digits: int
    constants: tuple[float, ...] | None  # N*m/A; None: torque is logged
    vices: tuple[str, ...]

    @property
    def lag(self) -> float:
        """s, by which its filter is late with slow things."""
        return math.sqrt(2.0) / (2.0 * math.pi * self.cutoff) if self.cutoff else 0.0


def draw_logger(arm: Arm, rng: np.random.Generator) -> Logger:
    """One of the loggers that people have."""

    def between(low: float, high: float) -> float:
        return float(math.exp(rng.uniform(math.log(low), math.log(high))))

    vices = tuple(name for name, share in (("gap", 0.1), ("duplicates", 0.1), ("spikes", 0.1)) if rng.random() < share)
    return Logger(
        rate=float(rng.choice([100.0, 125.0, 200.0, 250.0, 500.0])),
        cutoff=float(rng.choice([0.0, 0.0, between(20.0, 100.0)])),
        white=between(0.005, 0.04),
        slow=between(0.002, 0.012),
        memory=between(0.02, 0.3),
        quantum=between(0.0005, 0.01),
        ripple=between(0.001, 0.01),
        counts=int(rng.choice([2**17, 2**18, 2**20, 62832])),
        jitter=float(rng.choice([0.0, 0.0, 0.02, 0.15])),
        speeds=str(rng.choice(SPEEDS, p=[0.5, 0.25, 0.25])),
        digits=int(rng.choice([4, 6])),
        constants=tuple(float(f"{x:.4g}") for x in rng.uniform(3.0, 15.0, arm.count)) if rng.random() < 0.4 else None,
        vices=vices,
    )


@dataclass(frozen=True)
class Logged:
    """A log: (N,) stamps and (N, n) readings; `velocity` is None where it was not logged; torque, or current (A)."""

    time: Array
    q: Array
    velocity: Array | None
    torque: Array


def log_of(logger: Logger, arm: Arm, track: Track, scale: Array, delay: Array, rng: np.random.Generator) -> Logged:
    """The log of a track; `scale` (n,) are the joints' RMS torques, `delay` (n,) s by which torques come late."""
    n, count = arm.count, len(track.time)
    step = np.array([2.0 * math.pi / logger.counts if not axis.slide else 1e-6 for axis in arm.axes])
    q = np.round(track.q / step) * step
    rotor = np.array([20000.0 if axis.slide else float(rng.integers(1200, 3000)) for axis in arm.axes])
    drive = np.stack([np.interp(track.time - delay[j], track.time, track.drive[:, j]) for j in range(n)], axis=1)
    white = rng.normal(size=(count, n)) * logger.white * math.sqrt(1.0 / STEP / logger.rate)
    kept = math.exp(-STEP / logger.memory)
    slow = lfilter(
        [math.sqrt(1.0 - kept**2)], [1.0, -kept], rng.normal(size=(count, n)), axis=0, zi=_started(kept, n, rng)
    )[0]
    noise = white + logger.slow * slow + logger.ripple * np.sin(rotor * track.q + rng.uniform(0.0, 6.0, n))
    quantum = np.maximum(logger.quantum * scale, 1e-9)
    torque = np.round((drive + noise * scale) / quantum) * quantum
    velocity = track.velocity
    if logger.cutoff > 0.0:
        sos = butter(2, logger.cutoff, fs=1.0 / STEP, output="sos")
        zi = sosfilt_zi(sos)[:, :, None]
        q, velocity, torque = (sosfilt(sos, x, axis=0, zi=zi * x[:1])[0] for x in (q, velocity, torque))
    else:
        # A drive's own means of the torque and of nothing else, shorter than what delays are.
        torque = _mean_of(torque, max(1, round(0.5 / logger.rate / STEP)))
    return _sampled(logger, track.time, q, velocity, torque, scale, rng)


def _started(kept: float, n: int, rng: np.random.Generator) -> Array:
    return np.stack([lfiltic([1.0], [1.0, -kept], [x]) for x in rng.normal(size=n)], axis=1)


def _mean_of(values: Array, width: int) -> Array:
    """Means over a window about each step."""
    width += 1 - width % 2
    padded = np.pad(values, ((width // 2, width // 2), (0, 0)), mode="edge")
    sums = np.cumsum(np.pad(padded, ((1, 0), (0, 0))), axis=0)
    return (sums[width:] - sums[:-width]) / width


def _sampled(
    logger: Logger, time: Array, q: Array, velocity: Array, torque: Array, scale: Array, rng: np.random.Generator
) -> Logged:
    interval = 1.0 / logger.rate
    stamps = np.arange(0.0, time[-1], interval)
    stamps = np.clip(stamps + rng.uniform(-0.5, 0.5, len(stamps)) * logger.jitter * interval, 0.0, time[-1])
    if "gap" in logger.vices:
        at = float(rng.uniform(0.3, 0.7)) * time[-1]
        stamps = stamps[(stamps < at) | (stamps > at + float(rng.uniform(0.2, 1.0)))]
    q, velocity, torque = (
        np.stack([np.interp(stamps, time, item[:, j]) for j in range(q.shape[1])], axis=1)
        for item in (q, velocity, torque)
    )
    speeds: Array | None = velocity
    if logger.speeds == "differentiated":
        speeds = np.gradient(q, stamps, axis=0)
    elif logger.speeds == "none":
        speeds = None
    if "spikes" in logger.vices:
        for row in rng.integers(0, len(stamps), 4):
            torque[row, rng.integers(0, q.shape[1])] += float(rng.choice([-1.0, 1.0])) * 15.0 * float(scale.max())
    if logger.constants is not None:
        torque = torque / np.array(logger.constants)
    if "duplicates" in logger.vices:
        rows = np.sort(np.concatenate([np.arange(len(stamps)), rng.integers(0, len(stamps), 5)]))
        stamps, q, torque = stamps[rows], q[rows], torque[rows]
        speeds = None if speeds is None else speeds[rows]
    return Logged(stamps, q, speeds, torque)
