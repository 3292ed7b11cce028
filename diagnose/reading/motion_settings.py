"""What recording.yaml says of a motion log: `observes: motion`, torque constants, gear ratios, filter, sigma."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

from linkwright.core.units.quantities import read_quantity, shown
from linkwright.core.units.reading import Mapping

_KEYS = ("torque_constants", "gear_ratios", "filter")
"""Settings that only motion logs have."""


@dataclass(frozen=True)
class MotionSettings:
    """Settings of a motion log.

    Args:
        torque_constants: (n,) N*m/A (N/A for slides) by joint; None where the settings have none.
        torque_constants_free: Whether they are to be found.
        gear_ratios: (n,) turns of the motor for one of the joint, where torques, currents and constants are of the
            motor; None where they are of the joint.
        cutoff: Hz, of the low-pass on torques and model; None: chosen from the data.
        sigma: (n,) N*m (N), standard deviations of the torques, one for all joints or one for each; None: not declared.
    """

    torque_constants: tuple[float, ...] | None = None
    torque_constants_free: bool = False
    gear_ratios: tuple[float, ...] | None = None
    cutoff: float | None = None
    sigma: tuple[float, ...] | None = None


def read_motion_settings(mapping: Mapping) -> MotionSettings | None:
    """The settings of a motion log; None for those of another recording. Raises `InputError`."""
    declared = _observes_motion(mapping)
    if not declared and not any(mapping.has(key) for key in _KEYS):
        return None
    if not declared and mapping.has("observes"):
        key = next(key for key in _KEYS if mapping.has(key))
        raise mapping.error(key, "goes with `observes: motion`; write that, or take it out")
    free = mapping.has("torque_constants") and mapping.raw("torque_constants") == "free"
    cutoff = None
    if mapping.has("filter"):
        body = mapping.mapping("filter")
        with body.reading():
            cutoff = body.positive("cutoff", "frequency")
    return MotionSettings(
        torque_constants=None if free else _each_joint(mapping, "torque_constants", "torque_constant"),
        torque_constants_free=free,
        gear_ratios=_each_joint(mapping, "gear_ratios", "dimensionless"),
        cutoff=cutoff,
        sigma=_each_joint(mapping, "sigma", "torque"),
    )


def _observes_motion(mapping: Mapping) -> bool:
    raw = mapping.raw("observes") if mapping.has("observes") else None
    if isinstance(raw, list | dict) and "motion" in raw:
        if len(cast(list[object] | dict[str, object], raw)) > 1:
            raise mapping.error("observes", "has others beside motion; a motion log is a recording of its own")
        return True
    return raw == "motion"


def _each_joint(mapping: Mapping, name: str, kind: str) -> tuple[float, ...] | None:
    """Positive numbers by joint: bare ones in SI, as the contract of motion logs has them, or with their unit."""
    if not mapping.has(name):
        return None
    raw = mapping.raw(name)
    values = cast(list[object], raw) if isinstance(raw, list) else [raw]
    if not values:
        raise mapping.error(name, "is an empty list; it has one number for each joint")
    place = mapping.path_of(name)
    numbers: list[float] = []
    for number, value in enumerate(values, start=1):
        key = f"{place}[{number}]" if isinstance(raw, list) else place
        if isinstance(value, int | float) and not isinstance(value, bool):
            one = float(value)
        else:
            one = read_quantity(value, kind, file=mapping.file, key=key)
        if not 0.0 < one < float("inf"):
            raise mapping.error(name, f"holds {shown(value)}; each must be positive")
        numbers.append(one)
    return tuple(numbers)
