"""How large causes are: their share of a joint's torque."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from benchmarks.blind.generator.vectors import Array
from benchmarks.motion.generator.arms import Arm
from benchmarks.motion.generator.causes import KINDS, inertia_at
from benchmarks.motion.generator.moved import Cause, Moved
from benchmarks.motion.generator.signals import low_passed, moving, rms

ENDS = 1.0  # s, at which an arm hardly moves
SHARES_COULOMB = frozenset({"friction_asymmetry", "friction_warmup", "friction_place"})
"""Their amount may be negative, and friction as a whole never is."""
ON_ALL_ROWS = frozenset({"friction_reversal", "friction_stribeck", "gear_ripple"})
"""What acts where a joint hardly moves, or faster than slow things; all else counts where the joint moves."""
SLOWEST = 5.0  # Hz, of an elastic joint


def draw_cause(arm: Arm, rng: np.random.Generator) -> Cause:
    """An effect at random, sizes of one."""
    names = list(KINDS)
    weights = np.array([KINDS[name].weight for name in names])
    name = str(rng.choice(names, p=weights / weights.sum()))
    return Cause(name, *KINDS[name].draw(arm, rng))


def torque_of(cause: Cause, moved: Moved) -> Array:
    """(N, n), what it takes of the drives."""
    columns = KINDS[cause.effect].columns(cause, moved)
    return sum(
        (size * column for size, column in zip(cause.sizes.values(), columns, strict=True)), np.zeros_like(moved.q)
    )


def shares(cause: Cause, moved: Sequence[Moved]) -> Array:
    """(n,), the RMS of its torque over the joint's torque: in the band of slow things, but for a ripple."""
    own, whole, good = [], [], []
    for item in moved:
        part = slice(round(ENDS * item.rate), -round(ENDS * item.rate))
        torque = torque_of(cause, item)
        own.append((torque if cause.effect == "gear_ripple" else low_passed(torque, item.rate))[part])
        whole.append(item.torque[part])
        good.append(np.stack([moving(v, item.rate) for v in item.velocity[part].T], axis=1))
    counts = np.concatenate(good) | (cause.effect in ON_ALL_ROWS)
    squares = (np.concatenate(own) ** 2 * counts).sum(axis=0) / np.maximum(counts.sum(axis=0), 1)
    return np.sqrt(squares) / rms(np.concatenate(whole))


def sized(cause: Cause, moved: Sequence[Moved], wanted: float) -> Cause:
    """So large that its share is as wanted, or as large as it may be."""
    unit = float(shares(cause, moved).max())
    factor = float(f"{min(wanted / max(unit, 1e-12), _most(cause, moved[0].arm)):.4g}")
    return replace(cause, sizes={name: value * factor for name, value in cause.sizes.items()}, share=factor * unit)


def _most(cause: Cause, arm: Arm) -> float:
    """The greatest factor of sizes of one."""
    if cause.effect in SHARES_COULOMB:
        return 0.8 * arm.drives[0, cause.joint]
    if cause.effect in ("friction_reversal", "friction_stribeck"):
        return arm.drives[0, cause.joint]
    if cause.effect == "friction_quadratic" and cause.sizes["coefficient"] < 0.0:
        return 0.8 * arm.drives[1, cause.joint] / arm.axes[cause.joint].speed
    if cause.effect == "joint_compliance":
        return 1.0 / (inertia_at(arm, cause.joint) * (2.0 * math.pi * SLOWEST) ** 2)
    return KINDS[cause.effect].most


def alike(one: Cause, two: Cause, moved: Sequence[Moved]) -> bool:
    """Whether one of two takes nearly a multiple of what the other does."""
    scale = rms(np.concatenate([item.torque for item in moved]))
    a, b = (np.concatenate([(torque_of(c, item) / scale).ravel() for item in moved]) for c in (one, two))
    return abs(float(a @ b)) > 0.7 * float(np.linalg.norm(a) * np.linalg.norm(b))
