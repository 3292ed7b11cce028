"""Recordings of one arm on several days, by the textbook: tips from sums of cosines, a drive that winds up under the
weight at the tip by the torque that this has about its joint; mounted anew each day."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.recording import Recording
from linkwright.core.sections.numeric import Array
from tests.diagnose.recorded import LENGTHS, planar_arm, planar_tip

SIGMA = 15e-6
_G = 9.81


def arm() -> Arm:
    return replace(planar_arm(), gravity=(0.0, -_G, 0.0))


def day(
    seed: int,
    *,
    poses: int = 16,
    payloads: Sequence[float] = (0.0, 8.0),
    compliance: Mapping[int, float] | None = None,
    zeros: Mapping[int, float] | None = None,
    lengths: tuple[float, ...] = LENGTHS,
    sigma: float = SIGMA,
    mounted: bool = True,
    frame: str = "free",
) -> Recording:
    """A day's readings, two at each pose and payload: drives of these compliances (rad/(N*m), by joint from 1), zeros
    that are off (rad), measured from a frame that stands anywhere."""
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-1.5, 1.5, (poses, 3)), 2 * len(payloads), axis=0)
    load = np.tile(np.repeat(payloads, 2), poses)
    true = q.copy()
    for joint, off in (zeros or {}).items():
        true[:, joint - 1] += off
    true = true + _wound_up(true, load, compliance or {}, lengths)
    tip = planar_tip(true, lengths) + sigma * rng.standard_normal((len(q), 2))
    if mounted:
        turn = rng.uniform(-3.0, 3.0)
        tip = tip @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]) + rng.uniform(-2.0, 2.0, 2)
    return Recording(
        file=f"day-{seed}.csv",
        q=q,
        tip=tip,
        row=np.arange(1, len(q) + 1),
        time=10.0 * np.arange(len(q)),
        payload_mass=load,
        frame="free" if frame == "free" else "known",
    )


def _wound_up(q: Array, load: Array, compliance: Mapping[int, float], lengths: tuple[float, ...]) -> Array:
    """How far the drives give (N, 3), rad: compliance times the torque of the weight at the tip about the joint."""
    angles = np.cumsum(q, axis=1)
    along = np.cos(angles) * np.array(lengths)
    moved = np.zeros_like(q)
    for joint, gives in compliance.items():
        lever = along[:, joint - 1 :].sum(axis=1)
        moved[:, joint - 1] = -gives * _G * load * lever
    return moved
