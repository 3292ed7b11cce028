"""What recording.yaml says of a motion log: `observes: motion`, servo, torque constants, gear ratios,
encoders, filter, sigma."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

from linkwright.core.units.quantities import InputError, read_quantity, shown
from linkwright.core.units.reading import Mapping

_KEYS = ("torque_constants", "gear_ratios", "filter", "servo", "encoders")
"""Settings that only motion logs have."""
_CONSTANTS = ("torque_constant", "torque_per_voltage")


@dataclass(frozen=True)
class Servo:
    """Loops that make voltages of how far coordinates are from goals: a share of the `supply` (V), at most `limit`.

    Args:
        gain: (n,) share of the supply for each rad (m), one for all joints or one for each; None where nobody knows it:
            then nobody knows at which distance a loop reaches its limit either.
        supply: V; None alike.
        limit: Share of the supply.
    """

    gain: tuple[float, ...] | None = None
    supply: float | None = None
    limit: float = 1.0


@dataclass(frozen=True)
class MotionSettings:
    """Settings of a motion log.

    Args:
        torque_constants: (n,) N*m/A (N/A for slides) by joint, of voltages N*m/V; None where the settings have none.
        torque_constants_free: Whether they are to be found.
        gear_ratios: (n,) turns of the motor for one of the joint, where torques, currents and constants are of the
            motor; None where they are of the joint.
        cutoff: Hz, of the low-pass on torques and model; None: chosen from the data.
        sigma: (n,) N*m (N), standard deviations of the torques, one for all joints or one for each; None: not declared.
        servo: The loops of drives of which goals alone were logged; None where nothing is said of them.
        beyond_drive: Whether coordinates are of encoders on the joint's side, behind the drive that gives.
    """

    torque_constants: tuple[float, ...] | None = None
    torque_constants_free: bool = False
    gear_ratios: tuple[float, ...] | None = None
    cutoff: float | None = None
    sigma: tuple[float, ...] | None = None
    servo: Servo | None = None
    beyond_drive: bool = False


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
        torque_constants=None if free else _each_joint(mapping, "torque_constants", *_CONSTANTS),
        torque_constants_free=free,
        gear_ratios=_each_joint(mapping, "gear_ratios", "dimensionless"),
        cutoff=cutoff,
        sigma=_each_joint(mapping, "sigma", "torque"),
        servo=_servo(mapping),
        beyond_drive=mapping.choice("encoders", ("motor", "joint"), "motor") == "joint",
    )


def _servo(mapping: Mapping) -> Servo | None:
    if not mapping.has("servo"):
        return None
    body = mapping.mapping("servo")
    with body.reading():
        free = body.has("gain") and body.raw("gain") == "free"
        gain = None if free else _each_joint(body, "gain", "per_angle")
        supply = body.positive("supply", "voltage") if body.has("supply") else None
        limit = body.number("limit", 1.0)
        if not 0.0 < limit <= 1.0:
            raise body.error("limit", f"is {limit:g}; a share of the supply lies above 0 and is at most 1")
        if gain is None and not free:
            raise body.error("gain", "is missing: the share of the supply for each rad (`gain: 5 1/rad`), or `free`")
        if (gain is None) != (supply is None):
            raise body.error("supply", "goes with a `gain`: 12 V, say, or `gain: free` without it")
    return Servo(gain, supply, limit)


def _observes_motion(mapping: Mapping) -> bool:
    raw = mapping.raw("observes") if mapping.has("observes") else None
    if isinstance(raw, list | dict) and "motion" in raw:
        if len(cast(list[object] | dict[str, object], raw)) > 1:
            raise mapping.error("observes", "has others beside motion; a motion log is a recording of its own")
        return True
    return raw == "motion"


def _each_joint(mapping: Mapping, name: str, *kinds: str) -> tuple[float, ...] | None:
    """Positive numbers by joint: bare ones in SI, as the contract of motion logs has them, or with a unit of a kind."""
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
            one = _of_any(value, kinds, mapping.file, key)
        if not 0.0 < one < float("inf"):
            raise mapping.error(name, f"holds {shown(value)}; each must be positive")
        numbers.append(one)
    return tuple(numbers)


def _of_any(value: object, kinds: Sequence[str], file: object, key: str) -> float:
    """A quantity of the first kind whose unit it has. Raises `InputError` by the first kind where it has none's."""
    for kind in kinds[1:]:
        try:
            return read_quantity(value, kind, file=file, key=key)
        except InputError:
            continue
    return read_quantity(value, kinds[0], file=file, key=key)
