"""The arms of the cases: a few planar and spatial families, sizes drawn within them, and their arm files."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import yaml

from benchmarks.blind.generator.beams import Section, circle, rectangular_tube, tube
from benchmarks.blind.generator.mechanics import Arm, Joint, Link, nominal_inputs, solve

STEEL = (210e9, 0.3, 7850.0, 12e-6)
ALUMINIUM = (70e9, 0.3, 2700.0, 23e-6)
FAMILIES = ("planar_2r", "planar_3r", "welding_3r", "planar_4r", "rail_2r", "spatial_3r", "spatial_6r")
Way = tuple[float, float, float]
Z, DOWN_Y, X = (0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class Ranges:
    """Lowest and highest coordinate of each joint, rad or m."""

    low: tuple[float, ...]
    high: tuple[float, ...]


def _bar(length: float, section: Section, material: tuple[float, ...], direction: Way = X) -> Link:
    e, nu, rho, alpha = material  # Pa, -, kg/m^3, 1/K
    return Link(length, direction, rho * section.area, section, e, nu, rho, alpha, section.depth)


def _rigid(length: float, mass: float, expansion: float, depth: float, direction: Way = X) -> Link:
    return Link(length, direction, mass / length, None, expansion=expansion, depth=depth)


def draw_arm(family: str, stiffness: str, rng: np.random.Generator) -> tuple[Arm, Ranges]:
    """An arm of the family; `stiffness` is 'links' (rigid drives), 'drives' (both give) or 'bodies' (rigid links)."""
    material = STEEL if rng.random() < 0.5 and family != "welding_3r" else ALUMINIUM
    size = (1.0 if material is STEEL else 1.15) * float(rng.uniform(0.5, 0.9) if stiffness == "links" else 1.0)
    nu = material[1]

    def mm(value: float) -> float:
        return round(value * 1e3 * float(rng.uniform(0.95, 1.05))) / 1e3

    def pipe(diameter: float) -> Section:
        return tube(mm(diameter * size), mm(max(0.003, 0.05 * diameter)), nu)

    planar = family not in ("spatial_3r", "spatial_6r")
    turning = Joint(False, Z)
    if family == "planar_2r":
        joints, links = (turning,) * 2, (_bar(mm(0.5), pipe(0.07), material), _bar(mm(0.4), pipe(0.06), material))
        low, high = (-1.6, -2.3), (1.6, 2.3)
    elif family == "planar_3r":
        joints = (turning,) * 3
        links = tuple(_bar(mm(a), pipe(d), material) for a, d in ((0.85, 0.12), (0.75, 0.1), (0.3, 0.07)))
        low, high = (-1.7, -2.2, -2.2), (1.7, 2.2, 2.2)
    elif family == "welding_3r":
        joints = (turning,) * 3
        solid = rng.random() < 0.5
        links = tuple(
            _bar(mm(a), circle(mm(size * d), nu) if solid else rectangular_tube(mm(0.8 * d), mm(d), 0.003), material)
            for a, d in ((0.4, 0.08), (0.42, 0.07), (0.42, 0.06))
        )
        low, high = (-2.0, -2.2, -2.2), (2.0, 2.2, 2.2)
    elif family == "planar_4r":
        joints = (turning,) * 4
        sizes = ((0.5, 0.09), (0.4, 0.08), (0.3, 0.07), (0.2, 0.06))
        links = tuple(_bar(mm(a), pipe(d), material) for a, d in sizes)
        low, high = (-1.6, -2.0, -2.0, -2.0), (1.6, 2.0, 2.0, 2.0)
    elif family == "rail_2r":
        joints = (Joint(True, X), turning, turning)
        links = (
            _bar(mm(0.2), pipe(0.12), material),
            _bar(mm(0.6), pipe(0.09), material),
            _bar(mm(0.4), pipe(0.07), material),
        )
        low, high = (0.0, -1.6, -2.2), (1.0, 1.6, 2.2)
    elif family == "spatial_3r":
        joints = (turning, Joint(False, DOWN_Y), Joint(False, DOWN_Y))
        links = (
            _bar(mm(0.4), pipe(0.14), material, Z),
            _bar(mm(0.6), pipe(0.09), material),
            _bar(mm(0.5), pipe(0.07), material),
        )
        low, high = (-2.5, -0.6, -2.2), (2.5, 1.8, 0.8)
    elif family == "spatial_6r":
        bend = Joint(False, DOWN_Y)
        roll = Joint(False, X)
        joints = (turning, bend, bend, roll, bend, roll)
        links = (
            _bar(mm(0.4), pipe(0.15), material, Z),
            _bar(mm(0.55), pipe(0.11), material),
            _bar(mm(0.35), pipe(0.1), material),
            _rigid(mm(0.2), 3.0, material[3], 0.1),
            _rigid(mm(0.1), 2.0, material[3], 0.08),
            _rigid(mm(0.15), 1.0, material[3], 0.08, (0.6, 0.0, 0.8)),
        )
        low, high = (-2.5, -0.4, -1.8, -2.5, -1.8, -2.8), (2.5, 1.6, 0.6, 2.5, 1.8, 2.8)
    else:
        raise ValueError(family)
    joints = tuple(replace(j, mass=round(float(rng.uniform(0.0, 3.0)), 1) if i else 0.0) for i, j in enumerate(joints))
    if stiffness == "bodies":
        links = tuple(
            _rigid(k.length, round(k.line_mass * k.length, 2), k.expansion, k.depth, k.direction) for k in links
        )
    gravity = (0.0, -9.81, 0.0) if planar else (0.0, 0.0, -9.81)
    payload = round(float(rng.uniform(1.0, 5.0)), 1)
    arm = Arm(f"{family} {stiffness}", family, joints, links, gravity, payload, planar)
    if stiffness in ("drives", "bodies"):
        arm = _with_drives(arm, Ranges(low, high), rng)
    return arm, Ranges(low, high)


def _with_drives(arm: Arm, ranges: Ranges, rng: np.random.Generator) -> Arm:
    """Drives that give 0.05 to 0.3 mrad under their greatest torque, as catalogue figures of three digits."""
    q = rng.uniform(np.array(ranges.low)[:, None], np.array(ranges.high)[:, None], (arm.count, 200))
    torque = solve(arm, nominal_inputs(arm, q, np.full(200, arm.payload), np.zeros((3, 200))), 1).torque
    joints = []
    for joint, load in zip(arm.joints, np.abs(torque).max(axis=1), strict=True):
        give = float(rng.uniform(0.05e-3, 0.3e-3))
        stiff = max(float(load), 5.0) / give
        rounded = float(f"{stiff:.2e}")
        joints.append(replace(joint, compliance=0.0 if joint.prismatic else 1.0 / rounded))
    return replace(arm, joints=tuple(joints))


def _mm(value: float) -> str:
    return f"{value * 1e3:.10g} mm"


def _link_entry(link: Link) -> dict[str, object]:
    entry: dict[str, object] = {"length": _mm(link.length)}
    if tuple(link.direction) != X:
        entry["direction"] = [float(x) for x in link.direction]
    if link.section is None:
        mass = link.line_mass * link.length
        return entry | {"rigid": True, "mass": f"{mass:.10g} kg", "center_of_mass": _mm(link.length / 2)}
    shape = {key: value if isinstance(value, str) else _mm(value) for key, value in link.section.keys}
    material = {
        "elastic_modulus": f"{link.elastic_modulus / 1e9:.10g} GPa",
        "poisson_ratio": link.poisson_ratio,
        "density": f"{link.density:.10g} kg/m^3",
        "thermal_expansion": f"{link.expansion * 1e6:.10g} um/(m*K)",
    }
    return entry | {"section": shape, "material": material}


def arm_file(arm: Arm, ranges: Ranges) -> str:
    """The arm file that a tool is given: the nominal arm."""
    chain = []
    for joint, link, low, high in zip(arm.joints, arm.links, ranges.low, ranges.high, strict=True):
        entry: dict[str, object] = {"type": "prismatic" if joint.prismatic else "revolute"}
        usual = X if joint.prismatic else Z
        if tuple(joint.axis) != usual:
            entry["axis"] = {DOWN_Y: "-y", X: "x", Z: "z"}[joint.axis]
        unit = 1e3 if joint.prismatic else 180.0 / math.pi
        name = "mm" if joint.prismatic else "deg"
        entry["range"] = [f"{low * unit:.6g} {name}", f"{high * unit:.6g} {name}"]
        if joint.compliance > 0.0:
            entry["stiffness"] = f"{1.0 / joint.compliance:.10g} {'N/m' if joint.prismatic else 'N*m/rad'}"
        if joint.mass > 0.0:
            entry["mass"] = f"{joint.mass:.10g} kg"
        chain.append({"joint": entry, "link": _link_entry(link)})
    file: dict[str, object] = {
        "name": arm.name,
        "gravity": [f"{g:.10g} m/s^2" for g in arm.gravity],
        "temperature": "20 degC",
        "chain": chain,
        "payload": {"mass": f"{arm.payload:.10g} kg"},
    }
    if arm.leave_out:
        file["leave_out"] = list(arm.leave_out)
    return yaml.safe_dump(file, sort_keys=False, width=200)
