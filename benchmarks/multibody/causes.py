"""Causes that the library knows, as the engine plays them: each draws a middling size at a place and writes a plan.

Their parameters bear the names that an arm file has for them, so that a stated interval can be held against them; what
they do is the field's definition, played by forces, springs and rests of coordinates.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from benchmarks.blind.generator.vectors import Array
from benchmarks.multibody.engine import Machine
from benchmarks.multibody.session import Plan, Session, Tips

Parameters = Mapping[str, float]


@dataclass(frozen=True)
class Cause:
    """One cause: its id, where (from 1; empty: the whole), its parameters in SI, those that its dose scales."""

    effect: str
    at: tuple[int, ...]
    parameters: Parameters
    scaled: tuple[str, ...]

    def dosed(self, factor: float) -> Cause:
        """The cause larger by a factor."""
        values = {k: v * factor if k in self.scaled else v for k, v in self.parameters.items()}
        return replace(self, parameters=MappingProxyType(values))

    def write(self, plan: Plan) -> None:
        """Makes it part of a plan."""
        KINDS[self.effect].write(plan, self.at[0] - 1 if self.at else 0, self.parameters)


@dataclass(frozen=True)
class Stage:
    """The arm as its file has it, in a session: what draws have to know."""

    machine: Machine
    session: Session
    tips: Tips

    @property
    def torque(self) -> Array:
        """Of the drives (n, v), N*m."""
        return self.tips.load[list(self.machine.drive)]


@dataclass(frozen=True)
class Kind:
    """How a cause is drawn and played. `needs`: sides, payloads, time, plane, space, links, drives; least and greatest
    value of its first scaled parameter's size."""

    draw: Callable[[Stage, np.random.Generator], tuple[tuple[int, ...], dict[str, float]]]
    write: Callable[[Plan, int, Parameters], None]
    scaled: tuple[str, ...]
    greatest: float
    needs: frozenset[str] = frozenset()
    geometric: bool = False


def _sign(rng: np.random.Generator) -> float:
    return 1.0 if rng.random() < 0.5 else -1.0


def loaded_joint(stage: Stage, rng: np.random.Generator, first: int = 0) -> int:
    """A joint (from 0) that carries some of the load."""
    size = np.sqrt(np.mean(stage.torque**2, axis=1))
    return int(rng.choice([i for i in range(first, size.size) if size[i] > 0.05 * size.max()]))


def any_joint(stage: Stage, rng: np.random.Generator, first: int = 0) -> int:
    """Any joint (from 0)."""
    return int(rng.integers(first, stage.machine.arm.count))


def elastic_link(stage: Stage, rng: np.random.Generator) -> int:
    """A link (from 0) that bends."""
    return int(rng.choice([i for i, nodes in enumerate(stage.machine.nodes) if nodes]))


def _most(stage: Stage, joint: int) -> float:
    return max(float(np.abs(stage.torque[joint]).max()), 1e-3)


def turn_drive(plan: Plan, joint: int, amount: Array | float) -> None:
    """Turns a joint beyond what its encoder reads."""
    plan.rest[plan.machine.drive[joint]] += amount


# Drives


def _draw_compliance(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    i = loaded_joint(stage, rng)
    return (i + 1,), {"compliance": 2e-4 / _most(stage, i)}


def _compliance(plan: Plan, i: int, p: Parameters) -> None:
    plan.compliance[plan.machine.drive[i]] += p["compliance"]


def _draw_hardening(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    at, values = _draw_compliance(stage, rng)
    return at, values | {"knee": round(_most(stage, at[0] - 1) * float(rng.uniform(0.15, 0.4)), 3)}


def _hardening(plan: Plan, i: int, p: Parameters) -> None:
    drive = plan.machine.drive[i]
    plan.laws.append(lambda load, v, past: [(drive, p["compliance"] * p["knee"] * math.tanh(load[drive] / p["knee"]))])


def _draw_backlash(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    i = any_joint(stage, rng)
    held = float(rng.choice([0.0, 0.3, 1.3])) * _most(stage, i)
    return (i + 1,), {"total": 2e-4, "held_below": round(held, 2)}


def _backlash(plan: Plan, i: int, p: Parameters) -> None:
    drive, side = plan.machine.drive[i], plan.session.side[i]

    def law(load: Array, v: int, past: object) -> list[tuple[int, float]]:
        torque = float(load[drive])
        way = math.copysign(1.0, torque) if abs(torque) >= p["held_below"] else -float(side[v])
        return [(drive, 0.5 * p["total"] * way)]

    plan.laws.append(law)


def _draw_windup(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    i = loaded_joint(stage, rng)
    return (i + 1,), {"windup": 5e-5, "windup_per_load": 1e-4 / _most(stage, i)}


def _windup(plan: Plan, i: int, p: Parameters) -> None:
    drive, side = plan.machine.drive[i], plan.session.side[i]

    def law(load: Array, v: int, past: object) -> list[tuple[int, float]]:
        return [(drive, -float(side[v]) * (p["windup"] + p["windup_per_load"] * abs(float(load[drive]))))]

    plan.laws.append(law)


def _draw_creep(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    at, values = _draw_compliance(stage, rng)
    length = float(stage.session.loaded_for.max())
    return at, values | {"time_constant": round(length * float(rng.uniform(0.2, 0.6)), 0)}


def _creep(plan: Plan, i: int, p: Parameters) -> None:
    drive = plan.machine.drive[i]
    share = 1.0 - np.exp(-plan.session.loaded_for / p["time_constant"])
    plan.laws.append(lambda load, v, past: [(drive, p["compliance"] * float(share[v]) * float(load[drive]))])


def _draw_clearance(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    return (any_joint(stage, rng) + 1,), {"radius": 4e-5}


def _clearance(plan: Plan, i: int, p: Parameters) -> None:
    seat, axis = list(plan.machine.seat[i]), np.array(plan.machine.arm.joints[i].axis, dtype=float)

    def law(load: Array, v: int, past: object) -> list[tuple[int, float]]:
        push = load[seat] - axis * float(axis @ load[seat])
        size = float(np.linalg.norm(push))
        if size < 1e-9:
            return []
        return [(k, float(p["radius"] * push[n] / size)) for n, k in enumerate(seat)]

    plan.laws.append(law)


# Angles


def _of_joint(name: str, size: float, first: int = 0) -> Callable[..., tuple[tuple[int, ...], dict[str, float]]]:
    def draw(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
        return (any_joint(stage, rng, first) + 1,), {name: size * _sign(rng)}

    return draw


def _draw_wave(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    phase = float(rng.uniform(0.0, 2.0 * math.pi))
    return (any_joint(stage, rng) + 1,), {"sine": 2e-4 * math.cos(phase), "cosine": 2e-4 * math.sin(phase)}


def _draw_gear(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    at, values = _draw_wave(stage, rng)
    return at, values | {"order": float(rng.integers(2, 9))}


def _wave(plan: Plan, i: int, p: Parameters) -> None:
    angle = p.get("order", 1.0) * plan.session.q[i]
    turn_drive(plan, i, p["sine"] * np.sin(angle) + p["cosine"] * np.cos(angle))


def _draw_counterbalance(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    phase = float(rng.uniform(0.0, 2.0 * math.pi))
    i = int(rng.integers(0, stage.machine.arm.count))
    return (i + 1,), {"sine": 3e-4 * math.cos(phase), "cosine": 3e-4 * math.sin(phase)}


def _counterbalance(plan: Plan, i: int, p: Parameters) -> None:
    phi = plan.session.q[: i + 1].sum(axis=0)
    turn_drive(plan, i, p["sine"] * np.sin(phi) + p["cosine"] * np.cos(phi))


# Geometry


def _draw_length(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    return (any_joint(stage, rng) + 1,), {"length": 3e-4 * _sign(rng)}


def _length(plan: Plan, i: int, p: Parameters) -> None:
    plan.rest[plan.machine.stretch[i]] += p["length"]


def _draw_tool(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    phase = float(rng.uniform(0.0, 2.0 * math.pi))
    return (), {"along": 3e-4 * math.cos(phase), "across": 3e-4 * math.sin(phase)}


def _tool(plan: Plan, i: int, p: Parameters) -> None:
    for coordinate, name in zip(plan.machine.tool, ("along", "across"), strict=False):
        plan.rest[coordinate] += p[name]


def _draw_askew(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    phase = float(rng.uniform(0.0, 2.0 * math.pi))
    i = int(rng.integers(1, stage.machine.arm.count))
    return (i + 1,), {"tilt_u": 3e-4 * math.cos(phase), "tilt_v": 3e-4 * math.sin(phase)}


def _askew(plan: Plan, i: int, p: Parameters) -> None:
    axis = np.array(plan.machine.arm.joints[i].axis, dtype=float)
    hint = np.array([1.0, 0.0, 0.0]) if abs(axis[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    u = np.cross(axis, hint)
    u /= np.linalg.norm(u)
    turn = p["tilt_u"] * u + p["tilt_v"] * np.cross(axis, u)
    for coordinate, amount in zip(plan.machine.tilt[i], turn, strict=True):
        plan.rest[coordinate] += float(amount)


# Loads, the base, warmth


def _draw_mass(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    return (int(rng.integers(0, stage.machine.arm.count)) + 1,), {"mass": 0.5 * _sign(rng)}


def _mass(plan: Plan, i: int, p: Parameters) -> None:
    plan.extra_mass[i] += p["mass"]


def _draw_payload(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    return (), {"mass": 0.3}


def _payload(plan: Plan, i: int, p: Parameters) -> None:
    plan.payload = plan.payload + p["mass"]


def _draw_modulus(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    return (elastic_link(stage, rng) + 1,), {"excess": 0.06 * _sign(rng)}


def _modulus(plan: Plan, i: int, p: Parameters) -> None:
    for node in plan.machine.nodes[i]:
        plan.compliance[list(node)] /= 1.0 + p["excess"]


def _draw_tilt(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    if stage.machine.arm.planar:
        return (), {"about_z": 8e-3 * _sign(rng)}
    phase = float(rng.uniform(0.0, 2.0 * math.pi))
    return (), {"about_x": 8e-3 * math.cos(phase), "about_y": 8e-3 * math.sin(phase)}


def _tilt(plan: Plan, i: int, p: Parameters) -> None:
    turn = np.array([p.get(f"about_{k}", 0.0) for k in "xyz"])
    plan.gravity = plan.gravity + np.cross(plan.gravity, turn)


def _draw_base(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    return (), {"compliance": 2e-4 / max(float(np.abs(stage.torque).max()), 1e-3)}


def _base(plan: Plan, i: int, p: Parameters) -> None:
    plan.compliance[list(plan.machine.base[3:] if plan.machine.arm.planar else plan.machine.base[3:5])] += p[
        "compliance"
    ]


def _lag(rng: np.random.Generator) -> float:
    return 0.0 if rng.random() < 0.3 else round(float(rng.uniform(0.3, 1.5)) * 3600.0, 0)


def _draw_expansion(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    return (any_joint(stage, rng) + 1,), {"expansion": 2e-5, "lag": _lag(rng)}


def _expansion(plan: Plan, i: int, p: Parameters) -> None:
    length = plan.machine.arm.links[i].length
    plan.rest[plan.machine.stretch[i]] += p["expansion"] * length * plan.session.warming(p["lag"])


def _draw_gearbox(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    return (any_joint(stage, rng) + 1,), {"per_kelvin": 2e-5 * _sign(rng), "lag": _lag(rng)}


def _gearbox(plan: Plan, i: int, p: Parameters) -> None:
    turn_drive(plan, i, p["per_kelvin"] * plan.session.warming(p["lag"]))


# The frame and the instrument


def _draw_drift(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    hour = 1.0 / 3600.0
    way = rng.standard_normal(3)
    way[2] *= 0.0 if stage.machine.arm.planar else 1.0
    way /= np.linalg.norm(way)
    values = {name: float(6e-5 * hour * w) for name, w in zip("xyz", way, strict=True) if w}
    return (), values | {"about_z": 3e-5 * hour * _sign(rng)}


def _drift(plan: Plan, i: int, p: Parameters) -> None:
    time = plan.session.time
    shift = np.array([p.get(k, 0.0) for k in "xyz"])[:, None] * time

    def read(tips: Array, rests: object) -> Array:
        turned = np.stack([-tips[1], tips[0], np.zeros_like(time)])
        return shift + p["about_z"] * time * turned

    plan.readings.append(read)


def _draw_scale(stage: Stage, rng: np.random.Generator) -> tuple[tuple[int, ...], dict[str, float]]:
    return (), {"scale": 1e-4 * _sign(rng)}


def _scale(plan: Plan, i: int, p: Parameters) -> None:
    plan.readings.append(lambda tips, rests: p["scale"] * tips)


def _kind(
    draw: Callable[..., tuple[tuple[int, ...], dict[str, float]]],
    write: Callable[[Plan, int, Parameters], None],
    scaled: str,
    greatest: float,
    needs: str = "",
    *,
    geometric: bool = False,
) -> Kind:
    return Kind(draw, write, tuple(scaled.split()), greatest, frozenset(needs.split()), geometric)


KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        "joint_compliance": _kind(_draw_compliance, _compliance, "compliance", 1e-3),
        "joint_hardening": _kind(_draw_hardening, _hardening, "compliance", 1e-3, "payloads"),
        "backlash": _kind(_draw_backlash, _backlash, "total", 5e-3, "sides"),
        "friction_windup": _kind(_draw_windup, _windup, "windup windup_per_load", 2e-3, "sides"),
        "creep": _kind(_draw_creep, _creep, "compliance", 1e-3, "payloads"),
        "clearance": _kind(_draw_clearance, _clearance, "radius", 5e-4),
        "encoder_offset": _kind(
            _of_joint("offset", 3e-4),
            lambda plan, i, p: turn_drive(plan, i, p["offset"]),
            "offset",
            5e-3,
            geometric=True,
        ),
        "encoder_scale": _kind(
            _of_joint("scale", 2e-4),
            lambda plan, i, p: turn_drive(plan, i, p["scale"] * plan.session.q[i]),
            "scale",
            5e-3,
        ),
        "encoder_eccentricity": _kind(_draw_wave, _wave, "sine cosine", 5e-3),
        "gear_transmission_error": _kind(_draw_gear, _wave, "sine cosine", 5e-3),
        "joint_coupling": _kind(
            _of_joint("coupling", 3e-4, 1),
            lambda plan, i, p: turn_drive(plan, i, p["coupling"] * plan.session.q[i - 1]),
            "coupling",
            1e-2,
        ),
        "counterbalance": _kind(_draw_counterbalance, _counterbalance, "sine cosine", 1e-2, "plane drives"),
        "link_length": _kind(_draw_length, _length, "length", 5e-3, geometric=True),
        "tool_offset": _kind(_draw_tool, _tool, "along across", 5e-3, "plane", geometric=True),
        "axis_misalignment": _kind(_draw_askew, _askew, "tilt_u tilt_v", 5e-3, "space", geometric=True),
        "link_mass": _kind(_draw_mass, _mass, "mass", 8.0),
        "payload": _kind(_draw_payload, _payload, "mass", 5.0),
        "link_modulus": _kind(_draw_modulus, _modulus, "excess", 0.35, "links"),
        "base_tilt": _kind(_draw_tilt, _tilt, "about_x about_y about_z", 0.04, "payloads"),
        "base_compliance": _kind(_draw_base, _base, "compliance", 1e-3),
        "thermal_expansion": _kind(_draw_expansion, _expansion, "expansion", 3e-5),
        "gearbox_thermal": _kind(_draw_gearbox, _gearbox, "per_kelvin", 2e-4),
        "frame_drift": _kind(_draw_drift, _drift, "x y z about_z", 1e-6),
        "instrument_scale": _kind(_draw_scale, _scale, "scale", 2e-3, geometric=True),
    }
)


def possible(effect: str, stage: Stage) -> bool:
    """Whether the arm and the session can have and show it."""
    needs, arm = KINDS[effect].needs, stage.machine.arm
    has = {
        "sides": stage.session.design in ("full", "sides"),
        "payloads": stage.session.design in ("full", "payloads"),
        "plane": arm.planar,
        "space": not arm.planar,
        "links": any(stage.machine.nodes),
        "drives": any(j.compliance > 0.0 for j in arm.joints),
    }
    return all(has[need] for need in needs)


def credible(cause: Cause, stage: Stage) -> bool:
    """Whether an arm can have it: no link weighs less than half of what its file says."""
    if cause.effect != "link_mass":
        return True
    link = stage.machine.arm.links[cause.at[0] - 1]
    return cause.parameters["mass"] > -0.5 * link.line_mass * link.length


def draw_cause(effect: str, stage: Stage, rng: np.random.Generator) -> Cause:
    """The cause at a drawn place, of a middling size."""
    kind = KINDS[effect]
    at, values = kind.draw(stage, rng)
    return Cause(effect, at, MappingProxyType(values), tuple(name for name in kind.scaled if name in values))
