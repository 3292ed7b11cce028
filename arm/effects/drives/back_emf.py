"""A motor that turns makes a voltage against the one that drives it, which makes less torque the faster it turns."""

from __future__ import annotations

from linkwright.core.arm.effects.effect import torque
from linkwright.core.arm.effects.torques import drive_effect
from linkwright.core.arm.effects.traits import RecordingTraits

BACK_EMF = drive_effect(
    lambda motion, values, joint: values.get("coefficient", 0.0) * motion.velocity[:, joint],
    id="back_emf",
    title="back-EMF of the drive's motor",
    formula="(k_t^2/R)_i q'_i",
    cause="drives in motion",
    needs="several speeds, of a log of voltages",
    aliases=("friction_viscous",),
    source="G. F. Franklin, J. D. Powell & A. Emami-Naeini, Feedback Control of Dynamic Systems, 7th ed. (Pearson, "
    "2015), sec. 2.3: the torque of a DC motor is k_t (u - k_e q')/R",
    parameters=(
        torque("coefficient", "viscous_friction", 0.0, 1e5, (0.01, 2.0)).means(
            "torque at standstill that a motor lacks, by its speed: its stall torque over its no-load speed",
            "hobby servos: 0.03 to 1.5 N*m*s/rad",
        ),
    ),
    recording=RecordingTraits(of_voltage=True),
    rank=53,
)
