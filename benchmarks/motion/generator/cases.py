"""Cases: an arm, its motions, what is concealed and how large, its logs and what an oracle reaches on them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq

from benchmarks.blind.generator.vectors import Array
from benchmarks.motion.generator.arms import FAMILIES, STEP, Arm, draw_arm, with_drives
from benchmarks.motion.generator.causes import KINDS
from benchmarks.motion.generator.logger import Logged, Logger, draw_logger, log_of
from benchmarks.motion.generator.moved import LARGE, Cause, Moved
from benchmarks.motion.generator.signals import low_passed, moving, rms
from benchmarks.motion.generator.sizes import alike, draw_cause, shares, sized
from benchmarks.motion.generator.trajectories import draw_reference
from benchmarks.motion.generator.unknowns import DEVELOPMENT, PROOF, About, Unknown, draw_unknown, install
from benchmarks.motion.generator.world import (
    Track,
    UnstableError,
    World,
    consistent_acceleration,
    declared_torque,
    simulate,
    world_of,
)

HALVES = ("development", "proof")
SMALL = (0.005, 0.03)
KINDS_OF_CASES = ("null", "one", "unknown", "one", "null", "two", "one", "null", "unknown", "one") * 2
"""In turn; the last of each twenty has an arm file that declares no friction at all."""
BEYOND = 0.05
"""The least share of an unknown that rigid bodies and the usual friction leave of it."""
HUGE = 1.0
"""The greatest size of an unknown, about its share of the torque before anything is fitted."""
MOST = 0.4
"""The greatest: beyond it anybody sees that something is wrong."""
SLOW = 5.0  # Hz, of what is compared with the whole library
COARSE = 10
"""Steps of the controller per row of what is computed beside the logs."""


class NoCaseError(ValueError):
    """Nothing fit for a case was drawn."""


@dataclass(frozen=True)
class Case:
    """All of a case; the last of the logs is held for testing."""

    name: str
    seed: tuple[int, int, int]
    half: str
    kind: str
    arm: Arm
    logger: Logger
    logs: tuple[Logged, ...]
    causes: tuple[Cause, ...]
    unknown: Unknown | None
    beyond: float
    torque_rms: Array
    noise_rms: Array
    oracle_rms: Array


def kind_of(index: int) -> tuple[str, str]:
    """A case's kind, and its arm's family."""
    families = tuple(FAMILIES)
    kind = "bare" if index % 20 == 19 else KINDS_OF_CASES[index % 20]
    return kind, families[(index + index // 20) % len(families)]


def make_case(name: str, seed: tuple[int, int, int], half: str, kind: str, family: str) -> Case:
    """A case from its seed alone. Raises NoCaseError."""
    rng = np.random.default_rng(seed)
    for _ in range(20):
        try:
            return _drawn(name, seed, half, kind, family, rng)
        except (UnstableError, NoCaseError):
            continue
    raise NoCaseError(f"{name}: no arm of twenty followed its reference with causes of the sizes wanted")


def _drawn(name: str, seed: tuple[int, int, int], half: str, kind: str, family: str, rng: np.random.Generator) -> Case:
    arm = draw_arm(family, rng)
    seconds = [float(x) for x in np.round(rng.uniform(20.0, 40.0, int(rng.integers(2, 4))))]
    references = [draw_reference(arm, second, rng) for second in (*seconds, 20.0)]
    arm = _with_drives(arm, [reference.every(COARSE) for reference in references], rng)
    references = [replace(reference, arm=arm) for reference in references]
    moved = [reference.every(COARSE) for reference in references]
    scale = rms(np.concatenate([item.torque for item in moved]))
    nominal, causes = (_bare(arm, moved)) if kind == "bare" else (arm, _draw_causes(kind, moved, rng))
    about = About(
        arm,
        scale,
        np.abs(np.concatenate([item.q for item in moved])).max(axis=0),
        np.abs(np.concatenate([item.velocity for item in moved])).max(axis=0),
        min(seconds),
    )
    unknown, beyond = None, 0.0
    if kind == "unknown":
        unknown, beyond = _sized_unknown(half, about, nominal, causes, references[0], rng)
    logger = draw_logger(arm, rng)
    stiffness = float(rng.uniform(20.0, 45.0))
    world = build(nominal, causes, unknown, about)
    tracks = [
        simulate(world, nominal, reference, declared_torque(nominal, reference), stiffness) for reference in references
    ]
    logs = tuple(log_of(logger, nominal, track, scale, world.delay, rng) for track in tracks)
    noise, oracle = _oracle(nominal, causes, tracks, logs, logger)
    return Case(name, seed, half, kind, nominal, logger, logs, causes, unknown, beyond, scale, noise, oracle)


def build(nominal: Arm, causes: Sequence[Cause], unknown: Unknown | None, about: About) -> World:
    """The world of a case."""
    world = world_of(nominal)
    for cause in causes:
        KINDS[cause.effect].install(cause, world)
    if unknown is not None:
        install(unknown, world, about)
    return world


def _with_drives(arm: Arm, moved: Sequence[Moved], rng: np.random.Generator) -> Arm:
    """Friction and rotor inertia as drives of this size have them."""
    names = ("rigid", "velocity", "acceleration")
    load, *ways = (rms(np.concatenate([getattr(item, name) for item in moved])) for name in names)
    least = load + 0.04 * float(load.max())
    shares_of = [rng.uniform(*ends, arm.count) for ends in ((0.08, 0.35), (0.05, 0.3), (0.02, 0.12))]
    return with_drives(arm, np.array(shares_of) * least / [np.ones(arm.count), *ways])


def _bare(arm: Arm, moved: Sequence[Moved]) -> tuple[Arm, tuple[Cause, ...]]:
    """The arm without its friction, which is what is concealed."""
    effects = (("friction_coulomb", "torque"), ("friction_viscous", "coefficient"), ("armature", "inertia"))
    results = [
        Cause(effect, (j + 1,), {size: float(arm.drives[row, j])})
        for j in range(arm.count)
        for row, (effect, size) in enumerate(effects)
    ]
    shown = tuple(replace(result, share=float(shares(result, moved).max())) for result in results)
    return with_drives(arm, np.zeros_like(arm.drives)), shown


def _draw_causes(kind: str, moved: Sequence[Moved], rng: np.random.Generator) -> tuple[Cause, ...]:
    """Large and small ones, no two of an effect at one place, the large ones not alike."""
    if kind == "null":
        return ()
    arm, result = moved[0].arm, list[Cause]()
    large = {"one": 1, "two": 2, "unknown": 0}[kind]
    count = large + int(rng.integers(2, 5))
    for _ in range(300):
        if len(result) == count:
            return tuple(result)
        cause = draw_cause(arm, rng)
        if any((cause.effect, cause.at) == (other.effect, other.at) for other in result):
            continue
        loud = len(result) < large
        low, high = (1.2 * LARGE, 0.35) if loud else SMALL
        cause = sized(cause, moved, math.exp(float(rng.uniform(math.log(low), math.log(high)))))
        if cause.share < (LARGE if loud else SMALL[0] / 2.0) or (loud and result and alike(cause, result[0], moved)):
            continue
        result.append(cause)
    raise NoCaseError(f"{arm.family}: no {count} causes of the sizes wanted")


# Unknowns


def _sized_unknown(
    half: str, about: About, nominal: Arm, causes: Sequence[Cause], reference: Moved, rng: np.random.Generator
) -> tuple[Unknown, float]:
    """A class of the half, so large that enough of it is left by what the library has. Raises UnstableError."""
    name = str(rng.choice(DEVELOPMENT if half == "development" else PROOF))
    size = float(rng.uniform(0.15, 0.3))
    unknown = draw_unknown(name, nominal, size, rng)
    forward = declared_torque(nominal, reference)
    for _ in range(6):
        track = simulate(build(nominal, causes, unknown, about), nominal, reference, forward)
        left = float(beyond_library(nominal, track, about.torque).max())
        if BEYOND <= left <= MOST:
            return unknown, left
        factor = min(max((BEYOND + MOST) / 3.0 / left, 0.3), 2.0)
        unknown = replace(unknown, size=unknown.size * factor)
        if unknown.size > HUGE:
            break
    raise UnstableError(f"{name}: little of it is left")


def beyond_library(nominal: Arm, track: Track, scale: Array) -> Array:
    """(n,), the share of each joint's torque that rigid bodies, friction and drives of any size leave."""
    moved = moved_of(nominal, track, COARSE)
    drive = low_passed(track.drive, 1.0 / STEP, SLOW)[::COARSE]
    rows, left = slice(25, -25), np.zeros(nominal.count)
    # Point masses at ten places span all that a body can be.
    places = np.random.default_rng(1).uniform(-0.5, 0.5, (10, 3))
    bodies = [moved.beyond(nominal.with_point(link, 1.0, at)) for link in range(nominal.count) for at in places]
    for j in range(nominal.count):
        columns = np.column_stack([*(body[:, j] for body in bodies), *_usual(moved, j)])
        columns = low_passed(columns, 1.0 / STEP / COARSE, SLOW)[rows]
        columns = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-12)
        own = drive[rows, j]
        # NumPy's driver, by divide and conquer, fails to converge on some columns that depend on each other.
        rest = own - columns @ lstsq(columns, own, cond=1e-8, lapack_driver="gelss")[0]
        left[j] = float(rms(rest)) / scale[j]
    return left


def _usual(moved: Moved, j: int) -> list[Array]:
    """Columns of what is usual at a joint, (N,) each."""
    s, v, q, tau = moved.sign[:, j], moved.velocity[:, j], moved.q[:, j], moved.torque[:, j]
    rate = np.gradient(tau, moved.time)
    neighbours = [moved.velocity[:, k] for k in (j - 1, j + 1) if 0 <= k < moved.arm.count]
    return [
        np.ones_like(q), s, v, v * np.abs(v), np.arctan(v / 0.3),
        *(s * np.exp(-np.abs(v) / x) for x in (0.03, 0.1, 0.3)),
        q, moved.acceleration[:, j], tau, s * np.abs(tau), s * np.sin(q), s * np.cos(q),
        *(s * (1.0 - np.exp(-moved.time / x)) for x in (10.0, 60.0)), rate, np.gradient(rate, moved.time), *neighbours,
    ]  # fmt: skip


def moved_of(nominal: Arm, track: Track, every: int) -> Moved:
    """What moved, at every so many steps."""
    part = slice(None, None, every)
    acceleration = low_passed(consistent_acceleration(track), 1.0 / STEP, 40.0)
    return Moved(nominal, track.time[part], track.q[part], track.velocity[part], acceleration[part])


def _oracle(
    nominal: Arm, causes: Sequence[Cause], tracks: Sequence[Track], logs: Sequence[Logged], logger: Logger
) -> tuple[Array, Array]:
    """(n,) twice, N*m: RMS of the test log that is left by the true causes at their true sizes, and by them fitted to
    the other logs by least squares; in the tool's band, where the joint moves."""
    rate = 1.0 / STEP / COARSE
    rows, sides = [], []
    for track, log in zip(tracks, logs, strict=True):
        moved = moved_of(nominal, track, COARSE)
        unit = np.ones(nominal.count) if logger.constants is None else np.array(logger.constants)
        torque = low_passed(_of_log(log, track.time + logger.lag, unit), 1.0 / STEP)[::COARSE]
        columns = [column for cause in causes for column in KINDS[cause.effect].columns(cause, moved)]
        part = slice(round(rate), -round(rate))
        model = low_passed(np.stack([*columns, moved.torque], axis=2), rate)
        rows.append(np.concatenate([model[..., :-1], torque[..., None] - model[..., -1:]], axis=2)[part])
        logged = _logged(log, moved.time)[part]
        sides.append(np.stack([moving(v, rate) & logged for v in moved.velocity[part].T], axis=1))
    count, n = rows[0].shape[2] - 1, nominal.count
    matrix, wanted = np.zeros((count, count)), np.zeros(count)
    scale = np.array([float(rms(np.concatenate(rows)[:, j, -1])) for j in range(n)])
    for block, good in zip(rows[:-1], sides[:-1], strict=True):
        for j in range(n):
            part = block[good[:, j], j] / scale[j]
            matrix += part[:, :-1].T @ part[:, :-1]
            wanted += part[:, :-1].T @ part[:, -1]
    fitted = np.linalg.lstsq(matrix, wanted, rcond=1e-10)[0]
    true = np.array([size for cause in causes for size in cause.sizes.values()])
    test, good = rows[-1], sides[-1]
    return tuple(  # pyright: ignore
        np.array([float(rms((test[:, j, -1] - test[:, j, :-1] @ sizes)[good[:, j]])) for j in range(n)])
        for sizes in (true, fitted)
    )


def _logged(log: Logged, time: Array) -> NDArray[np.bool_]:
    """(M,) where there is a reading, 0.3 s away from each gap."""
    gap = np.min(np.abs(time[:, None] - log.time[np.newaxis, :: max(1, len(log.time) // 2000)]), axis=1) > 0.04
    return np.convolve(gap, np.ones(2 * round(0.3 / STEP / COARSE) + 1), mode="same") < 0.5


def _of_log(log: Logged, time: Array, unit: Array) -> Array:
    """(M, n), the logged torque at even times, spikes cut."""
    torque = log.torque * unit
    middle = np.median(torque, axis=0)
    far = np.abs(torque - middle) > 12.0 * np.median(np.abs(torque - middle), axis=0)
    columns = [np.interp(time, log.time[~far[:, j]], torque[~far[:, j], j]) for j in range(torque.shape[1])]
    return np.stack(columns, axis=1)
