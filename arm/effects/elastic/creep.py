"""A drive goes on giving under a load that stays: plastic parts, belts, worn seats."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..statics import PoseState
from ..vectors import times
from .effect import Effect, Parameter, Settings, Twist, drive_motion


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    compliance, constant = settings.values.get("compliance", 0.0), settings.values.get("time_constant", 0.0)
    anew = settings.values.get("anew", 1.0) > 0.0
    elapsed = state.conditions.loaded_for if anew else state.conditions.time
    if compliance == 0.0 or constant <= 0.0 or elapsed is None:
        return
    share = 1.0 - np.exp(-np.asarray(elapsed, dtype=float) / constant)
    for index, joint in enumerate(state.joints):
        if settings.acts_at(index):
            yield from drive_motion(state, index, times(compliance * share, joint.drive_load))


CREEP = Effect(
    id="creep",
    title="creep of the drives",
    formula="sum J_i tau_i c_i (1 - exp(-t/tc)), t since loading began",
    place="joint",
    cause="flexibility",
    automatic=False,
    needs="time, and steps of load",
    aliases=("thermal_expansion", "joint_compliance"),
    source="W. N. Findley, J. S. Lai & K. Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials "
    "(North-Holland, 1976): Kelvin's model",
    parameters=(
        Parameter(
            "compliance",
            "compliance",
            "compliance that the drive gains in the end",
            0.0,
            1e-2,
            (1e-8, 1e-5),
            "1 to 5 % of the compliance, all of it again in a worn or plastic part",
            role="size",
        ),
        Parameter(
            "time_constant",
            "time",
            "time after which 63 % of it has come",
            1.0,
            1e6,
            (60.0, 7.2e4),
            "minutes for belts and greases, hours for plastics",
            role="shape",
            grid=(60.0, 120.0, 300.0, 600.0, 1200.0, 2400.0, 3600.0, 7200.0, 14400.0, 28800.0, 72000.0),
        ),
        Parameter(
            "anew",
            "dimensionless",
            "1: creep begins anew with each payload; 0: it began with the recording, whatever the payload since",
            0.0,
            1.0,
            (0.0, 1.0),
            "Kelvin's model under steps of load, and under a load that is mostly the arm's own weight",
            role="shape",
            grid=(0.0, 1.0),
        ),
    ),
    twists=_twists,
    requires=("loaded_for",),
    enough=(("compliance", "time_constant"),),
)
