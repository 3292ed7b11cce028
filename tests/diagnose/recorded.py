"""Recordings for the tests: tables of text made from plain kinematics, written to files and read back."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.sections.numeric import Array

LENGTHS = (0.4, 0.42, 0.3)


def planar_arm(lengths: tuple[float, ...] = LENGTHS) -> Arm:
    """An arm in the plane of rigid, weightless links."""
    return Arm(
        "test arm",
        tuple(Joint(range=(-2.0, 2.0)) for _ in lengths),
        tuple(Link(length, mass=0.0) for length in lengths),
    )


def planar_tip(q: Array, lengths: tuple[float, ...] = LENGTHS) -> Array:
    """Tips (N, 2), m, by the textbook: sums of cosines and sines."""
    angles = np.cumsum(q, axis=1)
    return np.stack([np.cos(angles) @ np.array(lengths), np.sin(angles) @ np.array(lengths)], axis=1)


def sagging_tip(q: Array, stiffness: float | Array, payload: Array) -> Array:
    """Tips (N, 2) of springs in the joints (N*m/rad) under a payload (N,), kg, that pulls against y: each joint turns
    by the moment about it over its stiffness until both agree."""
    turned = np.zeros_like(q)
    for _ in range(60):
        angles = np.cumsum(q + turned, axis=1)
        reach = np.cumsum((np.cos(angles) * LENGTHS)[:, ::-1], axis=1)[:, ::-1]
        turned = -9.81 * payload[:, None] * reach / stiffness
    return planar_tip(q + turned)


def poses(count: int, seed: int = 3, joints: int = 3) -> Array:
    return np.random.default_rng(seed).uniform(-1.5, 1.5, (count, joints))


def table(q: Array, tip: Array, **further: Array) -> dict[str, list[str]]:
    """Columns of text in deg and mm."""
    columns = {f"q{k + 1}_deg": [f"{math.degrees(x):.7f}" for x in q[:, k]] for k in range(q.shape[1])}
    columns |= {f"{'xyz'[k]}_mm": [f"{1e3 * x:.6f}" for x in tip[:, k]] for k in range(tip.shape[1])}
    return columns | {name: [f"{x:.6f}" for x in values] for name, values in further.items()}


def written(path: Path, columns: dict[str, list[str]], separator: str = ",") -> Path:
    rows = zip(*columns.values(), strict=True)
    lines = [separator.join(columns), *(separator.join(row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path
