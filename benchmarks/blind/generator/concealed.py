"""The physics that can be concealed: each law gives its departure at given parameters, torques and histories.

The definitions are those of the field, as the table of effects states them; what acts on the arm is solved exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from benchmarks.blind.generator.designs import Design
from benchmarks.blind.generator.mechanics import Arm, Solution
from benchmarks.blind.generator.perturbation import Departure, nothing
from benchmarks.blind.generator.play import approached, backlash, pressed
from benchmarks.blind.generator.thermal import crept, lagged
from benchmarks.blind.generator.vectors import Array, cross, dot

Parameters = Mapping[str, float]


@dataclass(frozen=True)
class Effect:
    """One concealed effect: id, where (numbers from 1; empty: the whole), parameters SI, and the one that doses it."""

    effect: str
    at: tuple[int, ...]
    dose: str
    parameters: dict[str, float]

    def dosed(self, factor: float) -> Effect:
        """The effect with its dose scaled (with all amplitudes that go with it)."""
        names = {self.dose, *AMPLITUDES.get(self.effect, ())}
        values = {k: v * factor if k in names else v for k, v in self.parameters.items()}
        return replace(self, parameters=values)


AMPLITUDES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "encoder_eccentricity": ("sine", "cosine"),
        "gear_transmission_error": ("sine", "cosine"),
        "tool_offset": ("a", "b", "c"),
        "base_tilt": ("x", "y", "z"),
        "frame_misalignment": ("x", "y", "z", "rotation"),
        "frame_drift": ("x", "y", "z", "rotation"),
        "friction_windup": ("coulomb", "proportional"),
    }
)
GLOBAL = frozenset(
    {
        "payload",
        "tool_offset",
        "base_tilt",
        "base_compliance",
        "frame_misalignment",
        "frame_drift",
        "instrument_scale",
        "latency",
    }
)
UNIFORM = frozenset({"slope_propagation", "shear_deformation"})  # concealed by leaving them out of the arm file


@dataclass(frozen=True)
class Scene:
    """An arm at work in a recording, as it stands: torques and forces come from the latest solution."""

    arm: Arm
    design: Design
    solution: Solution
    run_up: float = 0.035


def height_angle(scene: Scene, joint: int) -> Array:
    """phi of a link: the sum of the turns about parallel axes up to and with it; about z in the plane."""
    arm = scene.arm
    axis = arm.joints[joint].axis
    turned = [i for i in range(joint + 1) if not arm.joints[i].prismatic and arm.joints[i].axis == axis]
    return scene.design.q[turned].sum(axis=0)


def hardened(torque: Array, parameters: Parameters) -> Array:
    """Wind-up of a drive that stiffens: c t0 tanh(torque/t0), or three zones of falling compliance (zones = 1)."""
    c, t0 = parameters["compliance"], parameters["knee"]
    if parameters.get("zones", 0.0) < 0.5:
        return c * t0 * np.tanh(torque / t0)
    size = np.abs(torque)
    first, second = 0.6 * t0, 1.6 * t0
    wound = np.minimum(size, first)
    wound = wound + 0.45 * np.clip(size - first, 0.0, second - first) + 0.2 * np.clip(size - second, 0.0, None)
    return c * np.sign(torque) * wound


def departure(effect: Effect, scene: Scene) -> Departure:
    """What the effect adds in this scene. Raises ValueError for an unknown id."""
    arm, design, solution = scene.arm, scene.design, scene.solution
    p, m = effect.parameters, design.time.size
    none = nothing(arm, m)
    if effect.effect in UNIFORM:
        return none
    if effect.effect in _WHOLE:
        return _WHOLE[effect.effect](p, scene, none)
    total = none
    for place in effect.at:
        i = place - 1
        field = np.zeros((arm.count, m))
        if effect.effect in _AT_JOINT:
            field[i] = _AT_JOINT[effect.effect](p, scene, i)
            total = total.plus(replace(none, joint=field))
        elif effect.effect == "clearance":
            shift = np.zeros((arm.count, 3, m))
            shift[i] = pressed(solution.carried[i], solution.axis[i], p["radius"])
            total = total.plus(replace(none, shift=shift))
        elif effect.effect in _AT_LINK:
            name, law = _AT_LINK[effect.effect]
            field[i] = law(p, scene, i)
            total = total.plus(replace(none, **{name: field}))
        else:
            raise ValueError(effect.effect)
    return total


def _warm(p: Parameters, scene: Scene) -> Array:
    return lagged(scene.design.air, p["lag"], scene.design.time) - 20.0


def _backlash(p: Parameters, scene: Scene, i: int) -> Array:
    d = scene.design
    return backlash(d.q[i], d.side[i], scene.solution.torque[i], p["total"], p["held_below"], scene.run_up, d.fresh)


def _windup(p: Parameters, scene: Scene, i: int) -> Array:
    d = scene.design
    width = 2.0 * (p["coulomb"] + p["proportional"] * np.abs(scene.solution.torque[i]))
    return approached(d.q[i], d.side[i], width, scene.run_up, d.fresh)


JointLaw = Callable[[Parameters, Scene, int], Array]
WholeLaw = Callable[[Parameters, Scene, Departure], Departure]

_AT_JOINT: Mapping[str, JointLaw] = MappingProxyType(
    {
        "joint_compliance": lambda p, s, i: s.solution.torque[i] * p["compliance"],
        "servo_droop": lambda p, s, i: s.solution.torque[i] * p["compliance"],
        "joint_hardening": lambda p, s, i: hardened(s.solution.torque[i], p),
        "backlash": _backlash,
        "friction_windup": _windup,
        "encoder_offset": lambda p, s, _: np.full(s.design.time.size, p["offset"]),
        "encoder_eccentricity": lambda p, s, i: p["sine"] * np.sin(s.design.q[i]) + p["cosine"] * np.cos(s.design.q[i]),
        "encoder_scale": lambda p, s, i: p["scale"] * s.design.q[i],
        "gear_transmission_error": lambda p, s, i: (
            p["sine"] * np.sin(p["harmonic"] * s.design.q[i]) + p["cosine"] * np.cos(p["harmonic"] * s.design.q[i])
        ),
        "joint_coupling": lambda p, s, i: p["ratio"] * s.design.q[i - 1],
        "gearbox_thermal": lambda p, s, _: p["rate"] * _warm(p, s),
        "creep": lambda p, s, i: s.solution.torque[i] * p["compliance"] * crept(s.design.time, p["time"]),
        "counterbalance": lambda p, s, i: (
            p["spring"] * np.sin(height_angle(s, i) - p["phase"]) * s.arm.joints[i].compliance
        ),
    }
)
_AT_LINK: Mapping[str, tuple[str, JointLaw]] = MappingProxyType(
    {
        "link_bending": ("bending", lambda p, s, _: np.full(s.design.time.size, p["flexibility"])),
        "link_modulus": ("softness", lambda p, s, _: np.full(s.design.time.size, p["softness"])),
        "link_mass": ("line_mass", lambda p, s, i: np.full(s.design.time.size, p["mass"] / s.arm.links[i].length)),
        "link_length": ("axial", lambda p, s, i: np.full(s.design.time.size, p["length"] / s.arm.links[i].length)),
        "thermal_expansion": ("axial", lambda p, s, _: p["expansion"] * _warm(p, s)),
        "thermal_bending": (
            "curvature",
            lambda p, s, i: s.arm.links[i].expansion * p["gradient"] * _warm(p, s) / s.arm.links[i].depth,
        ),
    }
)


def _frame(p: Parameters, scene: Scene, share: Array) -> Array:
    tip = scene.solution.tip
    up = np.zeros_like(tip)
    up[2] = p["rotation"]
    move = np.stack([np.full(tip.shape[1], p[name]) for name in ("x", "y", "z")])
    return share * (move + cross(up, tip))


def _same(values: list[float], m: int) -> Array:
    return np.repeat(np.array(values)[:, None], m, axis=1)


def _base_joint(p: Parameters, s: Scene, none: Departure) -> Departure:
    field = np.zeros_like(none.joint)
    field[0] = s.solution.torque[0] * p["compliance"]
    return replace(none, joint=field)


def _hours(s: Scene) -> Array:
    return (s.design.time - s.design.time[0]) / 3600.0


def _spring(p: Parameters, s: Scene, none: Departure) -> Departure:
    anchor = _same([p["x"], p["y"], p["z"]], s.design.time.size)
    return replace(none, force=-p["rate"] * (s.solution.tip - anchor))


def _magnet(p: Parameters, s: Scene, none: Departure) -> Departure:
    away = s.solution.tip - _same([p["x"], p["y"], p["z"]], s.design.time.size)
    distance = np.sqrt(dot(away, away) + p["core"] ** 2)
    return replace(none, force=-p["pull"] * p["core"] ** 2 * away / distance**3)


def _at_one(p: Parameters, none: Departure, values: Array) -> Departure:
    field = np.zeros_like(none.joint)
    field[int(p["joint"]) - 1] = values
    return replace(none, joint=field)


def _stick(p: Parameters, s: Scene, none: Departure) -> Departure:
    q = s.design.q[int(p["joint"]) - 1]
    inside = np.abs(q - p["centre"]) < p["half_width"]
    return _at_one(p, none, np.where(inside, p["size"], 0.0))


def _cable(p: Parameters, s: Scene, none: Departure) -> Departure:
    rng = np.random.default_rng(int(p["seed"]))
    visits = np.cumsum(s.design.fresh).astype(int) - 1
    walk = np.zeros((3, int(visits[-1]) + 1))
    for k in range(walk.shape[1]):
        walk[:, k] = (0.9 * walk[:, k - 1] if k else 0.0) + 0.44 * rng.standard_normal(3)
    force = p["size"] * walk[:, visits]
    if s.arm.planar:
        force[2] = 0.0
    return replace(none, force=force)


_WHOLE: Mapping[str, WholeLaw] = MappingProxyType(
    {
        "payload": lambda p, s, z: replace(z, payload=np.full(s.design.time.size, p["mass"])),
        "tool_offset": lambda p, s, z: replace(z, tool=_same([p["a"], p["b"], p["c"]], s.design.time.size)),
        "base_tilt": lambda p, s, z: replace(z, tilt=_same([p["x"], p["y"], p["z"]], s.design.time.size)),
        "base_compliance": _base_joint,
        "frame_misalignment": lambda p, s, z: replace(z, reading=_frame(p, s, np.ones(s.design.time.size))),
        "frame_drift": lambda p, s, z: replace(z, reading=_frame(p, s, _hours(s))),
        "instrument_scale": lambda p, s, z: replace(z, reading=p["scale"] * s.solution.tip),
        "latency": lambda p, s, z: replace(z, joint=s.design.speed * p["delay"]),
        # outside the table of effects
        "tip_spring": _spring,
        "tip_magnet": _magnet,
        "slip": lambda p, s, z: _at_one(p, z, np.where(s.design.time >= p["since"], p["size"], 0.0)),
        "periodic_in_time": lambda p, s, z: _at_one(
            p, z, p["size"] * np.sin(2 * np.pi * s.design.time / p["period"] + p["phase"])
        ),
        "stick": _stick,
        "cable_force": _cable,
    }
)
OUTSIDE = ("tip_spring", "tip_magnet", "slip", "periodic_in_time", "stick", "cable_force")
