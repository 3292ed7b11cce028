"""A simulated recording as a plain mapping for JSON: what was asked, and by how much the physics moves the tip."""

from __future__ import annotations

import math
from typing import Any

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.simulate import Plan, Simulation

from .fields import fields


def simulation_json(simulation: Simulation, arm: Arm, plan: Plan) -> dict[str, Any]:
    """What `simulate --json` writes."""
    return {
        "arm": arm.name,
        "rows": simulation.recording.size,
        **fields(plan, "poses", "seed", "noise_mm"),
        "rms_error_mm": 1e3 * math.sqrt(float((simulation.error**2).sum(axis=1).mean())),
        "effects": [fields(each, "effect", "at") for each in arm.effects],
        "idle": list(simulation.idle),
    }
