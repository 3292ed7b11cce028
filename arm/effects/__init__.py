"""The physics that moves the tip, one effect a file; this registry is the only list of them."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from .axial import AXIAL
from .backlash import BACKLASH
from .clearance import CLEARANCE
from .effect import Disc, Effect, Interval, Parameter, Settings, Twist, kind_at
from .encoder_offset import ENCODER_OFFSET
from .joint_compliance import JOINT_COMPLIANCE
from .link_bending import LINK_BENDING
from .rail_pitch import RAIL_PITCH
from .rail_straightness import RAIL_STRAIGHTNESS
from .shear_deformation import SHEAR_DEFORMATION
from .slope_propagation import SLOPE_PROPAGATION
from .thermal_expansion import THERMAL_EXPANSION
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
            JOINT_COMPLIANCE,
            CLEARANCE,
            BACKLASH,
            THERMAL_EXPANSION,
            ENCODER_OFFSET,
            RAIL_STRAIGHTNESS,
            RAIL_PITCH,
        )
    }
)

__all__ = ["EFFECTS", "Disc", "Effect", "Interval", "Parameter", "Settings", "Twist", "kind_at"]
