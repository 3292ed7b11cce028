"""The physics that moves the tip and loads the drives, one effect a file; this is the only list of those shipped.

`EFFECTS.register(effect)` adds one for this process, an entry point of the group `linkwright.effects` those of an
installed package.
"""

from __future__ import annotations

from linkwright.core.arm.effects.angles.encoder_eccentricity import ENCODER_ECCENTRICITY
from linkwright.core.arm.effects.angles.encoder_offset import ENCODER_OFFSET
from linkwright.core.arm.effects.angles.encoder_scale import ENCODER_SCALE
from linkwright.core.arm.effects.angles.gear_transmission_error import GEAR_TRANSMISSION_ERROR
from linkwright.core.arm.effects.angles.joint_coupling import JOINT_COUPLING
from linkwright.core.arm.effects.angles.joint_waviness import JOINT_WAVINESS
from linkwright.core.arm.effects.angles.latency import LATENCY
from linkwright.core.arm.effects.angles.stale_reading import STALE_READING
from linkwright.core.arm.effects.drives.armature import ARMATURE
from linkwright.core.arm.effects.drives.back_emf import BACK_EMF
from linkwright.core.arm.effects.drives.gear_ripple import GEAR_RIPPLE
from linkwright.core.arm.effects.drives.spring import SPRING
from linkwright.core.arm.effects.drives.torque_constant import TORQUE_CONSTANT
from linkwright.core.arm.effects.drives.torque_curve import TORQUE_CURVE
from linkwright.core.arm.effects.drives.torque_delay import TORQUE_DELAY
from linkwright.core.arm.effects.drives.torque_offset import TORQUE_OFFSET
from linkwright.core.arm.effects.elastic.axial import AXIAL
from linkwright.core.arm.effects.elastic.base_compliance import BASE_COMPLIANCE
from linkwright.core.arm.effects.elastic.column_bending import COLUMN_BENDING
from linkwright.core.arm.effects.elastic.creep import CREEP
from linkwright.core.arm.effects.elastic.joint_compliance import JOINT_COMPLIANCE
from linkwright.core.arm.effects.elastic.joint_hardening import JOINT_HARDENING
from linkwright.core.arm.effects.elastic.lateral_compliance import LATERAL_COMPLIANCE
from linkwright.core.arm.effects.elastic.link_bending import LINK_BENDING
from linkwright.core.arm.effects.elastic.link_modulus import LINK_MODULUS
from linkwright.core.arm.effects.elastic.servo_droop import SERVO_DROOP
from linkwright.core.arm.effects.elastic.shear_deformation import SHEAR_DEFORMATION
from linkwright.core.arm.effects.elastic.slope_propagation import SLOPE_PROPAGATION
from linkwright.core.arm.effects.elastic.torsion import TORSION
from linkwright.core.arm.effects.friction.friction_asymmetry import FRICTION_ASYMMETRY
from linkwright.core.arm.effects.friction.friction_coulomb import FRICTION_COULOMB
from linkwright.core.arm.effects.friction.friction_load import FRICTION_LOAD
from linkwright.core.arm.effects.friction.friction_load_stribeck import FRICTION_LOAD_STRIBECK
from linkwright.core.arm.effects.friction.friction_place import FRICTION_PLACE
from linkwright.core.arm.effects.friction.friction_quadratic import FRICTION_QUADRATIC
from linkwright.core.arm.effects.friction.friction_reversal import FRICTION_REVERSAL
from linkwright.core.arm.effects.friction.friction_stribeck import FRICTION_STRIBECK
from linkwright.core.arm.effects.friction.friction_viscous import FRICTION_VISCOUS
from linkwright.core.arm.effects.friction.friction_warmup import FRICTION_WARMUP
from linkwright.core.arm.effects.friction.gear_efficiency import GEAR_EFFICIENCY
from linkwright.core.arm.effects.geometry.axis_misalignment import AXIS_MISALIGNMENT
from linkwright.core.arm.effects.geometry.frame_drift import FRAME_DRIFT
from linkwright.core.arm.effects.geometry.frame_misalignment import FRAME_MISALIGNMENT
from linkwright.core.arm.effects.geometry.instrument_scale import INSTRUMENT_SCALE
from linkwright.core.arm.effects.geometry.link_length import LINK_LENGTH
from linkwright.core.arm.effects.geometry.rail_pitch import RAIL_PITCH
from linkwright.core.arm.effects.geometry.rail_straightness import RAIL_STRAIGHTNESS
from linkwright.core.arm.effects.geometry.tool_offset import TOOL_OFFSET
from linkwright.core.arm.effects.loads.base_tilt import BASE_TILT
from linkwright.core.arm.effects.loads.counterbalance import COUNTERBALANCE
from linkwright.core.arm.effects.loads.dynamic_deflection import DYNAMIC_DEFLECTION
from linkwright.core.arm.effects.loads.link_inertial import LINK_INERTIAL
from linkwright.core.arm.effects.loads.link_mass import LINK_MASS
from linkwright.core.arm.effects.loads.payload import PAYLOAD
from linkwright.core.arm.effects.loads.unknown_weight import UNKNOWN_WEIGHT
from linkwright.core.arm.effects.lost_motion.backlash import BACKLASH
from linkwright.core.arm.effects.lost_motion.clearance import CLEARANCE
from linkwright.core.arm.effects.lost_motion.friction_windup import FRICTION_WINDUP
from linkwright.core.arm.effects.structures.flange_compliance import FLANGE_COMPLIANCE
from linkwright.core.arm.effects.structures.guide_bending import GUIDE_BENDING
from linkwright.core.arm.effects.structures.link_stiffness import LINK_STIFFNESS
from linkwright.core.arm.effects.thermal.gearbox_thermal import GEARBOX_THERMAL
from linkwright.core.arm.effects.thermal.screw_expansion import SCREW_EXPANSION
from linkwright.core.arm.effects.thermal.thermal_bending import THERMAL_BENDING
from linkwright.core.arm.effects.thermal.thermal_expansion import THERMAL_EXPANSION

from . import traits
from .effect import Disc, Effect, Interval, Parameter, Settings, Twist, kind_at
from .registry import EFFECTS, parameter_title, without_zeros
from .traits import Readings

EFFECTS.ship(
    LINK_BENDING,
    SLOPE_PROPAGATION,
    AXIAL,
    TORSION,
    SHEAR_DEFORMATION,
    LINK_STIFFNESS,
    FLANGE_COMPLIANCE,
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
    GUIDE_BENDING,
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
    LINK_INERTIAL,
    FRICTION_COULOMB,
    FRICTION_VISCOUS,
    FRICTION_STRIBECK,
    FRICTION_LOAD,
    FRICTION_LOAD_STRIBECK,
    GEAR_EFFICIENCY,
    FRICTION_ASYMMETRY,
    FRICTION_WARMUP,
    FRICTION_REVERSAL,
    FRICTION_QUADRATIC,
    FRICTION_PLACE,
    ARMATURE,
    BACK_EMF,
    TORQUE_CONSTANT,
    TORQUE_OFFSET,
    TORQUE_DELAY,
    GEAR_RIPPLE,
    SPRING,
    TORQUE_CURVE,
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
    "parameter_title",
    "traits",
    "without_zeros",
]
