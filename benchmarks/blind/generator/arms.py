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
Way = tuple[float, float, float]
Z, DOWN_Y, X = (0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0)


JOINTS = {"z": Joint(False, Z), "y": Joint(False, DOWN_Y), "x": Joint(False, X), "rail": Joint(True, X)}
WAYS = {"x": X, "z": Z, "wrist": (0.6, 0.0, 0.8)}


@dataclass(frozen=True)
class Family:
    """A kind of arm: its joints by name, its links (length and diameter of a bar in m, or length, mass in kg and depth
    of a rigid body), the ends of the joints' ranges, and which way the links go (along x)."""

    joints: str
    links: tuple[tuple[float, ...], ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    ways: str = ""

    def along(self) -> list[Way]:
        """The direction of each link."""
        return [WAYS[name] for name in self.ways.split()] or [X] * len(self.links)

    @property
    def planar(self) -> bool:
        """Whether it moves in a plane."""
        return not {"x", "y"} & set(self.joints.split())


_KINDS = {
    "planar_2r": Family("z z", ((0.5, 0.07), (0.4, 0.06)), (-1.6, -2.3), (1.6, 2.3)),
    "planar_3r": Family("z z z", ((0.85, 0.12), (0.75, 0.1), (0.3, 0.07)), (-1.7, -2.2, -2.2), (1.7, 2.2, 2.2)),
    "welding_3r": Family("z z z", ((0.4, 0.08), (0.42, 0.07), (0.42, 0.06)), (-2.0, -2.2, -2.2), (2.0, 2.2, 2.2)),
    "planar_4r": Family(
        "z z z z",
        ((0.5, 0.09), (0.4, 0.08), (0.3, 0.07), (0.2, 0.06)),
        (-1.6, -2.0, -2.0, -2.0),
        (1.6, 2.0, 2.0, 2.0),
    ),
    "rail_2r": Family("rail z z", ((0.2, 0.12), (0.6, 0.09), (0.4, 0.07)), (0.0, -1.6, -2.2), (1.0, 1.6, 2.2)),
    "spatial_3r": Family(
        "z y y", ((0.4, 0.14), (0.6, 0.09), (0.5, 0.07)), (-2.5, -0.6, -2.2), (2.5, 1.8, 0.8), "z x x"
    ),
    "spatial_6r": Family(
        "z y y x y x",
        ((0.4, 0.15), (0.55, 0.11), (0.35, 0.1), (0.2, 3.0, 0.1), (0.1, 2.0, 0.08), (0.15, 1.0, 0.08)),
        (-2.5, -0.4, -1.8, -2.5, -1.8, -2.8),
        (2.5, 1.6, 0.6, 2.5, 1.8, 2.8),
        "z x x x x wrist",
    ),
}
FAMILIES = tuple(_KINDS)


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

    kind = _KINDS[family]
    solid = family == "welding_3r" and rng.random() < 0.5

    def section(diameter: float) -> Section:
        if family != "welding_3r":
            return pipe(diameter)
        return circle(mm(size * diameter), nu) if solid else rectangular_tube(mm(0.8 * diameter), mm(diameter), 0.003)

    links = tuple(
        _bar(mm(length), section(rest[0]), material, way)
        if len(rest) == 1
        else _rigid(mm(length), rest[0], material[3], rest[1], way)
        for (length, *rest), way in zip(kind.links, kind.along(), strict=True)
    )
    joints, low, high = tuple(JOINTS[name] for name in kind.joints.split()), kind.low, kind.high
    joints = tuple(replace(j, mass=round(float(rng.uniform(0.0, 3.0)), 1) if i else 0.0) for i, j in enumerate(joints))
    if stiffness == "bodies":
        links = tuple(
            _rigid(k.length, round(k.line_mass * k.length, 2), k.expansion, k.depth, k.direction) for k in links
        )
    gravity = (0.0, -9.81, 0.0) if kind.planar else (0.0, 0.0, -9.81)
    payload = round(float(rng.uniform(1.0, 5.0)), 1)
    arm = Arm(f"{family} {stiffness}", family, joints, links, gravity, payload, kind.planar)
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
