"""A drive that stiffens under load, as harmonic drives do: by a smooth curve, or by the three zones of a catalogue."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from linkwright.core.arm.chain.chain import Zones
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.effects.effect import (
    Effect,
    Kink,
    Parameter,
    Settings,
    Twist,
    drive_motion,
    given,
    shape,
    size,
)
from linkwright.core.arm.effects.functions import saturated, wound_up
from linkwright.core.arm.effects.traits import DriveTraits, PlayTraits
from linkwright.core.sections.numeric import tanh

ZONES = ("stiffness_1", "stiffness_2", "stiffness_3", "torque_1", "torque_2")


def _zones(values: Mapping[str, float]) -> Zones:
    """Stiffness K1 up to the load T1, K2 up to T2 and K3 beyond."""
    ends = (values["torque_1"], values["torque_2"], math.inf)
    return tuple(zip(ends, (values[name] for name in ZONES[:3]), strict=True))


def _kinks(state: PoseState, settings: Settings) -> Iterator[Kink]:
    if all(name in settings.values for name in ZONES):
        for index, joint in enumerate(state.joints):
            if settings.acts_at(index):
                yield Kink(drive_motion(state, index, 1.0), joint.drive_load, _zones(settings.values))


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    values = settings.values
    compliance, knee = values.get("compliance", 0.0), values.get("knee", 0.0)
    remaining, sharp = values.get("remaining", 0.0), values.get("sharp", 0.0) > 0.0
    for index, joint in enumerate(state.joints):
        load = joint.drive_load
        if not settings.acts_at(index):
            continue
        if all(name in values for name in ZONES):
            yield from drive_motion(state, index, wound_up(load, _zones(values)))
        if compliance != 0.0 and knee > 0.0:
            bent = saturated(load, knee) if sharp else knee * tanh(load / knee)
            yield from drive_motion(state, index, compliance * bent)
        if remaining != 0.0:
            yield from drive_motion(state, index, remaining * load)


def _zone(number: int) -> Parameter:
    return given(f"stiffness_{number}", "torsional_stiffness", 1e2, 1e9, (1e4, 1e6)).means(
        f"stiffness of the drive in zone {number}", "makers' catalogues of harmonic drives: K1, K2, K3"
    )


def _limit(number: int) -> Parameter:
    return given(f"torque_{number}", "torque", 0.0, 1e6, (2.0, 500.0)).means(
        f"load at which zone {number} ends", "makers' catalogues of harmonic drives: T1, T2"
    )


JOINT_HARDENING = Effect(
    id="joint_hardening",
    title="hardening of the drives",
    formula="sum J_i (c_i t0 tanh(tau_i/t0) + c tau_i); or three zones of stiffness K1, K2, K3 up to T1, T2 and beyond",
    place="joint",
    drive=DriveTraits(needed=True, by_load=True),
    cause="flexibility",
    needs="a wide range of torque",
    aliases=("joint_compliance",),
    source="T. D. Tuttle & W. P. Seering, A nonlinear model of a harmonic drive gear transmission, "
    "IEEE Transactions on Robotics and Automation 12 (1996) 368-374",
    parameters=(
        size("compliance", "compliance", 0.0, 1e-1, (2.5e-7, 1e-4)).means(
            "compliance without load, beyond that of the file, which load takes away",
            "reciprocals of the stiffnesses in catalogues",
        ),
        size("remaining", "compliance", -1e-1, 1e-1, (2.5e-7, 1e-4)).means(
            "compliance beyond that of the file which is left under high load", "reciprocals of K3 in catalogues"
        ),
        shape(
            "knee", "torque", 0.0, 1e6, (2.0, 500.0), grid=(0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0), relative_to_load=True
        ).means("load around which the compliance is lost", "makers' catalogues of harmonic drives: T1, T2"),
        shape("sharp", "dimensionless", 0.0, 1.0, (0.0, 1.0), grid=(0.0, 1.0), whole=True).means(
            "1: the compliance is lost at once at the knee, as between two zones; 0: smoothly",
            "makers' catalogues of harmonic drives draw both",
        ),
        _zone(1),
        _zone(2),
        _zone(3),
        _limit(1),
        _limit(2),
    ),
    twists=_twists,
    play=PlayTraits(kinks=_kinks),
    enough=(("compliance", "knee"), ("remaining",), ZONES),
    rank=150,
    linear=True,
)
