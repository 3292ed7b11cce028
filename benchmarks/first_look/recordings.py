"""Recordings of tips and motion logs of the first look's table: sound ones, and mistakes put into them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from .arms import Array, Machine, machine


@dataclass(frozen=True)
class Case:
    """Files of a case: the arm's, the columns of the table by header, the settings; and `says`, patterns of which each
    must be in what is said, `sizes` those whose group is a number, and which (give or take 5 %)."""

    arm: str
    columns: Mapping[str, Array]
    settings: str
    machine: Machine
    motion: bool
    says: tuple[str, ...] = ()
    sizes: tuple[tuple[str, float], ...] = ()
    extra: Mapping[str, Array] = field(default_factory=dict)


Spoil = Callable[[Case, np.random.Generator], Case]


def tips(rng: np.random.Generator) -> Case:
    """A sound recording of a tip: errors of geometry, drives that give way, play, noise."""
    kind = str(rng.choice(["plane", "desktop", "cobot"]))
    arm = machine(kind, rng)
    count = int(rng.integers(30, 80))
    q = rng.uniform(-1.4, 1.4, (count, arm.size)) * rng.uniform(0.5, 1.0)
    q[:, 0] *= 1.5
    if rng.random() < 0.3:  # along a path
        phase = np.linspace(0.0, 1.0, count)[:, None] * rng.uniform(2.0, 9.0, arm.size) + rng.uniform(0, 6, arm.size)
        q = rng.uniform(0.4, 1.2, arm.size) * np.sin(phase)
    coarse = 10.0 if kind == "desktop" else 1.0
    weights = arm.weights(q)
    heaviest = np.abs(weights).max()
    true = q + coarse * np.radians(rng.normal(0.0, 0.05, arm.size))
    true = true - rng.uniform(0.0, 5e-4 * coarse) * weights / heaviest * rng.uniform(0.3, 1.0, arm.size)
    true = true + 1e-4 * coarse * np.sin(rng.integers(1, 4) * q + rng.uniform(0, 6, arm.size))
    true = true + 0.5e-4 * coarse * rng.choice([-1.0, 1.0], q.shape)
    links = arm.links * (1.0 + rng.normal(0.0, 1e-3 * min(coarse, 3.0), (arm.size, 1)))
    tip = arm.tip(true, links) + rng.normal(0.0, 3e-5 * coarse, (count, 3))
    columns = {f"q{k + 1}_deg": np.degrees(q[:, k]) for k in range(arm.size)}
    width = 2 if kind == "plane" else 3
    free = width == 3 and rng.random() < 0.35
    settings = "frame: known\ntool: known\n"
    if free:
        from scipy.spatial.transform import Rotation

        tip = Rotation.from_euler("xyz", rng.uniform([-0.6, -0.6, 1.4], [0.6, 0.6, 2.6])).apply(
            tip - rng.uniform(-2, 2, 3)
        )
        settings = "frame: free\ntool: free\n"
    columns |= {f"{'xyz'[k]}_mm": 1e3 * tip[:, k] for k in range(width)}
    return Case(arm.file(weighs=bool(rng.random() < 0.7)), columns, settings, arm, False, extra={"q": q, "true": true})


def logs(rng: np.random.Generator) -> Case:
    """A sound motion log: masses that the file has wrong, friction of several kinds, rotors, springs, ripple, noise;
    torques, or currents with constants or without."""
    kind = str(rng.choice(["plane", "desktop", "cobot"]))
    arm = machine(kind, rng)
    rate = float(rng.choice([50.0, 100.0, 200.0]))
    time = np.arange(int(20.0 * rate)) / rate
    q, v, a = (np.zeros((len(time), arm.size)) for _ in range(3))
    middle = rng.uniform(-0.6, 0.6, arm.size)
    for _ in range(int(rng.integers(1, 4))):
        speed, phase = rng.uniform(0.4, 2.0, arm.size), rng.uniform(0.0, 6.3, arm.size)
        size = rng.uniform(0.15, 0.6, arm.size)
        at = time[:, None] * speed + phase
        q, v, a = q + size * np.sin(at), v + size * speed * np.cos(at), a - size * speed**2 * np.sin(at)
    q = q + middle
    inner = arm.torques(q, v, a)
    scale = np.maximum(np.std(inner, axis=0), 0.05 * np.std(inner, axis=0).max())
    torque = inner + rng.uniform(0.05, 0.35, arm.size) * scale * np.tanh(v / 0.01)
    torque = torque + rng.uniform(0.0, 0.2, arm.size) * scale * v + rng.uniform(0.0, 0.03, arm.size) * scale * a
    if rng.random() < 0.4:
        torque = torque + 0.1 * scale * np.exp(-((v / 0.08) ** 2)) * np.tanh(v / 0.01)
    if rng.random() < 0.4:
        torque = torque + 0.1 * scale * rng.uniform(-1, 1, arm.size) * np.sin(q * rng.integers(1, 3) + 0.3)
    if rng.random() < 0.3:
        torque = torque + 0.04 * scale * np.sin(rng.integers(20, 60) * q)
    if rng.random() < 0.3:
        torque = torque + 0.1 * scale * rng.normal(size=arm.size)
    torque = torque + 0.02 * scale * rng.normal(size=torque.shape)
    quiet = q + 1e-5 * rng.normal(size=q.shape)
    speeds = v + 2e-3 * rng.normal(size=q.shape)
    columns = {"t_s": time} | {f"q{k + 1}_rad": quiet[:, k] for k in range(arm.size)}
    if rng.random() < 0.7:
        columns |= {f"dq{k + 1}_radps": speeds[:, k] for k in range(arm.size)}
    settings = "observes: motion\n"
    drives = str(rng.choice(["torque", "torque", "constants", "free"]))
    constants = np.ones(arm.size) if drives == "torque" else rng.uniform(0.5, 15.0, arm.size)
    name = "tau{}_Nm" if drives == "torque" else "current{}_A"
    columns |= {name.format(k + 1): torque[:, k] / constants[k] for k in range(arm.size)}
    if drives == "constants":
        settings += f"torque_constants: [{', '.join(f'{item:.7g}' for item in constants)}]\n"
    elif drives == "free":
        settings += "torque_constants: free\n"
    file = arm.file(rng.uniform(0.8, 1.25, arm.size), 4.0 * np.abs(inner).max(axis=0))
    return Case(file, columns, settings, arm, True, extra={"q": q, "v": v, "a": a, "torque": torque})


def with_columns(case: Case, says: str | tuple[str, ...], **columns: Array) -> Case:
    """A case with other columns and what must be said of them."""
    more = (says,) if isinstance(says, str) else says
    return replace(case, columns={**case.columns, **columns}, says=(*case.says, *more))


def sized(case: Case, pattern: str, value: float) -> Case:
    """A case of which a number must be said too."""
    return replace(case, sizes=(*case.sizes, (pattern, value)))


def headers(case: Case, kind: str) -> list[str]:
    """The headers of a kind (`q`, `dq`, `tau`) joint by joint; torques' are those of currents too."""
    kinds = ("tau", "current") if kind == "tau" else (kind,)
    return [
        name
        for k in range(case.machine.size)
        for name in case.columns
        if any(name.rpartition("_")[0] == f"{each}{k + 1}" for each in kinds)
    ]


def some_joint(case: Case, rng: np.random.Generator, *, bearing: bool = False) -> int:
    """A joint (from 0) that shows: not the last one's roll, and where asked one that bears weight."""
    weights = np.std(case.machine.weights(case.extra["q"]), axis=0)
    heavy = np.flatnonzero(weights > (0.15 if bearing else 0.0) * weights.max())
    candidates = heavy[heavy < (3 if case.machine.size > 3 else case.machine.size)]
    return int(rng.choice(candidates))


def in_unit_of(name: str, angle: float) -> float:
    """An angle (rad) in a column's unit."""
    return math.degrees(angle) if name.endswith("_deg") else angle
