"""A gear loses another share of the load where it drives than where the load drives it."""

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
    load = load_torque(motion)[:, joint]
    rubs = np.abs(load) * direction(motion.velocity[:, joint])
    forward, backward = values.get("forward", 0.0), values.get("backward", 0.0)
    return 0.5 * forward * (load + rubs) - 0.5 * backward * (load - rubs)


GEAR_EFFICIENCY = drive_effect(
    _torque,
    id="gear_efficiency",
    title="loss of a gear by the direction of power",
    formula="f_i tau_i where tau_i q'_i > 0, -b_i tau_i where the load drives; with efficiencies 1/(1 + f) and 1 - b",
    cause="friction in motion",
    needs="loads that are lifted and let down, and masses that are known",
    aliases=("friction_load", "torque_constant", "link_inertial"),
    source="A. Wang & S. Kim, Directional efficiency in geared transmissions: characterization of backdrivability "
    "towards improved proprioceptive control, IEEE ICRA (2015) 1055-1062",
    parameters=(
        torque("forward", "dimensionless", 0.0, 10.0, (0.02, 0.3)).means(
            "what the drive gives more than the load, where it drives, as a share of the load: 1/efficiency - 1",
            "planetary and harmonic gears 5 to 30 %, worm gears more than the load",
        ),
        torque("backward", "dimensionless", 0.0, 10.0, (0.02, 0.3)).means(
            "what the drive holds less than the load, where that drives it: 1 - efficiency; beyond 1 it locks itself",
            "a little more than forwards; worm gears 0.5 to 2",
        ),
    ),
    watch=WatchTraits(lasts="a while"),
    rank=190,
)
