"""A drive that stiffens under load, as harmonic drives do: by a smooth curve, or by the three zones of a catalogue."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..statics import PoseState
from ..vectors import Scalar
from .effect import Effect, Parameter, Settings, Twist, drive_motion
from .functions import hyperbolic_tangent, saturated

ZONES = ("stiffness_1", "stiffness_2", "stiffness_3", "torque_1", "torque_2")


def three_zones(load: Scalar, values: Mapping[str, float]) -> Scalar:
    """The wind-up (rad, m) of a drive of stiffness K1 up to the load T1, K2 up to T2 and K3 beyond, either way."""
    first, second, third = (1.0 / values[name] for name in ZONES[:3])
    within_first = saturated(load, values["torque_1"])
    within_second = saturated(load, values["torque_2"])
    return third * load + (first - second) * within_first + (second - third) * within_second


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    values = settings.values
    compliance, knee = values.get("compliance", 0.0), values.get("knee", 0.0)
    remaining, sharp = values.get("remaining", 0.0), values.get("sharp", 0.0) > 0.0
    for index, joint in enumerate(state.joints):
        load = joint.drive_load
        if not settings.acts_at(index):
            continue
        if all(name in values for name in ZONES):
            yield from drive_motion(state, index, three_zones(load, values))
        if compliance != 0.0 and knee > 0.0:
            bent = saturated(load, knee) if sharp else knee * hyperbolic_tangent(load / knee)
            yield from drive_motion(state, index, compliance * bent)
        if remaining != 0.0:
            yield from drive_motion(state, index, remaining * load)


def _zone(number: int) -> Parameter:
    return Parameter(
        f"stiffness_{number}",
        "torsional_stiffness",
        f"stiffness of the drive in zone {number}",
        1e2,
        1e9,
        (1e4, 1e6),
        "makers' catalogues of harmonic drives: K1, K2, K3",
    )


def _limit(number: int) -> Parameter:
    return Parameter(
        f"torque_{number}",
        "torque",
        f"load at which zone {number} ends",
        0.0,
        1e6,
        (2.0, 500.0),
        "makers' catalogues of harmonic drives: T1, T2",
    )


JOINT_HARDENING = Effect(
    id="joint_hardening",
    title="hardening of the drives",
    formula="sum J_i (c_i t0 tanh(tau_i/t0) + c tau_i); or three zones of stiffness K1, K2, K3 up to T1, T2 and beyond",
    place="joint",
    cause="flexibility",
    automatic=False,
    needs="a wide range of torque",
    aliases=("joint_compliance",),
    source="T. D. Tuttle & W. P. Seering, A nonlinear model of a harmonic drive gear transmission, "
    "IEEE Transactions on Robotics and Automation 12 (1996) 368-374",
    parameters=(
        Parameter(
            "compliance",
            "compliance",
            "compliance without load, beyond that of the file, which load takes away",
            0.0,
            1e-2,
            (2.5e-7, 1e-4),
            "reciprocals of the stiffnesses in catalogues",
            role="size",
        ),
        Parameter(
            "remaining",
            "compliance",
            "compliance beyond that of the file which is left under high load",
            -1e-2,
            1e-2,
            (2.5e-7, 1e-4),
            "reciprocals of K3 in catalogues",
            role="size",
        ),
        Parameter(
            "knee",
            "torque",
            "load around which the compliance is lost",
            0.0,
            1e6,
            (2.0, 500.0),
            "makers' catalogues of harmonic drives: T1, T2",
            role="shape",
            grid=(0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0),
            relative_to_load=True,
        ),
        Parameter(
            "sharp",
            "dimensionless",
            "1: the compliance is lost at once at the knee, as between two zones; 0: smoothly",
            0.0,
            1.0,
            (0.0, 1.0),
            "makers' catalogues of harmonic drives draw both",
            role="shape",
            grid=(0.0, 1.0),
        ),
        _zone(1),
        _zone(2),
        _zone(3),
        _limit(1),
        _limit(2),
    ),
    twists=_twists,
    enough=(("compliance", "knee"), ("remaining",), ZONES),
)
