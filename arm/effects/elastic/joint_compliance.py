"""Drives give under the torque (or force) that they hold."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import MappingProxyType

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import times
from linkwright.core.arm.effects.effect import (
    Effect,
    Kink,
    Settings,
    Twist,
    drive_motion,
    given,
    size,
    torque_shape,
)
from linkwright.core.arm.effects.elastic.elastic_drive import RETARDATION, OfElasticDrive
from linkwright.core.arm.effects.functions import wound_up
from linkwright.core.arm.effects.loads.unknown_weight import under_unit_weights, unit_sag
from linkwright.core.arm.effects.traits import DriveTraits, LinkTraits, PlayTraits, WatchTraits


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    product = settings.values.get("unit_sag", 0.0)
    weighed = under_unit_weights(state) if product != 0.0 else None
    for index, joint in enumerate(state.joints):
        if not settings.acts_at(index):
            continue
        if weighed is not None:
            yield from drive_motion(state, index, times(product, weighed.joints[index].drive_load))
        if "compliance" in settings.values:
            yield from drive_motion(state, index, times(settings.values["compliance"], joint.drive_load))
        if "compliance" in settings.values or "unit_sag" in settings.values:
            continue
        if joint.zones and "stiffness" not in settings.values:
            yield from drive_motion(state, index, wound_up(joint.drive_load, joint.zones))
            continue
        stiffness = settings.values.get("stiffness", joint.stiffness)
        if stiffness is not None:
            yield from drive_motion(state, index, joint.drive_load / stiffness)


def _kinks(state: PoseState, settings: Settings) -> Iterator[Kink]:
    if not {"stiffness", "compliance", "unit_sag"} & set(settings.values):
        for index, joint in enumerate(state.joints):
            if joint.zones and settings.acts_at(index):
                yield Kink(drive_motion(state, index, 1.0), joint.drive_load, joint.zones)


def file_compliance(arm: Arm, joint: int) -> float:
    """The compliance (rad/(N*m), m/N) that an arm file gives a drive (from 0): 0 where it is rigid or left out."""
    stiffness = arm.joints[joint].stiffness
    return 0.0 if stiffness is None or JOINT_COMPLIANCE.id in arm.leave_out else 1.0 / stiffness


def drive_compliance(arm: Arm, joint: int) -> float:
    """The whole compliance of a drive (from 0) in an arm's model, rad/(N*m) or m/N."""
    total, stiffness = file_compliance(arm, joint), arm.joints[joint].stiffness
    for entry in arm.effects:
        if entry.effect == JOINT_COMPLIANCE.id and (not entry.at or joint + 1 in entry.at):
            if "compliance" in entry.parameters:
                total += entry.parameters["compliance"]
            elif "stiffness" in entry.parameters:
                total += 1.0 / entry.parameters["stiffness"]
            elif "unit_sag" not in entry.parameters:
                total += 0.0 if stiffness is None else 1.0 / stiffness
    return total


def drive_retardation(arm: Arm, joint: int) -> float | None:
    """The damping of a drive (from 0) over its stiffness, s; None where nobody says."""
    entries = (e for e in arm.effects if e.effect == JOINT_COMPLIANCE.id and joint + 1 in (e.at or (joint + 1,)))
    return next((e.parameters["retardation"] for e in entries if "retardation" in e.parameters), None)


def with_compliance(arm: Arm, joint: int, more: float) -> Arm:
    """The arm with a drive (from 0) that gives by `more` (rad/(N*m), m/N) beyond what it does."""
    values = MappingProxyType({"compliance": more})
    return replace(arm, effects=(*arm.effects, EffectEntry(JOINT_COMPLIANCE.id, (joint + 1,), values)))


JOINT_COMPLIANCE = Effect(
    id="joint_compliance",
    title="compliance of the drives",
    formula="sum J_i tau_i / K_i; of an actuator whose catalogue has zones of stiffness zone by zone; in motion the "
    "link stands d_i behind the encoder of the motor, K_i d_i + D_i d'_i = tau_i(q - d)",
    place="joint",
    drive=DriveTraits(needed=True, gives=True, by_load=True),
    cause="flexibility",
    automatic=True,
    needs="two payloads, or joint-side encoders; in motion encoders on both sides, or fast changes of torque",
    aliases=("link_bending", "servo_droop", "base_compliance", "link_inertial", "torque_delay"),
    source="M. W. Spong, Modeling and Control of Elastic Joint Robots, ASME J. Dyn. Sys. 109 (1987), "
    "doi:10.1115/1.3143860",
    parameters=(
        given("stiffness", "torsional_stiffness", 1.0, 1e9, (1e4, 4e6)).means(
            "torsional stiffness of the drive", "range from small harmonic drives to large machine-tool drives"
        ),
        size("compliance", "compliance", -1e-1, 1e-1, (2.5e-7, 1e-4)).means(
            "compliance of the drive beyond what the arm file gives it", "the reciprocal of the same stiffnesses"
        ),
        unit_sag("the drive"),
        torque_shape("retardation", "time", 0.0, 1.0, (1e-3, 2e-2), grid=(2e-3, 1e-2, 5e-2), default=RETARDATION).means(
            "damping between encoder and link over the stiffness there, D/K: how far its angle lags its torque",
            "gears swing at 5 to 20 Hz with 5 to 20 % of critical damping",
        ),
    ),
    twists=_twists,
    torques=OfElasticDrive(file_compliance, drive_compliance),
    play=PlayTraits(kinks=_kinks),
    watch=WatchTraits(lasts="a while", always=True),
    rank=10,
    linear=True,
    link=LinkTraits(flexible=True, in_modes=True),
    synonyms=("joint_stiffness", "drive_stiffness", "drive_compliance", "gear_stiffness"),
)
