"""A motion log from a model: an exciting trajectory, the torques that it takes, and noise on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.arm.avoid.poses import Room
from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.motion.dynamics import model_torque
from linkwright.core.arm.motion.motion import Motion

from .log import MotionLog
from .uses.trajectory import limits_of, moved, random_series

_NOISE = 0.01
"""Of a joint's torque (RMS), where nobody says how much noise there is."""


def simulate_motion(
    arm: Arm,
    motion: Motion | None = None,
    *,
    effects: Sequence[EffectEntry] = (),
    noise: float | Sequence[float] | None = None,
    seconds: float = 20.0,
    rate: float = 100.0,
    seed: int = 1,
) -> MotionLog:
    """A motion log as an arm of this model would write it.

    Args:
        arm: The arm, its own `effects` among what it has.
        motion: How it moves; None: an exciting trajectory within its ranges and speeds, drawn by the `seed`.
        effects: What it has beyond its file.
        noise: N*m (N), standard deviation of each torque, of all or of each joint; None: a hundredth of the torque.
        seconds: How long a trajectory that is drawn lasts.
        rate: Hz at which it is sampled.
        seed: Of trajectory and noise.

    Returns:
        The log, with speeds; `log_columns` makes the table of it that is read again.

    Raises:
        NoRoom: Regions to avoid leave the arm no room to move in.
        PropertyNeeded: A link's mass is not known.
        InputError: The arm has branches, or links that run out of a sleeve.

    >>> from linkwright.core.arm.chain.chain import Joint, Link
    >>> arm = Arm("rod", (Joint(),), (Link(0.5, mass=2.0, center_of_mass=0.25),))
    >>> rubs = EffectEntry("friction_coulomb", (1,), {"torque": 3.0})
    >>> simulate_motion(arm, effects=(rubs,), seconds=2.0).torque.shape
    (201, 1)
    """
    draw = np.random.default_rng(seed)
    if motion is None:
        room = Room(arm.avoid)
        motion = moved(arm, random_series(arm, draw, 1)[0], limits_of(arm, room, draw), seconds, rate, room)
    torque = model_torque(replace(motion, arm=replace(arm, effects=(*arm.effects, *effects))))
    usual = _NOISE * np.sqrt(np.mean(torque**2, axis=0))
    sigma = np.broadcast_to(usual if noise is None else np.asarray(noise, dtype=float), (arm.size,))
    return MotionLog(
        file="",
        time=motion.time,
        q=motion.q,
        torque=torque + sigma * draw.standard_normal(torque.shape),
        row=np.arange(1, motion.size + 1),
        velocity=motion.velocity,
        commanded=motion.commanded,
        joint_side=motion.joint_side,
        temperature=motion.temperature,
        payload_mass=motion.payload_mass,
        beyond_drive=motion.beyond_drive,
    )
