"""A simulated recording, described."""

from __future__ import annotations

import math

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.simulate import Plan, Simulation
from linkwright.core.units.quantities import format_quantity
from linkwright.results.document import Description, Lines


def describe(arm: Arm, simulation: Simulation, plan: Plan) -> Description:
    """By how much the physics moves the tip, and what of it this recording cannot hold."""
    rms = format_quantity(math.sqrt(float((simulation.error**2).sum(axis=1).mean())), "length", digits=3)
    scatter = format_quantity(plan.noise, "length", digits=3)
    what = f"the model moves the tip by {rms} RMS, noise {scatter} a component"
    headline = f"{simulation.recording.size} readings of {plan.poses} poses; {what}"
    idle = tuple(
        f"note: {name} moves nothing that this recording holds (linkwright effects show {name})"
        for name in dict.fromkeys(simulation.idle)
    )
    return Description(arm.name, headline, (Lines(idle),) if idle else (), subject=f"{arm.name}: ")
