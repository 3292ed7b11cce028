"""A URDF that was written and read back, beside the arm that was meant."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.following import completed
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.chain.vectors import unit
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.unknown_mass import of_unknown_mass
from linkwright.core.arm.evaluation import link_masses
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import format_quantity

_POSES = 16
_AWAY = 1e-6
"""How far (of the arm's reach, and of its mass) what is read back may be from what was meant."""


def unlike(meant: Arm, path: Path) -> Iterator[str]:
    """What a URDF says otherwise than the arm that was meant: how many joints it has, where its tips and what is down
    are at poses spread over the ranges, however its base is turned, and what moves of its weight; nothing where it is
    the same. Raises `InputError`."""
    tips = [f"{branch.name}_tip" for branch in meant.branches] or ["tip"]
    back = import_robot(path, tip=tips).arm
    if meant.size != back.size:
        yield f"it had {meant.size} joints and reads {back.size}"
        return
    low, high = (np.array([joint.range[end] for joint in meant.joints]) for end in (0, 1))
    q = completed(meant, low + (high - low) * np.random.default_rng(1).uniform(size=(_POSES, meant.size)))
    one, other = (_places(item, q, down=any(meant.gravity)) for item in (meant, back))
    left, _, right = np.linalg.svd(other.T @ one)
    left[:, -1] *= np.linalg.det(left @ right)  # a turn, and no mirror
    away = float(np.linalg.norm(other @ left @ right - one, axis=1).max())
    if away > _AWAY * (sum(meant.lengths) + 1.0):
        yield f"a tip is {format_quantity(away, 'length', digits=3)} away from where it was"
    masses = [_mass(item) for item in (meant, back)]
    if masses[0] is not None and masses[1] is not None and abs(masses[0] - masses[1]) > _AWAY * (masses[0] + 1.0):
        was, reads = (format_quantity(mass, "mass", digits=6) for mass in masses if mass is not None)
        yield f"{was} of it moved and {reads} move"


def _places(arm: Arm, q: Array, *, down: bool) -> Array:
    """Where each tip is at poses (N, n), a row each (M, 3) m; and, as one more, what is a metre `down`."""
    tips = [tip_position(arm.on(branch.name), q) for branch in arm.branches] or [tip_position(arm, q)]
    return np.vstack([*tips, *([unit(arm.gravity)] if down else [])])


def _mass(arm: Arm) -> float | None:
    """What all that moves weighs, kg; None where a link's mass is not known."""
    if of_unknown_mass(arm):
        return None
    beside = arm.carried_mass + arm.payload.mass - arm.joints[0].mass - sum(joint.motor_on_base for joint in arm.joints)
    return sum(link_masses(beams_of(arm))) + beside
