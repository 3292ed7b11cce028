"""Arms in the plane whose drives alone give, and what a force at the tip does to them, by the textbook."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.recording import Recording
from linkwright.core.sections.numeric import Array
from tests.diagnose.recorded import LENGTHS, planar_arm, planar_tip

SIGMA = 15e-6
"""m, noise of each component of a reading."""
COMPLIANCE = (1.5e-5, 2.5e-5, 4e-5)
"""rad/(N*m) of each drive."""


def arm_of_drives() -> Arm:
    """Three rigid, weightless links on drives that give."""
    arm = planar_arm()
    joints = tuple(replace(joint, stiffness=1.0 / item) for joint, item in zip(arm.joints, COMPLIANCE, strict=True))
    return replace(arm, joints=joints)


def jacobian(q: Array) -> Array:
    """How the tip moves with each joint, (N, 2, 3): a link's end goes at right angles to the link."""
    angles = np.cumsum(q, axis=1)
    ends = np.stack([-np.sin(angles) * LENGTHS, np.cos(angles) * LENGTHS], axis=1)
    return np.cumsum(ends[:, :, ::-1], axis=2)[:, :, ::-1]


def given_way(q: Array, force: Array) -> Array:
    """Where forces (N, 2) at the tip push it, (N, 2): J diag(C) J^T F."""
    turned = np.einsum("nij,ni->nj", jacobian(q), force) * COMPLIANCE
    return np.einsum("nij,nj->ni", jacobian(q), turned)


def turned_by(q: Array, errors: Array | tuple[float, float, float]) -> Array:
    """Where errors of the joints (N, 3) or (3,), rad, put the tip, (N, 2)."""
    return planar_tip(q + np.asarray(errors)) - planar_tip(q)


def visited(rng: np.random.Generator, poses: int, repeats: int) -> Array:
    """Random poses, each read some times in a row, (N, 3) rad."""
    return np.repeat(rng.uniform(-1.6, 1.6, (poses, 3)), repeats, axis=0)


def read(q: Array, moved: Array, rng: np.random.Generator, **further: Array) -> Recording:
    """What an instrument reads where the tip stands off its nominal place by `moved` (N, 2)."""
    tip = planar_tip(q) + moved + SIGMA * rng.standard_normal(moved.shape)
    return Recording("r.csv", q, tip, np.arange(1, len(q) + 1), time=20.0 * np.arange(len(q)), **further)
