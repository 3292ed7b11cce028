"""Effects drawn at plausible sizes: parameters, where they can sit, and what a recording of them must hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.blind.generator.arms import Ranges
from benchmarks.blind.generator.concealed import Effect, Scene

ANY = ("links", "drives", "bodies")
GOOD = ("full", "two_payloads", "two_sides", "moving")
LOADS = ("full", "two_payloads", "moving")
SIDES = ("full", "two_sides", "moving")


@dataclass(frozen=True)
class Recipe:
    """What an effect needs, and the least and greatest plausible factor on its drawn dose."""

    stiffness: tuple[str, ...] = ANY
    designs: tuple[str, ...] = GOOD
    planar_only: bool = False
    not_rail: bool = False
    least: float = 1e-3
    greatest: float = 30.0


_RECIPES: tuple[tuple[str, Recipe], ...] = (
    ("joint_compliance", Recipe(designs=LOADS)),
    ("joint_hardening", Recipe(designs=LOADS)),
    ("backlash", Recipe(designs=SIDES)),
    ("friction_windup", Recipe(designs=("full", "moving"))),
    ("clearance", Recipe(designs=("forced",), greatest=4.0)),
    ("encoder_offset", Recipe()),
    ("encoder_eccentricity", Recipe()),
    ("encoder_scale", Recipe()),
    ("gear_transmission_error", Recipe()),
    ("joint_coupling", Recipe()),
    ("link_bending", Recipe(stiffness=("bodies",), designs=LOADS)),
    ("link_modulus", Recipe(stiffness=("links", "drives"), designs=LOADS, least=0.01, greatest=3.0)),
    ("slope_propagation", Recipe(stiffness=("links",), designs=LOADS, least=1.0, greatest=1.0)),
    ("link_mass", Recipe(designs=LOADS, greatest=4.0)),
    ("link_length", Recipe()),
    ("payload", Recipe(designs=LOADS, greatest=4.0)),
    ("tool_offset", Recipe()),
    ("thermal_expansion", Recipe(least=0.03, greatest=4.0)),
    ("thermal_bending", Recipe(greatest=3.0)),
    ("gearbox_thermal", Recipe(greatest=10.0)),
    ("creep", Recipe(designs=LOADS)),
    ("base_tilt", Recipe(designs=LOADS, greatest=6.0)),
    ("frame_misalignment", Recipe()),
    ("frame_drift", Recipe()),
    ("instrument_scale", Recipe()),
    ("counterbalance", Recipe(stiffness=("drives", "bodies"), designs=LOADS, not_rail=True)),
    ("latency", Recipe(designs=("moving",))),
)
SINGLES = tuple(name for name, _ in _RECIPES)


def recipe(effect: str) -> Recipe:
    """The recipe of an effect of the table; that of one outside it holds nothing special."""
    return dict(_RECIPES).get(effect, Recipe(stiffness=("links", "drives")))


def _sign(rng: np.random.Generator) -> float:
    return 1.0 if rng.random() < 0.5 else -1.0


def _lag(rng: np.random.Generator) -> float:
    return 0.0 if rng.random() < 0.3 else round(float(rng.uniform(0.3, 2.0)) * 3600.0, 0)


def _joint(scene: Scene, rng: np.random.Generator, *, loaded: bool = False, first: int = 0) -> int:
    arm = scene.arm
    load = np.sqrt(np.mean(scene.solution.torque**2, axis=1))
    load[[j.prismatic for j in arm.joints]] = 0.0
    fit = [
        i
        for i in range(first, arm.count)
        if not arm.joints[i].prismatic and (not loaded or load[i] > 0.03 * load.max())
    ]
    return int(rng.choice(fit))


def _turning_link(scene: Scene, rng: np.random.Generator, *, elastic: bool | None = None) -> int:
    """A link that turns, with a section, without one, or either."""
    links, joints = scene.arm.links, scene.arm.joints
    fit = [i for i in range(scene.arm.count) if elastic is None or (links[i].section is not None) == elastic]
    turning = [i for i in fit if not joints[i].prismatic and tuple(links[i].direction) != tuple(joints[i].axis)]
    return int(rng.choice(turning or fit))


def _vector(rng: np.random.Generator, planar: bool, size: float) -> list[float]:
    way = rng.standard_normal(3)
    way[2] *= 0.0 if planar else 1.0
    return [float(x) for x in way / np.linalg.norm(way) * size]


def draw_effect(name: str, scene: Scene, ranges: Ranges, rng: np.random.Generator) -> Effect:
    """The effect at a drawn place with drawn parameters; its dose is at a middling size."""
    sized = float(rng.uniform(0.5, 2.0))
    if name in ("link_bending", "link_modulus", "link_mass", "link_length", "thermal_expansion", "thermal_bending"):
        return _at_link(name, scene, sized, rng)
    drawn = _of_drive(name, scene, sized, rng) or _of_angle(name, scene, sized, rng)
    return drawn or _of_arm(name, scene, sized, rng) or _outside(name, scene, ranges, sized, rng)


def _of_drive(name: str, scene: Scene, sized: float, rng: np.random.Generator) -> Effect | None:
    """What drives and bearings do; None for another effect."""
    if name in ("joint_compliance", "servo_droop", "joint_hardening", "creep"):
        i = _joint(scene, rng, loaded=True)
        most = float(np.abs(scene.solution.torque[i]).max())
        values = {"compliance": sized * 2e-4 / max(most, 1e-6)}
        if name == "joint_hardening":
            values |= {"knee": round(most * float(rng.uniform(0.2, 0.5)), 3), "zones": float(rng.random() < 0.5)}
        if name == "creep":
            values |= {"time": round(float(rng.uniform(0.3, 1.2)) * 3600.0, 0)}
        return Effect(name, (i + 1,), "compliance", values)
    if name == "backlash":
        i = _joint(scene, rng)
        most = float(np.abs(scene.solution.torque[i]).max())
        held = float(rng.choice([0.0, 0.35 * most, 1.3 * most + 1.0], p=[0.35, 0.2, 0.45]))
        return Effect(name, (i + 1,), "total", {"total": 2e-4 * sized, "held_below": round(held, 2)})
    if name == "friction_windup":
        i = _joint(scene, rng, loaded=True)
        mean = float(np.abs(scene.solution.torque[i]).mean())
        return Effect(name, (i + 1,), "coulomb", {"coulomb": 4e-5 * sized, "proportional": 8e-5 * sized / mean})
    if name == "clearance":
        return Effect(name, (_joint(scene, rng) + 1,), "radius", {"radius": 4e-5 * sized})
    return None


def _of_angle(name: str, scene: Scene, sized: float, rng: np.random.Generator) -> Effect | None:
    """What is wrong with a joint's angle; None for another effect."""
    keys = {"encoder_offset": "offset", "encoder_scale": "scale", "joint_coupling": "ratio"}
    if name in keys:
        i = 2 if name == "joint_coupling" else _joint(scene, rng)
        return Effect(name, (i + 1,), keys[name], {keys[name]: _sign(rng) * 1e-4 * sized})
    if name in ("encoder_eccentricity", "gear_transmission_error"):
        phase, i = float(rng.uniform(0, 2 * np.pi)), _joint(scene, rng)
        values = {"sine": 1e-4 * sized * np.cos(phase), "cosine": 1e-4 * sized * np.sin(phase)}
        if name == "gear_transmission_error":
            values |= {"harmonic": float(rng.choice([2, 3, 4, 5, 6, 8, 10]))}
        return Effect(name, (i + 1,), "sine", values)
    if name == "gearbox_thermal":
        i = _joint(scene, rng)
        return Effect(name, (i + 1,), "rate", {"rate": _sign(rng) * 5e-6 * sized, "lag": _lag(rng)})
    return None


def _of_arm(name: str, scene: Scene, sized: float, rng: np.random.Generator) -> Effect | None:
    """What concerns the whole arm, its base, its tip or the instrument; None for another effect."""
    arm, planar = scene.arm, scene.arm.planar
    if name in ("slope_propagation", "shear_deformation"):
        every = tuple(i + 1 for i in range(arm.count) if arm.links[i].section is not None)
        return Effect(name, every, "share", {"share": 1.0})
    if name == "payload":
        return Effect(name, (), "mass", {"mass": 0.5 * sized})
    if name == "tool_offset":
        a, b, c = _vector(rng, planar, 2e-4 * sized)
        return Effect(name, (), "a", {"a": a, "b": b, "c": c})
    if name == "base_tilt":
        way = [0.0, 0.0, _sign(rng)] if planar else [*_vector(rng, True, 1.0)[:2], 0.0]
        return Effect(name, (), "z", dict(zip("xyz", (3e-3 * sized * w for w in way), strict=True)))
    if name == "base_compliance":
        most = float(np.abs(scene.solution.torque[0]).max())
        return Effect(name, (), "compliance", {"compliance": 2e-4 * sized / max(most, 1e-6)})
    if name in ("frame_misalignment", "frame_drift"):
        hours = float(scene.design.time[-1] - scene.design.time[0]) / 3600.0 if name == "frame_drift" else 1.0
        x, y, z = _vector(rng, planar, 1e-4 * sized / hours)
        turn = _sign(rng) * 1e-4 * float(rng.uniform(0.0, 1.0)) / hours
        return Effect(name, (), "x", {"x": x, "y": y, "z": z, "rotation": turn})
    if name == "instrument_scale":
        return Effect(name, (), "scale", {"scale": _sign(rng) * 1e-4 * sized})
    if name == "counterbalance":
        values = {"spring": 100.0 * sized, "phase": round(float(rng.uniform(-0.8, 0.8)), 3)}
        return Effect(name, (2,), "spring", values)
    if name == "latency":
        return Effect(name, (), "delay", {"delay": 1e-3 * sized})
    return None


def _at_link(name: str, scene: Scene, sized: float, rng: np.random.Generator) -> Effect:
    arm = scene.arm
    elastic = {"link_bending": False, "link_modulus": True}.get(name)
    i = _turning_link(scene, rng, elastic=elastic)
    if name == "link_bending":
        return Effect(name, (i + 1,), "flexibility", {"flexibility": 2e-6 * sized})
    if name == "link_modulus":
        return Effect(name, (i + 1,), "softness", {"softness": (0.25 if rng.random() < 0.6 else -0.12) * sized / 2})
    if name == "link_mass":
        return Effect(name, (i + 1,), "mass", {"mass": 0.8 * sized})
    if name == "link_length":
        return Effect(name, (i + 1,), "length", {"length": _sign(rng) * 2e-4 * sized})
    if name == "thermal_bending":
        return Effect(name, (i + 1,), "gradient", {"gradient": _sign(rng) * 0.2 * sized, "lag": _lag(rng)})
    # the coefficient is the material's: the swing of the air sets the dose
    evenly = rng.random() < 0.25
    at = tuple(range(1, arm.count + 1)) if evenly else (i + 1,)
    near = arm.links[i].expansion * float(rng.uniform(0.92, 1.08))
    return Effect(name, at, "expansion", {"expansion": near, "lag": _lag(rng)})


def _outside(name: str, scene: Scene, ranges: Ranges, sized: float, rng: np.random.Generator) -> Effect:
    tip, design = scene.solution.tip, scene.design
    i = _joint(scene, rng)
    centre, spread = tip.mean(axis=1), tip.std(axis=1)
    anchor = centre + spread * rng.uniform(-1.5, 1.5, 3) * np.array([1.0, 1.0, 0.0 if scene.arm.planar else 1.0])
    place = dict(zip("xyz", (float(x) for x in anchor), strict=True))
    if name == "tip_spring":
        return Effect(name, (), "rate", {"rate": 50.0 * sized, **place})
    if name == "tip_magnet":
        return Effect(name, (), "pull", {"pull": 30.0 * sized, "core": float(np.linalg.norm(spread)) * 0.3, **place})
    if name == "cable_force":
        return Effect(name, (), "size", {"size": 15.0 * sized, "seed": float(rng.integers(1 << 31))})
    joint = {"joint": float(i + 1), "size": _sign(rng) * 1.5e-4 * sized}
    if name == "slip":
        starts = np.flatnonzero(design.fresh > 0)
        row = int(starts[int(len(starts) * float(rng.uniform(0.25, 0.75)))])
        return Effect(name, (i + 1,), "size", {**joint, "since": float(design.time[row])})
    if name == "periodic_in_time":
        period = float(design.time[-1]) / float(rng.uniform(3.0, 9.0))
        return Effect(name, (i + 1,), "size", {**joint, "period": period, "phase": float(rng.uniform(0, 6.28))})
    if name == "stick":
        low, high = ranges.low[i], ranges.high[i]
        middle = float(rng.uniform(low + 0.2 * (high - low), high - 0.2 * (high - low)))
        half = (high - low) * float(rng.uniform(0.08, 0.16))
        return Effect(name, (i + 1,), "size", {**joint, "centre": middle, "half_width": half})
    raise ValueError(name)
