"""Mistakes that people make of a recording, each put into a sound one with what must be said of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from scipy.signal import butter, lfilter

from .recordings import Case, Spoil, headers, in_unit_of, sized, some_joint, with_columns

Rng = np.random.Generator


def sign(case: Case, rng: Rng) -> Case:
    """A joint that counts the other way."""
    k = some_joint(case, rng, bearing=case.motion)
    names = [headers(case, kind)[k] for kind in ("q", "dq") if headers(case, kind)]
    return with_columns(case, f"{names[0]}.* (counts|count) the other way", **{n: -case.columns[n] for n in names})


def quarter(case: Case, rng: Rng) -> Case:
    """A zero a quarter turn away."""
    k = some_joint(case, rng, bearing=True)
    name = headers(case, "q")[k]
    by = float(rng.choice([-1.0, 1.0])) * math.pi / 2.0
    return with_columns(case, f"{name} counts from another zero", **{name: case.columns[name] + in_unit_of(name, by)})


def odd_zero(case: Case, rng: Rng) -> Case:
    """A zero at any angle."""
    k = some_joint(case, rng, bearing=True)
    name = headers(case, "q")[k]
    by = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 1.3))
    return with_columns(case, f"{name} counts from another zero", **{name: case.columns[name] + in_unit_of(name, by)})


def swapped(case: Case, rng: Rng) -> Case:
    """Two joints that changed places."""
    one = some_joint(case, rng, bearing=True)
    other = one + 1 if one + 1 < case.machine.size else one - 1
    columns = {}
    for kind in ("q", "dq"):
        if names := headers(case, kind):
            columns |= {names[one]: case.columns[names[other]], names[other]: case.columns[names[one]]}
    first, second = sorted((one + 1, other + 1))
    return with_columns(case, f"q{first}_.* and q{second}_.* have changed places", **columns)


def swapped_torques(case: Case, rng: Rng) -> Case:
    """Two torques that changed places."""
    one = some_joint(case, rng, bearing=True)
    other = one + 1 if one + 1 < case.machine.size else one - 1
    names = headers(case, "tau")
    columns = {names[one]: case.columns[names[other]], names[other]: case.columns[names[one]]}
    first, second = (names[k] for k in sorted((one, other)))
    return with_columns(case, f"{first} and {second} have changed places", **columns)


def absolute(case: Case, rng: Rng) -> Case:
    """An angle that holds its neighbour's."""
    names = headers(case, "q")
    k = int(rng.integers(1, min(3, len(names))))
    return with_columns(
        case,
        f"{names[k]} holds {names[k - 1]} as well",
        **{names[k]: case.columns[names[k]] + case.columns[names[k - 1]]},
    )


def angles_in_radians(case: Case, rng: Rng) -> Case:
    """All angles in the other unit."""
    del rng
    names = headers(case, "q")
    by = math.pi / 180.0 if not case.motion else 180.0 / math.pi
    return with_columns(
        case,
        r"seem to be in (rad|deg)|is it in degrees|as of angles in degrees",
        **{n: by * case.columns[n] for n in names},
    )


def metres(case: Case, rng: Rng) -> Case:
    """Tips in another unit of length."""
    by = float(rng.choice([1e-3, 0.1, 1.0 / 25.4]))
    names = [n for n in case.columns if n[0] in "xyz"]
    unit = {1e-3: "m", 0.1: "cm", 1.0 / 25.4: "in"}[by]
    return with_columns(case, f"seem to be in {unit}\\b", **{n: by * case.columns[n] for n in names})


def mirrored(case: Case, rng: Rng) -> Case:
    """An axis of the tip that points the other way."""
    del rng
    return with_columns(case, "left-handed", y_mm=-case.columns["y_mm"])


def late(case: Case, rng: Rng) -> Case:
    """Tips a few rows beside their joints."""
    by = int(rng.choice([-2, -1, 1, 2]))
    names = [n for n in case.columns if n[0] in "xyz"]
    return with_columns(case, "the tips stand", **{n: np.roll(case.columns[n], by) for n in names})


def steps(case: Case, rng: Rng) -> Case:
    """Steps per degree that are wrong: a joint turns so many times what is told."""
    k = some_joint(case, rng)
    name = headers(case, "q")[k]
    by = float(rng.choice([1.36, 0.72, 1.8, 0.5]))
    return sized(with_columns(case, (), **{name: case.columns[name] / by}), rf"turns ([-\d.]+) times .*?{name}", by)


def coupling(case: Case, rng: Rng) -> Case:
    """A joint that the one before takes along by a part."""
    names = headers(case, "q")
    k = int(rng.integers(1, min(3, len(names))))
    by = float(rng.choice([-0.25, 0.4, -0.5, 0.3]))
    columns = {names[k]: case.columns[names[k]] - by * case.columns[names[k - 1]]}
    return sized(with_columns(case, (), **columns), rf"turns by ([-\d.]+) of {names[k - 1]}", by)


def soft(case: Case, rng: Rng) -> Case:
    """A position loop that gives way by a third of a radian or more; the angles are those told."""
    q = case.extra["q"]
    weights = case.machine.weights(q)
    k = int(np.argmax(np.abs(weights).max(axis=0)))
    name = headers(case, "q")[k]
    by = float(rng.uniform(0.35, 0.6)) / float(np.abs(weights[:, k]).max())
    told = case.columns[name] + in_unit_of(name, 1.0) * by * weights[:, k]
    arm = case.machine.file()
    case = sized(with_columns(case, (), **{name: told}), rf"joint {k + 1} gives way by ([-\d.e]+) rad", by)
    return replace(case, arm=arm)


def turned_frame(case: Case, rng: Rng) -> Case:
    """A frame that is said to be the arm's and is not."""
    names = [n for n in case.columns if n[0] in "xyz"]
    angle = float(rng.uniform(0.5, 2.5))
    c, s = math.cos(angle), math.sin(angle)
    x, y = case.columns["x_mm"], case.columns["y_mm"]
    moved = {names[0]: c * x - s * y + 150.0, names[1]: s * x + c * y - 80.0}
    return replace(with_columns(case, "another frame|frame turned by", **moved), settings="frame: known\ntool: known\n")


def in_torques(case: Case) -> Case:
    """The case with torques in place of currents, whose free constants would hide a unit."""
    kept = {n: c for n, c in case.columns.items() if not n.startswith(("tau", "current"))}
    torques = {f"tau{k + 1}_Nm": case.extra["torque"][:, k] for k in range(case.machine.size)}
    return replace(case, columns=kept | torques, settings="observes: motion\n")


def torque_sign(case: Case, rng: Rng) -> Case:
    """A torque that counts the other way."""
    name = headers(case, "tau")[some_joint(case, rng, bearing=True)]
    return with_columns(case, f"{name} counts the other way", **{name: -case.columns[name]})


def motors(case: Case, rng: Rng) -> Case:
    """Torques of the motors."""
    by, case = rng.uniform(50.0, 120.0), in_torques(case)
    return with_columns(case, "gear_ratios|of the motor", **{n: case.columns[n] / by for n in headers(case, "tau")})


def newton_millimetres(case: Case, rng: Rng) -> Case:
    """Torques in N mm."""
    del rng
    case = in_torques(case)
    return with_columns(case, r"/1000", **{n: 1e3 * case.columns[n] for n in headers(case, "tau")})


def gravity(case: Case, rng: Rng) -> Case:
    """An arm file that stands otherwise."""
    lines = case.arm.splitlines()
    side = "[9.81 m/s^2, 0 m/s^2, 0 m/s^2]" if rng.random() < 0.5 else "[0 m/s^2, 9.81 m/s^2, 0 m/s^2]"
    lines = [f"gravity: {side}" if line.startswith("gravity:") else line for line in lines]
    return replace(case, arm="\n".join(lines) + "\n", says=(*case.says, "gravity acts along|counts from another zero"))


def clipped(case: Case, rng: Rng) -> Case:
    """A torque that its sensor or its driver clips."""
    name = headers(case, "tau")[some_joint(case, rng, bearing=True)]
    values = case.columns[name]
    low, high = np.quantile(values, [0.06, 0.92])
    return with_columns(case, f"{name}.*clipped", **{name: np.clip(values, low, high)})


def lagging(case: Case, rng: Rng) -> Case:
    """Speeds by a causal filter."""
    interval = float(np.median(np.diff(case.columns["t_s"])))
    b, a = np.asarray(butter(2, float(rng.uniform(2.0, 4.0)), fs=1.0 / interval, output="ba"), dtype=float)
    late = np.asarray(lfilter(b, a, case.extra["v"], axis=0), dtype=float)
    columns = {f"dq{k + 1}_radps": late[:, k] for k in range(case.machine.size)}
    return with_columns(case, r"lag.* by .*ms", **columns)


def speeds_sign(case: Case, rng: Rng) -> Case:
    """A speed that counts the other way."""
    k = some_joint(case, rng)
    speeds = {f"dq{j + 1}_radps": case.extra["v"][:, j] for j in range(case.machine.size)}
    name = f"dq{k + 1}_radps"
    return with_columns(case, f"{name}: is -", **{**speeds, name: -speeds[name]})


def speeds_in_degrees(case: Case, rng: Rng) -> Case:
    """Speeds in deg/s."""
    del rng
    speeds = {f"dq{j + 1}_radps": np.degrees(case.extra["v"][:, j]) for j in range(case.machine.size)}
    return with_columns(case, r"57\.", **speeds)


def voltages(case: Case, rng: Rng) -> Case:
    """PWM in place of current, of drives that friction and speed govern: no constant is known."""
    v, torque = case.extra["v"], case.extra["torque"]
    size = np.std(torque, axis=0)
    pwm = 0.15 * torque / size + 1.5 * v / np.std(v, axis=0) + 0.4 * np.tanh(v / 0.02)
    pwm = pwm + 0.05 * rng.normal(size=pwm.shape)
    columns = {n: c for n, c in case.columns.items() if n.rpartition("_")[0][:3] not in ("tau", "cur")}
    columns |= {f"current{k + 1}_A": pwm[:, k] for k in range(case.machine.size)}
    columns |= {f"dq{k + 1}_radps": v[:, k] for k in range(case.machine.size)}
    says = (
        *case.says,
        r"torque constant|torque_constants",
        r"^(?!.*(in deg|gravity acts|other way|changed places)).*$",
    )
    return replace(case, columns=columns, settings="observes: motion\ntorque_constants: free\n", says=says)


TIPS: Mapping[str, Spoil] = MappingProxyType({
    "sign": sign, "quarter zero": quarter, "odd zero": odd_zero, "swapped": swapped, "absolute": absolute,
    "unit of angle": angles_in_radians, "unit of length": metres, "mirrored": mirrored, "late": late,
    "steps": steps, "coupling": coupling, "soft loop": soft, "frame": turned_frame,
})  # fmt: skip
LOGS: Mapping[str, Spoil] = MappingProxyType({
    "sign": sign, "torque's sign": torque_sign, "quarter zero": quarter, "swapped": swapped,
    "swapped torques": swapped_torques, "unit of angle": angles_in_radians, "motors": motors,
    "N mm": newton_millimetres, "gravity": gravity, "clipped": clipped, "lagging speeds": lagging,
    "speeds' sign": speeds_sign, "speeds' unit": speeds_in_degrees, "voltages": voltages,
})  # fmt: skip
PAIRS: tuple[tuple[bool, str, str], ...] = (
    (False, "sign", "quarter zero"), (False, "steps", "steps"), (False, "sign", "steps"),
    (False, "swapped", "mirrored"), (False, "quarter zero", "coupling"), (False, "unit of length", "sign"),
    (True, "sign", "torque's sign"), (True, "quarter zero", "torque's sign"),
    (True, "swapped torques", "torque's sign"), (True, "clipped", "torque's sign"),
)  # fmt: skip
