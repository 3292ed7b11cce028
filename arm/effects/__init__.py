"""The physics that moves the tip, one effect a file; this is the only list of those that are shipped.

`EFFECTS.register(effect)` adds one for this process, an entry point of the group `linkwright.effects` those of an
installed package.
"""

from __future__ import annotations

from arm.effects.angles.encoder_eccentricity import ENCODER_ECCENTRICITY
from arm.effects.angles.encoder_offset import ENCODER_OFFSET
from arm.effects.angles.encoder_scale import ENCODER_SCALE
from arm.effects.angles.gear_transmission_error import GEAR_TRANSMISSION_ERROR
from arm.effects.angles.joint_coupling import JOINT_COUPLING
from arm.effects.angles.joint_waviness import JOINT_WAVINESS
from arm.effects.angles.latency import LATENCY
from arm.effects.angles.stale_reading import STALE_READING
from arm.effects.elastic.axial import AXIAL
from arm.effects.elastic.base_compliance import BASE_COMPLIANCE
from arm.effects.elastic.column_bending import COLUMN_BENDING
from arm.effects.elastic.creep import CREEP
from arm.effects.elastic.joint_compliance import JOINT_COMPLIANCE
from arm.effects.elastic.joint_hardening import JOINT_HARDENING
from arm.effects.elastic.lateral_compliance import LATERAL_COMPLIANCE
from arm.effects.elastic.link_bending import LINK_BENDING
from arm.effects.elastic.link_modulus import LINK_MODULUS
from arm.effects.elastic.servo_droop import SERVO_DROOP
from arm.effects.elastic.shear_deformation import SHEAR_DEFORMATION
from arm.effects.elastic.slope_propagation import SLOPE_PROPAGATION
from arm.effects.elastic.torsion import TORSION
from arm.effects.geometry.axis_misalignment import AXIS_MISALIGNMENT
from arm.effects.geometry.frame_drift import FRAME_DRIFT
from arm.effects.geometry.frame_misalignment import FRAME_MISALIGNMENT
from arm.effects.geometry.instrument_scale import INSTRUMENT_SCALE
from arm.effects.geometry.link_length import LINK_LENGTH
from arm.effects.geometry.rail_pitch import RAIL_PITCH
from arm.effects.geometry.rail_straightness import RAIL_STRAIGHTNESS
from arm.effects.geometry.tool_offset import TOOL_OFFSET
from arm.effects.loads.base_tilt import BASE_TILT
from arm.effects.loads.counterbalance import COUNTERBALANCE
from arm.effects.loads.dynamic_deflection import DYNAMIC_DEFLECTION
from arm.effects.loads.link_mass import LINK_MASS
from arm.effects.loads.payload import PAYLOAD
from arm.effects.loads.unknown_weight import UNKNOWN_WEIGHT
from arm.effects.lost_motion.backlash import BACKLASH
from arm.effects.lost_motion.clearance import CLEARANCE
from arm.effects.lost_motion.friction_windup import FRICTION_WINDUP
from arm.effects.thermal.gearbox_thermal import GEARBOX_THERMAL
from arm.effects.thermal.screw_expansion import SCREW_EXPANSION
from arm.effects.thermal.thermal_bending import THERMAL_BENDING
from arm.effects.thermal.thermal_expansion import THERMAL_EXPANSION

from .effect import Disc, Effect, Interval, Parameter, Readings, Settings, Twist, kind_at
from .registry import EFFECTS

EFFECTS.ship(
    LINK_BENDING,
    SLOPE_PROPAGATION,
    AXIAL,
    TORSION,
    SHEAR_DEFORMATION,
    LINK_MODULUS,
    LINK_MASS,
    JOINT_COMPLIANCE,
    JOINT_HARDENING,
    SERVO_DROOP,
    BACKLASH,
    FRICTION_WINDUP,
    CLEARANCE,
    ENCODER_OFFSET,
    AXIS_MISALIGNMENT,
    ENCODER_ECCENTRICITY,
    ENCODER_SCALE,
    GEAR_TRANSMISSION_ERROR,
    JOINT_WAVINESS,
    JOINT_COUPLING,
    LINK_LENGTH,
    PAYLOAD,
    TOOL_OFFSET,
    THERMAL_EXPANSION,
    THERMAL_BENDING,
    GEARBOX_THERMAL,
    SCREW_EXPANSION,
    CREEP,
    UNKNOWN_WEIGHT,
    BASE_TILT,
    BASE_COMPLIANCE,
    COLUMN_BENDING,
    LATERAL_COMPLIANCE,
    FRAME_MISALIGNMENT,
    FRAME_DRIFT,
    INSTRUMENT_SCALE,
    COUNTERBALANCE,
    LATENCY,
    STALE_READING,
    DYNAMIC_DEFLECTION,
    RAIL_STRAIGHTNESS,
    RAIL_PITCH,
)

__all__ = [
    "EFFECTS",
    "Disc",
    "Effect",
    "Interval",
    "Parameter",
    "Readings",
    "Settings",
    "Twist",
    "kind_at",
]
