"""A drive goes on giving under a load that stays: plastic parts, belts, worn seats."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import Scalar, times
from linkwright.core.arm.effects.effect import Effect, OfDrives, Settings, shape, size
from linkwright.core.arm.effects.traits import DriveTraits, Readings, RecordingTraits

_STEADY = 0.02
"""A load that changes by no more than this share of its greatest is steady."""


def _moved(state: PoseState, settings: Settings, index: int) -> Scalar:
    compliance, constant = settings.values.get("compliance", 0.0), settings.values.get("time_constant", 0.0)
    anew = settings.values.get("anew", 1.0) > 0.0
    elapsed = state.conditions.loaded_for if anew else state.conditions.time
    if compliance == 0.0 or constant <= 0.0 or elapsed is None:
        return 0.0
    share = 1.0 - np.exp(-np.asarray(elapsed, dtype=float) / constant)
    return times(compliance * share, state.joints[index].drive_load)


def _shown(readings: Readings, at: tuple[int, ...], shapes: Mapping[str, float]) -> bool:
    """Whether the load on a drive changes: under the same load for ever, creep is any slow settling. Creep from the
    recording's beginning is another than that from each payload's only where these are apart."""
    load = np.asarray(readings.state.joints[at[0]].drive_load, dtype=float)
    if not float(np.ptp(load)) > _STEADY * float(np.max(np.abs(load))):
        return False
    if shapes.get("anew") != 0.0:
        return True
    loaded_for = np.asarray(readings.state.conditions.loaded_for)
    return readings.time is not None and not np.array_equal(readings.time, loaded_for)


CREEP = Effect(
    id="creep",
    title="creep of the drives",
    formula="sum J_i tau_i c_i (1 - exp(-t/tc)), t since loading began",
    place="joint",
    drive=DriveTraits(needed=True),
    cause="flexibility",
    needs="time, and steps of load",
    aliases=("thermal_expansion", "joint_compliance"),
    source="W. N. Findley, J. S. Lai & K. Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials "
    "(North-Holland, 1976): Kelvin's model",
    parameters=(
        size("compliance", "compliance", 0.0, 1e-2, (1e-8, 1e-5)).means(
            "compliance that the drive gains in the end",
            "1 to 5 % of the compliance, all of it again in a worn or plastic part",
        ),
        shape(
            "time_constant",
            "time",
            1.0,
            1e6,
            (60.0, 7.2e4),
            grid=(60.0, 120.0, 300.0, 600.0, 1200.0, 2400.0, 3600.0, 7200.0, 14400.0, 28800.0, 72000.0),
        ).means("time after which 63 % of it has come", "minutes for belts and greases, hours for plastics"),
        shape("anew", "dimensionless", 0.0, 1.0, (0.0, 1.0), grid=(0.0, 1.0), whole=True, default=1.0).means(
            "1: creep begins anew with each payload; 0: it began with the recording, whatever the payload since",
            "Kelvin's model under steps of load, and under a load that is mostly the arm's own weight",
        ),
    ),
    twists=OfDrives(_moved),
    requires=("loaded_for",),
    enough=(("compliance", "time_constant"),),
    rank=280,
    linear=True,
    recording=RecordingTraits(shown_by=_shown),
)
