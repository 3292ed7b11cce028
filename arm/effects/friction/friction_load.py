"""Friction that grows with the load: gears press their teeth together with what they carry."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import direction, drive_effect
from linkwright.core.arm.effects.traits import WatchTraits
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import load_torque
from linkwright.core.sections.numeric import Array


def _torque(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    return values.get("share", 0.0) * np.abs(load_torque(motion)[:, joint]) * direction(motion.velocity[:, joint])


FRICTION_LOAD = drive_effect(
    _torque,
    id="friction_load",
    title="friction that grows with the load",
    formula="mu_i |tau_i| sign(q'_i)",
    cause="friction in motion",
    needs="several loads at one speed: postures, or payloads",
    aliases=("friction_coulomb", "friction_place", "torque_constant"),
    source="P. Hamon, M. Gautier & P. Garrec, Dynamic identification of robots with a dry friction model depending on "
    "load and velocity, IEEE/RSJ IROS (2010) 6187-6193, doi:10.1109/IROS.2010.5649189",
    parameters=(
        torque("share", "dimensionless", 0.0, 1.0, (0.02, 0.15)).means(
            "share of the load that friction takes",
            "losses of harmonic drives and of planetary gears: 5 to 10 % of the load",
        ),
    ),
    watch=WatchTraits(lasts="a while"),
    rank=100,
)
