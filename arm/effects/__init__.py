"""The physics that moves the tip, one effect a file; this registry is the only list of them."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from .axial import AXIAL
from .axis_misalignment import AXIS_MISALIGNMENT
from .backlash import BACKLASH
from .base_compliance import BASE_COMPLIANCE
from .base_tilt import BASE_TILT
from .clearance import CLEARANCE
from .counterbalance import COUNTERBALANCE
from .creep import CREEP
from .dynamic_deflection import DYNAMIC_DEFLECTION
from .effect import Disc, Effect, Interval, Parameter, Settings, Twist, kind_at
from .encoder_eccentricity import ENCODER_ECCENTRICITY
from .encoder_offset import ENCODER_OFFSET
from .encoder_scale import ENCODER_SCALE
from .frame_drift import FRAME_DRIFT
from .frame_misalignment import FRAME_MISALIGNMENT
from .friction_windup import FRICTION_WINDUP
from .gear_transmission_error import GEAR_TRANSMISSION_ERROR
from .gearbox_thermal import GEARBOX_THERMAL
from .instrument_scale import INSTRUMENT_SCALE
from .joint_compliance import JOINT_COMPLIANCE
from .joint_coupling import JOINT_COUPLING
from .joint_hardening import JOINT_HARDENING
from .joint_waviness import JOINT_WAVINESS
from .latency import LATENCY
from .link_bending import LINK_BENDING
from .link_length import LINK_LENGTH
from .link_mass import LINK_MASS
from .link_modulus import LINK_MODULUS
from .payload import PAYLOAD
from .rail_pitch import RAIL_PITCH
from .rail_straightness import RAIL_STRAIGHTNESS
from .screw_expansion import SCREW_EXPANSION
from .servo_droop import SERVO_DROOP
from .shear_deformation import SHEAR_DEFORMATION
from .slope_propagation import SLOPE_PROPAGATION
from .thermal_bending import THERMAL_BENDING
from .thermal_expansion import THERMAL_EXPANSION
from .tool_offset import TOOL_OFFSET
from .torsion import TORSION

EFFECTS: Mapping[str, Effect] = MappingProxyType(
    {
        effect.id: effect
        for effect in (
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
            BASE_TILT,
            BASE_COMPLIANCE,
            FRAME_MISALIGNMENT,
            FRAME_DRIFT,
            INSTRUMENT_SCALE,
            COUNTERBALANCE,
            LATENCY,
            DYNAMIC_DEFLECTION,
            RAIL_STRAIGHTNESS,
            RAIL_PITCH,
        )
    }
)

__all__ = ["EFFECTS", "Disc", "Effect", "Interval", "Parameter", "Settings", "Twist", "kind_at"]
